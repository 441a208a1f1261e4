//! The scanner behind the outline: one pass, an explicit stack, no content.

use std::ops::Range;

use super::{Kind, MAX_DEPTH, MAX_VALUES, NONE, Node, NodeId, Outline};

/// The first place at which a text stops being well-formed.
#[derive(Clone, Debug)]
pub struct SyntaxError {
    /// The bytes to mark.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What was expected; may be empty.
    pub label: String,
    /// The remedy; may be empty.
    pub help: String,
}

impl SyntaxError {
    fn new(span: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Self {
        Self {
            span,
            message: message.into(),
            label: label.into(),
            help: String::new(),
        }
    }

    fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = help.into();
        self
    }
}

/// What has to come next.
enum Next {
    Value,
    /// An element, a field, an entry, or the closing bracket.
    ItemOrClose,
    CommaOrClose,
}

pub(super) struct Scanner<'t> {
    text: &'t str,
    at: usize,
    outline: Outline,
    /// Open composite values, outermost first.
    open: Vec<NodeId>,
    /// Key of the value that comes next.
    key: Range<usize>,
}

type Step<T = Next> = Result<T, SyntaxError>;

impl<'t> Scanner<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let at = if text.starts_with('\u{feff}') {
            '\u{feff}'.len_utf8()
        } else {
            0
        };
        let outline = Outline {
            nodes: vec![],
            extensions: vec![],
        };
        Self {
            text,
            at,
            outline,
            open: vec![],
            key: 0..0,
        }
    }

    pub(super) fn run(mut self) -> Result<Outline, SyntaxError> {
        self.headers()?;
        if self.peek().is_none() {
            return Err(SyntaxError::new(
                0..0,
                "the scene is empty",
                "expected a scene `(...)`",
            ));
        }
        let mut next = self.value()?;
        while !self.open.is_empty() {
            next = match next {
                Next::Value => self.value()?,
                Next::ItemOrClose => self.item_or_close()?,
                Next::CommaOrClose => self.comma_or_close()?,
            };
        }
        self.skip_space()?;
        if self.at < self.text.len() {
            let label = "expected the end of the file";
            return Err(SyntaxError::new(
                self.token(),
                "text after the scene's end",
                label,
            ));
        }
        Ok(self.outline)
    }

    /// `#![enable(name, ...)]`, any number of times.
    fn headers(&mut self) -> Step<()> {
        self.skip_space()?;
        while self.rest().starts_with('#') {
            for part in ["#", "!", "[", "enable", "("] {
                self.expect(part)?;
            }
            while self.peek() != Some(')') {
                let name = self.atom();
                if name.is_empty() {
                    return Err(self.unexpected("the name of an extension"));
                }
                self.outline.extensions.push(name);
                self.skip_space()?;
                if self.peek() != Some(')') {
                    self.expect(",")?;
                }
            }
            self.expect(")")?;
            self.expect("]")?;
        }
        Ok(())
    }

    fn expect(&mut self, part: &str) -> Step<()> {
        if !self.rest().starts_with(part) {
            return Err(self.unexpected(&format!("`{part}`")));
        }
        self.at += part.len();
        self.skip_space()
    }

    fn value(&mut self) -> Step {
        self.skip_space()?;
        let start = self.at;
        let key = std::mem::take(&mut self.key);
        match self.peek() {
            Some('(' | '[' | '{') => self.open_bracket(start, key),
            Some('"') => self.string(0, start, key),
            Some('\'') => self.character(start, key),
            Some('r' | 'b') if self.string_prefix().is_some() => {
                let (hashes, length) = self.string_prefix().unwrap_or((0, 0));
                self.at += length;
                self.string(hashes, start, key)
            }
            Some('b') if self.rest().starts_with("b'") => {
                self.at += 1;
                self.character(start, key)
            }
            _ => self.atom_value(start, key),
        }
    }

    /// For `r"`, `r##"`, `b"`, `br#"`: the number of hashes (`usize::MAX`
    /// for none after an `r`, since nothing is escaped there either) and the
    /// length of the prefix.
    fn string_prefix(&self) -> Option<(usize, usize)> {
        let rest = self.rest();
        let body = rest.strip_prefix('b').unwrap_or(rest);
        let raw = body.strip_prefix('r');
        let hashed = raw.unwrap_or(body);
        let tail = hashed.trim_start_matches('#');
        let hashes = hashed.len() - tail.len();
        if !tail.starts_with('"') || (raw.is_none() && hashes > 0) {
            return None;
        }
        let marker = if raw.is_some() && hashes == 0 {
            usize::MAX
        } else {
            hashes
        };
        Some((marker, rest.len() - tail.len()))
    }

    /// A string whose opening quote is next.
    fn string(&mut self, hashes: usize, start: usize, key: Range<usize>) -> Step {
        self.skip_string(hashes, start)?;
        self.push(Kind::Text, start..self.at, start, key)?;
        Ok(Next::CommaOrClose)
    }

    fn skip_string(&mut self, hashes: usize, start: usize) -> Step<()> {
        let body = &self.text[self.at + 1..];
        let length = match hashes {
            0 => unescaped_quote(body, b'"'),
            usize::MAX => body.find('"').map(|i| i + 1),
            n => {
                let close = format!("\"{}", "#".repeat(n));
                body.find(&close).map(|i| i + close.len())
            }
        };
        let Some(length) = length else {
            let mark = start..self.line_end(start);
            return Err(SyntaxError::new(
                mark,
                "this text never ends",
                "expected a closing `\"`",
            ));
        };
        self.at += 1 + length;
        Ok(())
    }

    /// A character literal whose opening quote is next.
    fn character(&mut self, start: usize, key: Range<usize>) -> Step {
        // The longest escape is `\u{10ffff}`.
        let body = &self.text[self.at + 1..];
        match unescaped_quote(body, b'\'').filter(|&n| n <= 12) {
            Some(n) if body.starts_with('\\') || body[..n - 1].chars().count() == 1 => {
                self.at += 1 + n;
                self.push(Kind::Char, start..self.at, start, key)?;
                Ok(Next::CommaOrClose)
            }
            _ => Err(SyntaxError::new(
                start..start + 1,
                "this character never ends",
                "expected one character and a closing `'`",
            )
            .with_help("texts stand in double quotes")),
        }
    }

    fn atom_value(&mut self, start: usize, key: Range<usize>) -> Step {
        let atom = self.atom();
        if atom.is_empty() {
            return Err(self.unexpected("a value"));
        }
        let first = self.text.as_bytes()[start];
        if first.is_ascii_digit() || b"+-.".contains(&first) {
            self.push(Kind::Number, atom, start, key)?;
            return Ok(Next::CommaOrClose);
        }
        let end = self.at;
        self.skip_space()?;
        if self.peek() == Some('(') {
            return self.open_named(start, end, key);
        }
        self.push(Kind::Name, start..end, start, key)?;
        Ok(Next::CommaOrClose)
    }

    fn open_bracket(&mut self, start: usize, key: Range<usize>) -> Step {
        self.open_named(start, start, key)
    }

    /// Opens a composite value whose bracket is next.
    fn open_named(&mut self, start: usize, name_end: usize, key: Range<usize>) -> Step {
        let kind = match self.peek() {
            Some('[') => Kind::List,
            Some('{') => Kind::Map,
            _ => Kind::Tuple,
        };
        if self.open.len() >= MAX_DEPTH {
            let message = format!("brackets are nested more than {MAX_DEPTH} deep");
            return Err(SyntaxError::new(self.at..self.at + 1, message, ""));
        }
        self.at += 1;
        let id = self.push(kind, start..self.at, name_end, key)?;
        self.open.push(id);
        Ok(Next::ItemOrClose)
    }

    fn item_or_close(&mut self) -> Step {
        self.skip_space()?;
        if let Some(step) = self.try_close()? {
            return Ok(step);
        }
        let parent = self.open[self.open.len() - 1];
        match self.outline.kind(parent) {
            Kind::Map => self.map_key()?,
            Kind::Tuple | Kind::Struct => self.field_key(parent)?,
            _ => {}
        }
        Ok(Next::Value)
    }

    fn map_key(&mut self) -> Step<()> {
        let start = self.at;
        match self.string_prefix() {
            Some((hashes, length)) => {
                self.at += length;
                self.skip_string(hashes, start)?;
            }
            None => {
                if self.atom().is_empty() {
                    return Err(self.unexpected("a key such as `\"name\"`"));
                }
            }
        }
        self.key = start..self.at;
        self.skip_space()?;
        if self.peek() != Some(':') {
            return Err(self.unexpected("`:` after the key"));
        }
        self.at += 1;
        Ok(())
    }

    /// Consumes `name:` if there is one, and refuses a mixture of fields and
    /// plain elements.
    fn field_key(&mut self, parent: NodeId) -> Step<()> {
        let start = self.at;
        let name = self.atom();
        self.skip_space()?;
        let is_field = !name.is_empty() && self.peek() == Some(':');
        let is_first = self.outline.children(parent).next().is_none();
        if is_field && is_first {
            self.outline.nodes[parent.0 as usize].kind = Kind::Struct;
        } else if is_field != (self.outline.kind(parent) == Kind::Struct) {
            self.at = start;
            let token = if name.is_empty() { self.token() } else { name };
            let (message, label) = if is_field {
                (
                    "a named field among unnamed values",
                    "the values before have no names",
                )
            } else {
                ("a field without a name", "expected `name: value`")
            };
            return Err(SyntaxError::new(token, message, label));
        }
        if is_field {
            self.key = name;
            self.at += 1;
        } else {
            self.at = start;
        }
        Ok(())
    }

    fn comma_or_close(&mut self) -> Step {
        self.skip_space()?;
        if self.peek() == Some(',') {
            self.at += 1;
            return Ok(Next::ItemOrClose);
        }
        if let Some(step) = self.try_close()? {
            return Ok(step);
        }
        let close = self.closing_bracket();
        Err(self.unexpected(&format!("`,` or `{close}` before this")))
    }

    /// Closes the innermost bracket if its counterpart is next.
    fn try_close(&mut self) -> Step<Option<Next>> {
        let close = self.closing_bracket();
        let id = self.open[self.open.len() - 1];
        match self.peek() {
            Some(c) if c == close => {
                self.at += 1;
                self.outline.nodes[id.0 as usize].end = self.at as u32;
                self.open.pop();
                Ok(Some(Next::CommaOrClose))
            }
            None => {
                let mark = self.outline.head(id);
                Err(SyntaxError::new(
                    mark,
                    format!("expected `{close}`, found the end of the file"),
                    "opened here, never closed",
                ))
            }
            _ => Ok(None),
        }
    }

    fn closing_bracket(&self) -> char {
        match self.open.last().map(|&id| self.outline.kind(id)) {
            Some(Kind::List) => ']',
            Some(Kind::Map) => '}',
            _ => ')',
        }
    }

    fn push(
        &mut self,
        kind: Kind,
        span: Range<usize>,
        name_end: usize,
        key: Range<usize>,
    ) -> Step<NodeId> {
        let index = self.outline.nodes.len();
        if index >= MAX_VALUES {
            let message = format!("the scene has more than {MAX_VALUES} values");
            return Err(SyntaxError::new(span, message, "one too many").with_help(
                "put large meshes into OBJ or PLY files and name them with Mesh(file: \"...\")",
            ));
        }
        let parent = self.open.last().map_or(NONE, |id| id.0);
        self.outline.nodes.push(Node {
            start: span.start as u32,
            end: span.end as u32,
            name_end: name_end as u32,
            key_start: key.start as u32,
            key_end: key.end as u32,
            parent,
            first_child: NONE,
            last_child: NONE,
            next: NONE,
            kind,
        });
        if parent != NONE {
            let last = self.outline.nodes[parent as usize].last_child;
            if last == NONE {
                self.outline.nodes[parent as usize].first_child = index as u32;
            } else {
                self.outline.nodes[last as usize].next = index as u32;
            }
            self.outline.nodes[parent as usize].last_child = index as u32;
        }
        Ok(NodeId(index as u32))
    }

    /// Consumes a run of characters that belong to a number or a name.
    fn atom(&mut self) -> Range<usize> {
        let start = self.at;
        if self.rest().starts_with("r#") {
            self.at += 2;
        }
        let rest = self.rest();
        let is_end = |c: char| !(c.is_alphanumeric() || "_+-.".contains(c));
        self.at += rest.find(is_end).unwrap_or(rest.len());
        start..self.at
    }

    /// White space and comments.
    fn skip_space(&mut self) -> Step<()> {
        loop {
            let rest = self.rest();
            let trimmed = rest.trim_start_matches(is_space);
            self.at += rest.len() - trimmed.len();
            if trimmed.starts_with("//") {
                self.at += trimmed.find('\n').unwrap_or(trimmed.len());
            } else if trimmed.starts_with("/*") {
                self.skip_block_comment()?;
            } else {
                return Ok(());
            }
        }
    }

    fn skip_block_comment(&mut self) -> Step<()> {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let mut depth = 0usize;
        while self.at < bytes.len() {
            let step = match &bytes[self.at..] {
                [b'/', b'*', ..] => {
                    depth += 1;
                    2
                }
                [b'*', b'/', ..] => {
                    depth -= 1;
                    2
                }
                _ => 1,
            };
            self.at += step;
            if depth == 0 {
                return Ok(());
            }
        }
        Err(SyntaxError::new(
            start..start + 2,
            "this comment never ends",
            "expected a closing `*/`",
        ))
    }

    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// The next token, to mark it.
    fn token(&mut self) -> Range<usize> {
        let start = self.at;
        let atom = self.atom();
        self.at = start;
        if atom.is_empty() {
            start..start + self.peek().map_or(0, char::len_utf8)
        } else {
            atom
        }
    }

    fn unexpected(&mut self, expected: &str) -> SyntaxError {
        let token = self.token();
        let found = match &self.text[token.clone()] {
            "" => "the end of the file".to_owned(),
            found if found.len() > 40 => "a long word".to_owned(),
            found => format!("`{found}`"),
        };
        let mark = if token.is_empty() && token.start > 0 {
            // The end of the file: mark the last character instead.
            let last = self.text[..token.start]
                .trim_end()
                .char_indices()
                .next_back();
            last.map_or(token.clone(), |(i, c)| i..i + c.len_utf8())
        } else {
            token
        };
        SyntaxError::new(
            mark,
            format!("unexpected {found}"),
            format!("expected {expected}"),
        )
    }

    fn line_end(&self, from: usize) -> usize {
        self.text[from..]
            .find('\n')
            .map_or(self.text.len(), |i| from + i)
    }
}

/// Bytes up to and including the first `quote` that no backslash escapes.
fn unescaped_quote(body: &str, quote: u8) -> Option<usize> {
    let mut escaped = false;
    for (i, b) in body.bytes().enumerate() {
        match b {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b if b == quote => return Some(i + 1),
            _ => {}
        }
    }
    None
}

/// The white space of RON.
fn is_space(c: char) -> bool {
    matches!(
        c,
        ' ' | '\t'
            | '\n'
            | '\r'
            | '\x0B'
            | '\x0C'
            | '\u{85}'
            | '\u{200E}'
            | '\u{200F}'
            | '\u{2028}'
            | '\u{2029}'
    )
}

//! The scanner behind the outline: one pass, an explicit stack, no content.

mod token;

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

    /// A string whose opening quote is next.
    fn string(&mut self, hashes: usize, start: usize, key: Range<usize>) -> Step {
        self.skip_string(hashes, start)?;
        self.push(Kind::Text, start..self.at, start, key)?;
        Ok(Next::CommaOrClose)
    }

    /// A character literal whose opening quote is next.
    fn character(&mut self, start: usize, key: Range<usize>) -> Step {
        // The longest escape is `\u{10ffff}`.
        let body = &self.text[self.at + 1..];
        match token::unescaped_quote(body, b'\'').filter(|&n| n <= 12) {
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
                "put large meshes into files of their own and name them with Mesh(file: \"...\")",
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
            index: 0,
            kind,
        });
        if parent != NONE {
            let last = self.outline.nodes[parent as usize].last_child;
            if last == NONE {
                self.outline.nodes[parent as usize].first_child = index as u32;
            } else {
                self.outline.nodes[last as usize].next = index as u32;
                self.outline.nodes[index].index = self.outline.nodes[last as usize].index + 1;
            }
            self.outline.nodes[parent as usize].last_child = index as u32;
        }
        Ok(NodeId(index as u32))
    }
}

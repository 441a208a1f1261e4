//! The scanner's lower half: white space, names, numbers and texts.

use std::ops::Range;

use super::{Scanner, Step, SyntaxError};

impl<'t> Scanner<'t> {
    /// For `r"`, `r##"`, `b"`, `br#"`: the number of hashes (`usize::MAX`
    /// for none after an `r`, since nothing is escaped there either) and the
    /// length of the prefix.
    pub(super) fn string_prefix(&self) -> Option<(usize, usize)> {
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

    pub(super) fn skip_string(&mut self, hashes: usize, start: usize) -> Step<()> {
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

    /// Consumes a run of characters that belong to a number or a name.
    pub(super) fn atom(&mut self) -> Range<usize> {
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
    pub(super) fn skip_space(&mut self) -> Step<()> {
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

    pub(super) fn skip_block_comment(&mut self) -> Step<()> {
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

    pub(super) fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    pub(super) fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// The next token, to mark it.
    pub(super) fn token(&mut self) -> Range<usize> {
        let start = self.at;
        let atom = self.atom();
        self.at = start;
        if atom.is_empty() {
            start..start + self.peek().map_or(0, char::len_utf8)
        } else {
            atom
        }
    }

    pub(super) fn unexpected(&mut self, expected: &str) -> SyntaxError {
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

    pub(super) fn line_end(&self, from: usize) -> usize {
        self.text[from..]
            .find('\n')
            .map_or(self.text.len(), |i| from + i)
    }
}

/// Bytes up to and including the first `quote` that no backslash escapes.
pub(super) fn unescaped_quote(body: &str, quote: u8) -> Option<usize> {
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

//! From a formula's text to its words.

use std::ops::Range;

use super::FormulaError;

/// A word of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name,
    /// One of `+ - * / ^ ( ) ,`.
    Mark(u8),
    End,
}

/// Reads one word after the other.
#[derive(Debug)]
pub(super) struct Lexer<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Lexer<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { text, at: 0 }
    }

    /// The next word and its bytes.
    pub(super) fn next(&mut self) -> Result<(Token, Range<usize>), FormulaError> {
        let rest = self.text[self.at..].trim_start();
        let start = self.text.len() - rest.len();
        self.at = start;
        let Some(c) = rest.chars().next() else {
            return Ok((Token::End, start..start));
        };
        let token = match c {
            '0'..='9' | '.' => Token::Number(self.number(rest)?),
            'a'..='z' | 'A'..='Z' | '_' => {
                let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
                self.at += rest.find(|c| !is_part(c)).unwrap_or(rest.len());
                Token::Name
            }
            '*' if rest.starts_with("**") => {
                return Err(
                    FormulaError::new(start..start + 2, "`**` is no operator here")
                        .help("powers are written with `^`, as in `x^2`"),
                );
            }
            '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => {
                self.at += 1;
                Token::Mark(c as u8)
            }
            _ => return Err(stranger(c, start)),
        };
        Ok((token, start..self.at))
    }

    /// A number at the beginning of `rest`: digits, a point, an exponent.
    fn number(&mut self, rest: &str) -> Result<f64, FormulaError> {
        let start = self.at;
        let digits = |from: usize| {
            let tail = &rest[from..];
            from + tail
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(tail.len())
        };
        let mut end = digits(0);
        if rest[end..].starts_with('.') {
            end = digits(end + 1);
        }
        // An `e` belongs to the number only if a whole exponent follows.
        if rest[end..].starts_with(['e', 'E']) {
            let sign = usize::from(rest[end + 1..].starts_with(['+', '-']));
            let after = digits(end + 1 + sign);
            if after > end + 1 + sign {
                end = after;
            }
        }
        self.at += end;
        let error = |message: &str| FormulaError::new(start..start + end, message);
        if rest[end..].starts_with('.') {
            self.at += 1;
            return Err(error("a number with two points"));
        }
        match rest[..end].parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(error("this number is too large").label("beyond 1.8e308")),
            Err(_) => Err(error("a point without digits").label("expected a number")),
        }
    }
}

/// A character that no formula has.
fn stranger(c: char, start: usize) -> FormulaError {
    let help = match c {
        '²' | '³' => "powers are written with `^`, as in `x^2`",
        '×' | '·' | '⋅' => "products are written with `*`",
        '−' | '–' => "the minus sign is `-`",
        '÷' => "quotients are written with `/`",
        'π' => "write `pi`",
        '[' | ']' | '{' | '}' => "only round brackets group",
        '=' => "the surface is where the formula is zero: move everything to one side",
        _ => "a formula has x, y, z, numbers, functions and `+ - * / ^ ( ) ,`",
    };
    let span = start..start + c.len_utf8();
    FormulaError::new(
        span,
        format!("unexpected character `{}`", c.escape_default()),
    )
    .help(help)
}

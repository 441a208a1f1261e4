//! From words to a graph: operator precedence parsing (V. Pratt, *Top Down
//! Operator Precedence*, 1973).

use std::ops::Range;

use super::{
    FormulaError, MAX_BYTES, MAX_DEPTH, MAX_NODES,
    graph::{Graph, NodeId, Refusal},
    lexer::{Lexer, Token},
    operation::{Binary, Unary},
};

/// All names that a formula may use.
pub const NAMES: &[&str] = &[
    "x", "y", "z", "pi", "e", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt",
    "abs", "min", "max",
];

/// How tightly operators bind: a product more than a sum, a sign more than a
/// product, a power most.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const SIGN: u8 = 3;
const POWER: u8 = 4;

/// What a name means.
enum Meaning {
    Variable(u8),
    Number(f64),
    Unary(Unary),
    /// A function of two or more.
    Binary(Binary),
}

fn meaning(name: &str) -> Option<Meaning> {
    Some(match name {
        "x" => Meaning::Variable(0),
        "y" => Meaning::Variable(1),
        "z" => Meaning::Variable(2),
        "pi" => Meaning::Number(std::f64::consts::PI),
        "e" => Meaning::Number(std::f64::consts::E),
        "sin" => Meaning::Unary(Unary::Sin),
        "cos" => Meaning::Unary(Unary::Cos),
        "tan" => Meaning::Unary(Unary::Tan),
        "asin" => Meaning::Unary(Unary::Asin),
        "acos" => Meaning::Unary(Unary::Acos),
        "atan" => Meaning::Unary(Unary::Atan),
        "exp" => Meaning::Unary(Unary::Exp),
        "log" => Meaning::Unary(Unary::Log),
        "sqrt" => Meaning::Unary(Unary::Sqrt),
        "abs" => Meaning::Unary(Unary::Abs),
        "min" => Meaning::Binary(Binary::Min),
        "max" => Meaning::Binary(Binary::Max),
        _ => return None,
    })
}

/// What parsing leaves.
#[derive(Debug)]
pub(super) struct Parsed {
    pub(super) graph: Graph,
    pub(super) root: NodeId,
    /// Where each variable is first written.
    pub(super) first_use: [Option<Range<usize>>; 3],
}

pub(super) fn parse(text: &str) -> Result<Parsed, FormulaError> {
    if text.len() > MAX_BYTES {
        let error = FormulaError::new(0..0, "this formula is too long");
        return Err(error.label(format!("{} bytes; at most {MAX_BYTES}", text.len())));
    }
    let mut parser = Parser {
        text,
        lexer: Lexer::new(text),
        token: Token::End,
        span: 0..0,
        graph: Graph::default(),
        first_use: [None, None, None],
        depth: 0,
    };
    parser.advance()?;
    if parser.token == Token::End {
        let error = FormulaError::new(0..text.len(), "an empty formula");
        return Err(error.help("write one such as `x^2 + y^2 + z^2 - 1`"));
    }
    let root = parser.expression(0)?;
    if parser.token != Token::End {
        return Err(parser.surplus());
    }
    Ok(Parsed {
        graph: parser.graph,
        root,
        first_use: parser.first_use,
    })
}

struct Parser<'t> {
    text: &'t str,
    lexer: Lexer<'t>,
    /// The word that is looked at, and its bytes.
    token: Token,
    span: Range<usize>,
    graph: Graph,
    first_use: [Option<Range<usize>>; 3],
    depth: usize,
}

impl Parser<'_> {
    fn advance(&mut self) -> Result<(), FormulaError> {
        (self.token, self.span) = self.lexer.next()?;
        Ok(())
    }

    fn is(&self, mark: u8) -> bool {
        self.token == Token::Mark(mark)
    }

    /// The operator that is looked at, and how tightly it binds.
    fn operator(&self) -> Option<(u8, u8)> {
        let Token::Mark(mark) = self.token else {
            return None;
        };
        match mark {
            b'+' | b'-' => Some((mark, SUM)),
            b'*' | b'/' => Some((mark, PRODUCT)),
            b'^' => Some((mark, POWER)),
            _ => None,
        }
    }

    /// A part of the text whose operators bind more tightly than `floor`.
    fn expression(&mut self, floor: u8) -> Result<NodeId, FormulaError> {
        if self.depth == MAX_DEPTH {
            let error = FormulaError::new(self.span.clone(), "this formula is nested too deeply");
            return Err(error.label(format!("more than {MAX_DEPTH} levels")));
        }
        self.depth += 1;
        let mut left = self.operand()?;
        while let Some((mark, tightness)) = self.operator().filter(|o| o.1 > floor) {
            let span = self.span.clone();
            self.advance()?;
            // Powers group to the right, the rest to the left.
            let floor = if mark == b'^' { SIGN } else { tightness };
            let right = self.expression(floor)?;
            let node = match mark {
                b'+' => self.graph.binary(Binary::Add, left, right),
                b'-' => self.graph.binary(Binary::Sub, left, right),
                b'*' => self.graph.binary(Binary::Mul, left, right),
                b'/' => self.graph.binary(Binary::Div, left, right),
                _ => self.graph.power(left, right),
            };
            left = node.map_err(|r| refused(r, span))?;
        }
        self.depth -= 1;
        Ok(left)
    }

    /// A number, a name, a bracket, or one of these with a sign.
    fn operand(&mut self) -> Result<NodeId, FormulaError> {
        let span = self.span.clone();
        match self.token {
            Token::Number(value) => {
                self.advance()?;
                self.graph.number(value).map_err(|r| refused(r, span))
            }
            Token::Name => self.name(),
            Token::Mark(b'-') => {
                self.advance()?;
                let of = self.expression(SIGN)?;
                let node = self.graph.unary(Unary::Neg, of);
                node.map_err(|r| refused(r, span))
            }
            Token::Mark(b'(') => {
                self.advance()?;
                let inner = self.expression(0)?;
                self.close(&span)?;
                Ok(inner)
            }
            Token::Mark(_) | Token::End => Err(self.missing_operand()),
        }
    }

    /// The bracket that closes the one at `open`.
    fn close(&mut self, open: &Range<usize>) -> Result<(), FormulaError> {
        match self.token {
            Token::Mark(b')') => self.advance(),
            Token::End => Err(
                FormulaError::new(open.clone(), "this bracket is never closed").help("add a `)`"),
            ),
            _ => Err(self.surplus()),
        }
    }

    fn name(&mut self) -> Result<NodeId, FormulaError> {
        let span = self.span.clone();
        let name = &self.text[span.clone()];
        let Some(meaning) = meaning(name) else {
            let error = FormulaError::new(span, format!("unknown name `{}`", cut(name)));
            return Err(error
                .label("expected a variable, a constant or a function")
                .unknown(name));
        };
        self.advance()?;
        let node = match meaning {
            Meaning::Variable(index) => {
                self.first_use[index as usize].get_or_insert(span.clone());
                self.graph.variable(index)
            }
            Meaning::Number(value) => self.graph.number(value),
            Meaning::Unary(op) => {
                let list = self.arguments(&span)?;
                let [a] = list[..] else {
                    return Err(wrong_count(span, name, "one argument", list.len()));
                };
                self.graph.unary(op, a)
            }
            Meaning::Binary(op) => {
                let list = self.arguments(&span)?;
                let [first, second, ref rest @ ..] = list[..] else {
                    return Err(wrong_count(span, name, "two or more arguments", list.len()));
                };
                let both = self.graph.binary(op, first, second);
                rest.iter()
                    .fold(both, |a, &b| a.and_then(|a| self.graph.binary(op, a, b)))
            }
        };
        node.map_err(|r| refused(r, span))
    }

    /// What stands in the brackets behind a function's name.
    fn arguments(&mut self, name: &Range<usize>) -> Result<Vec<NodeId>, FormulaError> {
        let open = self.span.clone();
        if !self.is(b'(') {
            let word = &self.text[name.clone()];
            return Err(FormulaError::new(
                name.clone(),
                format!("the function `{word}` without brackets"),
            )
            .help(format!("write `{word}(..)`")));
        }
        self.advance()?;
        let mut list = vec![self.expression(0)?];
        while self.is(b',') {
            self.advance()?;
            list.push(self.expression(0)?);
        }
        self.close(&open)?;
        Ok(list)
    }

    /// A word where an operand was expected.
    fn missing_operand(&self) -> FormulaError {
        if self.token == Token::End {
            let end = self.text.trim_end().len();
            // The last character that is there can be marked.
            let last = self.text[..end].char_indices().next_back();
            let span = last.map_or(0..0, |(i, c)| i..i + c.len_utf8());
            return FormulaError::new(span, "the formula ends too early")
                .label("expected something after this");
        }
        let word = &self.text[self.span.clone()];
        let error = FormulaError::new(self.span.clone(), format!("unexpected `{word}`"))
            .label("expected a number, a variable, a function or `(`");
        if self.is(b'+') {
            error.help("a plus sign stands between two parts")
        } else {
            error
        }
    }

    /// A word that stands where an operator or the end was expected.
    fn surplus(&self) -> FormulaError {
        let word = &self.text[self.span.clone()];
        let (message, help) = match self.token {
            Token::Mark(b')') => ("this bracket was never opened".to_owned(), "remove it"),
            Token::Mark(b',') => (
                "unexpected `,`".to_owned(),
                "a comma parts the arguments of `min` and `max`; decimals have a point",
            ),
            _ => (
                format!("an operator is missing before `{}`", cut(word)),
                "products are written with `*`, as in `2*x`",
            ),
        };
        FormulaError::new(self.span.clone(), message).help(help)
    }
}

fn refused(refusal: Refusal, span: Range<usize>) -> FormulaError {
    match refusal {
        Refusal::TooMany => FormulaError::new(span, "this formula has too many parts")
            .label(format!("the part after the {MAX_NODES}th")),
        Refusal::NotFinite => FormulaError::new(span, "this has no finite value")
            .label("of numbers alone, and undefined or too large"),
    }
}

fn wrong_count(span: Range<usize>, name: &str, wanted: &str, found: usize) -> FormulaError {
    FormulaError::new(span, format!("`{name}` takes {wanted}")).label(format!("found {found}"))
}

/// A word cut to a length that fits a message.
fn cut(word: &str) -> String {
    const LONGEST: usize = 40;
    match word.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &word[..end]),
        None => word.to_owned(),
    }
}

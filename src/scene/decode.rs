//! From a part of the text to a value, by way of `ron`, with errors that
//! point at the right place and say what was expected.

use ron::{
    Options,
    error::{Error as RonError, SpannedError},
    extensions::Extensions,
};
use serde::de::DeserializeOwned;
use serde_path_to_error::{Path, Segment};

use super::{
    diagnostics::Diagnostic,
    outline::{Kind, NodeId},
    report::Report,
    suggest::nearest,
    vocabulary::expectation,
};

/// How scene files are read: a field that may be left out is written without
/// `Some`, and names stand directly in front of their fields.
pub(super) fn options() -> Options {
    Options::default().with_default_extension(
        Extensions::IMPLICIT_SOME
            | Extensions::UNWRAP_NEWTYPES
            | Extensions::UNWRAP_VARIANT_NEWTYPES,
    )
}

impl Report {
    /// Reads a value; a mistake is reported and gives `None`. Numbers are
    /// finite, everything else is as written.
    pub(super) fn decode<T: DeserializeOwned>(&mut self, node: NodeId) -> Option<T> {
        let span = self.outline.span(node);
        let source = self.source.clone();
        match decode_text(&source.text()[span]) {
            Ok(value) => Some(value),
            Err(Failure { path, code, offset }) => {
                let mut place = self.resolve(node, path.as_ref());
                // These are met behind the value that is wrong: `800.5` is
                // read as the whole number 800 with something after it.
                if matches!(code, RonError::ExpectedComma | RonError::TrailingCharacters) {
                    place = self.innermost(place, self.outline.span(node).start + offset);
                }
                let diagnostic = self.explain(place, &code);
                self.push(diagnostic);
                None
            }
        }
    }

    /// The value an error's path leads to, as far as it leads.
    fn resolve(&self, node: NodeId, path: Option<&Path>) -> NodeId {
        let mut at = node;
        for segment in path.into_iter().flat_map(Path::iter) {
            let next = match segment {
                Segment::Seq { index } => self.outline.item(at, *index),
                Segment::Map { key } => self.outline.field(self.text(), at, key),
                Segment::Enum { .. } => Some(at),
                Segment::Unknown => None,
            };
            match next {
                Some(next) => at = next,
                None => break,
            }
        }
        at
    }

    /// The innermost value that holds an offset or ends there.
    fn innermost(&self, from: NodeId, offset: usize) -> NodeId {
        let holds = |&child: &NodeId| {
            let span = self.outline.span(child);
            span.start <= offset && offset <= span.end
        };
        std::iter::successors(Some(from), |&at| self.outline.children(at).find(holds))
            .last()
            .unwrap_or(from)
    }

    fn explain(&self, place: NodeId, code: &RonError) -> Diagnostic {
        match code {
            RonError::NoSuchStructField {
                expected, found, ..
            } => self.unknown_field(self.holder_of(place, found), expected),
            RonError::DuplicateStructField { field, .. } => {
                let place = self.holder_of(place, field);
                self.about_key(place, format!("`{field}` is given twice"))
                    .with_label("given before")
                    .with_help("remove one of the two")
            }
            RonError::MissingStructField { field, .. } => self.missing_field(place, field),
            RonError::NoSuchEnumVariant {
                expected,
                found,
                outer,
            } => {
                let kind = outer.as_deref().unwrap_or("name");
                let label = format!("expected one of {}", list(expected));
                let diagnostic = self
                    .about_head(place, format!("unknown {kind} `{}`", short(found)))
                    .with_label(label);
                suggest(diagnostic, found, expected)
            }
            RonError::Message(message) => self.wrong_value(place, message.clone()),
            RonError::ExpectedDifferentLength { expected, found } => {
                let message = match expected.strip_prefix("an array of length ") {
                    Some(needed) => format!("{} where {needed} are needed", count(*found)),
                    None => format!("expected {expected}, found {}", count(*found)),
                };
                self.wrong_value(place, message)
            }
            RonError::ExpectedStructLikeEnd => {
                self.wrong_value(place, "too many values in these brackets".to_owned())
            }
            RonError::IntegerOutOfBounds => {
                let found = &self.text()[self.outline.span(place)];
                let what = if found.starts_with('-') {
                    "negative"
                } else {
                    "out of range"
                };
                self.wrong_value(place, format!("`{}` is {what}", short(found)))
            }
            RonError::InvalidEscape(what) => {
                self.wrong_value(place, format!("invalid escape in this text: {what}"))
            }
            RonError::ExpectedIdentifier => {
                let found = self.outline.kind(place).words();
                self.wrong_value(place, format!("expected a name here, found {found}"))
            }
            RonError::ExpectedStructLike | RonError::ExpectedNamedStructLike(_)
                if self.outline.kind(place) == Kind::Name =>
            {
                let name = short(&self.text()[self.outline.span(place)]);
                self.wrong_value(place, format!("`{name}` needs fields: `{name}(..)`"))
            }
            RonError::ExpectedStructLike | RonError::ExpectedNamedStructLike(_)
                if self.outline.kind(place) == Kind::Tuple =>
            {
                self.wrong_value(
                    place,
                    "expected named fields `name: value` in these brackets".to_owned(),
                )
            }
            other => self.wrong_type(place, other),
        }
    }

    /// Errors about a field may carry the path of the struct or of the field
    /// itself; this is the field.
    fn holder_of(&self, place: NodeId, field: &str) -> NodeId {
        self.outline
            .field(self.text(), place, field)
            .unwrap_or(place)
    }

    pub(super) fn unknown_field(&self, field: NodeId, expected: &[&str]) -> Diagnostic {
        let key = self
            .outline
            .key_text(self.text(), field)
            .unwrap_or_default();
        let owner = self.owner(field);
        let diagnostic = self
            .about_key(field, format!("unknown field `{}`{owner}", short(key)))
            .with_label(format!("expected one of {}", list(expected)));
        suggest(diagnostic, key, expected)
    }

    /// ` in Sphere`, if the field belongs to something with a name.
    fn owner(&self, field: NodeId) -> String {
        let parent = self.outline.parent(field);
        let name = parent.and_then(|p| self.outline.name(p));
        name.map(|n| format!(" in `{}`", short(&self.text()[n])))
            .unwrap_or_default()
    }

    pub(super) fn missing_field(&self, place: NodeId, field: &str) -> Diagnostic {
        let diagnostic = self
            .about_head(place, format!("missing field `{field}`"))
            .with_label(format!("needs `{field}`"));
        match expectation(field) {
            Some(wanted) => diagnostic.with_help(format!("add `{field}: ..`: {wanted}")),
            None => diagnostic.with_help(format!("add `{field}: ..`")),
        }
    }

    /// A message about a value, saying what its field expects.
    pub(super) fn wrong_value(&self, place: NodeId, message: String) -> Diagnostic {
        self.about(place, message).with_label(self.wanted(place))
    }

    fn wrong_type(&self, place: NodeId, code: &RonError) -> Diagnostic {
        let kind = self.outline.kind(place);
        let found = &self.text()[self.outline.span(place)];
        let message = match (kind, code) {
            (
                Kind::Number,
                RonError::ExpectedInteger
                | RonError::InvalidIntegerDigit { .. }
                | RonError::ExpectedComma
                | RonError::TrailingCharacters,
            ) if found.starts_with('-') || found.contains(['.', 'e', 'E']) => {
                let what = if found.starts_with('-') {
                    "negative"
                } else {
                    "not a whole number"
                };
                format!("`{}` is {what}", short(found))
            }
            (Kind::Number, RonError::ExpectedString) => {
                "expected a text in double quotes, found a number".to_owned()
            }
            (
                Kind::Number,
                RonError::ExpectedFloat
                | RonError::ExpectedComma
                | RonError::TrailingCharacters
                | RonError::FloatUnderscore
                | RonError::UnderscoreAtBeginning
                | RonError::UnexpectedChar(_)
                | RonError::InvalidIntegerDigit { .. },
            ) => format!("`{}` is not a number that fits here", short(found)),
            (Kind::Name, RonError::ExpectedString) => {
                format!(
                    "expected a text in double quotes, found the name `{}`",
                    short(found)
                )
            }
            (_, RonError::InvalidValueForType { expected, .. }) => {
                format!("expected {expected}, found {}", kind.words())
            }
            (Kind::Tuple, _) if self.outline.name(place).is_some() => {
                "expected named fields `name: value` in these brackets".to_owned()
            }
            _ => format!("wrong type: found {}", kind.words()),
        };
        self.wrong_value(place, message)
    }

    /// `expected ...` for the field a value belongs to.
    pub(super) fn wanted(&self, place: NodeId) -> String {
        let chain = std::iter::successors(Some(place), |&n| self.outline.parent(n)).take(3);
        for (depth, node) in chain.enumerate() {
            let Some(key) = self.outline.key_text(self.text(), node) else {
                continue;
            };
            if let Some(wanted) = self.wanted_in_map(node) {
                return wanted;
            }
            let in_tuple = depth == 1 && self.outline.kind(node) == Kind::Tuple;
            return match expectation(key) {
                Some(wanted) if depth == 0 => format!("expected {wanted}"),
                Some(wanted) if in_tuple => format!("expected a number; `{key}` is {wanted}"),
                Some(wanted) => format!("`{key}` is {wanted}"),
                None => String::new(),
            };
        }
        String::new()
    }

    /// The same for an entry of a map, whose key is a name.
    fn wanted_in_map(&self, node: NodeId) -> Option<String> {
        let map = self.outline.parent(node)?;
        if self.outline.kind(map) != Kind::Map {
            return None;
        }
        let section = self
            .outline
            .key_text(self.text(), map)
            .and_then(expectation);
        Some(
            section
                .map(|wanted| format!("expected {wanted}"))
                .unwrap_or_default(),
        )
    }
}

/// Why a piece of text could not be decoded.
struct Failure {
    /// Where in the value, as far as the deserializer knew.
    path: Option<Path>,
    code: RonError,
    /// Bytes of the text that had been read.
    offset: usize,
}

fn decode_text<T: DeserializeOwned>(text: &str) -> Result<T, Failure> {
    let failure = |path, e: SpannedError| Failure {
        path,
        offset: offset_of(text, e.span.start.line, e.span.start.col),
        code: e.code,
    };
    let mut deserializer =
        ron::Deserializer::from_str_with_options(text, &options()).map_err(|e| failure(None, e))?;
    let value = match serde_path_to_error::deserialize(&mut deserializer) {
        Ok(value) => value,
        Err(e) => {
            let path = e.path().clone();
            return Err(failure(Some(path), deserializer.span_error(e.into_inner())));
        }
    };
    deserializer
        .end()
        .map_err(|e| failure(None, deserializer.span_error(e)))?;
    Ok(value)
}

/// The byte offset of a line and a column, both counted from 1.
fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text
        .split_inclusive('\n')
        .take(line.saturating_sub(1))
        .map(str::len)
        .sum();
    let rest = text[start..].char_indices().nth(column.saturating_sub(1));
    rest.map_or(text.len(), |(i, _)| start + i)
}

/// Adds the nearest known name, if there is one.
pub(super) fn suggest(diagnostic: Diagnostic, written: &str, known: &[&str]) -> Diagnostic {
    match nearest(written, known.iter().copied()) {
        Some(name) => diagnostic.with_help(format!("did you mean `{name}`?")),
        None => diagnostic,
    }
}

/// `a`, `b` or `c` in words; long lists are cut.
pub(super) fn list(names: &[&str]) -> String {
    const SHOWN: usize = 12;
    let quoted: Vec<String> = names
        .iter()
        .take(SHOWN)
        .map(|name| format!("`{}`", short(name)))
        .collect();
    let more = if names.len() > SHOWN { ", ..." } else { "" };
    quoted.join(", ") + more
}

/// A name cut to a length that fits a message.
pub(super) fn short(name: &str) -> String {
    const LONGEST: usize = 40;
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    name.chars().take(LONGEST).chain("...".chars()).collect()
}

fn count(n: usize) -> String {
    match n {
        1 => "one value".to_owned(),
        n => format!("{n} values"),
    }
}

//! From a part of the text to a value, by way of `ron`, with errors that
//! point at the right place and say what was expected.

use ron::{Options, error::Error as RonError, extensions::Extensions};
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
            Err((path, code)) => {
                let place = self.resolve(node, path.as_ref());
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
                let message = format!("expected {expected}, found {}", count(*found));
                self.wrong_value(place, message)
            }
            RonError::ExpectedStructLikeEnd => {
                self.wrong_value(place, "too many values in these brackets".to_owned())
            }
            RonError::IntegerOutOfBounds => {
                self.wrong_value(place, "this number is out of range".to_owned())
            }
            RonError::InvalidEscape(what) => {
                self.wrong_value(place, format!("invalid escape in this text: {what}"))
            }
            RonError::ExpectedIdentifier | RonError::ExpectedStructLike
                if self.wants_name(place) =>
            {
                let found = self.outline.kind(place).words();
                self.wrong_value(place, format!("expected a name here, found {found}"))
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

    /// Whether a value should start with a name but doesn't.
    fn wants_name(&self, place: NodeId) -> bool {
        self.outline.name(place).is_none()
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
            (Kind::Number, RonError::ExpectedInteger | RonError::InvalidIntegerDigit { .. })
            | (Kind::Number, RonError::TrailingCharacters)
                if found.starts_with('-') || found.contains('.') =>
            {
                format!("`{}` is not a whole number", short(found))
            }
            (Kind::Number, RonError::ExpectedString) => {
                "expected a text in double quotes, found a number".to_owned()
            }
            (Kind::Number, _) => format!("`{}` is not a number that fits here", short(found)),
            (Kind::Name, RonError::ExpectedString) => {
                format!(
                    "expected a text in double quotes, found the name `{}`",
                    short(found)
                )
            }
            (_, RonError::InvalidValueForType { expected, .. }) => {
                format!("expected {expected}, found {}", kind.words())
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
            let element_of_triple = depth == 1 && self.outline.kind(node) == Kind::Tuple;
            return match expectation(key) {
                Some(wanted) if depth == 0 => format!("expected {wanted}"),
                Some(wanted) if element_of_triple => {
                    format!("expected a number; `{key}` is {wanted}")
                }
                Some(wanted) => format!("`{key}` is {wanted}"),
                None => String::new(),
            };
        }
        String::new()
    }
}

/// Decodes a piece of text; an error comes with the path on which it arose.
fn decode_text<T: DeserializeOwned>(text: &str) -> Result<T, (Option<Path>, RonError)> {
    let options = options();
    let mut deserializer =
        ron::Deserializer::from_str_with_options(text, &options).map_err(|e| (None, e.code))?;
    let value = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|e| (Some(e.path().clone()), e.into_inner()))?;
    deserializer.end().map_err(|e| (None, e))?;
    Ok(value)
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

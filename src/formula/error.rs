//! What is wrong with a formula.

use std::ops::Range;

/// The first mistake in a formula.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct FormulaError {
    /// Where it is, in bytes of the formula's text.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What was expected there; may be empty.
    pub label: String,
    /// The remedy; may be empty.
    pub help: String,
    /// A name that is not known: one of [`NAMES`](super::NAMES) may have
    /// been meant.
    pub unknown: Option<String>,
}

impl FormulaError {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            span,
            message: message.into(),
            label: String::new(),
            help: String::new(),
            unknown: None,
        }
    }

    pub(super) fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = help.into();
        self
    }

    pub(super) fn unknown(mut self, name: &str) -> Self {
        self.unknown = Some(name.to_owned());
        self
    }
}

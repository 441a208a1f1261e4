//! What is wrong with a mesh file, and where.

use std::ops::Range;

use crate::scene::diagnostics::Diagnostic;

/// What is wrong with a mesh file.
#[derive(Clone, Debug)]
pub(super) struct Fault {
    at: FaultPlace,
    pub(super) message: String,
    label: String,
}

#[derive(Clone, Debug)]
enum FaultPlace {
    File,
    /// Bytes to mark in a text.
    Text(Range<usize>),
    /// Offset in a binary file.
    Byte(usize),
}

impl Fault {
    pub(super) fn file(message: impl Into<String>) -> Self {
        Self {
            at: FaultPlace::File,
            message: message.into(),
            label: String::new(),
        }
    }

    pub(super) fn text(
        span: Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
    ) -> Self {
        Self {
            at: FaultPlace::Text(span),
            message: message.into(),
            label: label.into(),
        }
    }

    pub(super) fn byte(offset: usize, message: impl Into<String>) -> Self {
        Self {
            at: FaultPlace::Byte(offset),
            message: message.into(),
            label: String::new(),
        }
    }

    pub(super) fn into_diagnostic(self, file: &str, bytes: &[u8]) -> Diagnostic {
        match self.at {
            FaultPlace::File => Diagnostic::of_file(file, self.message),
            FaultPlace::Byte(offset) => Diagnostic::at_byte(file, offset, self.message),
            FaultPlace::Text(span) => {
                let start = bytes[..span.start]
                    .iter()
                    .rposition(|&b| b == b'\n')
                    .map_or(0, |i| i + 1);
                let line = bytes[..start].split(|&b| b == b'\n').count();
                let rest = &bytes[start..];
                let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
                let text = String::from_utf8_lossy(&rest[..end]);
                let place = (line, span.start - start + 1);
                Diagnostic::in_line(file, text.trim_end(), place, span, self.message)
            }
        }
        .with_label(self.label)
    }
}

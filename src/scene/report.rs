//! The desk at which mistakes are collected: a scene's text, its outline and
//! the messages so far.

use super::{
    diagnostics::{Diagnostic, Diagnostics},
    literal,
    outline::{Kind, NodeId, Outline},
    source::Source,
};

/// A scene's text and outline, and what was found wrong with it.
#[derive(Debug)]
pub(super) struct Report {
    pub(super) source: Source,
    pub(super) outline: Outline,
    pub(super) diagnostics: Diagnostics,
}

impl Report {
    pub(super) fn new(source: Source, outline: Outline) -> Self {
        Self {
            source,
            outline,
            diagnostics: Diagnostics::default(),
        }
    }

    pub(super) fn text(&self) -> &str {
        self.source.text()
    }

    /// A field's value, or the whole if it isn't written.
    pub(super) fn field(&self, node: NodeId, key: &str) -> NodeId {
        self.outline.field(self.text(), node, key).unwrap_or(node)
    }

    /// A message about a value that marks it, or only its beginning if it
    /// spans several lines; with its path as a note.
    pub(super) fn about(&self, node: NodeId, message: impl Into<String>) -> Diagnostic {
        let span = self.outline.span(node);
        let multiline = self.text()[span.clone()].contains('\n');
        let mark = if multiline {
            self.outline.head(node)
        } else {
            span
        };
        self.noted(node, Diagnostic::in_text(&self.source, mark, message))
    }

    /// A message about some bytes of what a text says.
    pub(super) fn about_text(
        &self,
        node: NodeId,
        span: std::ops::Range<usize>,
        message: impl Into<String>,
    ) -> Diagnostic {
        let whole = self.outline.span(node);
        let inner = literal::within(&self.text()[whole.clone()], &span);
        let mark = whole.start + inner.start..whole.start + inner.end;
        self.noted(node, Diagnostic::in_text(&self.source, mark, message))
    }

    /// A message about a value that marks only its beginning.
    pub(super) fn about_head(&self, node: NodeId, message: impl Into<String>) -> Diagnostic {
        let mark = self.outline.head(node);
        self.noted(node, Diagnostic::in_text(&self.source, mark, message))
    }

    /// A message about a field's key.
    pub(super) fn about_key(&self, node: NodeId, message: impl Into<String>) -> Diagnostic {
        let mark = self
            .outline
            .key(node)
            .unwrap_or_else(|| self.outline.head(node));
        self.noted(node, Diagnostic::in_text(&self.source, mark, message))
    }

    fn noted(&self, node: NodeId, diagnostic: Diagnostic) -> Diagnostic {
        let path = self.outline.path(self.text(), node);
        match (path.is_empty(), self.object_name(node)) {
            (true, _) => diagnostic,
            (false, None) => diagnostic.with_note(format!("in {path}")),
            (false, Some(name)) => diagnostic.with_note(format!("in {path}, named {name}")),
        }
    }

    /// The name, in its quotes, of the object or light a value belongs to.
    fn object_name(&self, node: NodeId) -> Option<&str> {
        let chain: Vec<NodeId> =
            std::iter::successors(Some(node), |&n| self.outline.parent(n)).collect();
        // The root, its section, the section's element.
        let element = chain.len().checked_sub(3).map(|i| chain[i])?;
        let name = self.outline.field(self.text(), element, "name")?;
        (self.outline.kind(name) == Kind::Text).then(|| &self.text()[self.outline.span(name)])
    }

    pub(super) fn push(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}

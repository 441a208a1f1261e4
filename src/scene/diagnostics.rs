//! What is wrong with a scene, where, and what to do about it.

use std::{fmt, ops::Range};

use annotate_snippets::{AnnotationKind, Element, Level, Origin, Renderer, Snippet};

use super::source::{Source, floor_char_boundary};

/// Diagnostics shown in full; the rest is counted.
const SHOWN: usize = 20;
/// Diagnostics after which reading stops: a file of nothing but mistakes must
/// fill neither memory nor time.
const KEPT: usize = 200;
/// Longest piece of a line shown around a mistake, in bytes.
const EXCERPT: usize = 160;

/// Where in its file a mistake is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A place in a text, counted from 1, the column in characters.
    Text {
        /// Line number.
        line: usize,
        /// Column in characters.
        column: usize,
    },
    /// A place in a binary file.
    Byte {
        /// Bytes before it.
        offset: usize,
    },
}

/// One mistake.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// The file as the user would write it.
    pub file: String,
    /// Where in the file.
    pub place: Place,
    /// The bytes of the file that are marked.
    pub span: Range<usize>,
    /// What is wrong, in one sentence.
    pub message: String,
    /// What was expected there; may be empty.
    pub label: String,
    /// The remedy, where one is known.
    pub help: Option<String>,
    /// Which part of the scene is concerned, or why this is a mistake.
    pub note: Option<String>,
    excerpt: Option<Excerpt>,
}

/// The piece of a line that is shown.
#[derive(Clone, Debug)]
struct Excerpt {
    text: String,
    /// The marked bytes of `text`.
    mark: Range<usize>,
    /// Whether `text` is the line from its start, so that columns in it are
    /// columns in the file.
    is_whole: bool,
}

impl Diagnostic {
    /// A mistake that concerns a file as a whole.
    pub fn of_file(file: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            place: Place::File,
            span: 0..0,
            message: message.into(),
            label: String::new(),
            help: None,
            note: None,
            excerpt: None,
        }
    }

    /// A mistake in a binary file, after `offset` bytes.
    pub fn at_byte(file: impl Into<String>, offset: usize, message: impl Into<String>) -> Self {
        let place = Place::Byte { offset };
        Self {
            place,
            span: offset..offset,
            ..Self::of_file(file, message)
        }
    }

    /// A mistake at a span of a text; only the span's first line is marked.
    pub fn in_text(source: &Source, span: Range<usize>, message: impl Into<String>) -> Self {
        let (line, column) = source.position(span.start);
        let line_span = source.line_span(span.start);
        Self {
            place: Place::Text { line, column },
            excerpt: Some(excerpt(
                &source.text()[line_span.clone()],
                line_span.start,
                &span,
            )),
            span,
            ..Self::of_file(source.name(), message)
        }
    }

    /// A mistake in one line of a text that is not at hand as a whole. The
    /// column counts from 1 in bytes of the line.
    pub(crate) fn in_line(
        file: impl Into<String>,
        text: &str,
        (line, column): (usize, usize),
        span: Range<usize>,
        message: impl Into<String>,
    ) -> Self {
        let mark = column - 1..column - 1 + span.len();
        let mut excerpt = excerpt(text, 0, &mark);
        excerpt.is_whole &= text.is_ascii();
        Self {
            place: Place::Text { line, column },
            excerpt: Some(excerpt),
            span,
            ..Self::of_file(file, message)
        }
    }

    /// Says what was expected.
    #[must_use]
    pub fn with_label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds the remedy.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds which part of the scene is concerned.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(note.into());
        self
    }

    /// `file`, `file:line:column` or `file: byte n`.
    pub fn location(&self) -> String {
        match self.place {
            Place::File => self.file.clone(),
            Place::Text { line, column } => format!("{}:{line}:{column}", self.file),
            Place::Byte { offset } => format!("{}: byte {offset}", self.file),
        }
    }

    /// The diagnostic as a few lines of text, with terminal colours or not.
    pub fn render(&self, colour: bool) -> String {
        let renderer = if colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        let mut parts: Vec<Element<'_>> = Vec::new();
        if let (Some(excerpt), Place::Text { line, column }) = (&self.excerpt, self.place) {
            let label = (!self.label.is_empty()).then_some(self.label.as_str());
            let mark = AnnotationKind::Primary.span(excerpt.mark.clone());
            let snippet = Snippet::source(&excerpt.text).line_start(line).fold(false);
            let snippet = snippet.annotation(mark.label(label));
            if excerpt.is_whole {
                parts.push(snippet.path(&self.file).into());
            } else {
                let origin = Origin::path(&self.file).line(line).char_column(column);
                parts.extend([origin.into(), snippet.into()]);
            }
        } else {
            parts.push(Origin::path(self.location()).into());
            if !self.label.is_empty() {
                parts.push(Level::NOTE.message(self.label.as_str()).into());
            }
        }
        if let Some(note) = &self.note {
            parts.push(Level::NOTE.message(note.as_str()).into());
        }
        if let Some(help) = &self.help {
            parts.push(Level::HELP.message(help.as_str()).into());
        }
        renderer.render(&[Level::ERROR
            .primary_title(self.message.as_str())
            .elements(parts)])
    }
}

/// The part of a line that is worth showing, and the mark within it. `start`
/// is the line's offset in the coordinates of `span`.
fn excerpt(line: &str, start: usize, span: &Range<usize>) -> Excerpt {
    let from = floor_char_boundary(line, span.start.saturating_sub(start));
    let to = floor_char_boundary(line, span.end.saturating_sub(start)).max(from);
    if line.len() <= EXCERPT {
        return Excerpt {
            text: line.to_owned(),
            mark: from..to,
            is_whole: true,
        };
    }
    let window = floor_char_boundary(line, from.saturating_sub(EXCERPT / 2));
    let end = floor_char_boundary(line, window + EXCERPT);
    let lead = if window > 0 { "... " } else { "" };
    let tail = if end < line.len() { " ..." } else { "" };
    let shift = |at: usize| at.min(end) - window + lead.len();
    let text = format!("{lead}{}{tail}", &line[window..end]);
    Excerpt {
        text,
        mark: shift(from)..shift(to),
        is_whole: false,
    }
}

/// All mistakes found in a scene and the files it names, in the order in
/// which they appear.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    dropped: usize,
}

impl Diagnostics {
    /// Adds a mistake.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.list.len() < KEPT {
            self.list.push(diagnostic);
        } else {
            self.dropped += 1;
        }
    }

    /// Whether there are so many mistakes that further ones are not kept.
    pub fn is_full(&self) -> bool {
        self.list.len() >= KEPT
    }

    /// Whether nothing is wrong.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Number of mistakes; a lower bound if the list is full.
    pub fn len(&self) -> usize {
        self.list.len() + self.dropped
    }

    /// The mistakes, up to a limit of two hundred.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }

    /// Puts the mistakes into the order of the text: first those of `file`,
    /// then those of other files.
    pub(crate) fn sort(&mut self, file: &str) {
        self.list.sort_by(|a, b| {
            (a.file != file, &a.file, a.span.start).cmp(&(b.file != file, &b.file, b.span.start))
        });
    }

    /// The first twenty mistakes in full, and how many more there are; with
    /// terminal colours or not.
    pub fn render(&self, colour: bool) -> String {
        let shown: Vec<String> = self
            .list
            .iter()
            .take(SHOWN)
            .map(|d| d.render(colour))
            .collect();
        let mut text = shown.join("\n\n");
        let more = self.len().saturating_sub(SHOWN);
        if more > 0 {
            let least = if self.is_full() { "at least " } else { "" };
            let plural = if more == 1 { "" } else { "s" };
            text.extend([
                "\n\n... and ",
                least,
                &more.to_string(),
                " more mistake",
                plural,
            ]);
        }
        text
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;
    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self {
            list: vec![diagnostic],
            dropped: 0,
        }
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Diagnostic {
        let source = Source::new("a.ron", "(\n  radius: -1,\n)");
        Diagnostic::in_text(&source, 12..14, "negative radius")
            .with_label("expected a length above 0")
            .with_help("write 1")
    }

    #[test]
    fn a_rendered_mistake_shows_place_caret_expectation_and_remedy() {
        let text = sample().render(false);
        for part in [
            "a.ron:2:11",
            "radius: -1",
            "^^ expected a length above 0",
            "help: write 1",
        ] {
            assert!(text.contains(part), "{part:?} is missing in\n{text}");
        }
    }

    #[test]
    fn colour_is_a_choice() {
        assert!(!sample().render(false).contains('\u{1b}'));
        assert!(sample().render(true).contains('\u{1b}'));
    }

    #[test]
    fn long_lines_are_cut_around_the_mistake() {
        let source = Source::new(
            "a.ron",
            format!("{}BAD{}", "é".repeat(4000), "x".repeat(4000)),
        );
        let text = Diagnostic::in_text(&source, 8000..8003, "bad").render(false);
        assert!(
            text.contains("BAD") && text.contains("a.ron:1:4001"),
            "{text}"
        );
        assert!(text.len() < 1000);
    }

    #[test]
    fn many_mistakes_are_counted_not_shown() {
        let mut all = Diagnostics::default();
        for _ in 0..225 {
            all.push(sample());
        }
        assert_eq!(all.len(), 225);
        assert_eq!(all.iter().count(), KEPT);
        let text = all.to_string();
        assert_eq!(text.matches("negative radius").count(), SHOWN);
        assert!(text.contains("and at least 205 more mistakes"));
    }
}

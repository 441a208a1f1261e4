//! A text file that messages point into.

use std::{
    ops::Range,
    sync::{Arc, OnceLock},
};

/// A file's name and text; copies share both.
#[derive(Clone, Debug)]
pub struct Source {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    name: String,
    text: String,
    /// Byte offsets at which lines start, found when first asked for.
    line_starts: OnceLock<Vec<u32>>,
}

impl Source {
    /// A file of the given name and text. Texts of 4 GiB and more are beyond
    /// the limits of every reader in this room.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let inner = Inner {
            name: name.into(),
            text: text.into(),
            line_starts: OnceLock::new(),
        };
        Self {
            inner: Arc::new(inner),
        }
    }

    /// The file's name as the user would write it.
    pub fn name(&self) -> &str {
        &self.inner.name
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.inner.text
    }

    /// Line and column of a byte offset, both counted from 1, the column in
    /// characters. Offsets past the end mean the end.
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let line = self.line_index(offset);
        let start = self.line_starts()[line] as usize;
        let end = floor_char_boundary(self.text(), offset);
        (
            line + 1,
            self.text()[start..end.max(start)].chars().count() + 1,
        )
    }

    /// Byte range of the line that holds an offset, without its line break.
    pub fn line_span(&self, offset: usize) -> Range<usize> {
        let line = self.line_index(offset);
        let start = self.line_starts()[line] as usize;
        let end = self
            .line_starts()
            .get(line + 1)
            .map_or(self.text().len(), |&e| e as usize - 1);
        let end = if end > start && self.text().as_bytes()[end - 1] == b'\r' {
            end - 1
        } else {
            end
        };
        start..end
    }

    fn line_index(&self, offset: usize) -> usize {
        self.line_starts()
            .partition_point(|&start| start as usize <= offset)
            - 1
    }

    fn line_starts(&self) -> &[u32] {
        self.inner.line_starts.get_or_init(|| {
            let breaks = self.text().bytes().enumerate().filter(|&(_, b)| b == b'\n');
            std::iter::once(0)
                .chain(breaks.map(|(i, _)| i as u32 + 1))
                .collect()
        })
    }
}

/// The largest character boundary of `text` at or below `offset`.
pub(crate) fn floor_char_boundary(text: &str, offset: usize) -> usize {
    let mut at = offset.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_characters_and_lines_from_one() {
        let source = Source::new("x.ron", "a\nbé c\r\n\nend");
        assert_eq!(source.position(0), (1, 1));
        assert_eq!(source.position(1), (1, 2));
        assert_eq!(source.position(2), (2, 1));
        // The space follows a two-byte character.
        assert_eq!(source.position(5), (2, 3));
        assert_eq!(source.position(999), (4, 4));
        assert_eq!(&source.text()[source.line_span(4)], "bé c");
        assert_eq!(&source.text()[source.line_span(999)], "end");
        assert_eq!(source.line_span(9), 9..9);
    }

    #[test]
    fn an_empty_text_has_one_line() {
        assert_eq!(Source::new("", "").position(0), (1, 1));
        assert_eq!(Source::new("", "").line_span(0), 0..0);
    }
}

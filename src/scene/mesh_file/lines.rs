//! Texts cut into chunks that are read in parallel.

use std::ops::Range;

/// Bytes of a chunk: long against what its bookkeeping costs, short against
/// a file for which threads matter.
pub(super) const CHUNK: usize = 1 << 20;

/// Cuts `range` into chunks of about `size` bytes. Each ends with a line
/// break, the last one with the range; a line that ends in a backslash is
/// continued by the next and not cut off from it.
pub(super) fn chunks(bytes: &[u8], range: Range<usize>, size: usize) -> Vec<Range<usize>> {
    let mut list = Vec::new();
    let mut start = range.start;
    while start < range.end {
        let mut end = (start + size).min(range.end);
        loop {
            end = line_end(&bytes[..range.end], end);
            let body = bytes[start..end].strip_suffix(b"\n").unwrap_or(b"");
            if end == range.end || !is_continued(body) {
                break;
            }
        }
        list.push(start..end);
        start = end;
    }
    list
}

/// Just after the line break at or behind `at`, or the end.
pub(super) fn line_end(bytes: &[u8], at: usize) -> usize {
    let rest = &bytes[at..];
    rest.iter()
        .position(|&b| b == b'\n')
        .map_or(bytes.len(), |i| at + i + 1)
}

/// Whether the last line ends in a backslash.
fn is_continued(text: &[u8]) -> bool {
    let last = text
        .iter()
        .rev()
        .find(|b| **b == b'\n' || !b.is_ascii_whitespace());
    last == Some(&b'\\')
}

/// The spans of the words between `range`'s ends.
pub(super) fn words(bytes: &[u8], range: Range<usize>, list: &mut Vec<Range<usize>>) {
    let mut start = None;
    for (i, byte) in range.clone().zip(&bytes[range.clone()]) {
        match (start, byte.is_ascii_whitespace()) {
            (None, false) => start = Some(i),
            (Some(s), true) => {
                list.push(s..i);
                start = None;
            }
            _ => {}
        }
    }
    list.extend(start.map(|s| s..range.end));
}

/// A finite number.
pub(super) fn number(text: &[u8]) -> Option<f64> {
    let parsed = std::str::from_utf8(text).ok()?.parse::<f64>().ok();
    parsed.filter(|v| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_cover_all_and_keep_continued_lines() {
        let text = b"one\ntwo \\  \nthree\n\nfour \\\n\\\nfive\nsix";
        for size in 1..40 {
            let list = chunks(text, 0..text.len(), size);
            let mut at = 0;
            for c in &list {
                assert_eq!(c.start, at);
                at = c.end;
                let piece = String::from_utf8_lossy(&text[c.clone()]);
                let last = piece.lines().last().unwrap().trim_end();
                assert!(
                    at == text.len() || !last.ends_with('\\'),
                    "{size}: {piece:?}"
                );
            }
            assert_eq!(at, text.len());
        }
        // A chunk is longer than asked for, hence the blank line is no own one.
        assert_eq!(chunks(text, 0..text.len(), 1).len(), 4);
        assert!(chunks(b"", 0..0, 5).is_empty());
    }
}

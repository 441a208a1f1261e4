//! Where a piece of a text stands in the literal that spells it.

use std::ops::Range;

/// The bytes of a RON text literal, quotes and escapes included, that spell
/// the bytes `span` of its value; relative to the literal's start.
pub(super) fn within(literal: &str, span: &Range<usize>) -> Range<usize> {
    let quote = literal.find('"').map_or(0, |i| i + 1);
    // Nothing is escaped in r"..." and r#"..."#.
    if literal.starts_with(['r', 'b']) {
        return quote + span.start..quote + span.end;
    }
    let (mut raw, mut value) = (quote, 0);
    let mut start = None;
    while value < span.end && raw < literal.len() {
        if value >= span.start {
            start.get_or_insert(raw);
        }
        let (written, meant) = character(&literal[raw..]);
        raw += written;
        value += meant;
    }
    start.unwrap_or(raw)..raw
}

/// How many bytes the first character of a literal's rest takes, as written
/// and as meant.
fn character(rest: &str) -> (usize, usize) {
    let mut letters = rest.chars();
    let first = letters.next().map_or(1, char::len_utf8);
    if !rest.starts_with('\\') {
        return (first, first);
    }
    let code = |digits: &str| {
        let meant = u32::from_str_radix(digits, 16)
            .ok()
            .and_then(char::from_u32);
        meant.map_or(1, char::len_utf8)
    };
    match letters.next() {
        Some('x') => {
            let end = (4..=rest.len()).find(|&i| rest.is_char_boundary(i));
            let end = end.unwrap_or(rest.len());
            (end, code(&rest[2..end]))
        }
        Some('u') => {
            let end = rest.find('}').unwrap_or(rest.len() - 1) + 1;
            let digits = rest[2..end].trim_matches(['{', '}']);
            (end, code(digits))
        }
        Some(c) => (1 + c.len_utf8(), 1),
        None => (1, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_found_behind_escapes() {
        for (literal, piece, marked) in [
            (r#""x + y""#, "y", "y"),
            (r#""a\tb\\c""#, "c", "c"),
            (r#""a\tb\\c""#, "\t", r"\t"),
            (r#""\u{e9}\x41é+q""#, "q", "q"),
            (r#""\u{e9}\x41é+q""#, "A", r"\x41"),
            (r#""\u{e9}\x41é+q""#, "\u{e9}A", r"\u{e9}\x41"),
            (r##"r#"say "x" "#"##, "x", "x"),
            (r#"r"a\tb""#, "b", "b"),
        ] {
            let value: String = ron::from_str(literal).expect(literal);
            let start = value.find(piece).expect(piece);
            let found = within(literal, &(start..start + piece.len()));
            assert_eq!(&literal[found], marked, "{piece} in {literal}");
        }
        assert_eq!(within(r#""""#, &(0..0)), 1..1);
    }
}

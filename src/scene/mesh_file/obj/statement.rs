//! The statements of an OBJ file: one logical line each.

use std::ops::Range;

use crate::scene::mesh_file::{Fault, lines};

/// One line of the file as it stands: where its code is, without a comment,
/// whether it continues in the next line, and where that starts.
fn physical_line(bytes: &[u8], at: usize) -> (Range<usize>, bool, usize) {
    let next = lines::line_end(bytes, at);
    let line = &bytes[at..next];
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    let comment = line.iter().position(|&b| b == b'#');
    let code = line[..comment.unwrap_or(line.len())].trim_ascii_end();
    match code.strip_suffix(b"\\") {
        Some(code) if comment.is_none() => (at..at + code.len(), true, next),
        _ => (at..at + code.len(), false, next),
    }
}

/// The words of the line at `at`, continued where it ends in a backslash, and
/// the start of the next one. Comments are left out.
pub(super) fn logical_line(bytes: &[u8], mut at: usize, words: &mut Vec<Range<usize>>) -> usize {
    words.clear();
    loop {
        let (code, continues, next) = physical_line(bytes, at);
        lines::words(bytes, code, words);
        at = next;
        if !continues || at == bytes.len() {
            return at;
        }
    }
}

/// How many positions and normals a chunk states.
pub(super) fn count(bytes: &[u8], chunk: Range<usize>) -> [usize; 2] {
    let bytes = &bytes[..chunk.end];
    let mut counts = [0; 2];
    let mut at = chunk.start;
    let mut is_new = true;
    while at < bytes.len() {
        let (code, continues, next) = physical_line(bytes, at);
        let code = bytes[code].trim_ascii_start();
        if is_new && !code.is_empty() {
            let end = code.iter().position(u8::is_ascii_whitespace);
            match &code[..end.unwrap_or(code.len())] {
                b"v" => counts[0] += 1,
                b"vn" => counts[1] += 1,
                _ => {}
            }
        }
        // A continued line may have had no word yet.
        is_new = !continues || (is_new && code.is_empty());
        at = next;
    }
    counts
}

/// An index from 0 for one counted from 1, or from the end if negative.
pub(super) fn resolve(
    text: &[u8],
    count: usize,
    span: &Range<usize>,
    what: &str,
) -> Result<u32, Fault> {
    let index: Option<i64> = std::str::from_utf8(text).ok().and_then(|t| t.parse().ok());
    let Some(index) = index else {
        return Err(Fault::text(
            span.clone(),
            format!("the {what} index is not a whole number"),
            "expected `p`, `p/t`, `p//n` or `p/t/n`",
        ));
    };
    let last = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX);
    let resolved = match index {
        1.. => Some(last - 1),
        _ => count.checked_sub(last),
    };
    let Some(resolved) = resolved.filter(|&i| i < count) else {
        let message = format!("{what} {index} does not exist");
        let label = format!("there are {count} so far, counted from 1 or from -1 backwards");
        return Err(Fault::text(span.clone(), message, label));
    };
    u32::try_from(resolved)
        .ok()
        .filter(|&i| i < u32::MAX)
        .ok_or_else(|| Fault::text(span.clone(), format!("too many {what} statements"), ""))
}

/// The first three numbers of a statement.
pub(super) fn coordinates(
    bytes: &[u8],
    keyword: &Range<usize>,
    arguments: &[Range<usize>],
) -> Result<[f64; 3], Fault> {
    if arguments.len() < 3 {
        let message = format!("{} numbers where three are needed", arguments.len());
        return Err(Fault::text(
            keyword.clone(),
            message,
            "expected `x y z` after this",
        ));
    }
    let mut c = [0.0; 3];
    for (value, span) in c.iter_mut().zip(arguments) {
        *value = lines::number(&bytes[span.clone()]).ok_or_else(|| {
            Fault::text(
                span.clone(),
                "this is not a finite number",
                "expected a number",
            )
        })?;
    }
    Ok(c)
}

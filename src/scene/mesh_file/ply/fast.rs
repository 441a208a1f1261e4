//! Many items at once, where they are laid out regularly.

use std::ops::Range;

use rayon::prelude::*;

use super::{
    Piece,
    body::Body,
    header::{ElementKind, Format},
};
use crate::scene::mesh_file::{
    Progress,
    lines::{self, line_end},
};

/// All items of a text with one item in each line that is not blank; `None`
/// if the text is not like that, or wrong.
pub(super) fn lines(
    body: &Body,
    elements: &[ElementKind],
    chunk: usize,
    progress: &Progress,
) -> Option<Piece> {
    let chunks = lines::chunks(body.bytes, body.at..body.bytes.len(), chunk);
    let counts: Vec<u64> = chunks
        .par_iter()
        .map(|c| filled_lines(body.bytes, c).count() as u64)
        .collect();
    let wanted = elements
        .iter()
        .try_fold(0u64, |n, e| n.checked_add(e.count))?;
    if counts.iter().sum::<u64>() != wanted {
        return None;
    }
    let firsts: Vec<u64> = counts
        .iter()
        .scan(0, |sum, n| {
            *sum += n;
            Some(*sum - n)
        })
        .collect();
    let pieces: Option<Vec<Piece>> = chunks
        .par_iter()
        .zip(&firsts)
        .map(|(range, &first)| {
            let piece = items(body, elements, range, first);
            progress.advance(range.len());
            piece
        })
        .collect();
    pieces.map(joined)
}

/// The lines of a chunk that are not blank, without the white space behind.
fn filled_lines<'b>(
    bytes: &'b [u8],
    chunk: &Range<usize>,
) -> impl Iterator<Item = Range<usize>> + 'b {
    let (mut at, end) = (chunk.start, chunk.end);
    std::iter::from_fn(move || {
        while at < end {
            let start = at;
            at = line_end(&bytes[..end], at);
            let length = bytes[start..at].trim_ascii_end().len();
            if length > 0 {
                return Some(start..start + length);
            }
        }
        None
    })
}

/// The items of a chunk's lines; the first of them has number `number` in the
/// file.
fn items(
    body: &Body,
    elements: &[ElementKind],
    chunk: &Range<usize>,
    number: u64,
) -> Option<Piece> {
    let mut piece = Piece::default();
    let mut left = elements.iter();
    let mut element = left.next()?;
    // Items of the current element up to the next line's.
    let mut index = number;
    for line in filled_lines(body.bytes, chunk) {
        while index >= element.count {
            index -= element.count;
            element = left.next()?;
        }
        index += 1;
        let mut reader = Body {
            bytes: &body.bytes[..line.end],
            at: line.start,
            format: body.format,
        };
        piece.take(&mut reader, element).ok()?;
        if reader.at != line.end {
            return None;
        }
    }
    Some(piece)
}

/// All items of a binary element that have the size of its first one; leaves
/// the reader behind them. `None`, with the reader where it was, if they are
/// not like that, or wrong.
pub(super) fn same_size(
    body: &mut Body,
    element: &ElementKind,
    chunk: usize,
    progress: &Progress,
) -> Option<Piece> {
    if body.format == Format::Ascii || element.count == 0 {
        return None;
    }
    let count = usize::try_from(element.count).ok()?;
    let (bytes, start, format) = (body.bytes, body.at, body.format);
    let reader_at = |at| Body { bytes, at, format };
    let mut first = reader_at(start);
    Piece::default().take(&mut first, element).ok()?;
    let size = first.at - start;
    let end = start.checked_add(size.checked_mul(count)?)?;
    if end > bytes.len() {
        return None;
    }
    let per_chunk = (chunk / size).max(1);
    let pieces: Option<Vec<Piece>> = (0..count.div_ceil(per_chunk))
        .into_par_iter()
        .map(|k| {
            let mut piece = Piece::default();
            let items = k * per_chunk..((k + 1) * per_chunk).min(count);
            for i in items.clone() {
                let mut reader = reader_at(start + i * size);
                piece.take(&mut reader, element).ok()?;
                if reader.at != start + (i + 1) * size {
                    return None;
                }
            }
            progress.advance(items.len() * size);
            Some(piece)
        })
        .collect();
    let piece = joined(pieces?);
    body.at = end;
    Some(piece)
}

fn joined(pieces: Vec<Piece>) -> Piece {
    let mut whole = Piece::default();
    whole
        .vertices
        .reserve(pieces.iter().map(|p| p.vertices.len()).sum());
    whole
        .normals
        .reserve(pieces.iter().map(|p| p.normals.len()).sum());
    whole
        .triangles
        .reserve(pieces.iter().map(|p| p.triangles.len()).sum());
    for piece in pieces {
        whole.append(&piece);
    }
    whole
}

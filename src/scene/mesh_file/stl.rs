//! STL, binary and text. Both list triangles with all their corners; corners
//! at equal positions become one vertex, so that the mesh knows how it hangs
//! together. The normals in the file say nothing that the corners don't, and
//! are skipped.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    Fault, MeshData, Progress, lines,
    names::{Namer, Names},
    position,
};
use crate::geometry::mesh::weld::{first_alike, first_at_place, hash_of};

/// Bytes before the triangles of a binary file: a free text and a count.
const HEADER: usize = 84;
/// Bytes of a triangle: normal, three corners, two bytes for anything.
const FACET: usize = 50;

pub(super) fn parse(bytes: &[u8], progress: &Progress) -> Result<MeshData, Fault> {
    let announced = announced_size(bytes);
    if announced == Some(bytes.len() as u64) {
        return binary(bytes, progress);
    }
    // Binary files may start with `solid`, too, but hold zero bytes.
    let head = &bytes[..bytes.len().min(HEADER)];
    if bytes.trim_ascii_start().starts_with(b"solid") && !head.contains(&0) {
        return text(bytes, progress);
    }
    Err(match announced {
        None => Fault::file("too short for an STL file, and no text that starts with `solid`"),
        Some(size) => Fault::byte(
            HEADER - 4,
            format!(
                "the triangles announced here need a file of {size} bytes, but it has {}",
                bytes.len()
            ),
        ),
    })
}

/// The size that a binary file says it has.
fn announced_size(bytes: &[u8]) -> Option<u64> {
    let count: [u8; 4] = bytes.get(HEADER - 4..HEADER)?.try_into().ok()?;
    Some(HEADER as u64 + u64::from(u32::from_le_bytes(count)) * FACET as u64)
}

fn binary(bytes: &[u8], progress: &Progress) -> Result<MeshData, Fault> {
    let facets = &bytes[HEADER..];
    let corner = |i: usize| {
        let at = i / 3 * FACET + 12 + i % 3 * 12;
        let number = |k: usize| {
            let b = &facets[at + 4 * k..at + 4 * k + 4];
            f32::from_le_bytes([b[0], b[1], b[2], b[3]])
        };
        [number(0), number(1), number(2)].map(f64::from)
    };
    let corners = facets.len() / FACET * 3;
    let broken = (0..corners)
        .into_par_iter()
        .position_first(|i| position(corner(i)).is_none());
    if let Some(i) = broken {
        let at = HEADER + i / 3 * FACET + 12 + i % 3 * 12;
        return Err(Fault::byte(at, "a corner is not finite or too far away"));
    }
    progress.advance(bytes.len() / 2);
    // Adding zero makes -0 and 0 the same place.
    let place = |i: usize| corner(i).map(|c| (c + 0.0).to_bits());
    let first = first_alike(
        corners,
        |i| hash_of(place(i)),
        |i, j| place(i).cmp(&place(j)),
    );
    let mesh = welded(&first, |i| DVec3::from_array(corner(i)), Names::default());
    progress.advance(bytes.len() - bytes.len() / 2);
    Ok(mesh)
}

/// The mesh of consecutive corners, given the first at the place of each.
fn welded(first: &[u32], corner: impl Fn(usize) -> DVec3, names: Names) -> MeshData {
    let mut vertices = Vec::new();
    let mut name = vec![0; first.len()];
    for (i, &f) in first.iter().enumerate() {
        name[i] = if f as usize == i {
            vertices.push(corner(i));
            vertices.len() as u32 - 1
        } else {
            name[f as usize]
        };
    }
    MeshData {
        vertices,
        normals: None,
        triangles: name.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        names,
    }
}

/// What a text file may say next.
#[derive(Clone, Copy, PartialEq)]
enum Next {
    Solid,
    Facet,
    Loop,
    /// So many corners were read.
    Vertex(u8),
    EndFacet,
}

impl Next {
    fn words(self) -> &'static str {
        match self {
            Self::Solid => "expected `solid`",
            Self::Facet => "expected `facet normal` or `endsolid`",
            Self::Loop => "expected `outer loop`",
            Self::Vertex(3) => "expected `endloop`: a facet has three corners",
            Self::Vertex(_) => "expected `vertex x y z`",
            Self::EndFacet => "expected `endfacet`",
        }
    }
}

fn text(bytes: &[u8], progress: &Progress) -> Result<MeshData, Fault> {
    let mut next = Next::Solid;
    let mut corners = Vec::new();
    let mut namer = Namer::default();
    let mut words = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let end = lines::line_end(bytes, at);
        words.clear();
        lines::words(bytes, at..end, &mut words);
        if let Some((keyword, rest)) = words.split_first() {
            next = line(bytes, next, keyword, rest, &mut corners).ok_or_else(|| {
                let last = words[words.len() - 1].end;
                Fault::text(
                    keyword.start..last,
                    "this line does not belong here",
                    next.words(),
                )
            })??;
            match bytes[keyword.clone()].to_ascii_lowercase().as_slice() {
                b"solid" => {
                    let name = joined(bytes, rest);
                    namer.say(1, name.into_iter().collect());
                }
                b"endsolid" => namer.mark(corners.len() / 3),
                _ => {}
            }
        }
        progress.advance(end - at);
        at = end;
    }
    if next != Next::Solid {
        let last = bytes.trim_ascii_end().len();
        return Err(Fault::text(
            last.saturating_sub(1)..last,
            "the file ends in the middle of a solid",
            next.words(),
        ));
    }
    Ok(welded(
        &first_at_place(&corners),
        |i| corners[i],
        namer.finish(),
    ))
}

/// The state after a line; `None` if the line does not belong there.
fn line(
    bytes: &[u8],
    next: Next,
    keyword: &Range<usize>,
    rest: &[Range<usize>],
    corners: &mut Vec<DVec3>,
) -> Option<Result<Next, Fault>> {
    let word = |span: &Range<usize>| bytes[span.clone()].to_ascii_lowercase();
    let second = rest.first().map(word).unwrap_or_default();
    let after = match (next, word(keyword).as_slice(), second.as_slice()) {
        (Next::Solid, b"solid", _) | (Next::EndFacet, b"endfacet", _) => Next::Facet,
        (Next::Facet, b"facet", b"normal") => Next::Loop,
        (Next::Facet, b"endsolid", _) => Next::Solid,
        (Next::Loop, b"outer", b"loop") => Next::Vertex(0),
        (Next::Vertex(n @ 0..3), b"vertex", _) if rest.len() == 3 => {
            let read = |span: &Range<usize>| lines::number(&bytes[span.clone()]);
            let [Some(x), Some(y), Some(z)] = [&rest[0], &rest[1], &rest[2]].map(read) else {
                let wrong = rest.iter().find(|s| read(s).is_none())?;
                let fault = Fault::text(
                    wrong.clone(),
                    "this is not a finite number",
                    "expected a number",
                );
                return Some(Err(fault));
            };
            let Some(p) = position([x, y, z]) else {
                let fault = Fault::text(keyword.clone(), "a corner is too far away", "this corner");
                return Some(Err(fault));
            };
            corners.push(p);
            Next::Vertex(n + 1)
        }
        (Next::Vertex(3), b"endloop", _) => Next::EndFacet,
        _ => return None,
    };
    Some(Ok(after))
}

/// All words of a line as one name.
fn joined(bytes: &[u8], words: &[Range<usize>]) -> Option<String> {
    let (first, last) = (words.first()?, words.last()?);
    Some(String::from_utf8_lossy(&bytes[first.start..last.end]).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRA: [[[f32; 3]; 3]; 4] = {
        let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 1.0]];
        [[o, y, x], [o, x, z], [[0.0, -0.0, 0.0], z, y], [x, y, z]]
    };

    fn read(bytes: &[u8]) -> Result<MeshData, Fault> {
        parse(bytes, &Progress::new(&|_| {}, "a.stl", bytes.len()))
    }

    fn as_binary() -> Vec<u8> {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend(4u32.to_le_bytes());
        for facet in TETRA {
            bytes.extend([0; 12]);
            bytes.extend(facet.iter().flatten().flat_map(|c| c.to_le_bytes()));
            bytes.extend([7; 2]);
        }
        bytes
    }

    fn as_text() -> String {
        let mut text = "solid my thing\n".to_owned();
        for facet in TETRA {
            text += " facet normal 0 0 0\n\touter loop\r\n";
            for [x, y, z] in facet {
                text += &format!("  VERTEX {x:e} {y} {z}\n");
            }
            text += " endloop\n endfacet\n\n";
        }
        text + "endsolid my thing\n"
    }

    #[test]
    fn both_kinds_are_welded_alike() {
        let a = read(&as_binary()).unwrap();
        assert_eq!(a.vertices, [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::Z]);
        assert_eq!(a.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [2, 1, 3]]);
        let b = read(as_text().as_bytes()).unwrap();
        assert_eq!((&a.vertices, &a.triangles), (&b.vertices, &b.triangles));
        assert!(b.names.all().contains("my thing") && a.names == Names::default());
    }

    #[test]
    fn what_is_cut_is_refused() {
        let bytes = as_binary();
        for n in 0..bytes.len() {
            assert!(read(&bytes[..n]).is_err(), "{n}");
        }
        let text = as_text();
        for n in 0..text.len() - "endsolid my thing\n".len() {
            assert!(read(&text.as_bytes()[..n]).is_err(), "{n}");
        }
    }
}

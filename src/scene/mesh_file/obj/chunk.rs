//! One chunk of an OBJ file, read on its own: how many positions and normals
//! stand before it is all it needs to know.

use std::ops::Range;

use glam::DVec3;

use super::statement::{coordinates, logical_line, resolve};
use crate::scene::mesh_file::{Fault, position, unit_normal};

/// Statements that say nothing about the surface, or nothing we need.
const SKIPPED: [&[u8]; 23] = [
    b"vt",
    b"vp",
    b"s",
    b"mg",
    b"mtllib",
    b"l",
    b"p",
    b"usemap",
    b"maplib",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"shadow_obj",
    b"trace_obj",
    b"cstype",
    b"deg",
    b"curv",
    b"curv2",
    b"surf",
    b"parm",
    b"end",
    b"bmat",
];

/// What a chunk says about faces; its positions and normals go into slices
/// that were cut out for them.
#[derive(Default)]
pub(super) struct Chunk {
    /// Positions of the corners, counted from 0.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Normals of the corners, counted from 1; 0 where there is none. Empty
    /// if the chunk has none at all.
    pub(super) normals_of: Vec<[u32; 3]>,
    /// Names: triangles of the chunk before them, their level, and they.
    pub(super) names: Vec<(usize, usize, Vec<String>)>,
}

/// A list that is filled in place; all its lists before count, too.
pub(super) struct Filled<'s> {
    pub(super) before: usize,
    pub(super) slice: &'s mut [DVec3],
    pub(super) count: usize,
}

impl Filled<'_> {
    fn push(&mut self, v: DVec3) {
        self.slice[self.count] = v;
        self.count += 1;
    }

    fn so_far(&self) -> usize {
        self.before + self.count
    }
}

pub(super) struct Reader<'s> {
    pub(super) bytes: &'s [u8],
    pub(super) positions: Filled<'s>,
    pub(super) normals: Filled<'s>,
    pub(super) chunk: Chunk,
}

impl Reader<'_> {
    pub(super) fn read(mut self, range: Range<usize>) -> Result<Chunk, Fault> {
        let bytes = &self.bytes[..range.end];
        let mut words = Vec::new();
        let mut polygon = Vec::new();
        let mut at = range.start;
        while at < bytes.len() {
            at = logical_line(bytes, at, &mut words);
            if let Some((keyword, arguments)) = words.split_first() {
                self.statement(keyword, arguments, &mut polygon)?;
            }
        }
        Ok(self.chunk)
    }

    fn statement(
        &mut self,
        keyword: &Range<usize>,
        arguments: &[Range<usize>],
        polygon: &mut Vec<[u32; 2]>,
    ) -> Result<(), Fault> {
        let bytes = self.bytes;
        match &bytes[keyword.clone()] {
            b"v" => {
                let c = coordinates(bytes, keyword, arguments)?;
                let p = position(c).ok_or_else(|| {
                    let message = "a vertex is not finite or too far away";
                    Fault::text(keyword.clone(), message, "this vertex")
                })?;
                self.positions.push(p);
            }
            b"vn" => {
                let c = coordinates(bytes, keyword, arguments)?;
                let n = unit_normal(c).ok_or_else(|| {
                    Fault::text(keyword.clone(), "a normal is not finite", "this normal")
                })?;
                self.normals.push(n);
            }
            b"f" => self.face(keyword, arguments, polygon)?,
            b"usemtl" => self.say(0, whole(arguments)),
            b"g" => self.say(1, arguments.iter().cloned()),
            b"o" => self.say(2, whole(arguments)),
            other if SKIPPED.contains(&other) => {}
            other => {
                let name = String::from_utf8_lossy(&other[..other.len().min(20)]).into_owned();
                return Err(Fault::text(
                    keyword.clone(),
                    format!("unknown statement `{name}`"),
                    "expected `v`, `vn`, `f` or another statement of OBJ files",
                ));
            }
        }
        Ok(())
    }

    fn say(&mut self, level: usize, spans: impl IntoIterator<Item = Range<usize>>) {
        let text = |span| String::from_utf8_lossy(&self.bytes[span]).into_owned();
        let names = spans.into_iter().map(text).collect();
        self.chunk
            .names
            .push((self.chunk.triangles.len(), level, names));
    }

    fn face(
        &mut self,
        keyword: &Range<usize>,
        corners: &[Range<usize>],
        polygon: &mut Vec<[u32; 2]>,
    ) -> Result<(), Fault> {
        if corners.len() < 3 {
            let message = format!("a face with {} corners", corners.len());
            return Err(Fault::text(
                keyword.clone(),
                message,
                "needs at least 3 corners",
            ));
        }
        polygon.clear();
        for corner in corners {
            polygon.push(self.corner(corner)?);
        }
        let has_normals = polygon.iter().any(|[_, n]| *n != 0);
        let chunk = &mut self.chunk;
        if has_normals {
            chunk.normals_of.resize(chunk.triangles.len(), [0; 3]);
        }
        for i in 2..polygon.len() {
            let corners = [polygon[0], polygon[i - 1], polygon[i]];
            chunk.triangles.push(corners.map(|[p, _]| p));
            if has_normals {
                chunk.normals_of.push(corners.map(|[_, n]| n));
            }
        }
        Ok(())
    }

    /// Position and normal of `p`, `p/t`, `p//n` or `p/t/n`.
    fn corner(&self, span: &Range<usize>) -> Result<[u32; 2], Fault> {
        let mut parts = self.bytes[span.clone()].split(|&b| b == b'/');
        let (p, _texture, n) = (parts.next().unwrap_or_default(), parts.next(), parts.next());
        if parts.next().is_some() {
            let label = "expected `p`, `p/t`, `p//n` or `p/t/n`";
            return Err(Fault::text(
                span.clone(),
                "a corner with more than three indices",
                label,
            ));
        }
        let normal = match n {
            None | Some(b"") => 0,
            Some(n) => resolve(n, self.normals.so_far(), span, "normal")? + 1,
        };
        Ok([resolve(p, self.positions.so_far(), span, "vertex")?, normal])
    }
}

/// All words as one name, which may have spaces.
fn whole(words: &[Range<usize>]) -> Option<Range<usize>> {
    Some(words.first()?.start..words.last()?.end)
}

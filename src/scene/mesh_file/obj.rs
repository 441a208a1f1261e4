//! Wavefront OBJ: `v`, `vn` and `f`; everything else that the format knows is
//! skipped.

use std::{collections::HashMap, ops::Range};

use glam::DVec3;

use super::{Fault, MeshData, fill_normals, position, push_fan, unit_normal};

/// Statements that say nothing about the surface, or nothing we need.
const SKIPPED: [&[u8]; 26] = [
    b"vt",
    b"vp",
    b"g",
    b"o",
    b"s",
    b"mg",
    b"usemtl",
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

/// Positions and normals are indexed separately in the file; a vertex of the
/// mesh is a pair of both.
#[derive(Default)]
struct Builder {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    vertices: Vec<DVec3>,
    vertex_normals: Vec<DVec3>,
    /// Vertices by position and normal index.
    pairs: HashMap<(u32, Option<u32>), u32>,
    triangles: Vec<[u32; 3]>,
    any_normal: bool,
    polygon: Vec<u32>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<MeshData, Fault> {
    let mut builder = Builder::default();
    let mut at = 0;
    let mut joined = Vec::new();
    while at < bytes.len() {
        let (tokens, next) = logical_line(bytes, at, &mut joined);
        at = next;
        if let Some((keyword, arguments)) = tokens.split_first() {
            builder.statement(bytes, keyword.clone(), arguments)?;
        }
    }
    builder.finish()
}

/// The tokens of the line at `at`, continued where it ends in a backslash,
/// and the start of the next one. Comments are left out.
fn logical_line<'t>(
    bytes: &[u8],
    mut at: usize,
    tokens: &'t mut Vec<Range<usize>>,
) -> (&'t [Range<usize>], usize) {
    tokens.clear();
    loop {
        let end = bytes[at..]
            .iter()
            .position(|&b| b == b'\n')
            .map_or(bytes.len(), |i| at + i);
        let line = &bytes[at..end];
        let code_end = line.iter().position(|&b| b == b'#').unwrap_or(line.len());
        let code = line[..code_end].trim_ascii_end();
        let (code, continues) = match code.strip_suffix(b"\\") {
            Some(code) if code_end == line.len() => (code, true),
            _ => (code, false),
        };
        let mut start = None;
        for i in 0..=code.len() {
            let is_space = code.get(i).is_none_or(u8::is_ascii_whitespace);
            match (start, is_space) {
                (None, false) => start = Some(i),
                (Some(s), true) => {
                    tokens.push(at + s..at + i);
                    start = None;
                }
                _ => {}
            }
        }
        at = (end + 1).min(bytes.len());
        if !continues || at == bytes.len() {
            return (tokens, at);
        }
    }
}

impl Builder {
    fn statement(
        &mut self,
        bytes: &[u8],
        keyword: Range<usize>,
        arguments: &[Range<usize>],
    ) -> Result<(), Fault> {
        match &bytes[keyword.clone()] {
            b"v" => {
                let c = coordinates(bytes, &keyword, arguments)?;
                let p = position(c).ok_or_else(|| {
                    Fault::text(
                        keyword,
                        "a vertex is not finite or too far away",
                        "this vertex",
                    )
                })?;
                self.positions.push(p);
            }
            b"vn" => {
                let c = coordinates(bytes, &keyword, arguments)?;
                let n = unit_normal(c)
                    .ok_or_else(|| Fault::text(keyword, "a normal is not finite", "this normal"))?;
                self.normals.push(n);
            }
            b"f" => self.face(bytes, &keyword, arguments)?,
            other if SKIPPED.contains(&other) => {}
            other => {
                let name = String::from_utf8_lossy(&other[..other.len().min(20)]).into_owned();
                return Err(Fault::text(
                    keyword,
                    format!("unknown statement `{name}`"),
                    "expected `v`, `vn`, `f` or another statement of OBJ files",
                ));
            }
        }
        Ok(())
    }

    fn face(
        &mut self,
        bytes: &[u8],
        keyword: &Range<usize>,
        corners: &[Range<usize>],
    ) -> Result<(), Fault> {
        if corners.len() < 3 {
            let message = format!("a face with {} corners", corners.len());
            return Err(Fault::text(
                keyword.clone(),
                message,
                "needs at least 3 corners",
            ));
        }
        let mut polygon = std::mem::take(&mut self.polygon);
        polygon.clear();
        for corner in corners {
            polygon.push(self.corner(bytes, corner)?);
        }
        push_fan(&mut self.triangles, &polygon);
        self.polygon = polygon;
        Ok(())
    }

    /// The vertex for `p`, `p/t`, `p//n` or `p/t/n`.
    fn corner(&mut self, bytes: &[u8], span: &Range<usize>) -> Result<u32, Fault> {
        let parts: Vec<&[u8]> = bytes[span.clone()].split(|&b| b == b'/').collect();
        let normal = match parts.as_slice() {
            [_] | [_, _] | [_, _, b""] => None,
            [_, _, n] => Some(resolve(n, self.normals.len(), span, "normal")?),
            _ => {
                let label = "expected `p`, `p/t`, `p//n` or `p/t/n`";
                return Err(Fault::text(
                    span.clone(),
                    "a corner with more than three indices",
                    label,
                ));
            }
        };
        let p = resolve(parts[0], self.positions.len(), span, "vertex")?;
        self.any_normal |= normal.is_some();
        if let Some(&vertex) = self.pairs.get(&(p, normal)) {
            return Ok(vertex);
        }
        let vertex = self.vertices.len() as u32;
        self.vertices.push(self.positions[p as usize]);
        self.vertex_normals
            .push(normal.map_or(DVec3::ZERO, |n| self.normals[n as usize]));
        self.pairs.insert((p, normal), vertex);
        Ok(vertex)
    }

    fn finish(self) -> Result<MeshData, Fault> {
        if self.positions.is_empty() {
            return Err(Fault::file("the mesh has no vertices; is it an OBJ file?"));
        }
        let mut normals = self.vertex_normals;
        if self.any_normal {
            fill_normals(&self.vertices, &self.triangles, &mut normals);
        }
        let normals = self.any_normal.then_some(normals);
        Ok(MeshData {
            vertices: self.vertices,
            normals,
            triangles: self.triangles,
        })
    }
}

/// An index from 0 for one counted from 1, or from the end if negative.
fn resolve(text: &[u8], count: usize, span: &Range<usize>, what: &str) -> Result<u32, Fault> {
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
    u32::try_from(resolved).map_err(|_| Fault::text(span.clone(), "too many vertices", ""))
}

/// The first three numbers of a statement.
fn coordinates(
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
        let parsed = std::str::from_utf8(&bytes[span.clone()])
            .ok()
            .and_then(|t| t.parse::<f64>().ok());
        *value = parsed.filter(|v| v.is_finite()).ok_or_else(|| {
            Fault::text(
                span.clone(),
                "this is not a finite number",
                "expected a number",
            )
        })?;
    }
    Ok(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_index_forms_name_the_same_triangle() {
        let head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 2\n";
        for face in [
            "f 1 2 3",
            "f 1/1 2/1 3/1",
            "f 1/1/1 2/1/1 3/1/1",
            "f 1//1 2//1 3//-1",
            "f -3 -2 -1",
            "f 1 2 \\\n 3",
        ] {
            let mesh = parse(format!("{head}{face} # end\r\n").as_bytes()).unwrap();
            assert_eq!(mesh.triangles, [[0, 1, 2]], "{face}");
            assert_eq!(mesh.vertices, [DVec3::ZERO, DVec3::X, DVec3::Y], "{face}");
            assert_eq!(
                mesh.normals.is_some(),
                face.contains("/-1") || face.contains("/1/1"),
                "{face}"
            );
            assert!(mesh.normals.is_none_or(|n| n == [DVec3::Z; 3]));
        }
    }

    #[test]
    fn vertices_split_where_normals_differ_and_polygons_fan() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\n\
                    f 1//1 2//1 3//1 4//1\nf 1//2 2//1 3//1\n";
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 1, 2]]);
        assert_eq!(mesh.vertices[4], mesh.vertices[0]);
        assert_eq!(mesh.normals.unwrap()[4], DVec3::X);
    }

    #[test]
    fn faces_without_normals_get_those_of_their_triangles() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 3 2\n";
        let normals = parse(text.as_bytes()).unwrap().normals.unwrap();
        assert_eq!(normals[..3], [DVec3::X; 3]);
        assert_eq!(normals[3..], [DVec3::NEG_Z; 3]);
    }
}

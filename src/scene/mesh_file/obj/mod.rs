//! Wavefront OBJ: `v`, `vn`, `f` and the names `usemtl`, `g` and `o`;
//! everything else that the format knows is skipped.
//!
//! The file is cut into chunks of lines. A first look counts what each
//! states, a second reads them, knowing what stands before; both in parallel.

mod chunk;
mod statement;

use glam::DVec3;
use rayon::prelude::*;

use self::chunk::{Chunk, Filled, Reader};
use super::{
    Fault, MeshData, Progress, fill_normals, lines,
    names::{Namer, Names},
};

pub(super) fn parse(bytes: &[u8], chunk: usize, progress: &Progress) -> Result<MeshData, Fault> {
    let chunks = lines::chunks(bytes, 0..bytes.len(), chunk);
    let counts: Vec<[usize; 2]> = chunks
        .par_iter()
        .map(|c| statement::count(bytes, c.clone()))
        .collect();
    let total = |k: usize| counts.iter().map(|c| c[k]).sum();
    let mut positions = vec![DVec3::ZERO; total(0)];
    let mut normals = vec![DVec3::ZERO; total(1)];
    let readers: Vec<Reader> = cut(&mut positions, counts.iter().map(|c| c[0]))
        .zip(cut(&mut normals, counts.iter().map(|c| c[1])))
        .map(|(positions, normals)| Reader {
            bytes,
            positions,
            normals,
            chunk: Chunk::default(),
        })
        .collect();
    let read: Vec<Result<Chunk, Fault>> = readers
        .into_par_iter()
        .zip(&chunks)
        .map(|(reader, range)| {
            let result = reader.read(range.clone());
            progress.advance(range.len());
            result
        })
        .collect();
    // The first mistake of the file is the first of the first chunk with one.
    let read = read.into_iter().collect::<Result<Vec<Chunk>, Fault>>()?;
    if positions.is_empty() {
        return Err(Fault::file("the mesh has no vertices; is it an OBJ file?"));
    }
    let (triangles, normals_of, names) = join(read);
    Ok(assemble(positions, &normals, triangles, &normals_of, names))
}

/// Consecutive pieces of a list, to be filled.
fn cut(
    list: &mut [DVec3],
    counts: impl Iterator<Item = usize>,
) -> impl Iterator<Item = Filled<'_>> {
    let (mut rest, mut before) = (list, 0);
    counts.map(move |n| {
        let (slice, tail) = std::mem::take(&mut rest).split_at_mut(n);
        rest = tail;
        before += n;
        Filled {
            before: before - n,
            slice,
            count: 0,
        }
    })
}

/// The triangles of all chunks, their normals (none if no chunk has any) and
/// their names.
fn join(chunks: Vec<Chunk>) -> (Vec<[u32; 3]>, Vec<[u32; 3]>, Names) {
    let has_normals = chunks.iter().any(|c| !c.normals_of.is_empty());
    let total = chunks.iter().map(|c| c.triangles.len()).sum();
    let mut triangles = Vec::with_capacity(total);
    let mut normals_of = Vec::with_capacity(if has_normals { total } else { 0 });
    let mut namer = Namer::default();
    for chunk in chunks {
        for (before, level, names) in chunk.names {
            namer.mark(triangles.len() + before);
            namer.say(level, names);
        }
        triangles.extend(chunk.triangles);
        if has_normals {
            normals_of.extend(chunk.normals_of);
            normals_of.resize(triangles.len(), [0; 3]);
        }
    }
    namer.mark(triangles.len());
    (triangles, normals_of, namer.finish())
}

/// Positions and normals are indexed separately in the file; a vertex of the
/// mesh is a pair of both. Pairs stand in the order of their indices.
fn assemble(
    positions: Vec<DVec3>,
    normals: &[DVec3],
    mut triangles: Vec<[u32; 3]>,
    normals_of: &[[u32; 3]],
    names: Names,
) -> MeshData {
    if normals_of.is_empty() {
        return MeshData {
            vertices: positions,
            normals: None,
            triangles,
            names,
        };
    }
    let pairs_of =
        |(p, n): (&[u32; 3], &[u32; 3])| [0, 1, 2].map(|k| u64::from(p[k]) << 32 | u64::from(n[k]));
    let mut pairs: Vec<u64> = (triangles.par_iter().zip(normals_of))
        .flat_map_iter(pairs_of)
        .collect();
    pairs.par_sort_unstable();
    pairs.dedup();
    triangles.par_iter_mut().zip(normals_of).for_each(|(t, n)| {
        *t = pairs_of((t, n)).map(|pair| pairs.partition_point(|&p| p < pair) as u32);
    });
    let vertices: Vec<DVec3> = pairs
        .iter()
        .map(|pair| positions[(pair >> 32) as usize])
        .collect();
    let normal = |pair: &u64| match *pair as u32 {
        0 => DVec3::ZERO,
        n => normals[n as usize - 1],
    };
    let mut normals: Vec<DVec3> = pairs.iter().map(normal).collect();
    fill_normals(&vertices, &triangles, &mut normals);
    MeshData {
        vertices,
        normals: Some(normals),
        triangles,
        names,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_in(bytes: &[u8], chunk: usize) -> Result<MeshData, Fault> {
        super::parse(bytes, chunk, &Progress::new(&|_| {}, "a.obj", bytes.len()))
    }

    fn parse(bytes: &[u8]) -> Result<MeshData, Fault> {
        parse_in(bytes, lines::CHUNK)
    }

    /// However the file is cut, it says the same; so do its mistakes.
    #[test]
    fn chunks_do_not_matter() {
        let text = "o all of it\nv 0 0 0\nv 1 \\\n0 0\n\\\n v 1 1 0 # corner \\\nv 0 1 0\n\
                    vn 0 0 1\nvn 1 0 0\ng a b\nf 1//1 2//1 3//-1\nusemtl red glass\n\
                    f 1 3 \\\n4\ng\nf -4//2 -1//2 -2/7/1 -3\nusemtl\nv 2 2 2\nf 1 2 -1\n";
        let whole = parse(text.as_bytes()).unwrap();
        assert_eq!(whole.triangles.len(), 5);
        assert_eq!(
            whole.names.runs_by(&["red glass", "b"]),
            [(1, Some(1)), (2, Some(0)), (4, Some(0)), (5, None)]
        );
        for size in 1..text.len() {
            assert_eq!(parse_in(text.as_bytes(), size).unwrap(), whole, "{size}");
        }
        let broken = text.replace("f 1 3", "f 1 5").replace("2 2 2", "2 2 x");
        for size in 1..text.len() {
            let fault = parse_in(broken.as_bytes(), size).unwrap_err();
            assert!(fault.message.contains("vertex 5"), "{size}: {fault:?}");
        }
    }

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
        assert_eq!(mesh.triangles, [[0, 2, 3], [0, 3, 4], [1, 2, 3]]);
        assert_eq!(mesh.vertices[1], mesh.vertices[0]);
        assert_eq!(mesh.normals.unwrap()[1], DVec3::X);
    }

    #[test]
    fn faces_without_normals_get_those_of_their_triangles() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 3 2\n";
        let normals = parse(text.as_bytes()).unwrap().normals.unwrap();
        let [with, without] = [DVec3::X, DVec3::NEG_Z];
        assert_eq!(normals, [without, with, without, with, without, with]);
    }
}

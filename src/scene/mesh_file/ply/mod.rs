//! Stanford PLY: ASCII and binary of both byte orders, any elements and
//! properties in any order; what isn't a position, a normal or a face is
//! skipped.
//!
//! A file is read one item after the other, which decides what is wrong with
//! it. Where items have lines, or all the same size, chunks of them are read
//! in parallel; if anything is not as expected there, the slow way is asked.

mod body;
mod fast;
mod header;

use glam::DVec3;

use body::Body;
use header::{ElementKind, Format};

use super::{Fault, MeshData, Names, Progress, fill_normals, position, push_fan, unit_normal};

pub(super) fn parse(bytes: &[u8], chunk: usize, progress: &Progress) -> Result<MeshData, Fault> {
    let (format, elements, body) = header::read(bytes)?;
    header::check_elements(&elements)?;
    progress.advance(body);
    let mut reader = Body {
        bytes,
        at: body,
        format,
    };
    let piece = match format {
        Format::Ascii => fast::lines(&reader, &elements, chunk, progress),
        Format::Little | Format::Big => None,
    };
    let mut piece = match piece {
        Some(piece) => piece,
        None => one_by_one(&mut reader, &elements, chunk, progress)?,
    };
    check_indices(&piece)?;
    let normals = (!piece.normals.is_empty()).then(|| {
        fill_normals(&piece.vertices, &piece.triangles, &mut piece.normals);
        piece.normals
    });
    Ok(MeshData {
        vertices: piece.vertices,
        normals,
        triangles: piece.triangles,
        names: Names::default(),
    })
}

/// What some items of a file give.
#[derive(Default)]
struct Piece {
    vertices: Vec<DVec3>,
    normals: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The corners of the last face.
    corners: Vec<u32>,
}

impl Piece {
    /// Reads the next item.
    fn take(&mut self, reader: &mut Body, element: &ElementKind) -> Result<(), Fault> {
        let start = reader.at;
        let item = reader.item(element, &mut self.corners)?;
        match element.name.as_slice() {
            b"vertex" => {
                let fault = |message| reader.fault(start..reader.at, message);
                let p = position(item.position)
                    .ok_or_else(|| fault("a vertex is not finite or too far away"))?;
                self.vertices.push(p);
                if let Some(n) = item.normal {
                    let n = unit_normal(n).ok_or_else(|| fault("a normal is not finite"))?;
                    self.normals.push(n);
                }
            }
            b"face" => push_fan(&mut self.triangles, &self.corners),
            _ => {}
        }
        Ok(())
    }

    /// Adds what follows.
    fn append(&mut self, more: &Self) {
        self.vertices.extend_from_slice(&more.vertices);
        self.normals.extend_from_slice(&more.normals);
        self.triangles.extend_from_slice(&more.triangles);
    }
}

fn one_by_one(
    reader: &mut Body,
    elements: &[ElementKind],
    chunk: usize,
    progress: &Progress,
) -> Result<Piece, Fault> {
    let mut piece = Piece::default();
    for element in elements {
        if let Some(more) = fast::same_size(reader, element, chunk, progress) {
            piece.append(&more);
            continue;
        }
        let mut told = reader.at;
        for _ in 0..element.count {
            piece.take(reader, element)?;
            if reader.at - told >= chunk {
                progress.advance(reader.at - told);
                told = reader.at;
            }
        }
        progress.advance(reader.at - told);
    }
    Ok(piece)
}

fn check_indices(mesh: &Piece) -> Result<(), Fault> {
    let count = mesh.vertices.len();
    for (i, t) in mesh.triangles.iter().enumerate() {
        if let Some(index) = t.iter().find(|&&v| v as usize >= count) {
            let message =
                format!("triangle {i} names vertex {index}, but there are {count}, counted from 0");
            return Err(Fault::file(message));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::scene::mesh_file::lines;

    fn parse_in(bytes: &[u8], chunk: usize) -> Result<MeshData, Fault> {
        super::parse(bytes, chunk, &Progress::new(&|_| {}, "a.ply", bytes.len()))
    }

    fn parse(bytes: &[u8]) -> Result<MeshData, Fault> {
        parse_in(bytes, lines::CHUNK)
    }

    /// A strip of quads with normals, as text or binary.
    fn strip(format: &str, n: u32) -> Vec<u8> {
        let mut bytes = format!(
            "ply\nformat {format} 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
             property double z\nproperty float nx\nproperty float ny\nproperty float nz\n\
             element face {n}\nproperty uchar part\nproperty list uchar int vertex_index\n\
             end_header\n",
            2 * n + 2
        )
        .into_bytes();
        let is_text = format == "ascii";
        for i in 0..2 * n + 2 {
            let (x, y) = (f64::from(i / 2) / 3.0, f64::from(i % 2));
            if is_text {
                bytes.extend(format!("{x} {y} 0.5\t0 0 1 \r\n").bytes());
            } else {
                bytes.extend([x, y, 0.5].iter().flat_map(|c| c.to_le_bytes()));
                bytes.extend([0.0f32, 0.0, 1.0].iter().flat_map(|c| c.to_le_bytes()));
            }
        }
        for i in 0..n {
            let t = [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1];
            if is_text {
                bytes.extend(format!("9 4 {} {} {} {}\n", t[0], t[1], t[2], t[3]).bytes());
            } else {
                bytes.extend([9, 4]);
                bytes.extend(t.iter().flat_map(|i| i.to_le_bytes()));
            }
        }
        bytes
    }

    /// However the file is cut, it says the same; so do its mistakes.
    #[test]
    fn chunks_do_not_matter() {
        let whole = parse(&strip("ascii", 40)).unwrap();
        assert_eq!((whole.vertices.len(), whole.triangles.len()), (82, 80));
        assert_eq!(whole.normals, Some(vec![DVec3::Z; 82]));
        for format in ["ascii", "binary_little_endian"] {
            let bytes = strip(format, 40);
            for size in [1, 2, 7, 50, 100, 1000, 10_000] {
                assert_eq!(parse_in(&bytes, size).unwrap(), whole, "{format} {size}");
            }
            let cut = &bytes[..bytes.len() - 7];
            let truth = parse(cut).unwrap_err().message;
            for size in [1, 50, 1000] {
                assert_eq!(parse_in(cut, size).unwrap_err().message, truth);
            }
        }
        // Items that share lines are read the slow way.
        let text = String::from_utf8(strip("ascii", 40)).unwrap();
        let (head, body) = text.split_at(text.find("end_header").unwrap() + 11);
        let mixed = format!("{head}{}", body.replace("\r\n", " "));
        assert_eq!(parse_in(mixed.as_bytes(), 50).unwrap(), whole);
    }

    const HEADER: &str = "element vertex 4\nproperty float x\nproperty double y\nproperty short z\n\
        property uchar red\nproperty list uchar float weights\nelement edge 1\nproperty int a\n\
        element face 1\nproperty list uint ushort vertex_indices\nend_header\n";

    fn square() -> MeshData {
        let vertices = [
            (0.5, 0.25, 0.0),
            (1.0, 0.0, 0.0),
            (1.0, 1.0, -2.0),
            (0.0, 1.0, 0.0),
        ];
        MeshData {
            vertices: vertices.map(DVec3::from).to_vec(),
            normals: None,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            names: Names::default(),
        }
    }

    #[test]
    fn ascii_with_strangers_between() {
        let text = format!(
            "ply\r\nformat ascii 1.0\r\ncomment x\n{HEADER}\
            0.5 0.25 0 7 0\n1 0 0 7 2 0.5 0.5\n1 1 -2 7 0\n0 1 0 7 0\n9\n4 0 1 2 3\n"
        );
        assert_eq!(parse(text.as_bytes()).unwrap(), square());
    }

    #[test]
    fn binary_of_both_byte_orders() {
        for (name, little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
            let mut bytes = format!("ply\nformat {name} 1.0\n{HEADER}").into_bytes();
            let mut put = |mut raw: Vec<u8>| {
                if !little {
                    raw.reverse();
                }
                bytes.extend(raw);
            };
            for v in square().vertices {
                put((v.x as f32).to_le_bytes().to_vec());
                put(v.y.to_le_bytes().to_vec());
                put((v.z as i16).to_le_bytes().to_vec());
                put(vec![7]);
                put(vec![1]);
                put(0.5f32.to_le_bytes().to_vec());
            }
            put(9i32.to_le_bytes().to_vec());
            put(4u32.to_le_bytes().to_vec());
            for i in 0..4u16 {
                put(i.to_le_bytes().to_vec());
            }
            assert_eq!(parse(&bytes).unwrap(), square(), "{name}");
            let cut = parse(&bytes[..bytes.len() - 1]).unwrap_err();
            assert!(cut.message.contains("ends"), "{cut:?}");
        }
    }

    #[test]
    fn claimed_counts_cost_nothing() {
        let text = format!(
            "ply\nformat binary_little_endian 1.0\n{}",
            HEADER.replace("vertex 4", "vertex 18446744073709551615")
        );
        assert!(parse(text.as_bytes()).is_err());
        let text = text
            .replace("edge 1", "edge 99999999999")
            .replace("property int a\n", "");
        assert!(
            parse(text.as_bytes())
                .unwrap_err()
                .message
                .contains("without properties")
        );
    }
}

//! Stanford PLY: ASCII and binary of both byte orders, any elements and
//! properties in any order; what isn't a position, a normal or a face is
//! skipped.

mod body;
mod header;

use body::Body;

use super::{Fault, MeshData, fill_normals, position, push_fan, unit_normal};

pub(super) fn parse(bytes: &[u8]) -> Result<MeshData, Fault> {
    let (format, elements, body) = header::read(bytes)?;
    header::check_elements(&elements)?;
    let mut reader = Body {
        bytes,
        at: body,
        format,
    };
    let mut mesh = MeshData::default();
    let mut normals = Vec::new();
    let mut corners = Vec::new();
    for element in &elements {
        for _ in 0..element.count {
            let start = reader.at;
            let item = reader.item(element, &mut corners)?;
            match element.name.as_slice() {
                b"vertex" => {
                    let p = position(item.position).ok_or_else(|| {
                        reader.fault(start..reader.at, "a vertex is not finite or too far away")
                    })?;
                    mesh.vertices.push(p);
                    if let Some(n) = item.normal {
                        normals.push(unit_normal(n).ok_or_else(|| {
                            reader.fault(start..reader.at, "a normal is not finite")
                        })?);
                    }
                }
                b"face" => push_fan(&mut mesh.triangles, &corners),
                _ => {}
            }
        }
    }
    check_indices(&mesh)?;
    if !normals.is_empty() {
        fill_normals(&mesh.vertices, &mesh.triangles, &mut normals);
        mesh.normals = Some(normals);
    }
    Ok(mesh)
}

fn check_indices(mesh: &MeshData) -> Result<(), Fault> {
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

//! Small files, written by hand, whose triangles are known.

use glam::DVec3;

use super::*;

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let mut bits = 0u32;
        for i in 0..3 {
            bits = bits << 8 | u32::from(*group.get(i).unwrap_or(&0));
        }
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= group.len() { digit as char } else { '=' });
        }
    }
    text
}

/// Four corners of a square in the plane y = 0 of the file, seen from +y in
/// the order of a strip; then indices of all widths.
fn data() -> Vec<u8> {
    let corners: [[f32; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
    ];
    let mut bytes: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|c| c.to_le_bytes())
        .collect();
    bytes.extend([0u8, 1, 2, 2, 1, 3, 0, 0]);
    bytes.extend([0u16, 1, 2, 2, 1, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend([0u32, 1, 2, 2, 1, 3].iter().flat_map(|i| i.to_le_bytes()));
    // Normals as normalised bytes, four to a vertex: stride 4.
    bytes.extend([[0u8, 127, 0, 9]; 4].iter().flatten());
    bytes
}

fn lists(uri: &str) -> String {
    format!(
        r#""asset": {{"version": "2.0"}},
        "buffers": [{{{uri} "byteLength": {}}}],
        "bufferViews": [
            {{"buffer": 0, "byteLength": 48}},
            {{"buffer": 0, "byteOffset": 48, "byteLength": 44}},
            {{"buffer": 0, "byteOffset": 92, "byteLength": 16, "byteStride": 4}}
        ],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
            {{"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}},
            {{"bufferView": 1, "byteOffset": 8, "componentType": 5123, "count": 6, "type": "SCALAR"}},
            {{"bufferView": 1, "byteOffset": 20, "componentType": 5125, "count": 6, "type": "SCALAR"}},
            {{"bufferView": 2, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3"}}
        ],
        "materials": [{{"name": "glass"}}, {{}}],"#,
        data().len()
    )
}

fn document(rest: &str) -> String {
    let uri = format!(
        "\"uri\": \"data:application/octet-stream;base64,{}\",",
        base64(&data())
    );
    format!("{{{} {rest}}}", lists(&uri))
}

fn read(rest: &str) -> Result<MeshData, Fault> {
    parse_text(
        document(rest).as_bytes(),
        Path::new("/nonexistent"),
        &Inputs::default(),
    )
}

/// The corners of all triangles.
fn corners(mesh: &MeshData) -> Vec<[DVec3; 3]> {
    let at = |i: u32| mesh.vertices[i as usize];
    mesh.triangles.iter().map(|t| t.map(at)).collect()
}

/// The square, with the file's y as our z.
fn square() -> Vec<[DVec3; 3]> {
    let [a, b, c, d] = [
        DVec3::ZERO,
        DVec3::NEG_Y,
        DVec3::X,
        DVec3::new(1.0, -1.0, 0.0),
    ];
    vec![[a, b, c], [c, b, d]]
}

#[test]
fn indices_of_all_widths_strips_and_fans() {
    for (primitive, order) in [
        (r#""indices": 1"#, [0, 1, 2]),
        (r#""indices": 2, "mode": 4"#, [0, 1, 2]),
        (r#""indices": 3"#, [0, 1, 2]),
        (r#""mode": 5"#, [0, 2, 1]),
    ] {
        let mesh = read(&format!(
            r#""meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, {primitive}}},
                                         {{"attributes": {{}}, "mode": 1}}]}}],
               "nodes": [{{"mesh": 0}}]"#
        ))
        .unwrap();
        let mut expected = square();
        // A strip starts its second triangle at the second vertex.
        let second = expected[1];
        expected[1] = [0, 1, 2].map(|k| {
            if order[1] == 2 {
                second[[1, 2, 0][k]]
            } else {
                second[k]
            }
        });
        assert_eq!(corners(&mesh), expected, "{primitive}");
        assert_eq!(mesh.normals, None);
        assert!(mesh.names.all().is_empty());
    }
    let fan = read(
        r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]}],
           "nodes": [{"mesh": 0}]"#,
    )
    .unwrap();
    assert_eq!(fan.triangles, [[1, 2, 0], [2, 3, 0]]);
}

#[test]
fn nodes_place_mirror_and_name() {
    let mesh = read(
        r#""meshes": [{"name": "plate", "primitives": [
               {"attributes": {"POSITION": 0, "NORMAL": 4}, "indices": 1, "material": 0},
               {"attributes": {"POSITION": 0}, "indices": 2, "material": 1}]}],
           "nodes": [
               {"children": [2], "scale": [1, 2, 1], "translation": [0, 5, 0]},
               {"name": "unseen", "mesh": 0},
               {"name": "left", "mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,3,0,1]}],
           "scenes": [{"nodes": [1]}, {"nodes": [0]}], "scene": 1"#,
    )
    .unwrap();
    // y: 3 up in the inner node, doubled and 5 more in the outer one.
    let place = |p: DVec3| DVec3::new(-p.x, p.y, 11.0);
    let mirrored = |[a, b, c]: [DVec3; 3]| [place(a), place(c), place(b)];
    let once: Vec<_> = square().into_iter().map(mirrored).collect();
    assert_eq!(corners(&mesh), [once.clone(), once].concat());
    // The second primitive has none of its own.
    assert_eq!(mesh.normals, Some(vec![DVec3::Z; 8]));
    let names: Vec<_> = mesh.names.all().into_iter().collect();
    assert_eq!(names, ["glass", "left", "plate"]);
    assert_eq!(
        mesh.names.runs_by(&["left", "glass"]),
        [(2, Some(1)), (4, Some(0))]
    );
}

#[test]
fn binary_files_hold_both_parts() {
    let rest = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                  "nodes": [{"mesh": 0}]"#;
    let mut json = format!("{{{} {rest}}}", lists("")).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    let data = data();
    bytes.extend((28 + json.len() as u32 + data.len() as u32).to_le_bytes());
    for (name, chunk) in [(b"JSON", &json), (b"BIN\0", &data)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(name);
        bytes.extend(chunk);
    }
    let read = |bytes: &[u8]| parse_binary(bytes, Path::new(""), &Inputs::default());
    assert_eq!(corners(&read(&bytes).unwrap()), square());
    for n in 0..bytes.len() {
        assert!(read(&bytes[..n]).is_err(), "{n}");
    }
}

#[test]
fn hostile_documents_are_refused() {
    let one = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],"#;
    for (rest, message) in [
        (r#""nodes": [{"mesh": 3}]"#, "meshes[3] is asked for"),
        (
            r#""nodes": [{"children": [0]}], "scenes": [{"nodes": [0]}]"#,
            "hangs on two",
        ),
        (
            r#""nodes": [{}, {}], "scenes": [{"nodes": [1, 1]}]"#,
            "nodes[1]: a node",
        ),
        (r#""nodes": [{"mesh": -1}]"#, "nodes[0]: invalid value"),
        (
            r#""nodes": [{"mesh": 0, "translation": [1e300, 0, 0]}]"#,
            "too far away",
        ),
        (
            r#""nodes": [{"mesh": 0, "rotation": [0, 0, 0, 0]}]"#,
            "quaternion",
        ),
        (
            r#""nodes": [], "extensionsRequired": ["KHR_draco_mesh_compression"]"#,
            "draco",
        ),
        (r#""scene": 1, "scenes": [{}]"#, "scenes[1] is asked for"),
    ] {
        let fault = read(&format!("{one} {rest}")).unwrap_err();
        assert!(fault.message.contains(message), "{rest}: {fault:?}");
    }
    for (from, to, message) in [
        (
            r#""count": 4, "type": "VEC3"}"#,
            r#""count": 5, "type": "VEC3"}"#,
            "do not fit",
        ),
        (
            r#""count": 4"#,
            r#""count": 18446744073709551615"#,
            "do not fit",
        ),
        (r#""count": 4"#, r#""count": 0"#, "`count` is 0"),
        (r#""type": "VEC3""#, r#""type": "VEC2""#, "VEC3"),
        (r#""count": 4"#, r#""count": 3"#, "names vertex 3"),
        (
            r#""byteLength": 48}"#,
            r#""byteLength": 48, "byteStride": 4}"#,
            "12 bytes",
        ),
        (r#""bufferView": 0, "#, r#""sparse": {}, "#, "sparse"),
        ("base64,", "base64,!", "broken base64"),
        (
            "data:application/octet-stream;base64,",
            "https://",
            "path of a file",
        ),
        (
            r#""byteLength": 108"#,
            r#""byteLength": 109"#,
            "there are 108 bytes",
        ),
    ] {
        let text = document(&format!(r#"{one} "nodes": [{{"mesh": 0}}]"#)).replacen(from, to, 1);
        let fault = parse_text(
            text.as_bytes(),
            Path::new("/nonexistent"),
            &Inputs::default(),
        )
        .unwrap_err();
        assert!(fault.message.contains(message), "{to}: {fault:?}");
    }
}

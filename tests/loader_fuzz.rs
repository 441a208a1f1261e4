//! Whatever a user feeds to the loader: it answers, in bounded time and
//! memory, with a scene or with mistakes that have places.
//!
//! Work is bounded by construction (one pass over the text, limits on what
//! generators make); here a hang or a panic fails the run.

use std::path::Path;

use nephroid::scene::{Place, load_str, mesh_file, outline::Outline};
use proptest::{collection::vec, prelude::*, sample::Index};

const VALID: &str = r##"#![enable(implicit_some)]
(
    camera: (eye: (0, -5, 3.5), look_at: (0, 0, 0.3), up: (0, 0, 1), fov: 45),
    image: (width: 8, height: 6, exposure: 1, filter: Box),
    materials: { "floor": Diffuse(reflectance: "#808080"), "glass": Dielectric(ior: 1.5) },
    meshes: { "water": Waves(x: (-1, 1), y: (-1, 1), cells: 3, waves: [(amplitude: 0.1, k: (5, 2))]) },
    objects: [
        (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: "floor"), // floor
        (name: "ball", shape: Sphere(center: (0, 0, 1), radius: 1), material: "glass",
         at: [(scale: 2), (rotate: [(axis: (0, 0, 1), degrees: 30)], translate: (1, 2, 3))]),
        (shape: Mesh(named: "water"), open: true, material: Dielectric(ior: 1.33)),
        (shape: Cylinder(base: (0, 0, 0), end: (0, 0, 1), radius: 0.5, capped: true), material: Mirror()),
        (shape: TorusKnot(segments: 5, sides: 3), material: "glass"),
        (shape: Mesh(vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], triangles: [(0, 1, 2)]), material: "floor"),
    ],
    lights: [
        Sphere(center: (2, -1, 4), radius: 0.15, radiance: 200),
        Spot(position: (0, 0, 5), look_at: (0, 0, 0), inner: 10, outer: 20, power: (1, 2, 3)),
        Quad(center: (0, 0, 6), size: (1, 2), facing: (0, 0, 0), power: 10),
        Directional(direction: (0, 0, -1), irradiance: 3, beam: (center: (0, 0, 9), radius: 1)),
    ],
    render: (passes: 8, memory: "64 MiB", indirect: false),
)
"##;

const OBJ: &str =
    "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -1 -2 -3\n";

fn ply(format: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    if format == "ascii" {
        bytes.extend(b"0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n");
        return bytes;
    }
    let little = format == "binary_little_endian";
    let word = |raw: [u8; 4]| {
        let mut raw = raw;
        if !little {
            raw.reverse();
        }
        raw
    };
    for v in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        for c in v {
            bytes.extend(word(c.to_le_bytes()));
        }
        bytes.push(9);
    }
    bytes.push(3);
    for i in 0..3i32 {
        bytes.extend(word(i.to_le_bytes()));
    }
    bytes
}

const STL: &str = "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   \
    vertex 0 1 0\n  endloop\n endfacet\nendsolid a b\n";

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(1u32.to_le_bytes());
    let numbers = [
        0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0,
    ];
    bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0; 2]);
    bytes
}

/// A triangle with normals: 36 bytes of corners, 3 of indices and one to
/// spare, 36 of normals, in the buffer with the given start of its entry.
fn gltf(buffer: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [1]}}],
"nodes": [{{"mesh": 0, "name": "leaf", "scale": [1, -2, 1]}},
          {{"children": [0], "rotation": [0, 0.6, 0, 0.8], "translation": [1, 2, 3]}}],
"meshes": [{{"name": "m", "primitives": [
    {{"attributes": {{"POSITION": 0, "NORMAL": 2}}, "indices": 1, "material": 0}},
    {{"attributes": {{"POSITION": 0}}, "mode": 5}}]}}],
"materials": [{{"name": "red"}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}},
    {{"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"}},
    {{"bufferView": 2, "byteOffset": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
"bufferViews": [{{"buffer": 0, "byteLength": 36}},
    {{"buffer": 0, "byteOffset": 36, "byteLength": 4}},
    {{"buffer": 0, "byteOffset": 40, "byteLength": 36, "byteStride": 12}}],
"buffers": [{{{buffer}"byteLength": 76}}]}}"#
    )
}

/// The bytes of that buffer.
fn gltf_data() -> Vec<u8> {
    let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let normals = [[0.0f32, 0.0, 1.0]; 3];
    let mut bytes: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0]);
    bytes.extend(normals.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes
}

/// The same with its data in the text.
fn gltf_text() -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut data = String::new();
    for group in gltf_data().chunks(3) {
        let bits = (0..3).fold(0u32, |b, i| b << 8 | u32::from(*group.get(i).unwrap_or(&0)));
        let digits = (0..=group.len()).map(|i| DIGITS[(bits >> (18 - 6 * i) & 63) as usize]);
        data.extend(digits.map(char::from));
    }
    gltf(&format!("\"uri\": \"data:;base64,{data}==\", "))
}

fn glb() -> Vec<u8> {
    let mut json = gltf("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let data = gltf_data();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + data.len() as u32).to_le_bytes());
    for (name, chunk) in [(b"JSON", &json), (b"BIN\0", &data)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(name);
        bytes.extend(chunk);
    }
    bytes
}

/// Loads a text; whatever is wrong must have a place within it.
fn throw(text: &str) {
    let Err(found) = load_str(text, "fuzz.ron", Path::new("/nonexistent")) else {
        return;
    };
    assert!(!found.is_empty(), "refused without a reason");
    for d in &found {
        assert!(!d.message.is_empty());
        assert!(
            d.span.start <= d.span.end && d.span.end <= text.len(),
            "{d:?}"
        );
        if let Place::Text { line, column } = d.place {
            assert!(line >= 1 && line <= text.matches('\n').count() + 1, "{d:?}");
            assert!(column >= 1, "{d:?}");
        }
    }
    assert!(found.to_string().contains("fuzz.ron"));
}

fn throw_mesh(name: &str, bytes: &[u8]) {
    match mesh_file::parse(name, bytes) {
        Ok(mesh) => {
            let count = mesh.vertices.len();
            assert!(
                mesh.triangles
                    .iter()
                    .flatten()
                    .all(|&i| (i as usize) < count)
            );
            assert!(mesh.vertices.iter().all(|v| v.is_finite()));
            assert!(mesh.normals.is_none_or(|n| {
                n.len() == count && n.iter().all(|n| (n.length() - 1.0).abs() < 1e-12)
            }));
        }
        Err(d) => assert!(!d.message.is_empty() && d.render(false).contains(name)),
    }
}

/// One change to a text.
#[derive(Clone, Debug)]
enum Edit {
    Remove(Index, usize),
    Insert(Index, String),
    Copy(Index, Index, usize),
    Cut(Index),
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let piece = prop_oneof![
        "[()\\[\\]{},:\"'#/*\\\\]{1,3}",
        "[a-z]{1,4}",
        prop::sample::select(vec![
            "NaN",
            "inf",
            "-inf",
            "1e400",
            "-0.0",
            "1e-320",
            "0",
            "-1",
            "None",
            "Some(",
            "\u{0}",
            "é",
            "\u{feff}",
            "r#\"",
            "/*",
            "*/",
            "//",
            "true",
            "()",
            "0x1F",
            "1_000",
            "18446744073709551616",
            "Sphere",
            "Mesh(file: \"/\")",
            "\"#zzzzzz\"",
            "open: true,",
        ])
        .prop_map(str::to_owned),
    ];
    let edit = prop_oneof![
        (any::<Index>(), 1..12usize).prop_map(|(i, n)| Edit::Remove(i, n)),
        (any::<Index>(), piece).prop_map(|(i, s)| Edit::Insert(i, s)),
        (any::<Index>(), any::<Index>(), 1..60usize).prop_map(|(a, b, n)| Edit::Copy(a, b, n)),
        any::<Index>().prop_map(Edit::Cut),
    ];
    vec(edit, 1..4)
}

/// Numbers that look for trouble.
fn number() -> impl Strategy<Value = String> {
    let hard = [
        "0",
        "-1",
        "1e308",
        "4294967295",
        "18446744073709551615",
        "0.5",
        "null",
        "5125",
    ];
    prop_oneof![
        prop::sample::select(hard.to_vec()).prop_map(str::to_owned),
        (0..80u32).prop_map(|n| n.to_string()),
    ]
}

fn apply(mut bytes: Vec<u8>, edits: &[Edit]) -> Vec<u8> {
    for edit in edits {
        let len = bytes.len() + 1;
        match edit {
            Edit::Remove(i, n) => {
                let i = i.index(len);
                let end = (i + n).min(bytes.len());
                bytes.drain(i..end);
            }
            Edit::Insert(i, s) => {
                let i = i.index(len);
                bytes.splice(i..i, s.bytes());
            }
            Edit::Copy(from, to, n) => {
                let from = from.index(len);
                let piece = bytes[from..(from + n).min(bytes.len())].to_vec();
                let to = to.index(len);
                bytes.splice(to..to, piece);
            }
            Edit::Cut(i) => bytes.truncate(i.index(len)),
        }
    }
    bytes
}

#[test]
fn the_unchanged_inputs_are_good() {
    load_str(VALID, "fuzz.ron", Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        mesh_file::parse("a.obj", OBJ.as_bytes())
            .expect("good")
            .triangles
            .len(),
        3
    );
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let mesh = mesh_file::parse("a.ply", &ply(format)).expect("good");
        assert_eq!(mesh.triangles, [[0, 1, 2]], "{format}");
    }
    for (name, bytes, triangles) in [
        ("a.stl", STL.as_bytes(), 1),
        ("a.stl", &binary_stl(), 1),
        ("a.glb", &glb(), 2),
        ("a.gltf", gltf_text().as_bytes(), 2),
    ] {
        let mesh = mesh_file::parse(name, bytes).unwrap_or_else(|e| panic!("{}", e.render(false)));
        assert_eq!(mesh.triangles.len(), triangles, "{name}");
        throw_mesh(name, bytes);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn arbitrary_bytes(bytes in vec(any::<u8>(), 0..300)) {
        throw(&String::from_utf8_lossy(&bytes));
        throw_mesh("a.obj", &bytes);
        throw_mesh("a.ply", &bytes);
        throw_mesh("a.stl", &bytes);
        throw_mesh("a.gltf", &bytes);
        throw_mesh("a.glb", &bytes);
        let glb = [b"glTF\x02\0\0\0\xff\0\0\0".as_slice(), &bytes].concat();
        throw_mesh("a.glb", &glb);
    }

    #[test]
    fn arbitrary_text(text in "\\PC{0,200}", ron in "[()\\[\\]{},:\"'#/*a-zA-Z0-9. \n-]{0,200}") {
        throw(&text);
        throw(&ron);
        throw(&format!("(camera: {ron})"));
        throw(&format!("(objects: [(shape: {ron}, material: \"x\")])"));
    }

    #[test]
    fn mutated_scenes(edits in edits()) {
        let bytes = apply(VALID.as_bytes().to_vec(), &edits);
        throw(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn mutated_meshes(edits in edits(), flips in vec((any::<Index>(), any::<u8>()), 0..4)) {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let mut bytes = apply(ply(format), &edits);
            for (i, value) in &flips {
                if !bytes.is_empty() {
                    let i = i.index(bytes.len());
                    bytes[i] = *value;
                }
            }
            throw_mesh("a.ply", &bytes);
        }
        throw_mesh("a.obj", &apply(OBJ.as_bytes().to_vec(), &edits));
        throw_mesh("a.gltf", &apply(gltf_text().into_bytes(), &edits));
        throw_mesh("a.stl", &apply(STL.as_bytes().to_vec(), &edits));
        for (name, bytes) in [("a.stl", binary_stl()), ("a.glb", glb())] {
            let mut bytes = bytes;
            for (i, value) in &flips {
                let i = i.index(bytes.len());
                bytes[i] = *value;
            }
            throw_mesh(name, &bytes);
            throw_mesh(name, &apply(bytes, &edits));
        }
    }

    /// Numbers in place of numbers: what the lists of a glTF file say about
    /// each other.
    #[test]
    fn gltf_with_other_numbers(places in vec((any::<Index>(), number()), 1..5)) {
        let text = gltf_text();
        let is_digit = |i: usize| text.as_bytes()[i].is_ascii_digit();
        let starts: Vec<usize> = (1..text.find("base64").unwrap())
            .filter(|&i| is_digit(i) && !is_digit(i - 1))
            .collect();
        let mut chosen: Vec<(usize, &String)> =
            places.iter().map(|(i, n)| (starts[i.index(starts.len())], n)).collect();
        chosen.sort();
        chosen.dedup_by_key(|c| c.0);
        let mut changed = text.clone();
        for (start, number) in chosen.into_iter().rev() {
            let end = start + text[start..].find(|c: char| !c.is_ascii_digit()).unwrap();
            changed.replace_range(start..end, number);
        }
        throw_mesh("a.gltf", changed.as_bytes());
    }

    /// Parents hold their children, children stand in order, and no value is
    /// lost, whatever the text.
    #[test]
    fn outlines_are_trees_of_nested_spans(edits in edits()) {
        let text = String::from_utf8_lossy(&apply(VALID.as_bytes().to_vec(), &edits)).into_owned();
        if let Ok(outline) = Outline::scan(&text) {
            let mut stack = vec![outline.root()];
            while let Some(node) = stack.pop() {
                let span = outline.span(node);
                let mut at = span.start;
                for child in outline.children(node) {
                    let inner = outline.span(child);
                    prop_assert!(at <= inner.start && inner.end <= span.end);
                    prop_assert!(text.get(inner.clone()).is_some());
                    prop_assert_eq!(outline.parent(child), Some(node));
                    at = inner.end;
                    stack.push(child);
                }
            }
        }
    }
}

/// Long inputs that invite work growing with the square of their length: one
/// line, many parts, each of them wrong. Quadratic work on these would take
/// hours.
#[test]
fn long_broken_scenes_take_linear_work() {
    let repeat = |part: &str| part.repeat((4 << 20) / part.len());
    let camera =
        "camera: (eye: (0, -5, 3), look_at: (0, 0, 0), fov: 45), image: (width: 8, height: 6)";
    for text in [
        format!("({camera}, objects: [{}])", repeat("3,")),
        format!(
            "({camera}, objects: [{}])",
            repeat("(shape: Sphere(center: (0, 0, 0), radius: -1), material: \"a\"),")
        ),
        format!(
            "({camera}, lights: [{}])",
            repeat("Point(position: (0, 0, 0), power: -1),")
        ),
        format!("({camera}, {})", repeat("a: 1,")),
        format!("({camera}, materials: {{{}}})", repeat("\"a\": 1,")),
        format!(
            "({camera}, objects: [(shape: Mesh(vertices: [{}]), material: 1)])",
            repeat("(0, 0),")
        ),
        repeat("("),
        repeat("[1,"),
        repeat("/*"),
        repeat("r#\""),
        repeat("'a"),
        repeat("\"\\"),
    ] {
        throw(&text);
    }
    throw_mesh("a.obj", repeat("f 1 2 3\n").as_bytes());
    throw_mesh("a.obj", repeat("v 0 0 0 \\\n").as_bytes());
    throw_mesh(
        "a.obj",
        repeat("v 0 0 0\nusemtl a\nf 1 1 1\ng b\nf 1 1 1\n").as_bytes(),
    );
    throw_mesh(
        "a.stl",
        format!("solid\n{}", repeat("facet normal\nouter loop\n")).as_bytes(),
    );
    throw_mesh("a.gltf", repeat("[").as_bytes());
    throw_mesh(
        "a.gltf",
        format!("{{\"asset\": {}", repeat("{\"a\":")).as_bytes(),
    );
    let gltf = |list: &str, part: &str| {
        format!(
            "{{\"asset\": {{\"version\": \"2.0\"}}, \"{list}\": [{}{{}}]}}",
            repeat(part)
        )
    };
    throw_mesh("a.gltf", gltf("nodes", "{\"children\": [1]},").as_bytes());
    throw_mesh("a.gltf", gltf("nodes", "{\"mesh\": 0},").as_bytes());
    throw_mesh("a.gltf", gltf("accessors", "{},").as_bytes());
    throw_mesh(
        "a.ply",
        format!("ply\nformat ascii 1.0\n{}", repeat("element a 1\n")).as_bytes(),
    );
}

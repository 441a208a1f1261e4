//! Meshes as they are written: shared, cut by names, shaded, generated.

use std::{f64::consts::PI, sync::Arc};

use glam::DVec3;
use nephroid::{
    geometry::{Shape, Surface},
    material::Material,
    scene::{Summary, load},
};

use crate::{object, with};

#[test]
fn named_meshes_are_shared_and_files_read_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::fs::write(folder.path().join("tetra.obj"), obj).expect("written");
    let text = with(
        "meshes: {\"a\": File(\"tetra.obj\")},
         objects: [(shape: Mesh(named: \"a\"), material: Dielectric(ior: 1.5)),
                   (shape: Mesh(file: \"tetra.obj\"), material: Mirror())]",
    );
    let path = folder.path().join("scene.ron");
    std::fs::write(&path, text).expect("written");
    let scene = load(&path).unwrap_or_else(|e| panic!("{e}"));
    let [Shape::Mesh(a), Shape::Mesh(b)] = [0, 1].map(|i| scene.world.instances()[i].shape.clone())
    else {
        panic!("meshes")
    };
    assert!(Arc::ptr_eq(&a, &b));
    assert!(a.is_closed() && (a.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
    let summary = Summary::of(&scene);
    assert_eq!(
        (summary.objects, summary.triangles, summary.stored_triangles),
        (2, 8, 4)
    );
    assert!(summary.to_string().contains("8 x 6"), "{summary}");
    assert!(
        summary.to_string().contains("black"),
        "no lights: {summary}"
    );
}

/// A box with a lid of its own material, and a fin that belongs to nothing.
const BOX_OBJ: &str = "o box\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng body\nusemtl base\nf 1 3 2\n\
    f 1 2 4\nf 1 4 3\nusemtl lid\nf 2 3 4\nusemtl\nf 1 2 4\n";

fn meshes_of(scene: &nephroid::scene::Scene) -> Vec<Arc<nephroid::geometry::TriangleMesh>> {
    let mesh = |i: &nephroid::geometry::Instance| match &i.shape {
        Shape::Mesh(mesh) => Some(mesh.clone()),
        _ => None,
    };
    scene.world.instances().iter().filter_map(mesh).collect()
}

fn loaded_beside(files: &[(&str, &str)], text: &str) -> nephroid::scene::Scene {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    let path = folder.path().join("scene.ron");
    std::fs::write(&path, text).expect("written");
    load(&path).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn parts_of_a_mesh_have_materials_by_name() {
    let scene = loaded_beside(
        &[("box.obj", BOX_OBJ)],
        &with(
            "meshes: {\"box\": File(\"box.obj\")},
             objects: [(name: \"a\", shape: Mesh(named: \"box\"), material: Mirror(),
                        materials: {\"lid\": Diffuse(reflectance: 0.25), \"base\": Diffuse(reflectance: 0.5)}),
                       (name: \"b\", shape: Mesh(file: \"box.obj\"), at: (translate: (5, 0, 0)),
                        materials: {\"lid\": Mirror(), \"base\": Mirror(), \"box\": Mirror(reflectance: 0.5)}),
                       (name: \"c\", shape: Mesh(file: \"./box.obj\"), material: Diffuse(reflectance: 0.75), at: (scale: 2),
                        materials: {\"lid\": Mirror(), \"base\": Mirror()})]",
        ),
    );
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "a", "a/lid", "a/base", "b/lid", "b/base", "b/box", "c", "c/lid", "c/base"
        ]
    );
    let counts: Vec<usize> = meshes_of(&scene)
        .iter()
        .map(|m| m.triangle_count())
        .collect();
    assert_eq!(counts, [1, 1, 3, 1, 3, 1, 1, 1, 3]);
    let grey = |i: usize| match scene.objects[i].material {
        Material::Diffuse { reflectance } => reflectance.0[0],
        Material::Mirror { reflectance } => -reflectance.0[0],
        _ => panic!("no such material"),
    };
    assert_eq!([0, 1, 2, 5, 6].map(grey), [-1.0, 0.25, 0.5, -0.5, 0.75]);
    // Cut alike, shared, wherever they stand.
    let meshes = meshes_of(&scene);
    for (i, j) in [(0, 6), (1, 7), (2, 8)] {
        assert!(Arc::ptr_eq(&meshes[i], &meshes[j]));
    }
    assert_eq!(Summary::of(&scene).meshes.len(), 6);
}

/// A file of several chunks, read by one thread and by five.
#[test]
fn threads_do_not_change_a_mesh() {
    let mut obj = String::new();
    for i in 0..60_000 {
        obj += &format!("v {i} {} 0.125\nvn 0 {} 1\n", i % 7, i % 3);
    }
    for i in 3..60_000 {
        obj += &format!(
            "usemtl {}\nf {} {i}//{} {}//1\n",
            i % 5,
            i - 2,
            i - 1,
            i + 1
        );
    }
    assert!(obj.len() > 3 << 20, "fewer than three chunks");
    let read = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let data = nephroid::scene::mesh_file::parse("a.obj", obj.as_bytes());
            let data = data.unwrap_or_else(|e| panic!("{}", e.render(false)));
            let (v, n, t) = (
                data.vertices.clone(),
                data.normals.clone(),
                data.triangles.clone(),
            );
            let mesh = nephroid::geometry::TriangleMesh::new(v, n, t).expect("sound");
            (data, *mesh.defects())
        })
    };
    let (one, five) = (read(1), read(5));
    assert_eq!(one.1, five.1);
    assert!(one.0 == five.0, "the numbers differ");
}

/// Many places, one mesh in memory, until somebody wants it otherwise.
#[test]
fn instances_share_one_mesh() {
    let places: Vec<String> = (0..40)
        .map(|i| {
            let path = ["box.obj", "./box.obj"][i % 2];
            let turn = format!("(axis: (1, 2, 3), degrees: {i})");
            format!(
                "(shape: Mesh(file: \"{path}\"), material: Mirror(), \
                 at: (rotate: {turn}, translate: ({i}, 0, 0))),"
            )
        })
        .collect();
    let places = places.concat();
    let text = with(&format!(
        "objects: [{places}
            (shape: Mesh(file: \"box.obj\", smooth: true), material: Mirror()),
            (shape: Mesh(file: \"box.obj\", smooth: 180), material: Mirror()),
            (shape: Mesh(file: \"box.obj\", smooth: false), material: Mirror())]"
    ));
    let scene = loaded_beside(&[("box.obj", BOX_OBJ)], &text);
    let summary = Summary::of(&scene);
    let places: Vec<usize> = summary.meshes.iter().map(|m| m.places).collect();
    assert_eq!(places, [40, 1, 1, 1]);
    assert_eq!(
        (summary.triangles, summary.stored_triangles),
        (43 * 5, 4 * 5)
    );
    let smooth: Vec<bool> = summary.meshes.iter().map(|m| m.is_smooth).collect();
    assert_eq!(smooth, [false, true, true, false]);
}

#[test]
fn smooth_is_by_the_file_by_faces_or_by_angle() {
    // Two squares that meet at 90 degrees, with normals like those of a ball.
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nvn 0 1 1\nvn 0 2 1\n\
               f 1//1 2//1 3//2 4//2\nf 2//1 1//1 5//1 6//1\n";
    let text = |smooth: &str| {
        with(&format!(
            "meshes: {{\"m\": (file: \"bent.obj\"{smooth})}},
             objects: [(shape: Mesh(named: \"m\"), material: Mirror()),
                       (shape: Mesh(named: \"m\", smooth: 120), material: Mirror())]"
        ))
    };
    // The normal at the middle of the edge that both squares share.
    let at_the_edge = |mesh: &nephroid::geometry::TriangleMesh| {
        let (origin, dir) = (glam::DVec3::new(0.5, 1e-9, 1.0), glam::DVec3::NEG_Z);
        let hit = nephroid::geometry::Surface::intersect(mesh, origin, dir, 9.0, None);
        nephroid::geometry::Surface::surface(mesh, origin, dir, &hit.expect("below")).ns
    };
    let half = glam::DVec3::new(0.0, 1.0, 1.0).normalize();
    for (smooth, expected, vertices) in [
        ("", half, 6),
        (", smooth: true", half, 6),
        (", smooth: false", glam::DVec3::Z, 6),
        (", smooth: 30", glam::DVec3::Z, 8),
        (", smooth: 90", half, 6),
    ] {
        let scene = loaded_beside(&[("bent.obj", obj)], &text(smooth));
        let meshes = meshes_of(&scene);
        assert!(
            (at_the_edge(&meshes[0]) - expected).length() < 1e-8,
            "{smooth}"
        );
        assert_eq!(meshes[0].vertex_count(), vertices, "{smooth}");
        assert!((at_the_edge(&meshes[1]) - half).length() < 1e-8);
    }
}

#[test]
fn the_summary_tells_what_is_wrong_with_meshes() {
    // A tetrahedron with a face turned, one face twice and a flat one. A
    // stated normal is wrong for three corners, two that are made of faces
    // which contradict each other are, too.
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\nf 1 3 4\n\
               f 2 3 4\nf 2 3 4\nf 1 2 2\n";
    let scene = loaded_beside(
        &[("bad.obj", obj)],
        &with("objects: [(name: \"bad\", shape: Mesh(file: \"bad.obj\"), material: Mirror())]"),
    );
    let summary = Summary::of(&scene);
    let [mesh] = summary.meshes.as_slice() else {
        panic!("one mesh")
    };
    let d = &mesh.defects;
    assert_eq!(
        [
            d.open.count,
            d.twisted.count,
            d.crowded.count,
            d.doubled,
            mesh.dropped,
            mesh.disagreeing
        ],
        [0, 2, 3, 1, 1, 5]
    );
    assert_eq!((mesh.triangles, mesh.volume), (5, None));
    let text = summary.to_string();
    for part in [
        "bad: ",
        "5 triangles, smooth, not closed",
        "2 edges join faces of opposite winding, the first from (0, 0, 0) to (0, 1, 0)",
        "3 edges belong to more than two faces, the first from (1, 0, 0) to (0, 1, 0)",
        "1 face repeats another one",
        "1 face of zero area was dropped",
        "5 corners have normals on the other side",
    ] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
}

#[test]
fn generated_glass_is_closed_and_outward() {
    let scene = object("(shape: TorusKnot(), material: Dielectric(ior: 1.5))");
    let Shape::Mesh(mesh) = &scene.world.instances()[0].shape else {
        panic!("a mesh")
    };
    assert_eq!(mesh.triangle_count(), 131_072);
    assert!(mesh.is_smooth() && mesh.disagreeing_normals() == 0);
    // A tube's volume is its section times the length of the curve (Pappus).
    let expected = PI * 0.15 * 0.15 * 0.27 * knot_length();
    assert!(
        (mesh.signed_volume() / expected - 1.0).abs() < 5e-3,
        "{}",
        mesh.signed_volume()
    );
}

/// Length of the curve behind the default knot in its own units.
fn knot_length() -> f64 {
    let n = 10_000;
    let point = |k: i32| {
        let t = f64::from(k) / f64::from(n) * 2.0 * PI;
        let r = 2.0 + (3.0 * t).cos();
        DVec3::new(
            r * (2.0 * t).cos(),
            r * (2.0 * t).sin(),
            1.2 * (3.0 * t).sin(),
        )
    };
    (0..n).map(|k| (point(k + 1) - point(k)).length()).sum()
}

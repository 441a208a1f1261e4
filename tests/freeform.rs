//! Height fields in scenes, and the lens that throws a picture: what light
//! does at the faces that the scene language builds.

#[path = "../scenes/makers/freeform_picture.rs"]
#[allow(dead_code, reason = "its main is not called")]
mod drawing;

use std::{fs, path::Path, sync::Arc};

use glam::DVec3;
use nephroid::{
    design::{self, Picture, Task},
    film,
    geometry::{Ray, Shape, TriangleMesh},
    scene::{self, Scene},
    transport::{Carried, Lobes, lobes},
};

fn lenses() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/lenses")
}

/// A scene of one object, with `heights.exr` or `heights.png` beside it.
fn scene(folder: &Path, object: &str) -> Scene {
    let text = format!(
        "(camera: (eye: (0, -5, 3), look_at: (0, 0, 0), fov: 45), image: (width: 8, height: 6), \
          objects: [{object}, (name: \"screen\", material: Diffuse(reflectance: 1), \
          shape: Quad(center: (0, 0, 0), size: (9, 9), normal: (0, 0, 1)))], lights: [])"
    );
    scene::load_str(&text, "test.ron", folder).unwrap_or_else(|e| panic!("{text}\n{e}"))
}

fn mesh(scene: &Scene) -> Arc<TriangleMesh> {
    match &scene.world.instances()[0].shape {
        Shape::Mesh(mesh) => mesh.clone(),
        other => panic!("{other:?} is no mesh"),
    }
}

/// Where light that comes straight down at `(x, y)` lands on the screen, if
/// it does.
fn landing(scene: &Scene, x: f64, y: f64) -> Option<[f64; 2]> {
    let mut ray = Ray::new(DVec3::new(x, y, 2.0), DVec3::NEG_Z);
    for _ in 0..4 {
        let hit = scene.world.closest(&ray, f64::INFINITY)?;
        let point = scene.world.surface(&ray, &hit);
        let object = scene.object(hit.surface);
        match lobes(&object.material, &point, ray.dir, Carried::Flux) {
            None => return Some([point.p.x, point.p.y]),
            Some(Lobes::One(lobe) | Lobes::Two(_, lobe)) => ray = point.spawn(lobe.dir),
        }
    }
    None
}

/// Correlation of where light lands on the screen, through a lens on
/// `[-x, x] x [-y, y]`, with `density` on `size` cells, the first row at +y.
fn correlation(scene: &Scene, [x, y]: [f64; 2], size: [usize; 2], density: &[f64]) -> f64 {
    const RAYS: usize = 5;
    let mut found = vec![0.0; density.len()];
    for j in 0..RAYS * size[1] {
        for i in 0..RAYS * size[0] {
            let place = |k: usize, n: usize| 2.0 * (k as f64 + 0.5) / (RAYS * n) as f64 - 1.0;
            let from = [x * place(i, size[0]), y * place(j, size[1])];
            let Some(p) = landing(scene, from[0], from[1]) else {
                continue;
            };
            let column = (0.5 + 0.5 * p[0] / x) * size[0] as f64;
            let row = (0.5 - 0.5 * p[1] / y) * size[1] as f64;
            if column >= 0.0 && row >= 0.0 {
                let (column, row) = (column as usize, row as usize);
                if column < size[0] && row < size[1] {
                    found[row * size[0] + column] += 1.0 / (RAYS * RAYS) as f64;
                }
            }
        }
    }
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let (f, d) = (mean(&found), mean(density));
    let pairs = found.iter().zip(density).map(|(a, b)| (a - f, b - d));
    let (mut ff, mut fd, mut dd) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        ff += a * a;
        fd += a * b;
        dd += b * b;
    }
    fd / (ff * dd).sqrt()
}

fn write_exr(path: &Path, size: [usize; 2], f: impl Fn(usize, usize) -> f64) {
    let values: Vec<f64> = (0..size[0] * size[1])
        .map(|k| f(k % size[0], k / size[0]))
        .collect();
    film::write_heights(path, size, &values, &[]).unwrap();
}

/// The first row of an image is at the greatest y, its first column at the
/// least x; heights are metres.
#[test]
fn an_image_lies_as_it_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    write_exr(&folder.path().join("heights.exr"), [3, 2], |i, j| {
        i as f64 + 10.0 * j as f64
    });
    let field = |more: &str| {
        let object = format!(
            "(material: Mirror(), shape: HeightField(heights: \"heights.exr\", \
              x: (1, 5), y: (-1, 2){more}))"
        );
        scene(folder.path(), &object)
    };
    let top = |scene: &Scene, x: f64, y: f64| {
        let ray = Ray::new(DVec3::new(x, y, 100.0), DVec3::NEG_Z);
        100.0 - scene.world.closest(&ray, f64::INFINITY).unwrap().t
    };
    let plain = field("");
    assert_eq!(mesh(&plain).triangle_count(), 4);
    // Heights are 10 along -y over 3 m, 1 along x over 2 m.
    let known = |x: f64, y: f64| 0.5 * (x - 1.0) + 10.0 * (2.0 - y) / 3.0;
    for (x, y) in [(1.01, -0.99), (2.3, 0.4), (4.9, 1.8)] {
        assert!((top(&plain, x, y) - known(x, y)).abs() < 1e-12);
    }
    let scaled = field(", range: (9, 8.5), cells: (6, 5), smooth: false");
    assert_eq!(mesh(&scaled).triangle_count(), 60);
    assert!(!mesh(&scaled).is_smooth());
    let z = top(&scaled, 2.3, 0.4);
    assert!((z - (9.0 - 0.5 * known(2.3, 0.4))).abs() < 1e-12);
}

/// A bowl of 16 bits is closed by its depth and keeps its volume.
#[test]
fn a_png_becomes_a_body() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::ImageBuffer::from_fn(33, 17, |i, j| {
        let (x, y) = (f64::from(i) / 16.0 - 1.0, f64::from(j) / 8.0 - 1.0);
        image::Luma([(65535.0 * 0.5 * (x * x + y * y)).round() as u16])
    });
    picture.save(folder.path().join("heights.png")).unwrap();
    let object = "(material: Dielectric(ior: 1.5), shape: HeightField(heights: \"heights.png\", \
                   range: (0, 0.2), x: (-1, 1), y: (-1, 1), depth: 0.3, cells: 96))";
    let scene = scene(folder.path(), object);
    let mesh = mesh(&scene);
    assert_eq!(mesh.disagreeing_normals(), 0);
    // 4 (0.3 + 0.2 / 3), the facets above the bowl, half a step of 16 bits.
    let volume = mesh.signed_volume();
    assert!((volume - 4.0 * (0.3 + 0.2 / 3.0)).abs() < 1e-4, "{volume}");
}

/// A paraboloid by its formula: rays along the axis meet at the focus but for
/// the chords of the facets, whose normals are exact at the vertices.
#[test]
fn a_formula_becomes_a_mirror_with_its_focus() {
    let object = "(material: Mirror(), shape: HeightField(formula: \"0.25 * (x^2 + y^2) + 3\", \
                   x: (-1, 1), y: (-1, 1), cells: 200))";
    let scene = scene(Path::new(""), object);
    assert_eq!(mesh(&scene).triangle_count(), 80_000);
    for (x, y) in [(0.7, 0.1), (-0.4, 0.9), (0.25, -0.75)] {
        let ray = Ray::new(DVec3::new(x, y, 9.0), DVec3::NEG_Z);
        let hit = scene.world.closest(&ray, f64::INFINITY).unwrap();
        let point = scene.world.surface(&ray, &hit);
        let known = DVec3::new(-0.5 * x, -0.5 * y, 1.0).normalize();
        assert!((point.p.z - 3.0 - 0.25 * (x * x + y * y)).abs() < 3e-5);
        // A normal between vertices 0.01 apart is off by the square of that.
        assert!((point.ns - known).length() < 1e-5, "{}", point.ns - known);
    }
}

#[test]
fn the_picture_of_the_scene_is_the_drawing() {
    let stored = image::open(lenses().join("nephroid.png"))
        .unwrap()
        .to_luma8();
    let drawn = drawing::picture();
    let off = stored.pixels().zip(drawn.pixels());
    // Another platform's cosine may move a rounding.
    let off = off.map(|(a, b)| a.0[0].abs_diff(b.0[0])).max();
    assert!(off.unwrap() <= 1);
    assert!(fs::metadata(lenses().join("nephroid.png")).unwrap().len() < 50_000);
}

/// Light through the lens that ships, as the scene sets it up: the nephroid
/// is where it was drawn, upright and not mirrored.
#[test]
fn the_lens_of_the_scene_throws_its_picture() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/freeform.ron");
    let scene = scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
    let drawn = film::read_png(&lenses().join("nephroid.png")).unwrap();
    let size = [drawn.width() as usize, drawn.height() as usize];
    let values = drawn.pixels().iter().map(|p| p.luminance()).collect();
    let picture = Picture { size, values };
    // As the lens was asked for it, and then in squares of eight cells.
    let fine = picture.density([512, 512], 0.05).unwrap();
    let mut density = vec![0.0; 64 * 64];
    for (k, value) in fine.iter().enumerate() {
        density[k / 512 / 8 * 64 + k % 512 / 8] += value / 64.0;
    }
    let seen = [64, 64];
    let upright = correlation(&scene, [0.05, 0.05], seen, &density);
    assert!(upright > 0.98, "{upright}");
    let mirrored: Vec<f64> = density
        .chunks(64)
        .flat_map(|r| r.iter().rev())
        .copied()
        .collect();
    let turned: Vec<f64> = density.iter().rev().copied().collect();
    for other in [mirrored, turned] {
        let found = correlation(&scene, [0.05, 0.05], seen, &other);
        assert!(found < upright - 0.02, "{found} beside {upright}");
    }
}

/// An oblong picture, through the mesh that the scene language makes of the
/// file that the design writes.
#[test]
fn a_designed_lens_works_as_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let values = (0..64 * 32).map(|k| f64::from(u8::from((k % 64) < 20 && k / 64 > 22)));
    let picture = Picture {
        size: [64, 32],
        values: values.collect(),
    };
    let task = Task {
        lens: [0.2, 0.1],
        magnification: 1.0,
        distance: 0.5,
        ior: 1.6,
        resolution: [64, 32],
        darkest: 0.2,
    };
    let lens = design::design(&task, &picture).unwrap();
    let path = folder.path().join("heights.exr");
    film::write_heights(&path, [64, 32], &lens.rows_from_the_top(), &[]).unwrap();
    let object = "(material: Dielectric(ior: 1.6), shape: HeightField(heights: \"heights.exr\", \
                   x: (-0.1, 0.1), y: (-0.05, 0.05), depth: 0.01), \
                   at: (rotate: (axis: (1, 0, 0), degrees: 180), translate: (0, 0, 0.5)))";
    let scene = scene(folder.path(), object);
    let density = picture.density([32, 16], 0.2).unwrap();
    let found = correlation(&scene, [0.1, 0.05], [32, 16], &density);
    assert!(found > 0.98, "{found}");
}

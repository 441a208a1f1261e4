//! The same bytes whatever the number of threads, the order of the passes and
//! their grouping; other bytes for another seed.

mod common;

use std::{fs, ops::ControlFlow};

use common::{renderer, scene};
use nephroid::{
    film::{Film, Layer, Provenance, Window, write_film},
    numeric::exact::Quantum,
    render::{Job, run},
    scene::Scene,
};
use rayon::ThreadPoolBuilder;

const PASSES: u32 = 11;

/// Every estimator at work: soft and hard lights, glass, mirror, pane,
/// indirect light, and enough photons for a tree that is built in parallel.
fn everything() -> Scene {
    scene(
        "(camera: (eye: (0, -4, 2), look_at: (0, 0, 0.6), fov: 50), image: (width: 33, height: 21),
          materials: {
            \"grey\": Diffuse(reflectance: (0.5, 0.6, 0.7)),
            \"glass\": Dielectric(ior: 1.5),
          },
          objects: [
            (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
            (shape: Plane(point: (0, 3, 0), normal: (0, -1, 0)), material: \"grey\"),
            (shape: Sphere(center: (0, 0, 0.6), radius: 0.5), material: \"glass\"),
            (shape: Sphere(center: (1.1, 0.5, 0.5), radius: 0.4), material: Mirror(reflectance: 0.9)),
            (shape: Quad(corner: (-1.5, -0.5, 0.1), u: (0.8, 0, 0), v: (0, 0.2, 1)),
             material: Dielectric(ior: 1.5, thin: true)),
            (shape: Waves(x: (-1, 1), y: (-2, -1), level: 0.1, cells: 16,
                waves: [(amplitude: 0.02, k: (5.2, 2.1))]), material: \"glass\", open: true),
          ],
          lights: [
            Sphere(center: (0.2, 0.4, 2.2), radius: 0.2, radiance: (30, 20, 10)),
            Point(position: (-2, -1, 2), power: 30),
            Quad(center: (1, 1, 3), size: (0.5, 0.5), facing: (0, 0, 0), radiance: 5),
          ],
          render: (passes: 11, photons: 20000, seed: 5))",
    )
}

/// The film and the bytes of its file; the wall time is no part of either.
fn film_and_file(scene: &Scene) -> (Film, Vec<u8>) {
    let outcome = run(scene, &Job::of(scene), &mut |_| ControlFlow::Continue(()));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("picture.exr");
    let provenance = Provenance {
        scene_hash: "everything".to_owned(),
        seed: outcome.report.seed,
        photons: outcome.report.photons_emitted,
        render_seconds: 0.0,
        further: Vec::new(),
    };
    let [w, h] = scene.resolution;
    write_film(&path, &outcome.film, Window::whole(w, h), &provenance).expect("written");
    (outcome.film, fs::read(&path).expect("readable"))
}

#[test]
fn any_number_of_threads() {
    let scene = everything();
    let (film, file) = film_and_file(&scene);
    assert!(file.len() > 1000 && film.image().mean().mean() > 0.0);
    for threads in [1, 2, 7] {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        let (other, bytes) = pool.install(|| film_and_file(&scene));
        assert!(other == film, "{threads} threads give another film");
        assert!(bytes == file, "{threads} threads give another file");
    }
    let (again, bytes) = film_and_file(&everything());
    assert!(again == film && bytes == file, "a second run differs");
}

#[test]
fn another_seed_is_another_picture() {
    let mut scene = everything();
    let (film, file) = film_and_file(&scene);
    scene.settings.seed += 1;
    let (other, bytes) = film_and_file(&scene);
    assert!(film != other && file != bytes);
    for layer in [Layer::Direct, Layer::Caustic, Layer::Indirect] {
        assert!(
            film.layer_image(layer) != other.layer_image(layer),
            "{} does not depend on the seed",
            layer.name()
        );
    }
}

/// Passes in any order, on any number of films that are merged later.
#[test]
fn order_and_grouping_of_passes() {
    let scene = everything();
    let renderer = renderer(&scene);
    let quantum = Quantum::for_typical(0.3);
    let [w, h] = scene.resolution;
    let film_of = |passes: &[u32]| {
        let mut film = Film::new(w, h, quantum);
        for &i in passes {
            film.add_pass(i, &renderer.pass(i).samples);
        }
        film
    };
    let whole = film_of(&(0..PASSES).collect::<Vec<_>>());
    let shuffled: Vec<u32> = (0..PASSES).map(|i| (i * 7 + 3) % PASSES).collect();
    assert!(film_of(&shuffled) == whole, "shuffled");
    let mut parts = film_of(&shuffled[..4]);
    let mut rest = film_of(&shuffled[9..]);
    rest.merge(&film_of(&shuffled[4..9])).expect("same picture");
    parts.merge(&rest).expect("same picture");
    assert!(parts == whole, "merged in parts");
}

/// A window shows what the whole picture shows there, also where the program
/// chooses the number of photons.
#[test]
fn a_crop_is_a_window_of_the_whole() {
    let mut scene = everything();
    scene.settings.photons = None;
    let job = Job::of(&scene);
    let render = |crop| {
        let job = Job {
            crop,
            ..job.clone()
        };
        run(&scene, &job, &mut |_| ControlFlow::Continue(())).film
    };
    let whole = render(None);
    let [x0, y0, width, height] = [5, 3, 17, 9];
    let window = render(Some([x0, y0, width, height]));
    for layer in Layer::ALL {
        let (all, part) = (whole.layer_image(layer), window.layer_image(layer));
        for y in 0..height {
            for x in 0..width {
                assert_eq!(
                    part.pixel(x, y),
                    all.pixel(x0 + x, y0 + y),
                    "{} at {x}, {y}",
                    layer.name()
                );
            }
        }
    }
}

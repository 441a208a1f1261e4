//! The reference methods against closed forms, against each other, and against
//! the renderer.

mod common;

use std::{f64::consts::PI, ops::ControlFlow};

use common::{Estimate, scene_of};
use nephroid::{
    film::{Film, Layer, PixelSample},
    reference::{self, Method, Pinhole, Reference},
    render::{Job, REPLICATES, run},
    scene::Scene,
};

/// Pixels along a block whose mean is compared: errors of neighbouring pixels
/// go together.
const BLOCK: u32 = 8;

/// Student's t for two samples of eight replicates has 14 degrees of freedom:
/// 7 is exceeded once in 160,000 tests, some 500 of which are made here.
const MOST_ERRORS: f64 = 7.0;

/// Whose picture is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    Photons,
    Method(Method),
}

use By::Photons;

const PATH: By = By::Method(Method::Path);
const LIGHT: By = By::Method(Method::Light);
const BDPT: By = By::Method(Method::Bdpt);
const METROPOLIS: By = By::Method(Method::Metropolis);

/// The scene's film after so many rounds of eight passes.
fn film(scene: &Scene, by: By, rounds: u32) -> Film {
    let mut job = Job::of(scene);
    job.settings.passes = rounds * REPLICATES;
    let on = &mut |_: &_| ControlFlow::Continue(());
    match by {
        Photons => run(scene, &job, on).film,
        By::Method(method) => reference::render(scene, &job, method, on).film,
    }
}

/// Mean of each block of pixels, with the spread of the replicates.
fn blocks(film: &Film) -> Vec<Estimate> {
    let images: Vec<_> = (0..REPLICATES as usize)
        .map(|r| film.replicate_image(r))
        .collect();
    let mut found = Vec::new();
    for top in (0..film.height()).step_by(BLOCK as usize) {
        for left in (0..film.width()).step_by(BLOCK as usize) {
            let means: Vec<f64> = images
                .iter()
                .map(|image| {
                    let rows = top..(top + BLOCK).min(film.height());
                    let pixels = rows.flat_map(|y| {
                        (left..(left + BLOCK).min(film.width())).map(move |x| (x, y))
                    });
                    let (sum, count) = pixels.fold((0.0, 0.0), |(sum, count), (x, y)| {
                        (sum + image.pixel(x, y)[1], count + 1.0)
                    });
                    sum / count
                })
                .collect();
            found.push(Estimate::of(&means));
        }
    }
    found
}

/// Mean of the whole picture (or a layer's share of it), by replicates.
fn whole(film: &Film) -> Estimate {
    let means: Vec<f64> = (0..REPLICATES as usize)
        .map(|r| film.replicate_image(r).mean()[1])
        .collect();
    Estimate::of(&means)
}

/// Asserts that all pictures show the same, block by block; `precision` is the
/// largest standard error of a picture's mean, `bias` what the photons' blur
/// may move between blocks, both relative to the mean of the picture.
fn assert_agree(scene: &Scene, all: &[(By, u32)], precision: f64, bias: f64, what: &str) {
    let films: Vec<(By, Film)> = all
        .iter()
        .map(|&(by, rounds)| (by, film(scene, by, rounds)))
        .collect();
    let (first, truth) = &films[0];
    let mean = whole(truth).mean;
    let (truth_blocks, truth_mean) = (blocks(truth), whole(truth));
    for (by, film) in &films {
        let own = whole(film);
        assert!(
            own.error <= precision * mean,
            "{what}: {by:?} is not precise: {own:?}"
        );
        assert_eq!(film.refused(), 0, "{what}: {by:?}");
    }
    for (by, film) in &films[1..] {
        let slack = if *by == Photons || *first == Photons {
            bias * mean
        } else {
            0.0
        };
        let pairs = blocks(film).into_iter().zip(&truth_blocks);
        let pairs = pairs.chain([(whole(film), &truth_mean)]);
        for (i, (a, b)) in pairs.enumerate() {
            let error = (a.error * a.error + b.error * b.error).sqrt();
            assert!(
                (a.mean - b.mean).abs() <= MOST_ERRORS * error + slack + 1e-9 * mean,
                "{what}: {by:?} and {first:?} differ in block {i}: {a:?} {b:?}, {:.1} errors",
                (a.mean - b.mean) / error
            );
        }
    }
}

/// An integrating sphere: the wall is equally bright everywhere,
/// E = P / (4 pi R^2 (1 - a)), and every method that sees light between
/// diffuse surfaces must find it.
#[test]
fn furnace() {
    let albedo = 0.7;
    let scene = scene_of(
        "eye: (0.3, 0.1, -0.2), look_at: (1, 0.4, 0.3), fov: 80",
        [16, 16],
        &format!(
            "(shape: Sphere(center: (0, 0, 0), radius: 2), material: Diffuse(reflectance: {albedo}))"
        ),
        "Point(position: (0, 0, 0), power: 20)",
        "max_depth: 200",
    );
    let direct = 20.0 / (4.0 * PI * 4.0) * albedo / PI;
    let exact = direct / (1.0 - albedo);
    for (by, rounds, precision) in [
        (PATH, 4, 0.01),
        (BDPT, 4, 0.01),
        (METROPOLIS, 8, 0.03),
        (LIGHT, 4, 0.02),
    ] {
        whole(&film(&scene, by, rounds)).assert_is(exact, precision, &format!("{by:?}"));
    }
    // Whitted's light does not bounce.
    let whitted = film(&scene, By::Method(Method::Whitted), 1).image();
    assert!(
        whitted
            .pixels()
            .iter()
            .all(|p| (p[1] / direct - 1.0).abs() < 1e-12)
    );
    // The hole may be wide, for the wall looks the same from everywhere.
    let pinhole = Pinhole {
        radius: 0.4,
        depth: 1.0,
    };
    let naive = Reference::new(
        &scene,
        &scene.settings,
        Method::LightNaive,
        [16, 16],
        [0, 0, 16, 16],
    )
    .with_pinhole(pinhole);
    let rounds = 24;
    let means: Vec<f64> = (0..REPLICATES)
        .map(|replicate| {
            let passes = (0..rounds).map(|round| round * REPLICATES + replicate);
            let sum: f64 = passes
                .flat_map(|pass| naive.pass(pass))
                .map(|p| p.total()[1])
                .sum();
            sum / (256.0 * f64::from(rounds))
        })
        .collect();
    Estimate::of(&means).assert_is(exact, 0.06, "through a pinhole");
}

const ROOM: &str = "
    (shape: Quad(center: (0, 0, 0), size: (2, 2), normal: (0, 0, 1)), material: \"grey\"),
    (shape: Quad(center: (0, 0, 2), size: (2, 2), normal: (0, 0, -1)), material: \"grey\"),
    (shape: Quad(center: (0, 1, 1), size: (2, 2), normal: (0, -1, 0)), material: \"grey\"),
    (shape: Quad(center: (-1, 0, 1), size: (2, 2), normal: (1, 0, 0)), material: Diffuse(reflectance: (0.6, 0.2, 0.1))),
    (shape: Quad(center: (1, 0, 1), size: (2, 2), normal: (-1, 0, 0)), material: Diffuse(reflectance: (0.1, 0.5, 0.2))),";

const VIEW: &str = "eye: (0, -3.2, 1), look_at: (0, 0, 1), fov: 40";

/// A room of diffuse walls: all methods own all its paths.
#[test]
fn diffuse_room() {
    let scene = scene_of(
        VIEW,
        [24, 24],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.3, 0.2, 0.4), radius: 0.4), material: \"grey\"),"
        ),
        "Quad(corner: (-0.4, -0.4, 1.9), u: (0, 0.8, 0), v: (0.8, 0, 0), radiance: 6)",
        "",
    );
    let all = [(BDPT, 3), (PATH, 3), (METROPOLIS, 6), (Photons, 3)];
    assert_agree(&scene, &all, 0.02, 0.0, "room");
    // What light tracing sees is everything but the lamp.
    let without_lamp = |by, rounds| {
        let film = film(&scene, by, rounds);
        let mean = |layer| film.layer_image(layer).mean()[1];
        mean(Layer::Direct) + mean(Layer::Indirect)
    };
    let (light, path) = (without_lamp(LIGHT, 6), without_lamp(PATH, 6));
    assert!((light / path - 1.0).abs() < 0.03, "{light} {path}");
}

/// A ball of glass, a mirror and a large lamp: caustics that a path from the
/// eye can find, and bidirectional paths in glass.
#[test]
fn caustics_of_a_large_lamp() {
    let scene = scene_of(
        VIEW,
        [24, 24],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"glass\"),
             (shape: Sphere(center: (-0.4, 0.4, 0.4), radius: 0.35), material: \"mirror\"),"
        ),
        "Quad(corner: (-0.7, -0.7, 1.9), u: (0, 1.4, 0), v: (1.4, 0, 0), radiance: 3)",
        "",
    );
    let all = [(BDPT, 6), (PATH, 8), (METROPOLIS, 12), (Photons, 3)];
    assert_agree(&scene, &all, 0.02, 0.01, "caustics");
}

/// Water in glass, one body in the other, and the camera in a third: indices
/// of both sides, whichever way the path goes.
#[test]
fn bodies_in_each_other() {
    let scene = scene_of(
        "eye: (0, -0.9, 1), look_at: (0, 0, 0.9), fov: 70",
        [16, 16],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.3, 0, 0.6), radius: 0.4), material: Dielectric(ior: 1.5, priority: 1)),
             (shape: Sphere(center: (0.3, 0, 0.6), radius: 0.3), material: Dielectric(ior: 1.33, priority: 2)),
             (shape: Sphere(center: (0, -0.9, 1), radius: 0.2), material: Dielectric(ior: 1.4, priority: 3)),"
        ),
        "Quad(corner: (-0.7, -0.7, 1.9), u: (0, 1.4, 0), v: (1.4, 0, 0), radiance: 3)",
        "",
    );
    let all = [(BDPT, 6), (PATH, 8), (METROPOLIS, 12), (Photons, 3)];
    assert_agree(&scene, &all, 0.04, 0.01, "bodies");
}

/// A slab of glass over a floor that the camera sees beside it, and a lamp: the
/// camera's view of the floor is free, so light tracing sees all of it.
#[test]
fn slab_over_a_floor() {
    let scene = scene_of(
        "eye: (0, 0, 0.6), look_at: (0, 0, 0), up: (0, 1, 0), fov: 60",
        [16, 16],
        "(shape: Quad(center: (0, 0, 0), size: (3, 3), normal: (0, 0, 1)), material: \"grey\"),
         (shape: Quad(center: (0.4, 0, 0.9), size: (1.2, 1.2), normal: (0, 0, -1)), material: \"glass\", open: true),
         (shape: Quad(center: (0.4, 0, 1.0), size: (1.2, 1.2), normal: (0, 0, 1)), material: \"glass\", open: true),",
        "Disc(center: (0.3, 0, 2), normal: (0, 0, -1), radius: 0.5, radiance: 5)",
        "",
    );
    let all = [
        (LIGHT, 12),
        (PATH, 12),
        (BDPT, 8),
        (METROPOLIS, 12),
        (Photons, 3),
    ];
    assert_agree(&scene, &all, 0.04, 0.02, "slab");
}

/// Every kind of light: what leaves it for the floor and the ball is what they
/// receive.
#[test]
fn every_light() {
    for light in [
        "Point(position: (0.4, -0.5, 2), power: 30)",
        "Spot(position: (0.4, -0.5, 2), look_at: (0, 0, 0), inner: 20, outer: 40, power: 30)",
        "Directional(direction: (-0.2, 0.2, -1), irradiance: 9, beam: (center: (0.4, -0.5, 2), radius: 0.6))",
        "Directional(direction: (-0.2, 0.2, -1), irradiance: 9, angular_diameter: 0)",
        "Directional(direction: (-0.2, 0.2, -1), irradiance: 9, angular_diameter: 30)",
        "Sphere(center: (0.4, -0.5, 2), radius: 0.4, radiance: 9)",
        "Disc(center: (0.4, -0.5, 2), normal: (0, 0, -1), radius: 0.5, radiance: 9)",
        "Quad(corner: (0, -0.7, 2), u: (0, 0.8, 0), v: (0.8, 0, 0), radiance: 9)",
    ] {
        let scene = scene_of(
            "eye: (0, -2, 1.6), look_at: (0, 0, 0.1), fov: 35",
            [16, 16],
            "(shape: Quad(center: (0, 0, 0), size: (6, 6), normal: (0, 0, 1)), material: \"grey\"),
             (shape: Sphere(center: (0, 0, 0.4), radius: 0.3), material: \"white\"),",
            light,
            "",
        );
        let all = [(PATH, 4), (LIGHT, 6), (BDPT, 4), (METROPOLIS, 8)];
        assert_agree(&scene, &all, 0.06, 0.0, light);
    }
}

/// Panes and index-matched balls are crossed in straight lines, by all
/// methods; a wide filter weighs what is splatted as what is gathered; a crop
/// is a part of the picture.
#[test]
fn straight_lines_filters_and_crops() {
    let text = "(camera: (eye: (0, -2, 1.2), look_at: (0, 0, 0.3), fov: 40),
        image: (width: 16, height: 16, filter: Gaussian),
        materials: {\"grey\": Diffuse(reflectance: 0.5)},
        objects: [
            (shape: Quad(center: (0, 0, 0), size: (4, 4), normal: (0, 0, 1)), material: \"grey\"),
            (shape: Sphere(center: (0.3, 0, 0.3), radius: 0.3), material: Dielectric(ior: 1)),
            (shape: Quad(center: (0, -0.8, 0.6), size: (3, 3), normal: (0, 1, 0)), material: Dielectric(ior: 1.5, thin: true)),
            (shape: Sphere(center: (-0.3, 0.2, 0.25), radius: 0.25), material: \"grey\"),
        ],
        lights: [Disc(center: (0.5, 0, 2), normal: (0, 0, -1), radius: 0.4, radiance: 9)])";
    let scene = common::scene(text);
    let all = [(PATH, 6), (BDPT, 6), (METROPOLIS, 8), (Photons, 3)];
    assert_agree(&scene, &all, 0.03, 0.02, "panes");
    let crop = [3, 2, 8, 8];
    let mut job = Job::of(&scene);
    job.crop = Some(crop);
    job.settings.passes = 6 * REPLICATES;
    let on = &mut |_: &_| ControlFlow::Continue(());
    let means = [Method::Path, Method::Bdpt, Method::Metropolis].map(|method| {
        let film = reference::render(&scene, &job, method, on).film;
        (method, whole(&film))
    });
    for (method, mean) in &means[1..] {
        let (_, truth) = means[0];
        let error = (mean.error * mean.error + truth.error * truth.error).sqrt();
        let off = (mean.mean - truth.mean) / error;
        assert!(off.abs() < MOST_ERRORS, "{method:?}: {mean:?} {truth:?}");
    }
}

/// The same bytes for any number of threads.
#[test]
fn threads_change_nothing() {
    let scene = scene_of(
        VIEW,
        [20, 12],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"glass\"),"
        ),
        "Quad(corner: (-0.4, -0.4, 1.9), u: (0, 0.8, 0), v: (0.8, 0, 0), radiance: 6)",
        "",
    );
    for method in Method::ALL {
        let reference = Reference::new(&scene, &scene.settings, method, [20, 12], [0, 0, 20, 12]);
        let pass = |threads| -> Vec<PixelSample> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| reference.pass(9))
        };
        let one = pass(1);
        assert!(one.iter().any(|p| !p.total().is_black()) || method == Method::LightNaive);
        assert_eq!(one, pass(3), "{method:?}");
    }
}

/// One point light and nothing that divides light: Whitted's picture is the
/// direct layer of path tracing, pixel by pixel.
#[test]
fn whitted_is_the_direct_light_of_points() {
    let scene = scene_of(
        VIEW,
        [12, 12],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"mirror\"),"
        ),
        "Point(position: (0.1, -0.3, 1.7), power: 30)",
        "",
    );
    let direct = |by| film(&scene, by, 1).layer_image(Layer::Direct);
    let (whitted, path) = (direct(By::Method(Method::Whitted)), direct(PATH));
    assert!(whitted.mean()[1] > 0.1);
    for (a, b) in whitted.pixels().iter().zip(path.pixels()) {
        assert!((a[1] - b[1]).abs() <= 1e-12 * b[1].abs(), "{a:?} {b:?}");
    }
}

/// What a method can't see is said in words.
#[test]
fn blind_spots_are_named() {
    let scene = scene_of(
        VIEW,
        [8, 8],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"glass\"),"
        ),
        "Point(position: (0.1, -0.3, 1.7), power: 30)",
        "",
    );
    let words = |method: Method| method.blind_spots(&scene).join("\n");
    assert!(words(Method::Path).contains("caustics of lights[0]"));
    assert!(words(Method::Bdpt).contains("seen in mirrors or glass"));
    assert!(words(Method::Light).contains("what mirrors and glass show is black"));
    assert!(words(Method::Whitted).contains("caustics are missing"));
    assert!(words(Method::LightNaive).contains("blurred"));
    // And it is so.
    let caustic = |by| film(&scene, by, 1).layer_image(Layer::Caustic).mean()[1];
    assert_eq!(caustic(PATH), 0.0);
    assert!(caustic(BDPT) > 0.0);
}

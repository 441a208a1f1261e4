//! How many sheets of light lie over a place: photons count them, and pictures are
//! more exact for it.

mod common;

#[path = "../benches/estimators/exact/mod.rs"]
#[allow(
    dead_code,
    unused_imports,
    reason = "few of the closed forms are needed"
)]
mod exact;

use std::f64::consts::PI;

use common::{Estimate, as_gathered, render, renderer, scene, scene_of};
use exact::Case;
use glam::DVec3;
use nephroid::{
    film::{Image, Layer},
    metrics::relmse,
    photon::{Emitter, shoot},
    render::{REPLICATES, Renderer},
    sampling::{Purpose, Sequence},
    scene::Scene,
};

const PATHS: u64 = 1 << 15;

/// Mean number of sheets over a part of the floor, of replicates of a pass.
fn sheets(
    renderer: &Renderer<'_>,
    emitter: &Emitter,
    area: f64,
    within: impl Fn(DVec3) -> bool,
) -> Estimate {
    let ctx = renderer.context();
    let numbers: Vec<f64> = (0..REPLICATES)
        .map(|replicate| {
            let sequence = Sequence::new(5, Purpose::Photon, replicate, 0);
            let shot = shoot(&ctx, emitter, sequence, 0, PATHS);
            let there = shot.photons.iter().filter(|p| within(p.position));
            there.map(|p| p.sheet).sum::<f64>() / (PATHS as f64 * area)
        })
        .collect();
    Estimate::of(&numbers)
}

/// A floor under a thick pane, with a ball far away that asks for photons, too.
fn under_a_pane(lights: &str) -> Scene {
    scene_of(
        "eye: (0, -0.1, 0.3), look_at: (0, 0, 0), up: (0, 1, 0), fov: 40",
        [32, 32],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\"),
         (shape: Box(min: (-1.5, -1.5, 0.4), max: (1.5, 1.5, 0.7)), material: \"glass\"),
         (shape: Sphere(center: (2.5, 0, 0.4), radius: 0.3), material: \"glass\")",
        lights,
        "photons: 32768, indirect: false",
    )
}

/// Whatever the light, and whether or not paths are guided, there is one sheet; and
/// as many as there are lights. Those of glowing balls are not counted: a part of them
/// is always turned away.
#[test]
fn every_light_lays_one_sheet() {
    let kinds = [
        "Point(position: (0.1, 0, 2), power: 60)",
        "Spot(position: (0.1, 0, 2), look_at: (0, 0, 0), power: 1, outer: 30, inner: 15)",
        "Directional(direction: (0.2, 0, -1), irradiance: 1, angular_diameter: 0)",
        "Directional(direction: (0.2, 0, -1), irradiance: 1, angular_diameter: 3)",
        "Directional(direction: (0.2, 0, -1), irradiance: 1, beam: (center: (-0.2, 0, 1), radius: 0.6))",
        "Quad(corner: (-0.2, -0.2, 2), u: (0, 0.4, 0), v: (0.4, 0, 0), radiance: 1)",
        "Disc(center: (0, 0, 2), radius: 0.2, facing: (0, 0, 0), radiance: 1)",
    ];
    let both = format!("{}, {}", kinds[0], kinds[3]);
    let ball = "Sphere(center: (0.1, 0, 2), radius: 0.2, radiance: 1)";
    let cases = kinds
        .iter()
        .map(|l| (*l, 1.0))
        .chain([(both.as_str(), 2.0), (ball, 0.0)]);
    for (lights, number) in cases {
        let scene = under_a_pane(lights);
        let renderer = renderer(&scene);
        let square = |p: DVec3| p.z == 0.0 && p.x.abs() < 0.2 && p.y.abs() < 0.2;
        for (emitter, how) in [
            (renderer.emitter().expect("casters"), "not guided"),
            (renderer.emitter_of(2).expect("casters"), "guided"),
        ] {
            let found = sheets(&renderer, emitter, 0.16, square);
            if number == 0.0 {
                assert_eq!(found.mean, 0.0);
                continue;
            }
            found.assert_is(number, 0.03, &format!("{lights}, {how}"));
        }
    }
}

/// Behind a ball there are three within the fold, and one outside.
#[test]
fn a_fold_lays_two_more() {
    let case = Case::named("before").expect("a scene");
    let mut scene = scene(&case.text());
    scene.settings.photons = Some(PATHS);
    let renderer = renderer(&scene);
    let emitter = renderer.emitter().expect("a caster");
    // The fold lies between the two rings.
    for (low, high, number) in [(0.02, 0.07, 3.0), (0.076, 0.13, 1.0)] {
        let area = PI * (high * high - low * low);
        let ring = |p: DVec3| p.z.abs() < 1e-9 && (low..high).contains(&p.truncate().length());
        let found = sheets(&renderer, emitter, area, ring);
        found.assert_is(number, 0.05, &format!("{low} m to {high} m"));
    }
}

/// Against exact solutions, after one round: less error is left than as gathered,
/// where the light is smooth a fifth or less.
#[test]
fn pictures_are_more_exact() {
    for (name, most) in [
        ("focus", 1.0 / 6.0),
        ("after", 1.0 / 5.0),
        ("bumpy", 0.5),
        ("before", 0.9),
    ] {
        let case = Case::named(name).expect("a scene");
        let mut scene = scene(&case.text());
        scene.settings.passes = 8;
        let film = render(&scene).film;
        let reference = case.reference().image;
        let error = |radiance: &Image| {
            let irradiance = Image::from_fn(radiance.width(), radiance.height(), |x, y| {
                radiance.pixel(x, y) * PI
            });
            relmse(&irradiance, &reference).expect("same size")
        };
        let (with, without) = (
            error(&film.layer_image(Layer::Caustic)),
            error(&as_gathered(&film)),
        );
        assert!(with < most * without, "{name}: {with} of {without}");
    }
}

//! Light through an implicit sphere goes where it goes through the exact one.

mod common;

use glam::DVec3;
use nephroid::{
    film::Layer,
    geometry::Ray,
    metrics::relmse,
    scene::Scene,
    transport::{Carried, Lobes, lobes},
};

use common::{ball, render, scene};

const PLANE: f64 = 1.3;
const BEAM: f64 = 0.95;
const WINDOW: f64 = 1.4;
const PIXELS: u32 = 40;

/// The scene of a ball lens, the ball exact and implicit.
fn balls(settings: &str) -> [Scene; 2] {
    let text = ball::scene_text(PLANE, BEAM, WINDOW, PIXELS, settings);
    let exact = format!("Sphere(center: (0, 0, {PLANE}), radius: 1)");
    let implicit = format!(
        "Implicit(f: \"x^2 + y^2 + (z - {PLANE})^2 - 1\", bounds: ((-1, -1, {}), (1, 1, {})))",
        PLANE - 1.0,
        PLANE + 1.0
    );
    assert!(text.contains(&exact));
    [scene(&text), scene(&text.replace(&exact, &implicit))]
}

/// Where a ray that comes straight down goes through the ball and lands.
fn landing(scene: &Scene, x: f64, y: f64) -> (DVec3, f64) {
    let mut ray = Ray::new(DVec3::new(x, y, PLANE + 2.0), DVec3::NEG_Z);
    let mut weight = 1.0;
    loop {
        let hit = scene.world.closest(&ray, f64::INFINITY).expect("the floor");
        let point = scene.world.surface(&ray, &hit);
        let material = &scene.object(hit.surface).material;
        match lobes(material, &point, ray.dir, Carried::Flux) {
            None => return (point.p, weight),
            Some(Lobes::One(lobe) | Lobes::Two(_, lobe)) => {
                weight *= lobe.share * lobe.weight[0];
                ray = point.spawn(lobe.dir);
            }
        }
    }
}

#[test]
fn rays_take_the_same_way() {
    let [exact, implicit] = balls("passes: 1");
    for i in 0..3000 {
        let height = BEAM * (f64::from(i) + 0.5) / 3000.0;
        let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
        let (p, w) = landing(&exact, height * cos, height * sin);
        let (q, v) = landing(&implicit, height * cos, height * sin);
        assert!(
            p.distance(q) < 1e-12 && (w - v).abs() < 1e-12,
            "at height {height}: {p} {q}"
        );
        // And both are where the closed form says.
        let known = ball::landing(height, PLANE);
        assert!((q - DVec3::new(known * cos, known * sin, 0.0)).length() < 1e-12);
        let share = ball::transmittance(height);
        assert!(
            (v - share).abs() < 1e-12,
            "at height {height}: {v} for {share}"
        );
    }
}

/// Both pictures are as near to the exact irradiance as noise and the bias
/// of the kernel leave them, and no farther from each other.
#[test]
fn the_caustic_is_that_of_the_exact_sphere() {
    let known = ball::irradiance(PLANE, BEAM, WINDOW, PIXELS);
    let [exact, implicit] =
        balls("passes: 16, photons: 16384").map(|s| render(&s).film.layer_image(Layer::Caustic));
    let error = |a, b| relmse(a, b).expect("same size");
    let (by_exact, by_implicit) = (error(&exact, &known), error(&implicit, &known));
    assert!(by_exact < 0.02, "{by_exact}");
    assert!(
        by_implicit < 1.25 * by_exact,
        "{by_implicit} against {by_exact}"
    );
    let apart = error(&implicit, &exact);
    assert!(apart < 2.0 * by_exact, "{apart} against {by_exact}");
    let flux = [&exact, &implicit].map(|image| image.mean()[1]);
    assert!((flux[1] / flux[0] - 1.0).abs() < 5e-3, "{flux:?}");
}

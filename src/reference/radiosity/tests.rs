//! Form factors against their closed forms, and the elements themselves.

use std::{f64::consts::PI, path::Path};

use super::*;
use crate::{
    reference::Method,
    sampling::{Purpose, Sequence},
    scene::load_str,
};

/// Rays from a side: low discrepancy keeps the error of a form factor well
/// below that of as many random rays.
const RAYS: u64 = 1 << 17;

/// Bound on the error of a form factor.
const CLOSE: f64 = 1e-3;

fn scene(objects: &str) -> Scene {
    let text = format!(
        "(camera: (eye: (9, -9, 9), look_at: (0, 0, 0), fov: 40), image: (width: 8, height: 8),
          materials: {{\"grey\": Diffuse(reflectance: 0.5)}}, objects: [{objects}],
          lights: [Point(position: (0.1, 0.2, 0.3), power: 1)])"
    );
    load_str(&text, "test.ron", Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

/// An object of the common material.
fn grey(shape: &str) -> String {
    format!("(shape: {shape}, material: \"grey\"),")
}

/// Shares of the rays from a side of instance `from` (0 in front, 1 behind its
/// normals), spread over its area, that land on each instance.
fn form_factors(scene: &Scene, patches: u32, from: u32, behind: usize) -> Vec<f64> {
    let setup = Setup::new(
        scene,
        &scene.settings,
        Method::Radiosity,
        [8, 8],
        [0, 0, 8, 8],
        1,
    );
    let solver = Solver::new(scene, patches);
    let own: Vec<usize> = (0..solver.elements.all().len())
        .filter(|e| solver.elements.instance(*e) == from)
        .collect();
    let area: f64 = own.iter().map(|e| solver.elements.all()[*e].area).sum();
    let mut shares = vec![0.0; scene.world.instances().len()];
    let sequence = Sequence::new(3, Purpose::Reference, 0, 0);
    let rays = RAYS / own.len() as u64;
    for (k, element) in own.into_iter().enumerate() {
        let part = solver.elements.all()[element].area / (area * rays as f64);
        for i in 0..rays {
            let mut stream = sequence.at(k as u64 * rays + i);
            let side = 2 * element + behind;
            let Some((mut flight, weight)) = solver.leaving(side, Rgb::grey(part), &mut stream)
            else {
                continue;
            };
            flight.throughput *= weight;
            if let Some((side, flux)) = solver.landing(&setup, &mut flight, &mut stream) {
                shares[solver.elements.instance(side / 2) as usize] += flux[1];
            }
        }
    }
    shares
}

fn assert_factor(found: f64, exact: f64, what: &str) {
    assert!(
        (found - exact).abs() < CLOSE,
        "{what}: {found}, exactly {exact}"
    );
}

/// Between a disc of radius `a` and one of radius `b` on the same axis at
/// distance `h`.
fn discs(a: f64, b: f64, h: f64) -> f64 {
    let x = 1.0 + (h * h + b * b) / (a * a);
    0.5 * (x - (x * x - 4.0 * (b / a).powi(2)).sqrt())
}

/// Between parallel squares of side 1 at distance 1.
fn parallel_squares() -> f64 {
    let root = 2f64.sqrt();
    2.0 / PI * ((4f64 / 3.0).sqrt().ln() + 2.0 * root * (1.0 / root).atan() - PI / 2.0)
}

/// Between squares that share an edge, at a right angle.
fn perpendicular_squares() -> f64 {
    let root = 2f64.sqrt();
    (PI / 2.0 - root * (1.0 / root).atan() + 0.25 * 0.75f64.ln()) / PI
}

/// The form factors that every course begins with (J. Howell, *A Catalog of
/// Radiation Heat Transfer Configuration Factors*: C-11, C-14, C-41, B-12),
/// whatever the number of elements.
#[test]
fn form_factors_are_the_closed_forms() {
    assert!((parallel_squares() - 0.199_825).abs() < 1e-6);
    assert!((perpendicular_squares() - 0.200_044).abs() < 1e-6);
    let floor = grey("Quad(corner: (0, 0, 0), u: (1, 0, 0), v: (0, 1, 0))");
    let ceiling = grey("Quad(corner: (0, 0, 1), u: (0, 1, 0), v: (1, 0, 0))");
    let wall = grey("Quad(corner: (0, 0, 0), u: (0, 1, 0), v: (0, 0, 1))");
    let disc = |z: f64, nz: f64, r: f64| {
        grey(&format!(
            "Disc(center: (0, 0, {z:?}), normal: (0, 0, {nz:?}), radius: {r:?})"
        ))
    };
    for patches in [1, 7] {
        let squares = scene(&format!("{floor}{ceiling}{wall}"));
        let f = form_factors(&squares, patches, 0, 0);
        assert_factor(f[1], parallel_squares(), "parallel squares");
        assert_factor(f[2], perpendicular_squares(), "perpendicular squares");
        assert_eq!(f[0], 0.0, "a square does not see itself");
        let f = form_factors(&squares, patches, 0, 1);
        assert_eq!(f, [0.0; 3], "nothing is below");
        let f = form_factors(
            &scene(&format!("{}{}", disc(0.0, 1.0, 0.8), disc(1.2, -1.0, 1.5))),
            patches,
            0,
            0,
        );
        assert_factor(f[1], discs(0.8, 1.5, 1.2), "coaxial discs");
        // A disc that is small against its distance is a point.
        let f = form_factors(
            &scene(&format!("{}{}", disc(0.0, 1.0, 1e-4), disc(1.2, -1.0, 1.5))),
            patches,
            0,
            0,
        );
        assert_factor(
            f[1],
            1.5 * 1.5 / (1.5 * 1.5 + 1.2 * 1.2),
            "a point and a disc",
        );
    }
}

/// Bodies: a box, a tube, a ball, a mesh; what leaves one side of a closed body
/// stays in it, and A F is the same both ways.
#[test]
fn form_factors_of_bodies() {
    // The box around a small ball: what leaves the ball lands on the box, and
    // the box sees the ball by the ratio of their areas.
    let ball = grey("Sphere(center: (0.2, 0.1, 0.4), radius: 0.3)");
    let case = grey("Box(min: (-1, -1, -1), max: (1, 1, 1))");
    let tube = grey("Cylinder(base: (0, 0, -1), end: (0, 0, 1.5), radius: 1, capped: true)");
    let squashed = grey("Sphere(center: (0, 0, 0), radius: 0.5), at: (scale: (1, 0.6, 0.3))");
    for (outer, area) in [(&case, 24.0), (&tube, 2.0 * PI * (1.0 + 2.5))] {
        let scene = scene(&format!("{ball}{outer}"));
        let from_ball = form_factors(&scene, 9, 0, 0);
        assert_factor(from_ball[1], 1.0, "from the ball");
        assert_eq!(from_ball[0], 0.0, "a ball does not see itself");
        let from_outer = form_factors(&scene, 9, 1, 1);
        let seen = 4.0 * PI * 0.09 / area;
        assert_factor(from_outer[0], seen, "the ball from outside");
        assert_factor(from_outer[1], 1.0 - seen, "the body itself");
    }
    let scene = scene(&format!("{squashed}{case}"));
    let total: f64 = {
        let elements = Elements::new(&scene, 24);
        let own = (0..elements.all().len()).filter(|e| elements.instance(*e) == 0);
        own.map(|e| elements.all()[e].area).sum()
    };
    let from_case = form_factors(&scene, 24, 1, 1)[0];
    assert_factor(from_case, total / 24.0, "a squashed ball from its case");
}

/// Every point of an element is found again in it, over all kinds of parts.
#[test]
fn points_lie_in_their_elements() {
    let scene = scene(
        &[
            "Quad(corner: (3, 0, 0), u: (1, 0.2, 0), v: (0.3, 2, 0.1))",
            "Disc(center: (6, 0, 0), normal: (1, 1, 1), radius: 0.7)",
            "Box(min: (-1, -1, -1), max: (1, 1.5, 1.2))",
            "Cylinder(base: (0, 5, -1), end: (0.3, 5, 1.5), radius: 0.4, capped: true)",
            "Sphere(center: (0, 9, 0), radius: 1), at: (scale: (1, 2, 0.5), rotate: (axis: (0, 1, 1), degrees: 30))",
            "Triangle(a: (0, -5, 0), b: (1, -5, 0.2), c: (0.3, -4, 0.1))",
            "TorusKnot(p: 2, q: 3, center: (-6, 0, 0), scale: 0.5, tube: 0.2, segments: 24, sides: 6)",
        ]
        .map(grey)
        .concat(),
    );
    let elements = Elements::new(&scene, 40);
    assert_eq!(elements.all().len() as u64, count(&scene, 40));
    assert_eq!(obstacle(&scene), None);
    for element in 0..elements.all().len() {
        for u in [[0.01, 0.02], [0.5, 0.5], [0.97, 0.99]] {
            let (point, weight) = elements.point(element, u).expect("a chart");
            assert_eq!(elements.at(&point), Some(element), "{u:?} {point:?}");
            assert!((0.3..3.0).contains(&weight), "{weight}");
        }
    }
}

//! Surfaces of two bodies in one place are one surface between the media on its
//! sides.

use glam::DVec3;
use nephroid::{
    geometry::Ray,
    scene::Scene,
    transport::{Carried, Lobe, Lobes, lobes, media_beside, meet},
};

use crate::{CAMERA, LAMP, around, common::scene_of, dielectric, with_context};

/// Sizes of blocks, and how far they are from the origin.
pub(crate) const PLACES: [(f64, f64); 5] = [
    (1.0, 0.0),
    (1.0, 1e4),
    (1e-3, 7.0),
    (300.0, 0.3),
    (1e5, 1e5),
];

/// Kinds of blocks: whose faces stand along the axes, that are turned, that are
/// round, made of triangles.
pub(crate) const KINDS: [&str; 4] = ["box", "turned", "round", "mesh"];

pub(crate) fn triple(v: DVec3) -> String {
    format!("({:?}, {:?}, {:?})", v.x, v.y, v.z)
}

/// A block of a kind from `low` to `high` along z, otherwise from `-size` to
/// `size` around `at`.
pub(crate) fn block(
    kind: &str,
    [low, high]: [f64; 2],
    size: f64,
    at: DVec3,
    material: &str,
) -> String {
    let min = at + DVec3::new(-size, -size, low);
    let max = at + DVec3::new(size, size, high);
    let cuboid = format!("Box(min: {}, max: {})", triple(min), triple(max));
    match kind {
        "box" => format!("(shape: {cuboid}, material: {material}),"),
        "turned" => format!(
            "(shape: {cuboid}, material: {material},
              at: (rotate: [(axis: (1, 0, 0), degrees: 17), (axis: (0, 0, 1), degrees: 40)])),"
        ),
        "round" => format!(
            "(shape: Cylinder(base: {}, end: {}, radius: {size:?}, capped: true),
              material: {material}),",
            triple(at.with_z(min.z)),
            triple(at.with_z(max.z))
        ),
        _ => {
            let corner = |i: u32| {
                let pick = |axis: u32| if i >> axis & 1 == 0 { min } else { max };
                triple(DVec3::new(pick(0).x, pick(1).y, pick(2).z))
            };
            let corners: Vec<String> = (0..8).map(corner).collect();
            format!(
                "(shape: Mesh(vertices: [{}], triangles: [
                    (0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
                    (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]),
                  material: {material}),",
                corners.join(", ")
            )
        }
    }
}

pub(crate) fn turned(kind: &str, v: DVec3) -> DVec3 {
    if kind != "turned" {
        return v;
    }
    let about = |axis, degrees: f64| glam::DQuat::from_axis_angle(axis, degrees.to_radians());
    about(DVec3::Z, 40.0) * (about(DVec3::X, 17.0) * v)
}

/// The lobes on the way of a ray that is refracted wherever it can be, and where
/// it ends.
fn followed(scene: &Scene, origin: DVec3, dir: DVec3) -> (Vec<(Lobe, f64)>, Ray) {
    with_context(scene, |ctx| {
        let mut ray = Ray::new(origin, dir);
        let mut media = around(ctx, origin);
        let mut steps = Vec::new();
        while let Some(met) = meet(ctx, &ray, f64::INFINITY, &mut media) {
            let found = lobes(&met.material, &met.point, ray.dir, Carried::Flux);
            let (lobe, share) = match found.expect("glass") {
                Lobes::One(lobe) => (lobe, 1.0),
                Lobes::Two(_, lobe) => (lobe, lobe.share),
            };
            media = media_beside(ctx, media, &met.point, lobe.dir);
            ray = met.point.spawn(lobe.dir);
            steps.push((lobe, share));
            assert!(steps.len() < 20, "no end: {steps:?}");
        }
        assert!(media.ranks().is_empty(), "outside in {media:?}");
        (steps, ray)
    })
}

/// What passes a face between indices, unpolarized, by Fresnel's formulas.
fn passes(from: f64, to: f64, sine_in_air: f64) -> f64 {
    let [c1, c2] = [from, to].map(|n| (1.0 - (sine_in_air / n).powi(2)).sqrt());
    let s = (from * c1 - to * c2) / (from * c1 + to * c2);
    let p = (to * c1 - from * c2) / (to * c1 + from * c2);
    1.0 - 0.5 * (s * s + p * p)
}

/// Rays through two blocks on each other, of any kind and any order, priorities
/// the same or not, downward and upward: what passes, and how far it is shifted,
/// is what a slab of two layers does. Of equal glass nothing is seen between.
#[test]
fn stacked_blocks_are_a_slab_of_two_layers() {
    let mut rays = 0;
    for kind in KINDS {
        for (size, shift) in PLACES {
            for [n, m] in [[1.5, 1.5], [1.33, 1.5], [1.7, 1.33]] {
                for order in 0..4 {
                    let at = DVec3::new(0.31, -0.17, 0.23) * shift;
                    let joint = 0.1 * size;
                    let (low, high) = (-0.2 * size, 0.35 * size);
                    let lower = block(kind, [low, joint], size, at, &dielectric(n, order & 1));
                    // A rounding between them, of either sign, is none.
                    let seam = [joint, joint.next_up(), joint.next_down()][order as usize % 3];
                    let upper = block(kind, [seam, high], size, at, &dielectric(m, 0));
                    let text = if order < 2 {
                        lower + &upper
                    } else {
                        upper + &lower
                    };
                    let scene = scene_of(CAMERA, [8, 8], &text, LAMP, "");
                    for (i, angle) in [0.0, 0.2, 0.8, 1.2f64].into_iter().enumerate() {
                        let side = if (i as i32 + order) % 2 == 0 {
                            1.0
                        } else {
                            -1.0
                        };
                        let (s, c) = angle.sin_cos();
                        let dir = turned(kind, DVec3::new(0.6 * s, 0.8 * s, side * c));
                        let mark = DVec3::new(0.013, 0.027, joint / size) * size;
                        let start = turned(kind, at + mark) - dir * (3.0 * size);
                        let (steps, out) = followed(&scene, start, dir);
                        let case =
                            format!("{kind}, {size:e} at {shift:e}, {n} on {m}, {order}, {angle}");
                        let bent = steps.iter().filter(|(lobe, _)| lobe.is_bent());
                        assert_eq!(bent.count(), if n == m { 2 } else { 3 }, "{case}");
                        let share: f64 = steps.iter().map(|(_, share)| share).product();
                        let expected = passes(1.0, n, s) * passes(n, m, s) * passes(m, 1.0, s);
                        assert!(
                            (share - expected).abs() < 1e-11,
                            "{case}: {share}, {expected}"
                        );
                        assert!(out.dir.distance(dir) < 1e-12, "{case}: {:?}", out.dir);
                        let layer = |h: f64, n: f64| h * s * (1.0 - c / (n * n - s * s).sqrt());
                        let expected = layer(joint - low, n) + layer(high - joint, m);
                        let found = (out.origin - start).cross(dir).length();
                        let off = 1e-13 * (size + shift);
                        assert!(
                            (found - expected).abs() < off,
                            "{case}: {found}, {expected}"
                        );
                        rays += 1;
                    }
                }
            }
        }
    }
    assert_eq!(rays, 4 * 5 * 3 * 4 * 4);
}

/// What lies apart is apart: a slit of a thousand roundings between blocks of the
/// same glass is seen.
#[test]
fn a_slit_is_no_joint() {
    let (size, at) = (1.0, DVec3::ZERO);
    let slit = 1000.0 * f64::EPSILON;
    for kind in KINDS {
        let lower = block(kind, [-0.5, 0.0], size, at, &dielectric(1.5, 0));
        let upper = block(kind, [slit, 0.5], size, at, &dielectric(1.5, 0));
        let scene = scene_of(CAMERA, [8, 8], &(lower + &upper), LAMP, "");
        let dir = turned(kind, DVec3::new(0.3, 0.2, -0.9).normalize());
        let (steps, _) = followed(&scene, dir * -3.0, dir);
        assert_eq!(steps.len(), 4, "{kind}");
    }
}

/// A liquid that fills the hollow of its glass exactly: five faces of it touch
/// the glass, one is free.
#[test]
fn a_liquid_may_fill_its_glass_exactly() {
    for (size, shift) in PLACES {
        let at = DVec3::new(0.31, -0.17, 0.23) * shift;
        let corner = |x: f64, z: f64| triple(at + DVec3::new(x, x, z) * size);
        let boxed = |low: [f64; 2], high: [f64; 2]| {
            format!(
                "Box(min: {}, max: {})",
                corner(low[0], low[1]),
                corner(high[0], high[1])
            )
        };
        let hollow = boxed([-0.8, -0.5], [0.8, 2.0]);
        let glass = format!(
            "(shape: Difference(of: [(shape: {}), (shape: {hollow})]), material: {}),",
            boxed([-1.0, -0.7], [1.0, 0.9]),
            dielectric(1.5, 0)
        );
        let liquid = format!(
            "(shape: {}, material: {}),",
            boxed([-0.8, -0.5], [0.8, 0.4]),
            dielectric(1.33, 0)
        );
        for text in [glass.clone() + &liquid, liquid.clone() + &glass] {
            let scene = scene_of(CAMERA, [8, 8], &text, LAMP, "");
            // Down through the liquid and the floor; across through both walls.
            for (start, dir, layers) in [
                (
                    DVec3::new(0.1, 0.2, 3.0),
                    DVec3::NEG_Z,
                    [(1.0, 1.33), (1.33, 1.5), (1.5, 1.0)].as_slice(),
                ),
                (
                    DVec3::new(-3.0, 0.2, 0.1),
                    DVec3::X,
                    &[(1.0, 1.5), (1.5, 1.33), (1.33, 1.5), (1.5, 1.0)],
                ),
            ] {
                let (steps, _) = followed(&scene, at + start * size, dir);
                assert_eq!(steps.len(), layers.len(), "{size:e} at {shift:e}");
                for ((_, share), &(from, to)) in steps.iter().zip(layers) {
                    let expected = passes(from, to, 0.0);
                    assert!((share - expected).abs() < 1e-12, "{share}, {expected}");
                }
            }
        }
    }
}

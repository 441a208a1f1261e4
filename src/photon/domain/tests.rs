//! The cells around starts against differences of the map, and against the
//! densities.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::*;
use crate::{
    light::{DiscLight, PointLight, QuadLight, SphereLight},
    sampling::{Purpose, Sequence},
};

/// Lights of all kinds, near the origin.
fn lights() -> Vec<(&'static str, Light)> {
    let axis = DVec3::new(0.3, -0.5, -0.8).normalize();
    let sun = |diameter| Light::Sun(Sun::new(axis, diameter, Rgb::WHITE));
    vec![
        (
            "point",
            Light::Point(PointLight {
                position: DVec3::new(0.1, 0.2, 0.3),
                intensity: Rgb::WHITE,
            }),
        ),
        (
            "spot",
            Light::Spot(SpotLight::new(
                DVec3::new(0.1, 0.2, 0.3),
                axis,
                20.0,
                60.0,
                Rgb::WHITE,
            )),
        ),
        (
            "sphere",
            Light::Sphere(SphereLight {
                center: DVec3::new(-0.2, 0.1, 0.4),
                radius: 0.4,
                radiance: Rgb::WHITE,
            }),
        ),
        (
            "quad",
            Light::Quad(QuadLight {
                corner: DVec3::new(-0.4, 0.1, 0.2),
                u: DVec3::new(0.7, 0.1, -0.2),
                v: DVec3::new(0.3, -0.8, 0.1),
                radiance: Rgb::WHITE,
            }),
        ),
        (
            "disc",
            Light::Disc(DiscLight {
                center: DVec3::new(0.1, 0.0, 0.2),
                normal: axis,
                radius: 0.5,
                radiance: Rgb::WHITE,
            }),
        ),
        (
            "beam",
            Light::Beam(Beam {
                center: DVec3::new(0.1, 0.0, 0.2),
                axis,
                radius: 1.5,
                irradiance: Rgb::WHITE,
            }),
        ),
        ("sun", sun(0.5)),
        ("wide sun", sun(70.0)),
        ("parallel sun", sun(0.0)),
    ]
}

/// All of the domain, a ball near by, a small one far away.
fn targets() -> [Target; 3] {
    let ball = |center, radius| Target::Sphere(BoundingSphere { center, radius });
    [
        Target::Whole,
        ball(DVec3::new(0.6, -0.9, -1.6), 0.9),
        ball(DVec3::new(-20.0, 30.0, -40.0), 0.5),
    ]
}

/// The scene's bounds, from outside of which the sun shines.
const ALL: BoundingSphere = BoundingSphere {
    center: DVec3::new(0.3, 0.2, 0.1),
    radius: 4.0,
};

fn start(light: &Light, target: Target, u: [f64; 4]) -> Start {
    let mut start = draw(light, target, [u[0], u[1]], [u[2], u[3]]);
    if let Light::Sun(_) = light {
        start.move_before(&ALL);
    }
    start
}

/// Calls `check` for every light, target and a number of samples away from
/// the folds and the borders of the maps.
fn for_all(mut check: impl FnMut(&str, &Light, Target, [f64; 4], &Start)) {
    let sequence = Sequence::new(3, Purpose::Pilot, 0, 0);
    for (name, light) in lights() {
        for target in targets() {
            // Nothing bounds the sun.
            if matches!((&light, target), (Light::Sun(_), Target::Whole)) {
                continue;
            }
            let mut checked = 0;
            for i in 0..300 {
                let mut s = sequence.at(i);
                let ([a, b], [c, d]) = (s.next_2d(), s.next_2d());
                let smooth = |u: [f64; 2]| {
                    let [x, y] = u.map(|x| (2.0 * x - 1.0).abs());
                    (x - y).abs() > 0.01 && x.max(y) < 0.95
                };
                if !(smooth([a, b]) && smooth([c, d])) {
                    continue;
                }
                let u = [a, b, c, d];
                let start = start(&light, target, u);
                // The frame around an axis folds at z = 0.
                if start.normal.z.abs() < 0.02 || start.dir.z.abs() < 0.02 {
                    continue;
                }
                checked += 1;
                check(name, &light, target, u, &start);
            }
            assert!(checked > 50, "{name}, {target:?}: {checked} samples");
        }
    }
}

/// The sides of a cell are derivatives along two steps in the square whose
/// parallelogram has area 1: what one of origin and direction says about the
/// steps holds for the other. What is drawn from something round has equal and
/// perpendicular sides.
///
/// Central differences of step 1e-5, whose error is of the order of 1e-10
/// times the third derivative, which is below 1e5 times the first.
#[test]
fn cells_follow_the_map() {
    const H: f64 = 1e-5;
    for_all(|name, light, target, u, at| {
        for (k, pair) in at.differential.pairs().iter().enumerate() {
            let by = [0, 1].map(|j| {
                let moved = |h: f64| {
                    let mut v = u;
                    v[2 * k + j] += h;
                    start(light, target, v)
                };
                let (a, b) = (moved(H), moved(-H));
                [a.origin - b.origin, a.dir - b.dir].map(|v| v / (2.0 * H))
            });
            let origins = VectorPair::from(by.map(|b| b[0]));
            let dirs = VectorPair::from(by.map(|b| b[1]));
            let in_sun = k == 1 && matches!(light, Light::Sun(_));
            let ([a, b], [s, t]) = if in_sun || pair.dp == VectorPair::ZERO {
                (dirs.to_array(), pair.dd.to_array())
            } else {
                (origins.to_array(), pair.dp.to_array())
            };
            let area = a.cross(b);
            let coordinates = |v: DVec3| {
                DVec2::new(v.cross(b).dot(area), a.cross(v).dot(area)) / area.length_squared()
            };
            let steps = [s, t].map(coordinates);
            let what = format!("{name}, {target:?}, {u:?}, pair {k}");
            assert!(
                (steps[0].perp_dot(steps[1]).abs() - 1.0).abs() < 1e-5,
                "{what}: {steps:?}"
            );
            // Rounding of the difference: a hundred units at most.
            let floor = 1e-14 * (1.0 + at.origin.length()) / H;
            for (got, by) in [(pair.dp, origins), (pair.dd, dirs)] {
                let (got, [a, b]) = (got.to_array(), by.to_array());
                for (got, step) in got.iter().zip(steps) {
                    let expected = a * step.x + b * step.y;
                    let size = a.length() * step.x.abs() + b.length() * step.y.abs();
                    assert!(
                        (*got - expected).length() <= 1e-5 * size + floor * step.length(),
                        "{what}: {got} is not {expected}"
                    );
                }
            }
            let edges = matches!(light, Light::Quad(_)) && k == 1;
            if edges {
                assert!(
                    (steps[0] - DVec2::X).length() < 1e-5 && (steps[1] - DVec2::Y).length() < 1e-5,
                    "{what}: {steps:?}"
                );
            } else {
                let (n, m) = (s.length(), t.length());
                assert!(
                    (n / m - 1.0).abs() < 1e-9 && s.dot(t).abs() < 1e-9 * n * m,
                    "{what}: {s}, {t}"
                );
            }
            for dd in pair.dd.to_array() {
                assert!(
                    dd.dot(at.dir).abs() <= 1e-12 * (1.0 + dd.length()),
                    "{name}: a unit vector turns about itself"
                );
            }
        }
    });
}

/// A cell that is moved along a side by as much as there is room stays in what
/// the light covers: the start of the emission is as close to the map's rim as
/// the coordinates of its sample tell.
#[test]
fn room_ends_at_the_rim() {
    for_all(|name, light, target, u, at| {
        for (k, room) in at.differential.room().iter().enumerate() {
            let [a, b] = [u[2 * k], u[2 * k + 1]];
            let expected = if matches!(light, Light::Quad(_)) && k == 1 {
                DVec2::new(a.min(1.0 - a), b.min(1.0 - b))
            } else {
                let r = (2.0 * a - 1.0).abs().max((2.0 * b - 1.0).abs());
                // A disc of area 1, and half its chord.
                DVec2::new(1.0 - r, (1.0 - r * r).sqrt()) / PI.sqrt()
            };
            // Under Lambert's law cells grow towards the horizon.
            let lambert = k == 0
                && matches!(target, Target::Whole)
                && matches!(light, Light::Sphere(_) | Light::Quad(_) | Light::Disc(_));
            if lambert {
                let z = at.dir.dot(at.normal);
                let off = (*room - DVec2::new(z, 1.0) * (z / PI).sqrt()).length();
                assert!(off < 1e-9, "{name}, {u:?}: {room}");
            } else {
                let off = (*room - expected).length();
                assert!(off < 1e-12, "{name}, {target:?}, {u:?}: {room}, {expected}");
            }
        }
    });
}

/// The unit cube's image has the volume one over the density: the pairs'
/// determinants multiply to it, for the first pair does not move the point
/// (or, for parallel light, the direction).
#[test]
fn determinants_are_inverse_densities() {
    for_all(|name, light, target, u, at| {
        let det = |v: VectorPair| {
            let [a, b] = v.to_array();
            a.cross(b).length()
        };
        let pairs = at.differential.pairs();
        let volume = match light {
            Light::Point(_) | Light::Spot(_) => det(pairs[0].dd),
            Light::Sphere(_) | Light::Quad(_) | Light::Disc(_) => {
                det(pairs[0].dd) * det(pairs[1].dp)
            }
            Light::Beam(_) => det(pairs[0].dp),
            Light::Sun(l) => {
                if let Some(pair) = pairs.get(1) {
                    let cone = TAU * warp::one_minus_cos(l.sin_half);
                    assert!((det(pair.dd) / cone - 1.0).abs() < 1e-8, "{name}: its cone");
                }
                det(pairs[0].dp)
            }
        };
        assert!(
            (volume * at.own_density - 1.0).abs() < 1e-8,
            "{name}, {target:?}, {u:?}: volume {volume}, density {}",
            at.own_density
        );
    });
}

/// A start lies in the part from which it was drawn, but for those on the
/// very rim.
#[test]
fn a_part_contains_its_own_starts() {
    for_all(|name, light, target, u, start| {
        let beam_missed = matches!(light, Light::Beam(_)) && start.emission.is_black();
        assert!(
            contains(light, target, start) || beam_missed,
            "{name}, {target:?}, {u:?}"
        );
    });
}

//! The derivatives of starts against differences of the map, and against the
//! densities.

use std::f64::consts::TAU;

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

/// Central differences of step 1e-5, whose error is of the order of 1e-10
/// times the third derivative, which is below 1e5 times the first.
#[test]
fn differentials_are_derivatives() {
    const H: f64 = 1e-5;
    for_all(|name, light, target, u, at| {
        for (k, pair) in at.differential.pairs().iter().enumerate() {
            let (by_p, by_d) = (pair.dp.to_array(), pair.dd.to_array());
            for j in 0..2 {
                let moved = |h: f64| {
                    let mut v = u;
                    v[2 * k + j] += h;
                    start(light, target, v)
                };
                let (a, b) = (moved(H), moved(-H));
                let dp = (a.origin - b.origin) / (2.0 * H);
                let dd = (a.dir - b.dir) / (2.0 * H);
                // Rounding of the difference: a hundred units at most.
                let floor = 1e-14 * (1.0 + at.origin.length()) / H;
                for (got, expected) in [(by_p[j], dp), (by_d[j], dd)] {
                    let off = (got - expected).length();
                    assert!(
                        off <= 1e-5 * expected.length() + floor,
                        "{name}, {target:?}, {u:?}, {k}.{j}: {got} is not {expected}"
                    );
                }
                assert!(
                    by_d[j].dot(at.dir).abs() <= 1e-12 * (1.0 + by_d[j].length()),
                    "{name}: a unit vector turns about itself"
                );
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

mod fold;
mod vicinity;

use std::f64::consts::{FRAC_2_PI, PI};

use glam::Vec3;

use super::{
    normal::{decode, encode},
    *,
};
use crate::{
    photon::Footprint,
    sampling::{Purpose, Sequence, Stream, warp},
};

fn numbers(item: u64) -> impl Fn(u64) -> Stream {
    let sequence = Sequence::new(5, Purpose::Pilot, 0, item);
    move |i| sequence.at(i)
}

const KERNELS: Kernels = Kernels {
    least: 0.0,
    most: 1e3,
    most_bounced: 1e3,
    blind: 0.0,
    caustics: true,
    spacing: 0.0,
};

fn query(p: DVec3, n: DVec3, blind: f64) -> Query {
    let kernels = Kernels { blind, ..KERNELS };
    Query { p, n, kernels }
}

fn ask(map: &PhotonMap, q: &Query) -> Gathered {
    map.irradiance(q, |_, _| [1.0; 3])
}

/// Photons on the square `[-half, half]^2` of a floor.
fn floor_photons(
    count: u64,
    half: f64,
    mut shape: impl FnMut(&mut Stream) -> (f64, Option<Footprint>),
) -> Vec<Photon> {
    let at = numbers(0);
    (0..count)
        .map(|i| {
            let mut s = at(i);
            let [a, b] = s.next_2d();
            let (z, footprint) = shape(&mut s);
            Photon {
                position: DVec3::new((2.0 * a - 1.0) * half, (2.0 * b - 1.0) * half, z),
                normal: DVec3::Z,
                flux: Rgb::new(1.0, 0.5, 0.25),
                footprint,
                bounced: false,
                sheet: 0.0,
            }
        })
        .collect()
}

fn turned(angle: f64, major: f64, minor: f64) -> Footprint {
    let (sin, cos) = crate::numeric::trig::sin_cos(angle);
    Footprint {
        major: DVec3::new(cos, sin, 0.0) * major,
        minor,
        fold: f64::INFINITY,
    }
}

#[test]
fn normals_survive_their_code() {
    let at = numbers(1);
    for i in 0..2000 {
        let n = warp::sphere(at(i).next_2d()).as_vec3();
        assert!(decode(encode(n)).distance(n) < 1e-4, "{n}");
    }
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for n in [axis, -axis] {
            assert!(decode(encode(n)).distance(n) < 1e-4, "{n}");
        }
    }
}

/// Ellipses of all sizes up to a hundred times longer than wide, and photons
/// without a footprint, against a loop over all of them: each is found once.
#[test]
fn agrees_with_brute_force() {
    let mut photons = floor_photons(20_000, 1.0, |s| {
        let kind = s.next_1d();
        let major = 0.003 * 100f64.powf(s.next_1d());
        let minor = major * 100f64.powf(-s.next_1d());
        let mut footprint = turned(2.0 * PI * s.next_1d(), major, minor);
        if s.next_1d() < 0.5 {
            footprint.fold = 1e-4 + 0.02 * s.next_1d() * s.next_1d();
        }
        (0.0, (kind < 0.9).then_some(footprint))
    });
    for (i, p) in photons.iter_mut().enumerate() {
        p.bounced = i % 5 == 0;
        p.sheet = if p.bounced { 0.0 } else { (i % 3) as f64 };
    }
    let map = PhotonMap::new(&photons, 1000, 0.5);
    let at = numbers(2);
    for i in 0..300 {
        let mut s = at(i);
        let p = DVec3::new(2.0 * s.next_1d() - 1.0, 2.0 * s.next_1d() - 1.0, 0.0);
        let q = Query {
            kernels: Kernels {
                least: 0.01 * s.next_1d(),
                most: 0.03 + 0.1 * s.next_1d(),
                most_bounced: 0.03 + 0.2 * s.next_1d(),
                blind: 0.01 + 0.04 * s.next_1d(),
                caustics: i % 3 != 0,
                ..KERNELS
            },
            ..query(p, DVec3::Z, 0.0)
        };
        let mut expected = [0.0; 2];
        let mut sheets = 0.0;
        let mut reached = 0;
        for ph in &photons {
            if !(ph.bounced || q.kernels.caustics) {
                continue;
            }
            let most = if ph.bounced {
                q.kernels.most_bounced
            } else {
                q.kernels.most
            };
            let o = p - ph.position;
            let (along, across, a, b, fold) = match ph.footprint {
                Some(f) => {
                    let axis = f.major.normalize();
                    let size = |x: f64| x.clamp(q.kernels.least, most);
                    let a = size(0.5 * f.major.length());
                    let b = size((0.5 * f.minor).min(f.fold));
                    (o.dot(axis), o.dot(DVec3::Z.cross(axis)), a, b, f.fold)
                }
                None => {
                    let r = q.kernels.blind;
                    (o.x, o.y, r, r, f64::INFINITY)
                }
            };
            // Beyond a fold is nothing, and before it what would be beyond.
            let height = |across: f64| 1.0 - (along / a).powi(2) - (across / b).powi(2);
            let t = height(across);
            if t > 0.0 && (b <= fold || across >= -fold) {
                let image = if b > fold {
                    height(across + 2.0 * fold)
                } else {
                    0.0
                };
                let sum = t + image.max(0.0);
                let density = FRAC_2_PI * sum / (a * b) / 1000.0;
                expected[usize::from(ph.bounced)] += density;
                sheets += density * ph.sheet;
                reached += 1;
            }
        }
        let got = ask(&map, &q);
        for (e, g) in expected.into_iter().zip([got.irradiance, got.bounced]) {
            assert!(
                (g[0] - e).abs() <= 1e-3 * e.max(1.0),
                "query {i}: {} against {e}",
                g[0]
            );
            assert!((g[1] - 0.5 * g[0]).abs() <= 1e-9 * e, "colours");
            assert!((g[2] - 0.25 * g[0]).abs() <= 1e-9 * e, "colours");
        }
        assert!(
            (got.sheets - sheets).abs() <= 1e-3 * sheets.max(1.0),
            "query {i}: {} sheets against {sheets}",
            got.sheets
        );
        // Up to rounding at the rims.
        assert!(
            got.accepted.abs_diff(reached) <= 2,
            "{} of {reached}",
            got.accepted
        );
    }
}

/// Long ellipses in spans: a query looks at few that do not reach it.
#[test]
fn few_candidates_for_each_kernel() {
    for aspect in [1.0, 3.0, 10.0, 30.0] {
        let photons = floor_photons(1 << 15, 1.0, |s| {
            let minor = 0.01;
            (
                0.0,
                Some(turned(2.0 * PI * s.next_1d(), aspect * minor, minor)),
            )
        });
        let map = PhotonMap::new(&photons, 1 << 15, 1.0);
        let at = numbers(3);
        let (mut visited, mut accepted) = (0.0, 0.0);
        for i in 0..500 {
            let [a, b] = at(i).next_2d();
            let found = ask(
                &map,
                &query(DVec3::new(a - 0.5, b - 0.5, 0.0), DVec3::Z, 0.0),
            );
            visited += f64::from(found.visited);
            accepted += f64::from(found.accepted);
        }
        let each = visited / accepted;
        assert!(each < 4.0, "{each} candidates a kernel at aspect {aspect}");
    }
}

/// Uniform light on a plane: the mean estimate is flux over area for every
/// kernel size, away from the edges.
#[test]
fn uniform_light_on_a_plane() {
    for r in [0.02, 0.1, 0.4] {
        let n = 1u64 << 16;
        let map = PhotonMap::new(
            &floor_photons(n, 1.0, |s| (0.0, Some(turned(s.next_1d(), r, 0.5 * r)))),
            n,
            1.0,
        );
        let at = numbers(4);
        let queries = 400;
        let mean: f64 = (0..queries)
            .map(|i| {
                let [a, b] = at(i).next_2d();
                let p = DVec3::new(a - 0.5, b - 0.5, 0.0);
                ask(&map, &query(p, DVec3::Z, 0.0)).irradiance[0]
            })
            .sum::<f64>()
            / queries as f64;
        // One watt a photon, one path each: 1 W over 4 m2. The bound is three
        // standard errors of independent photons; low-discrepancy ones do
        // better.
        let se = 0.25 * (4.0 / (3.0 * n as f64 * 0.25 * PI * 0.5 * r * r)).sqrt()
            / (queries as f64).sqrt().min(0.5 / r);
        assert!((mean - 0.25).abs() < 3.0 * se, "size {r}: {mean}, se {se}");
    }
}

#[test]
fn the_other_side_and_other_faces_get_nothing() {
    let map = PhotonMap::new(&floor_photons(10_000, 1.0, |_| (0.0, None)), 10_000, 1.0);
    let light = |p, n| ask(&map, &query(p, n, 0.1)).irradiance;
    assert!(light(DVec3::ZERO, DVec3::Z)[0] > 0.0);
    assert!(light(DVec3::ZERO, DVec3::NEG_Z).is_black(), "back side");
    assert!(
        light(DVec3::ZERO, DVec3::X).is_black(),
        "a wall on the floor"
    );
    let above = DVec3::new(0.0, 0.0, 0.03);
    assert!(light(above, DVec3::Z).is_black(), "a shelf above");
}

/// On a sphere the kernels of neighbours count whatever the curvature lifts
/// them off the tangent plane.
#[test]
fn curved_receivers_keep_their_photons() {
    let n = 40_000;
    let at = numbers(6);
    let photons: Vec<Photon> = (0..n)
        .map(|i| {
            let normal = warp::sphere(at(i).next_2d());
            Photon {
                position: normal,
                normal,
                flux: Rgb::WHITE,
                footprint: None,
                bounced: false,
                sheet: 0.0,
            }
        })
        .collect();
    let map = PhotonMap::new(&photons, n, 1.0);
    for r in [0.05, 0.2, 0.5] {
        let mut mean = 0.0;
        for i in 0..100 {
            let p = warp::sphere(numbers(7)(i).next_2d());
            mean += ask(&map, &query(p, p, r)).irradiance[0] / 100.0;
        }
        let expected = 1.0 / (4.0 * PI);
        // The chord is shorter than the arc: exact to second order in r.
        let tolerance = 0.02 + 0.5 * r * r;
        assert!(
            (mean / expected - 1.0).abs() < tolerance,
            "{r}: {}",
            mean / expected
        );
    }
}

/// A few photons at the far end of an unbounded plane leave the others where
/// they are.
#[test]
fn far_photons_do_not_blur_near_ones() {
    let mut photons = floor_photons(20_000, 1.0, |_| (0.0, None));
    let near = PhotonMap::new(&photons, 20_000, 1.0);
    for (i, far) in [1e6, -3e7, 1e9].into_iter().enumerate() {
        photons[1000 * (i + 1)].position.x = far;
    }
    let all = PhotonMap::new(&photons, 20_000, 1.0);
    let at = numbers(8);
    for i in 0..100 {
        let [a, b] = at(i).next_2d();
        let q = query(
            DVec3::new(1.6 * a - 0.8, 1.6 * b - 0.8, 0.0),
            DVec3::Z,
            0.05,
        );
        // At most three of the photons in reach were taken away.
        let one = FRAC_2_PI / (0.05 * 0.05) / 20_000.0;
        let [near, all] = [&near, &all].map(|m| ask(m, &q).irradiance[0]);
        assert!(
            (-1e-4..=3.0 * one).contains(&(near - all)),
            "{near} became {all}"
        );
    }
}

#[test]
fn degenerate_sets() {
    let one = |p: DVec3| Photon {
        position: p,
        normal: DVec3::Z,
        flux: Rgb::WHITE,
        footprint: None,
        bounced: false,
        sheet: 0.0,
    };
    let at_origin = |map: &PhotonMap, q: &Query| ask(map, q).irradiance;
    let simple = query(DVec3::ZERO, DVec3::Z, 1.0);
    assert!(at_origin(&PhotonMap::new(&[], 10, 1.0), &simple).is_black());

    let same = vec![one(DVec3::splat(3.0)); 5000];
    let map = PhotonMap::new(&same, 5000, 1.0);
    let found = ask(&map, &query(DVec3::splat(3.0), DVec3::Z, 0.5)).irradiance[0];
    assert!(
        // Kernels are worked out in single precision.
        (found - FRAC_2_PI / 0.25).abs() < 1e-6,
        "5000 coincident photons: {found}"
    );

    let bad = [
        one(DVec3::ZERO),
        one(DVec3::new(f64::NAN, 0.0, 0.0)),
        one(DVec3::splat(f64::INFINITY)),
    ];
    let map = PhotonMap::new(&bad, 3, 1.0);
    assert_eq!((map.len(), map.refused()), (1, 2));
    for broken in [
        Query {
            kernels: Kernels {
                blind: f64::NAN,
                ..simple.kernels
            },
            ..simple
        },
        Query {
            kernels: Kernels {
                least: f64::NAN,
                ..simple.kernels
            },
            ..simple
        },
        Query {
            p: DVec3::NAN,
            ..simple
        },
    ] {
        assert!(at_origin(&map, &broken).is_black());
    }

    // A line of light: an ellipse of no width is widened to what is asked for.
    let line = Photon {
        footprint: Some(turned(0.0, 0.5, 0.0)),
        ..one(DVec3::ZERO)
    };
    let map = PhotonMap::new(&[line], 1, 1.0);
    let thin = Query {
        kernels: Kernels {
            least: 0.01,
            ..simple.kernels
        },
        ..simple
    };
    let middle = at_origin(&map, &thin)[0];
    assert!(
        (middle / (FRAC_2_PI / (0.5 * 0.01)) - 1.0).abs() < 1e-6,
        "{middle}"
    );
}

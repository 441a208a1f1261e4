//! Chi-square tests of streams, warps, tables and the choice of lobes.
//!
//! Streams of different items are independent of each other (points of one
//! low-discrepancy sequence are not, and would pass too easily), so counts
//! follow Pearson's law.

mod common;

use std::{cell::Cell, f64::consts::TAU};

use common::{
    assert_close,
    cells::{DRAWS, Grid, assert_follows, assert_uniform, height, turn},
    independent,
};
use glam::DVec3;
use nephroid::{
    geometry::{SurfaceId, SurfacePoint},
    material::Material,
    sampling::{Discrete, Purpose, Sequence, warp},
    spectrum::Rgb,
    transport::{Carried, Lobes, lobes},
};

#[test]
fn streams_are_uniform() {
    for index in [0, 1, 12_345, (1 << 32) + 7] {
        for d in [0, 1, 4, 23, 62, 63, 64, 100] {
            let points = (0..DRAWS).map(|item| {
                let mut s = Sequence::new(11, Purpose::Photon, 3, item).at(index);
                s.seek(d);
                s.next_2d()
            });
            assert_uniform(
                points,
                &format!("index {index}, dimensions {d} and {}", d + 1),
            );
        }
    }
    let own_order = |item| {
        let sequence = Sequence::new(11, Purpose::Camera, 3, item);
        sequence.at_own_order(77).next_2d()
    };
    assert_uniform((0..DRAWS).map(own_order), "own order");
    // Neighbouring items and replicates see nothing of each other.
    let neighbours = |i: u64| {
        let a = Sequence::new(11, Purpose::Camera, 3, i).at(5).next_1d();
        let b = Sequence::new(11, Purpose::Camera, 3, i + 1).at(5).next_1d();
        [a, b]
    };
    assert_uniform((0..DRAWS).map(|i| neighbours(2 * i)), "neighbouring items");
    let replicates = |i: u64| {
        let a = Sequence::new(11, Purpose::Camera, 3, i).at(5).next_1d();
        let b = Sequence::new(11, Purpose::Camera, 4, i).at(5).next_1d();
        [a, b]
    };
    assert_uniform((0..DRAWS).map(replicates), "neighbouring replicates");
}

#[test]
fn warps_follow_their_densities() {
    let u = |i| independent(21, i).next_2d();
    let disc = |i| {
        let p = warp::disc(u(i));
        [p.length_squared(), turn(p.x, p.y)]
    };
    assert_uniform((0..DRAWS).map(disc), "disc");
    // Density cos / pi: the squared sine is uniform.
    let hemisphere = |i| {
        let d = warp::cosine_hemisphere(u(i));
        assert!(d.z >= 0.0 && (d.length() - 1.0).abs() < 1e-15);
        [d.x * d.x + d.y * d.y, turn(d.x, d.y)]
    };
    assert_uniform((0..DRAWS).map(hemisphere), "cosine hemisphere");
    let sphere = |i| {
        let d = warp::sphere(u(i));
        assert!((d.length() - 1.0).abs() < 1e-15);
        [0.5 * (d.z + 1.0), turn(d.x, d.y)]
    };
    assert_uniform((0..DRAWS).map(sphere), "sphere");
    for q in [2.0, 1.5, 1.0, 0.3, 1e-3, 1e-9, 1e-16, 1e-30] {
        let cone = |i| {
            let d = warp::cone(u(i), q);
            [height(d) / q, turn(d.x, d.y)]
        };
        assert_uniform((0..DRAWS).map(cone), &format!("cone of 1 - cos = {q:e}"));
    }
}

/// Each density integrates to one over its domain.
#[test]
fn densities_are_normalised() {
    let n = 1000;
    let cosine: f64 = (0..n)
        .map(|i| {
            warp::cosine_hemisphere_pdf((f64::from(i) + 0.5) / f64::from(n)) * TAU / f64::from(n)
        })
        .sum();
    assert_close(cosine, 1.0, 1e-12, "cosine hemisphere");
    for q in [2.0, 0.3, 1e-12] {
        // The cone's solid angle is 2 pi (1 - cos).
        assert_close(warp::cone_pdf(q) * TAU * q, 1.0, 1e-15, "cone");
    }
    assert_eq!(warp::cosine_hemisphere_pdf(-0.5), 0.0);
}

#[test]
fn tables_follow_their_weights() {
    let weights = [0.3, 0.0, 5.0, 1.0, 1e-3, 2.0, 0.0];
    let table = Discrete::new(&weights).expect("positive weights");
    let mut counts = [0; 7];
    let mut rest = Grid::<16>::new();
    for i in 0..DRAWS {
        let mut s = independent(31, i);
        let (k, u) = table.sample(s.next_1d());
        counts[k] += 1;
        rest.0[Grid::<16>::cell([u, s.next_1d()])] += 1;
    }
    assert_follows(&counts, &weights, "table");
    assert_follows(&rest.0, &[1.0; 256], "what is left of the number");
    for (i, w) in weights.iter().enumerate() {
        assert!((table.probability(i) - w / 8.301).abs() < 1e-15);
    }
}

/// Specular steps choose by Fresnel's shares.
#[test]
fn lobes_are_chosen_by_fresnel() {
    let point = SurfacePoint {
        p: DVec3::ZERO,
        error: 0.0,
        ng: DVec3::Z,
        ns: DVec3::Z,
        surface: SurfaceId {
            instance: 0,
            part: 0,
        },
    };
    let tests = Cell::new(0u64);
    for (ior, thin) in [(1.5, false), (2.4, false), (1.5, true)] {
        for degrees in [3.0f64, 30.0, 56.3, 75.0, 88.0] {
            for side in [1.0, -1.0] {
                let (s, c) = degrees.to_radians().sin_cos();
                let d = DVec3::new(s, 0.0, -side * c);
                let ratio = if side > 0.0 || thin { ior } else { 1.0 / ior };
                let found = lobes(
                    &Material::Dielectric {
                        ior,
                        thin,
                        priority: None,
                    },
                    &point,
                    d,
                    Carried::Flux,
                )
                .expect("a specular surface");
                if s > ratio {
                    assert!(
                        matches!(found, Lobes::One(l) if l.is_bent() && l.weight == Rgb::WHITE)
                    );
                    continue;
                }
                let (i, t) = (degrees.to_radians(), (s / ratio).asin());
                let rs = ((i - t).sin() / (i + t).sin()).powi(2);
                let rp = ((i - t).tan() / (i + t).tan()).powi(2);
                let r = 0.5 * (rs + rp);
                let r = if thin { 2.0 * r / (1.0 + r) } else { r };
                tests.set(tests.get() + 1);
                let reflected = (0..DRAWS)
                    .filter(|&k| {
                        let u = independent(90 + tests.get(), k).next_1d();
                        found.choose(|| u).dir.z * side > 0.0
                    })
                    .count() as u64;
                assert_follows(
                    &[reflected, DRAWS - reflected],
                    &[r, 1.0 - r],
                    &format!("index {ior}, {degrees} degrees"),
                );
            }
        }
    }
    assert!(tests.get() > 20);
}

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::*;
use crate::{
    geometry::{SurfaceId, SurfacePoint},
    plan::Media,
    sampling::{Purpose, Sequence},
    spectrum::Rgb,
};

fn ball(x: f64, y: f64, z: f64, radius: f64) -> BoundingSphere {
    BoundingSphere {
        center: DVec3::new(x, y, z),
        radius,
    }
}

/// A point of a surface with this normal.
fn point(p: DVec3, n: DVec3) -> DiffusePoint {
    let n = n.normalize();
    let surface = SurfaceId {
        instance: 0,
        part: 0,
    };
    let point = SurfacePoint {
        p,
        error: 0.0,
        ng: n,
        ns: n,
        surface,
    };
    DiffusePoint::new(point, -n, Rgb::WHITE, Media::NONE)
}

fn bounces(targets: &[BoundingSphere]) -> Bounces {
    Bounces {
        targets: targets.to_vec(),
    }
}

/// Mean of `f` over the bounces from a point, and its variance.
fn mean_of(bounces: &Bounces, at: &DiffusePoint, f: impl Fn(DVec3) -> f64) -> [f64; 2] {
    let sequence = Sequence::new(4, Purpose::Pilot, 0, 0);
    let n = 1 << 14;
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..n {
        let u = sequence.at(i).next_2d();
        let x = bounces
            .direction(at, u)
            .map_or(0.0, |b| b.weight * f(b.dir));
        sum += x;
        squares += x * x;
    }
    let mean = sum / n as f64;
    [mean, squares / n as f64 - mean * mean]
}

/// All around, as a ball that is seen wholly or in part, two balls one before
/// the other, one that is nearly touched, one under the horizon.
#[test]
fn weights_make_up_for_aiming() {
    let balls = [
        ball(3.0, 0.0, 1.0, 0.5),
        ball(6.0, 0.2, 2.0, 1.5),
        ball(-1.0, -1.0, 0.1, 0.7),
        ball(0.0, 0.0, 1.001, 1.0),
        ball(0.0, 2.0, -3.0, 1.0),
    ];
    for n in [DVec3::Z, DVec3::new(1.0, 0.3, 0.2), DVec3::NEG_Y] {
        let at = point(DVec3::ZERO, n);
        for few in [&balls[..0], &balls[..1], &balls[..3], &balls] {
            let bounces = bounces(few);
            let [all, _] = mean_of(&bounces, &at, |_| 1.0);
            assert!((all - 1.0).abs() < 3e-3, "{n}: {all}");
            // The mean squared cosine, by its closed form.
            let [squared, _] = mean_of(&bounces, &at, |d| d.dot(at.ns).powi(2));
            assert!((squared - 0.5).abs() < 3e-3, "{n}: {squared}");
        }
    }
}

/// The light of a distant ball of unit radiance: the share of the hemisphere is
/// sin² of its half-angle times the cosine of its middle.
#[test]
fn a_distant_ball_is_found_by_all() {
    let target = ball(3.0, 0.0, 4.0, 0.25);
    let at = point(DVec3::ZERO, DVec3::Z);
    let share = (0.25f64 / 5.0).powi(2) * 0.8;
    let meets = |d: DVec3| f64::from(u8::from(target.center.reject_from(d).length() < 0.25));
    let plain = mean_of(&Bounces::EVEN, &at, meets);
    let aimed = mean_of(&bounces(&[target]), &at, meets);
    assert!((aimed[0] / share - 1.0).abs() < 1e-3, "{aimed:?}, {share}");
    assert!((plain[0] / share - 1.0).abs() < 0.1, "{plain:?}, {share}");
    // Rare ones have the variance of their chance; aimed ones that of missing
    // every other time.
    assert!((plain[1] / share - 1.0).abs() < 0.1, "{plain:?}");
    assert!((aimed[1] / share.powi(2) - 1.0).abs() < 0.02, "{aimed:?}");
}

/// Inside a sphere and where all are below the horizon directions are those of
/// the cosine, bit by bit; so they are if no part is aimed.
#[test]
fn nothing_to_aim_at() {
    let at = point(DVec3::new(0.3, 0.0, 0.0), DVec3::Z);
    for bounces in [
        bounces(&[ball(0.0, 0.0, 0.2, 1.0), ball(0.0, 0.0, -2.0, 1.0)]),
        bounces(&[ball(0.3, 0.0, 0.0, 0.0)]),
        Bounces::EVEN,
    ] {
        for u in [[0.1, 0.2], [0.3, 0.6], [0.999, 0.2]] {
            let bounce = bounces.direction(&at, u).expect("a direction");
            assert_eq!(bounce.dir, warp::cosine_hemisphere(u).normalize());
            assert_eq!((bounce.weight, bounce.ratio), (1.0, None));
        }
    }
}

/// Directions near the rim of a cone and of the hemisphere have finite weights,
/// at most those of directions that were never aimed.
#[test]
fn weights_are_bounded() {
    let targets = [ball(0.0, 5.0, 0.5, 1.0), ball(0.0, 0.0, 1e9, 1.0)];
    let at = point(DVec3::ZERO, DVec3::Z);
    let bounces = bounces(&targets);
    let sequence = Sequence::new(5, Purpose::Pilot, 0, 0);
    for i in 0..10_000 {
        let mut stream = sequence.at(i);
        let u = match i % 3 {
            0 => [stream.next_1d(), 0.0],
            1 => [AIMED * (1.0 - f64::EPSILON), stream.next_1d()],
            _ => stream.next_2d(),
        };
        let Some(bounce) = bounces.direction(&at, u) else {
            continue;
        };
        let density = bounce.dir.z * FRAC_1_PI * bounce.weight;
        assert!(density.is_finite() && bounce.dir.z > 0.0, "{bounce:?}");
        let most = 1.0 / (1.0 - AIMED);
        assert!(bounce.weight <= most * (1.0 + 1e-12), "{bounce:?}");
    }
}

/// A pilot's looks: nothing but a rare direction brings light, or all do alike.
#[test]
fn aiming_pays_where_light_is_rare() {
    let scene = |light: &dyn Fn(f64) -> f64| {
        let target = ball(3.0, 0.0, 4.0, 0.25);
        let at = point(DVec3::ZERO, DVec3::Z);
        let sequence = Sequence::new(6, Purpose::Pilot, 0, 0);
        let looks: Vec<[pilot::Look; 4]> = (0..64)
            .map(|i| {
                std::array::from_fn(|j| {
                    let u = sequence.at(4 * i + j as u64).next_2d();
                    let bounce = bounces(&[target]).direction(&at, u).expect("a direction");
                    let met = target.center.reject_from(bounce.dir).length() < 0.25;
                    pilot::Look {
                        light: [1.0, bounce.weight * light(f64::from(u8::from(met)))],
                        ratio: bounce.ratio,
                        work: [5.0, if met { 4.0 } else { 2.0 }],
                    }
                })
            })
            .collect();
        pilot::is_worth_it(&looks)
    };
    assert!(scene(&|met| met), "the ball alone");
    assert!(!scene(&|_| 1.0), "all that is around");
    assert!(!scene(&|_| 0.0), "nothing");
}

//! Ways of single rays by Snell's law and formulas for lenses.

use glam::DVec3;
use nephroid::{
    geometry::Ray,
    photon::Photon,
    sampling::{Purpose, Sequence},
    scene::Scene,
    transport::{Carried, Lobes, Walker, lobes, media_beside, meet},
};

use crate::{
    CAMERA, LAMP, ball,
    common::{photon_paths, scene_of},
    dielectric, objects, slab,
    twin::{Body, point, slow_way},
    way, with_context,
};

/// Water around glass by priorities, whatever their order, and by an interface
/// that names both indices.
pub(crate) fn ball_in_water(how: usize) -> Scene {
    let center = [0.3, -0.2, 0.4];
    let water = |p| ball([0.0, 0.0, 0.0], 2.0, &dielectric(1.33, p));
    objects(&match how {
        0 => water(0) + &ball(center, 1.0, &dielectric(1.5, 1)),
        1 => ball(center, 1.0, &dielectric(1.5, 127)) + &water(-128),
        2 => water(0) + &ball(center, 1.0, "Dielectric(ior: 1.5)"),
        _ => {
            ball([0.0, 0.0, 0.0], 2.0, "Dielectric(ior: 1.33)")
                + &ball(center, 1.0, "Dielectric(ior: 1.5, outside: 1.33)")
        }
    })
}

/// Four interfaces, each by Snell's law in vectors.
#[test]
fn a_ball_in_water_follows_snell() {
    let bodies = [
        Body {
            center: DVec3::ZERO,
            radius: 2.0,
            ior: 1.33,
            priority: 0,
        },
        Body {
            center: DVec3::new(0.3, -0.2, 0.4),
            radius: 1.0,
            ior: 1.5,
            priority: 1,
        },
    ];
    for how in 0..4 {
        let scene = ball_in_water(how);
        with_context(&scene, |ctx| {
            assert_eq!(ctx.plan.nest.is_some(), how < 3);
            let mut tested = 0;
            for i in 0..200 {
                let mut s = Sequence::new(3, Purpose::Pilot, 0, i).at(0);
                let p = DVec3::new(1.2 * s.next_1d() - 0.6, 1.2 * s.next_1d() - 0.6, 5.0);
                let d = (point(&mut s, 0.4) - p).normalize();
                let Some(slow) = slow_way(&bodies, p, d, 8) else {
                    continue;
                };
                let fast = way(ctx, p, d, 8);
                assert_eq!((fast.len(), slow.len()), (4, 4), "way {how}, ray {i}");
                for (a, b) in fast.iter().zip(&slow) {
                    let away = a.p.distance(b.p).max(a.dir.distance(b.dir));
                    assert!(away < 1e-12, "way {how}, ray {i}: {a:?} {b:?}");
                }
                tested += 1;
            }
            assert!(tested > 150, "{tested} tested");
        });
    }
}

/// A liquid between two panes of glass, `overlap` of their thickness into both.
pub(crate) fn filled(overlap: f64) -> Scene {
    let glass = |z: f64| slab(z, z + 0.2, 3.0, &dielectric(1.5, 1));
    let reach = 0.2 * overlap;
    scene_of(
        CAMERA,
        [8, 8],
        &(glass(0.5)
            + &slab(0.7 - reach, 1.1 + reach, 2.9, &dielectric(1.33, 0))
            + &glass(1.1)
            + &ball([0.2, 0.1, 0.9], 0.1, &dielectric(1.0, 2))
            + "(shape: Quad(center: (0, 0, 0), size: (9, 9), normal: (0, 0, 1)), material: \"grey\")"),
        "Sphere(center: (0.3, 0.2, 3), radius: 0.2, power: 10)",
        "",
    )
}

/// How far a liquid reaches into its glass does not matter: not to rays, and
/// not to the photons with their footprints. It may end where the glass begins.
#[test]
fn overlap_depth_leaves_no_trace() {
    for overlap in [0.0, 0.01] {
        no_trace_of(overlap, 0.5);
    }
}

fn no_trace_of(thin: f64, deep: f64) {
    let [thin, deep] = [thin, deep].map(filled);
    let trace = |scene: &Scene| -> Vec<Option<Photon>> {
        let paths = photon_paths(scene, 6000);
        paths.into_iter().map(|p| p.photon).collect()
    };
    let (mut same, mut parted) = (0, 0);
    for (a, b) in trace(&thin).into_iter().zip(trace(&deep)) {
        let (Some(a), Some(b)) = (a, b) else {
            assert_eq!(a.is_some(), b.is_some());
            continue;
        };
        if a.position.distance(b.position) > 1e-3 {
            // A coin on the edge of a roundoff may fall to the other side.
            parted += 1;
            continue;
        }
        assert!(a.position.distance(b.position) < 1e-11, "{a:?} {b:?}");
        assert!((a.flux.mean() - b.flux.mean()).abs() < 1e-12 * a.flux.mean());
        let (Some(f), Some(g)) = (a.footprint, b.footprint) else {
            assert_eq!(a.footprint.is_some(), b.footprint.is_some());
            continue;
        };
        // An axis has two ends; which of them is told depends on the fold.
        let apart = f.major.distance(g.major).min(f.major.distance(-g.major));
        assert!(apart < 1e-8 * f.major.length(), "{f:?} {g:?}");
        let folds = [f, g].map(|f| f.minor / f.fold);
        assert!((folds[0] - folds[1]).abs() < 1e-6, "{f:?} {g:?}");
        assert!(
            (f.minor - g.minor).abs() < 1e-8 * f.major.length(),
            "{f:?} {g:?}"
        );
        same += 1;
    }
    assert!(same > 1000 && parted < 3, "{same} same, {parted} parted");
}

/// Glass, liquid, glass: parallel faces turn nothing, and shift a ray by
/// `sum h sin i (1 - cos i / sqrt(n^2 - sin^2 i))`, whatever the overlap.
#[test]
fn a_filled_slab_shifts_by_the_sum_of_its_layers() {
    for overlap in [0.0, 0.01, 0.25, 0.5] {
        let scene = filled(overlap);
        with_context(&scene, |ctx| {
            for angle in [0.0f64, 0.3, 0.9, 1.3] {
                let (s, c) = angle.sin_cos();
                let d = DVec3::new(0.0, s, -c);
                let start = DVec3::new(-0.8, -0.3, 0.9) - d * 2.0;
                let steps = way(ctx, start, d, 8);
                assert_eq!(steps.len(), 4, "overlap {overlap}, angle {angle}");
                let [a, .., z] = steps[..] else {
                    unreachable!()
                };
                assert!(z.dir.distance(d) < 1e-14);
                let shift = (z.p - a.p).cross(d).length();
                let layer = |h: f64, n: f64| h * s * (1.0 - c / (n * n - s * s).sqrt());
                let expected = 2.0 * layer(0.2, 1.5) + layer(0.4, 1.33);
                assert!(
                    (shift - expected).abs() < 1e-13,
                    "{shift} is not {expected}"
                );
            }
        });
    }
}

/// A ball lens focuses at `n r / (2 (n - 1))` from its centre, n its index
/// over that of what surrounds it; below one, before the ball.
#[test]
fn lenses_and_bubbles_in_water_focus_by_their_relative_index() {
    for (ior, around) in [(1.5, 1.33), (1.0, 1.33), (1.33, 1.6)] {
        let text = ball([0.0; 3], 1.0, &dielectric(ior, 1))
            + &slab(-20.0, 20.0, 20.0, &dielectric(around, 0));
        let scene = objects(&text);
        with_context(&scene, |ctx| {
            let height = 1e-4;
            let start = DVec3::new(height, 0.0, 5.0);
            let steps = way(ctx, start, DVec3::NEG_Z, 2);
            let out = steps[1];
            let along = out.p.x / out.dir.x;
            let found = -(out.p.z - along * out.dir.z);
            let n = ior / around;
            let expected = n / (2.0 * (n - 1.0));
            // The aberration at height h is of the order h^2.
            assert!(
                (found - expected).abs() < 1e-6,
                "{ior} in {around}: {found} instead of {expected}"
            );
        });
    }
}

/// A bubble reflects totally where a ray passes its centre at more than r / n.
#[test]
fn a_bubble_reflects_totally_beyond_its_critical_height() {
    let text =
        slab(-20.0, 20.0, 20.0, &dielectric(1.33, 0)) + &ball([0.0; 3], 1.0, &dielectric(1.0, 1));
    let scene = objects(&text);
    with_context(&scene, |ctx| {
        for (factor, refracted) in [(1.0 - 1e-9, true), (1.0 + 1e-9, false)] {
            let start = DVec3::new(factor / 1.33, 0.0, 5.0);
            let step = way(ctx, start, DVec3::NEG_Z, 1)[0];
            assert_eq!(step.refracted, refracted, "{step:?}");
        }
    });
}

/// Snell's window: from under water the sky fills a cone whose half-angle has
/// the sine 1 / 1.33; beyond, the surface mirrors. The lens of the camera
/// stands in a ball of glass.
#[test]
fn the_sky_under_water_fills_snells_window() {
    let text = slab(-20.0, 0.0, 20.0, &dielectric(1.33, 0))
        + &ball([0.0, 0.0, -4.0], 1.0, &dielectric(1.5, 1));
    let camera = "eye: (0, 0, -4), look_at: (0, 0, 0), up: (0, 1, 0), fov: 120";
    let scene = scene_of(camera, [8, 8], &text, LAMP, "");
    with_context(&scene, |ctx| {
        let critical = (1.0f64 / 1.33).asin();
        for (angle, sky) in [
            (0.0, true),
            (0.5 * critical, true),
            (critical - 1e-7, true),
            (critical + 1e-7, false),
            (1.2 * critical, false),
        ] {
            // Through the middle of the ball rays go straight.
            let d = DVec3::new(angle.sin(), 0.0, angle.cos());
            let mut walker = Walker::from_camera(ctx, Ray::new(DVec3::new(0.0, 0.0, -4.0), d));
            let nested = ctx.plan.nest.as_ref().expect("two bodies");
            assert_eq!(nested.nest.medium(&walker.media), Some(1));
            let met = meet(ctx, &walker.ray, f64::INFINITY, &mut walker.media).expect("the ball");
            let out = met.point.spawn(d);
            let mut beyond = media_beside(ctx, walker.media, &met.point, d);
            let step = meet(ctx, &out, f64::INFINITY, &mut beyond).expect("the surface");
            let found = lobes(&step.material, &step.point, d, Carried::Radiance);
            let two = matches!(found, Some(Lobes::Two(..)));
            assert_eq!(two, sky, "at {angle}");
        }
    });
}

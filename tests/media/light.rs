//! Light as a whole: furnaces, pictures, watts, where paths start.

use glam::DVec3;
use nephroid::{
    geometry::Ray,
    plan::Media,
    sampling::{Purpose, Sequence, warp},
    transport::{End, Walker, meet, transmittance},
};

use crate::{
    CAMERA, around, ball,
    common::{Estimate, assert_close, photon_paths, reflectance, render, scene_of},
    dielectric, objects,
    rays::filled,
    slab,
    twin::{Body, index_at, point, scene_with},
    with_context,
};

/// Radiance that has left all media is what it was: no body, however nested,
/// shows in an even surrounding. From within it is brighter by the squared
/// index of the place.
#[test]
fn nested_media_do_not_show_in_an_even_surrounding() {
    let bodies = [
        Body {
            center: DVec3::ZERO,
            radius: 1.5,
            ior: 1.33,
            priority: 0,
        },
        Body {
            center: DVec3::new(0.5, 0.0, 0.6),
            radius: 1.2,
            ior: 1.5,
            priority: 1,
        },
        Body {
            center: DVec3::new(0.2, 0.1, 0.9),
            radius: 0.7,
            ior: 1.0,
            priority: 2,
        },
    ];
    let scene = scene_with(&bodies);
    with_context(&scene, |ctx| {
        let mut seen = [0; 3];
        for i in 0..2000 {
            let mut s = Sequence::new(6, Purpose::Pilot, 0, i).at(0);
            let (p, d) = (point(&mut s, 2.0), warp::sphere(s.next_2d()).normalize());
            let mut path = Walker::new(Ray::new(p, d), around(ctx, p));
            let mut coins = Sequence::new(6, Purpose::Pilot, 1, i).at(0);
            if let End::Truncated = path.walk(ctx, &mut coins, &mut |_| false) {
                continue;
            }
            let n = index_at(&bodies, p);
            assert_close(path.throughput[1], n * n, 1e-13, "throughput");
            assert!(path.media == Media::NONE);
            seen[[1.0, 1.33, 1.5]
                .iter()
                .position(|&x| x == n)
                .expect("an index")] += 1;
        }
        assert!(seen.iter().all(|&n| n > 150), "{seen:?}");
    });
}

/// The same scene by priorities and with every interface written out is the
/// same picture, bit by bit.
#[test]
fn priorities_and_explicit_interfaces_make_the_same_picture() {
    let picture = |inner: &str| {
        let objects = ball([0.0, 0.0, 1.2], 1.0, "Dielectric(ior: 1.33)")
            + &ball([0.1, 0.0, 1.3], 0.6, inner)
            + "(shape: Quad(center: (0, 0, 0), size: (9, 9), normal: (0, 0, 1)), material: \"grey\")";
        let scene = scene_of(
            CAMERA,
            [16, 12],
            &objects,
            "Sphere(center: (1, 0, 5), radius: 0.3, power: 100)",
            "passes: 8, photons: 4096",
        );
        render(&scene).film.image().pixels().to_vec()
    };
    let nested = picture("Dielectric(ior: 1.5, priority: 3)");
    assert!(nested == picture("Dielectric(ior: 1.5, outside: 1.33)"));
    assert!(nested != picture("Dielectric(ior: 1.5, outside: 1)"));
}

/// What leaves glass around a lamp, in water, is what Fresnel lets through;
/// with all inner reflections it is everything.
#[test]
fn light_leaves_the_glass_around_it() {
    let (inner, outer) = (reflectance(0.0, 1.33 / 1.5), reflectance(0.0, 1.0 / 1.33));
    for (depth, expected) in [(2, (1.0 - inner) * (1.0 - outer)), (60, 1.0)] {
        let text = ball([0.0; 3], 2.0, &dielectric(1.33, 0))
            + &ball([0.0; 3], 1.0, &dielectric(1.5, 1))
            + &ball([0.0; 3], 5.0, "Diffuse(reflectance: 0)");
        let scene = scene_of(
            CAMERA,
            [8, 8],
            &text,
            "Point(position: (0, 0, 0), power: 20)",
            &format!("max_depth: {depth}, indirect: false"),
        );
        // At normal incidence nothing is bent, but refracted all the same.
        let stored: Vec<f64> = photon_paths(&scene, 20_000)
            .iter()
            .map(|p| p.tally.stored)
            .collect();
        let estimate = Estimate::of(&stored);
        assert!(
            (estimate.mean - 20.0 * expected).abs() <= 5.0 * estimate.error + 1e-9,
            "{estimate:?}, expected {}",
            20.0 * expected
        );
        assert!(estimate.error < 0.03);
    }
}

/// A lamp half in the water: its photons know on which side they start, and
/// shadow rays from within pass what is hidden and nothing else.
#[test]
fn starts_and_shadow_rays_know_their_side() {
    let text = slab(-2.0, 0.0, 3.0, &dielectric(1.33, 0))
        + &slab(-2.0, -1.0, 1.0, &dielectric(1.33, -1))
        + &slab(-2.5, -1.8, 4.0, "Diffuse(reflectance: 0.5)");
    let lamps = "Sphere(center: (0, 0, 0), radius: 0.5, power: 10),
        Point(position: (1.5, 0, -0.2), power: 5), Point(position: (0, 0, 2), power: 5)";
    let scene = scene_of(CAMERA, [8, 8], &text, lamps, "");
    let mut sides = [0; 2];
    for path in photon_paths(&scene, 2000) {
        let start = path.emission;
        if start.light == 0 {
            let below = start.ray.origin.z < 0.0;
            assert_eq!(start.media.top().is_some(), below, "{:?}", start.ray);
            sides[usize::from(below)] += 1;
        }
    }
    assert!(sides.iter().all(|&n| n > 100), "{sides:?}");
    with_context(&scene, |ctx| {
        // From the floor, below the hidden slab.
        let from = DVec3::new(0.1, 0.2, -1.7);
        let mut media = around(ctx, from);
        assert_eq!(media.ranks(), [0, 1]);
        let ray = Ray::new(from, DVec3::NEG_Z);
        let met = meet(ctx, &ray, f64::INFINITY, &mut media).expect("the floor");
        let share = |light: usize| {
            let named = &ctx.scene.lights[light];
            let sample = named
                .light
                .sample_direct(met.point.p, [0.5; 2])
                .expect("a sample");
            transmittance(ctx, &met.point, &media, &sample, named.instance)
        };
        assert_eq!(share(1), 1.0, "in the same water");
        assert_eq!(share(2), 0.0, "beyond the surface");
    });
}

/// Watt by watt, also where photons start inside and bounce under water.
#[test]
fn the_ledger_balances_under_water() {
    let scene = filled(0.5);
    let tank = scene_of(
        CAMERA,
        [8, 8],
        &(slab(-1.0, 1.0, 2.0, &dielectric(1.33, 0))
            + &slab(-1.5, -0.5, 1.9, "\"grey\"")
            + &ball([0.3, 0.0, 0.9], 0.4, &dielectric(1.31, 1))
            + &ball([-0.4, 0.0, 0.0], 0.3, &dielectric(1.0, 2))),
        "Sphere(center: (0, 0, 0.5), radius: 0.1, power: 10), Point(position: (1, 0, 4), power: 30)",
        "passes: 2, photons: 8192",
    );
    for scene in [scene, tank] {
        let report = render(&scene).report;
        for light in &report.lights {
            let ledger = &light.ledger;
            assert!(ledger.stored > 0.0);
            assert!(
                ledger.imbalance().abs() <= 1e-9 * ledger.launched,
                "{}: {} W",
                light.name,
                ledger.imbalance()
            );
        }
    }
}

/// Bodies that lie apart, panes, open surfaces and explicit interfaces ask for
/// none of this.
#[test]
fn only_bodies_that_come_near_each_other_are_nested() {
    let apart = ball([0.0; 3], 1.0, "\"glass\"") + &ball([1.5, 1.5, 0.0], 1.0, "\"glass\"");
    let touching = ball([0.0; 3], 1.0, "\"glass\"") + &ball([1.4, 1.4, 0.0], 1.0, "\"glass\"");
    let explicit = ball([0.0; 3], 1.0, "\"glass\"")
        + &ball([0.0; 3], 0.5, "Dielectric(ior: 1, outside: 1.5)")
        + "(shape: Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: 2), material: \"glass\", open: true)";
    let deep: String = (1..=12)
        .map(|i| {
            ball(
                [0.0; 3],
                f64::from(i),
                &dielectric(1.0 + 0.05 * f64::from(i), -i),
            )
        })
        .collect();
    for (text, nested) in [
        (&apart, false),
        (&touching, true),
        (&explicit, false),
        (&deep, true),
    ] {
        let scene = objects(text);
        with_context(&scene, |ctx| {
            assert_eq!(ctx.plan.nest.is_some(), nested, "{text}");
        });
    }
    // Seven are remembered; the innermost of twelve is among them.
    let scene = objects(&deep);
    with_context(&scene, |ctx| {
        let media = around(ctx, DVec3::ZERO);
        assert_eq!(media.ranks(), [5, 6, 7, 8, 9, 10, 11]);
    });
}

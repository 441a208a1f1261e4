//! Rays that leave surfaces: they never meet again what they stand on, and
//! paths through closed shapes go in and out in turn.

use std::sync::Arc;

use glam::DVec3;
use nephroid::geometry::{
    Ray, Shape, SurfacePoint, Transform, World,
    shape::{Cylinder, Sphere},
};
use proptest::prelude::*;

use crate::scenes::{self, Random, single, sphere_mesh};

/// A convex closed shape of the given kind.
fn convex(random: &mut Random, kind: u64, at: DVec3, size: f64) -> Shape {
    match kind % 3 {
        0 => Shape::Sphere(Sphere::new(at, size)),
        1 => Shape::Cylinder(Cylinder::new(
            at,
            at + random.direction() * size,
            0.6 * size,
            true,
        )),
        _ => Shape::Mesh(Arc::new(sphere_mesh(random, 10, at, size, 0.0))),
    }
}

fn hit_from(world: &World, ray: &Ray) -> Option<SurfacePoint> {
    world
        .closest(ray, f64::INFINITY)
        .map(|h| world.surface(ray, &h))
}

/// A first point on the only instance, seen from around it.
fn first_point(random: &mut Random, world: &World) -> Option<SurfacePoint> {
    let s = world.instance_sphere(0).expect("bounded");
    let origin = s.center + random.direction() * s.radius * random.range(1.5, 4.0);
    let target = s.center + random.vector(0.5) * s.radius;
    hit_from(world, &Ray::new(origin, (target - origin).normalize()))
}

fn any_place() -> impl Strategy<Value = (u64, f64, f64, bool)> {
    (any::<u64>(), -8.0..8.0f64, 0.0..1e5f64, any::<bool>())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn convex_shapes_are_left_for_good((seed, exponent, away, moved) in any_place(), kind in 0u64..3) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let at = random.direction() * away * size;
        let transform = moved.then(|| random.transform(10.0 * size));
        let world = single(convex(&mut random, kind, at, size), transform);
        for _ in 0..60 {
            let Some(point) = first_point(&mut random, &world) else { continue };
            let dir = random.direction();
            let outside = point.spawn(dir);
            if dir.dot(point.ng) > 0.0 {
                let again = world.closest(&outside, f64::INFINITY);
                prop_assert!(again.is_none(), "left {point:?} along {dir}, met {again:?}");
                continue;
            }
            let Some(exit) = hit_from(&world, &outside) else {
                return Err(TestCaseError::fail(format!("no exit from {point:?} along {dir}")));
            };
            prop_assert!(exit.ng.dot(dir) > 0.0, "an exit is an exit: {point:?} to {exit:?}");
            let gone = world.closest(&exit.spawn(dir), f64::INFINITY);
            prop_assert!(gone.is_none(), "left {exit:?} along {dir}, met {gone:?}");
        }
    }

    #[test]
    fn flat_surfaces_are_never_met_again((seed, exponent, away, moved) in any_place(), kind in 2u64..6) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let at = random.direction() * away * size;
        let transform = moved.then(|| random.transform(10.0 * size));
        let world = single(scenes::shape(&mut random, kind, at, size), transform);
        for _ in 0..60 {
            let Some(point) = first_point(&mut random, &world) else { continue };
            let ray = point.spawn(random.direction());
            if let Some(hit) = world.closest(&ray, f64::INFINITY) {
                prop_assert_ne!(hit.surface, point.surface);
            }
        }
    }

    /// Along a random line through any closed shape, entries and exits
    /// alternate and end outside.
    #[test]
    fn lines_enter_and_leave_in_turn(seed: u64, moved: bool) {
        let mut random = Random(seed);
        let transform: Option<Transform> = moved.then(|| random.transform(2.0));
        // Rough spheres are not convex: many crossings.
        let shape = if random.below(2) == 0 {
            Shape::Mesh(Arc::new(sphere_mesh(&mut random, 12, DVec3::ONE, 1.0, 0.7)))
        } else {
            let kind = random.below(3);
            convex(&mut random, kind, DVec3::ONE, 1.0)
        };
        let world = single(shape, transform);
        let s = world.instance_sphere(0).expect("bounded");
        for _ in 0..60 {
            let origin = s.center + random.direction() * s.radius * 3.0;
            let dir = (s.center + random.vector(0.6) * s.radius - origin).normalize();
            let mut ray = Ray::new(origin, dir);
            let mut inside = false;
            while let Some(point) = hit_from(&world, &ray) {
                let entering = point.ng.dot(dir) < 0.0;
                prop_assert_eq!(entering, !inside, "at {:?}", point);
                inside = entering;
                ray = point.spawn(dir);
            }
            prop_assert!(!inside, "a line ends outside");
        }
    }

    /// A segment between two surface points is free unless something stands
    /// between them.
    #[test]
    fn segments_do_not_shadow_themselves(seed: u64, exponent in -6.0..6.0f64) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let kind = random.below(3);
        let world = single(convex(&mut random, kind, random_at(seed) * size, size), None);
        let s = world.instance_sphere(0).expect("bounded");
        for _ in 0..40 {
            let Some(point) = first_point(&mut random, &world) else { continue };
            let target = s.center + random.direction() * s.radius * 3.0;
            // Either may be the case; what decides is the tangent plane.
            prop_assume!((target - point.p).dot(point.ng).abs() > 1e-6 * s.radius);
            let (ray, distance) = point.spawn_towards(target).expect("apart");
            let below = (target - point.p).dot(point.ng) < 0.0;
            prop_assert_eq!(world.occluded(&ray, distance, |_| false), below);
        }
    }
}

fn random_at(seed: u64) -> DVec3 {
    Random(!seed).vector(100.0)
}

/// A ray inside a sphere bounces with the same chord for ever and never
/// leaves it; also with the centre far away and under a transform.
#[test]
fn a_hundred_bounces_stay_on_the_sphere() {
    for (away, moved) in [(0.0, false), (1e5, false), (0.0, true), (1e3, true)] {
        let mut random = Random(21);
        for _ in 0..200 {
            let center = random.direction() * away;
            let similarity = glam::DAffine3::from_scale_rotation_translation(
                DVec3::splat(2.5),
                random.rotation(),
                random.vector(away),
            );
            let transform = moved.then(|| Transform::new(similarity).unwrap());
            let world = single(Shape::Sphere(Sphere::new(center, 1.0)), transform);
            let s = world.instance_sphere(0).unwrap();
            let mut dir = random.direction();
            let mut point =
                hit_from(&world, &Ray::new(s.center + random.vector(0.5), dir)).unwrap();
            let cosine = dir.dot(point.ng);
            for bounce in 0..100 {
                dir = (dir - point.ng * (2.0 * dir.dot(point.ng))).normalize();
                let ray = point.spawn(dir);
                let hit = world.closest(&ray, f64::INFINITY).expect("still inside");
                point = world.surface(&ray, &hit);
                let off = ((point.p - s.center).length() - s.radius).abs();
                // The check itself rounds like the centre's coordinates.
                let allowed = 4.0 * point.error;
                assert!(
                    off <= allowed,
                    "bounce {bounce}: off by {off:e} of {allowed:e}"
                );
                assert!(
                    (dir.dot(point.ng) - cosine).abs() < 1e-13 * (1.0 + 100.0 * away.max(1.0)),
                    "angle"
                );
            }
        }
    }
}

/// Grazing chords are short but real, down to where the two ends round to
/// one point.
#[test]
fn grazing_chords_end_where_they_should() {
    let world = single(Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)), None);
    let point = hit_from(&world, &Ray::new(DVec3::X * 3.0, DVec3::NEG_X)).unwrap();
    for k in 1..14 {
        let sine = libm::exp10(-f64::from(k));
        let dir = DVec3::new(-sine, (1.0 - sine * sine).sqrt(), 0.0);
        let hit = world
            .closest(&point.spawn(dir), f64::INFINITY)
            .expect("a chord");
        assert!(
            (hit.t / (2.0 * sine) - 1.0).abs() < 1e-15 / sine + 1e-15,
            "{sine}: {}",
            hit.t
        );
    }
}

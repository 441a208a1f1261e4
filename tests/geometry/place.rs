//! Scale, place, signed zeros and bounds.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use nephroid::geometry::{
    Aabb, Instance, Ray, Shape, Surface, Transform, World,
    shape::{Conic, Cuboid, Cylinder, Disc, Plane, Quad, Sphere, Torus},
};

use crate::scenes::{self, Random, sphere_mesh};

/// One of everything, scaled and then moved.
fn diorama(scale: f64, shift: DVec3) -> World {
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * scale + shift;
    let mesh = sphere_mesh(&mut Random(3), 16, DVec3::ZERO, 1.0, 0.2);
    let place = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.8, 0.6, -0.5) * scale,
        DQuat::from_rotation_y(0.4),
        p(0.0, 2.0, 1.0),
    );
    let shapes = [
        (Shape::Plane(Plane::new(p(0.0, 0.0, -1.0), DVec3::Z)), None),
        (
            Shape::Sphere(Sphere::new(p(1.0, 0.0, 0.5), 0.7 * scale)),
            None,
        ),
        (
            Shape::Cylinder(Cylinder::new(
                p(-1.0, 0.0, -0.5),
                p(-1.2, 0.3, 1.0),
                0.4 * scale,
                true,
            )),
            None,
        ),
        (
            Shape::Cylinder(Cylinder::new(
                p(-1.0, -2.0, -0.5),
                p(-1.2, -2.0, 1.0),
                0.5 * scale,
                false,
            )),
            None,
        ),
        (
            Shape::Disc(Disc::new(
                p(0.0, 0.0, 3.0),
                DVec3::new(0.2, 0.1, -1.0),
                scale,
            )),
            None,
        ),
        (
            Shape::Quad(Quad::new(
                p(-3.0, -3.0, -1.0),
                DVec3::Y * 6.0 * scale,
                DVec3::Z * 5.0 * scale,
            )),
            None,
        ),
        (
            Shape::Conic(Conic::cone(
                p(2.0, 2.0, -0.5),
                p(2.2, 2.1, 1.0),
                [0.6 * scale, 0.0],
                true,
            )),
            None,
        ),
        (
            Shape::Conic(Conic::paraboloid(
                p(2.0, -2.0, 1.0),
                p(2.0, -2.0, -0.5),
                0.7 * scale,
                false,
            )),
            None,
        ),
        (
            Shape::Torus(Torus::new(
                p(-1.5, 2.0, 0.5),
                DVec3::new(0.3, 0.2, 1.0),
                0.7 * scale,
                0.25 * scale,
            )),
            None,
        ),
        (
            Shape::Cuboid(Cuboid::new(Aabb {
                min: p(0.5, -2.0, -0.5),
                max: p(1.0, -1.25, 0.25),
            })),
            None,
        ),
        (
            Shape::Mesh(Arc::new(mesh)),
            Some(Transform::new(place).unwrap()),
        ),
    ];
    World::new(
        shapes
            .into_iter()
            .map(|(shape, transform)| Instance { shape, transform })
            .collect(),
    )
}

#[test]
fn scale_and_place_do_not_matter() {
    let original = diorama(1.0, DVec3::ZERO);
    let away = DVec3::new(1e5, -0.7e5, 0.3e5);
    for (scale, shift) in [
        (1e-4, DVec3::ZERO),
        (3e-2, away * 3e-2),
        (1.0, away),
        (1e5, DVec3::ZERO),
        (1e5, away),
    ] {
        let other = diorama(scale, shift);
        let mut random = Random(41);
        let mut hits = 0;
        for _ in 0..20_000 {
            let origin = random.vector(3.0);
            let dir = random.direction();
            let here = Ray::new(origin, dir);
            let there = Ray::new(origin * scale + shift, dir);
            let a = original.closest(&here, f64::INFINITY);
            let b = other.closest(&there, f64::INFINITY);
            assert_eq!(
                a.map(|h| h.surface),
                b.map(|h| h.surface),
                "{here:?} at {scale}, {shift}"
            );
            let (Some(a), Some(b)) = (a, b) else { continue };
            let (p, q) = (original.surface(&here, &a), other.surface(&there, &b));
            let cosine = p.ng.dot(dir).abs();
            // Coordinates at the new place round to 1.5e-11 of the old size.
            let rounding = 1e-14 * (1.0 + shift.length() / scale);
            assert!(
                (a.t - b.t / scale).abs() * cosine <= 30.0 * rounding * (1.0 + a.t),
                "{a:?} {b:?}"
            );
            assert!(
                (p.ng - q.ng).length() * cosine <= 30.0 * rounding * (1.0 + a.t),
                "{p:?} {q:?}"
            );
            hits += 1;
        }
        assert!(hits > 10_000, "the rays meet something");
    }
}

#[test]
fn the_sign_of_zero_does_not_matter() {
    let world = diorama(1.0, DVec3::ZERO);
    let mut random = Random(42);
    let mut hits = 0;
    for _ in 0..5000 {
        // Coordinates on faces of boxes and seams of meshes now and then.
        let snap = |x: f64| (x * 8.0).round() / 8.0;
        let v = random.vector(3.0);
        let origin = if random.below(2) == 0 {
            v
        } else {
            DVec3::new(snap(v.x), snap(v.y), snap(v.z))
        };
        let mut dir = random.direction();
        let zeroed = 1 + random.below(6);
        for axis in 0..3 {
            if zeroed >> axis & 1 == 1 {
                dir[axis] = 0.0;
            }
        }
        let dir = dir.normalize();
        let expected = world.closest(&Ray::new(origin, dir), f64::INFINITY);
        hits += usize::from(expected.is_some());
        for signs in 0..8 {
            let mut dir = dir;
            for axis in 0..3 {
                if dir[axis] == 0.0 && signs >> axis & 1 == 1 {
                    dir[axis] = -0.0;
                }
            }
            assert_eq!(
                world.closest(&Ray::new(origin, dir), f64::INFINITY),
                expected,
                "{dir}"
            );
        }
    }
    assert!(hits > 1000, "the rays meet something");
}

#[test]
fn bounds_contain_every_hit() {
    for seed in 0..60 {
        let mut random = Random(seed);
        let world = scenes::world(&mut random, 25);
        for _ in 0..300 {
            let ray = scenes::ray(&mut random, &world);
            let Some(hit) = world.closest(&ray, f64::INFINITY) else {
                continue;
            };
            let i = hit.surface.instance;
            let point = world.surface(&ray, &hit);
            let unbounded = matches!(world.instances()[i as usize].shape, Shape::Plane(_));
            assert_eq!(world.instance_bounds(i).is_none(), unbounded);
            assert_eq!(world.instance_sphere(i).is_none(), unbounded);
            if let (Some(b), Some(s)) = (world.instance_bounds(i), world.instance_sphere(i)) {
                assert!(b.contains(point.p), "{point:?} outside {b:?}");
                // A sphere's own radius is exact, its points are not.
                let slack = 2.0 * point.error;
                assert!(
                    point.p.distance(s.center) <= s.radius + slack,
                    "{point:?} outside {s:?}"
                );
                assert!(world.bounds().unwrap().contains(point.p));
            }
        }
    }
}

/// Boxes of round shapes touch them: turned ones are no larger than needed.
#[test]
fn bounds_are_tight() {
    let axis = DVec3::new(1.0, 2.0, 2.0) / 3.0;
    let disc = Shape::Disc(Disc::new(DVec3::ZERO, axis, 3.0))
        .bounds()
        .unwrap();
    let expected = DVec3::new(8f64.sqrt(), 5f64.sqrt(), 5f64.sqrt());
    assert!((disc.max - expected).length() < 1e-13, "{disc:?}");
    let tube = Cylinder::new(DVec3::ZERO, axis * 6.0, 3.0, true);
    assert!((tube.bounds().unwrap().max - (expected + axis * 6.0)).length() < 1e-13);
    assert!((tube.bounding_sphere().unwrap().radius - 18f64.sqrt()).abs() < 1e-13);
    // A squashed and turned sphere: an ellipsoid's exact box.
    let map = DAffine3::from_quat(DQuat::from_rotation_z(0.7))
        * DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0));
    let world = scenes::single(
        Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)),
        Transform::new(map),
    );
    let (s, c) = 0.7f64.sin_cos();
    let expected = DVec3::new(
        (4.0 * c * c + s * s).sqrt(),
        (4.0 * s * s + c * c).sqrt(),
        1.0,
    );
    assert!((world.instance_bounds(0).unwrap().max - expected).length() < 1e-13);
    assert!((world.instance_sphere(0).unwrap().radius - 2.0).abs() < 1e-13);
}

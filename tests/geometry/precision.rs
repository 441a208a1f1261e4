//! The error that a hit states really bounds its distance from the surface.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use nephroid::{
    geometry::{
        Ray, Shape, SurfacePoint, Transform, TriangleMesh, World,
        shape::{Cylinder, Disc, Plane, Quad, Sphere, Triangle},
    },
    numeric::Frame,
};
use proptest::prelude::*;

use crate::{
    exact::{Dd, Vec3Dd, add, cross, dot, length, sub, vec},
    scenes::{Random, single},
};

/// A shape as it was asked for, and its signed distance to a point (to first
/// order) in 32 digits.
struct Case {
    shape: Shape,
    distance: Box<dyn Fn(Vec3Dd, u32) -> Dd>,
}

fn case(random: &mut Random, kind: u64, at: DVec3, size: f64) -> Case {
    let frame = Frame::around(random.direction());
    let r = random.range(0.2, 1.0) * size;
    let (u, v) = (
        frame.s * size,
        frame.t * r + frame.s * random.range(-0.7, 0.7) * size,
    );
    let flat = move |origin: DVec3, normal: Vec3Dd| -> Box<dyn Fn(Vec3Dd, u32) -> Dd> {
        Box::new(move |p, _| dot(sub(p, vec(origin)), normal) / length(normal))
    };
    match kind % 6 {
        0 => Case {
            shape: Shape::Plane(Plane::new(at, frame.n * 3.0)),
            distance: flat(at, vec(frame.n * 3.0)),
        },
        1 => Case {
            shape: Shape::Disc(Disc::new(at, frame.n * 0.7, r)),
            distance: flat(at, vec(frame.n * 0.7)),
        },
        2 => Case {
            shape: Shape::Quad(Quad::new(at, u, v)),
            distance: flat(at, cross(vec(u), vec(v))),
        },
        3 => {
            let (b, c) = (at + u, at + v);
            let normal = cross(sub(vec(b), vec(at)), sub(vec(c), vec(at)));
            let shape = if random.below(2) == 0 {
                Shape::Triangle(Triangle::new(at, b, c))
            } else {
                let mesh = TriangleMesh::new(vec![at, b, c], None, vec![[0, 1, 2]]).unwrap();
                Shape::Mesh(Arc::new(mesh))
            };
            Case {
                shape,
                distance: flat(at, normal),
            }
        }
        4 => Case {
            shape: Shape::Sphere(Sphere::new(at, r)),
            distance: Box::new(move |p, _| length(sub(p, vec(at))) - Dd::of(r)),
        },
        _ => cylinder(at, at + random.direction() * size, r),
    }
}

fn cylinder(base: DVec3, end: DVec3, r: f64) -> Case {
    let axis = sub(vec(end), vec(base));
    let distance = move |p: Vec3Dd, part: u32| match part {
        0 => length(cross(sub(p, vec(base)), axis)) / length(axis) - Dd::of(r),
        1 => dot(sub(p, vec(base)), axis) / length(axis),
        _ => dot(sub(p, vec(end)), axis) / length(axis),
    };
    Case {
        shape: Shape::Cylinder(Cylinder::new(base, end, r, true)),
        distance: Box::new(distance),
    }
}

/// Random rays towards `center`; yields the hits' points.
fn points(
    random: &mut Random,
    world: &World,
    center: DVec3,
    size: f64,
    count: usize,
) -> Vec<(Ray, f64, SurfacePoint)> {
    let mut found = Vec::new();
    for _ in 0..count {
        let far = if random.below(4) == 0 { 1e4 } else { 3.0 };
        let origin = center + random.direction() * size * far;
        let dir = (center + random.vector(0.8) * size - origin).normalize();
        let ray = Ray::new(origin, dir);
        if let Some(hit) = world.closest(&ray, f64::INFINITY) {
            found.push((ray, hit.t, world.surface(&ray, &hit)));
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn stated_errors_hold(seed: u64, kind in 0u64..6, exponent in -8.0..8.0f64, away in 0u32..6) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let at = random.direction() * size * if away == 0 { 0.0 } else { libm::exp10(f64::from(away) - 1.0) };
        let case = case(&mut random, kind, at, size);
        let world = single(case.shape.clone(), None);
        for (ray, t, point) in points(&mut random, &world, at, size, 40) {
            let off = (case.distance)(vec(point.p), point.surface.part).round();
            // Along the normal; an axis sees at most its largest component.
            let along = off.abs() * point.ng.abs().max_element();
            prop_assert!(along <= point.error, "{:?}: off by {along:e}, stated {:e}", case.shape, point.error);
            // The bound is of use only if it is small.
            let reach = at.length() + 4.0 * size + (point.p - at).length();
            prop_assert!(point.error <= 1e-14 * reach, "{:e} for a reach of {reach}", point.error);
            // The point is where the ray says, up to the ray's own rounding.
            let cosine = point.ng.dot(ray.dir).abs();
            let apart = (point.p - ray.at(t)).length();
            prop_assert!(apart * cosine <= 1e-14 * (t + reach), "apart by {apart:e} at cosine {cosine}");
            prop_assert!((point.ng.length() - 1.0).abs() < 1e-14 && point.ns.dot(point.ng) > 0.0);
        }
    }

    /// The same under a transform: the point is sent back in 32 digits.
    #[test]
    fn stated_errors_hold_under_transforms(seed: u64, kind in 0u64..6, away in 0u32..6) {
        let mut random = Random(seed);
        let at = random.vector(3.0);
        let case = case(&mut random, kind, at, 1.0);
        let scale = DVec3::new(random.range(0.1, 4.0), -random.range(0.1, 4.0), random.range(0.1, 4.0));
        let map = DAffine3::from_scale_rotation_translation(
            scale,
            random.rotation(),
            random.direction() * libm::exp10(f64::from(away)),
        ) * DAffine3::from_quat(random.rotation());
        let transform = Transform::new(map).unwrap();
        let world = single(case.shape.clone(), Some(transform));
        for (_, _, point) in points(&mut random, &world, transform.point(at), 1.0, 40) {
            let (own, gradient) = back(&map, vec(point.p), vec(transform.inverse_normal(point.ng)));
            let off = (case.distance)(own, point.surface.part).round() / gradient;
            let along = off.abs() * point.ng.abs().max_element();
            prop_assert!(along <= point.error, "{:?}: off by {along:e}, stated {:e}", case.shape, point.error);
            let reach = map.translation.length() + 100.0 + point.p.length();
            prop_assert!(point.error <= 1e-13 * reach, "{:e} for a reach of {reach}", point.error);
        }
    }
}

/// The object point of `p`, and the length of a unit object normal mapped to
/// the world's gradient: object distance over that is world distance.
fn back(map: &DAffine3, p: Vec3Dd, normal: Vec3Dd) -> (Vec3Dd, f64) {
    let DMat3 {
        x_axis: x,
        y_axis: y,
        z_axis: z,
    } = map.matrix3;
    let (x, y, z) = (vec(x), vec(y), vec(z));
    let det = dot(x, cross(y, z));
    let rows = [cross(y, z), cross(z, x), cross(x, y)].map(|r| r.map(|c| c / det));
    let from = sub(p, vec(map.translation));
    let own = rows.map(|r| dot(r, from));
    let gradient = (0..3).fold(vec(DVec3::ZERO), |g, i| {
        add(g, rows[i].map(|c| c * normal[i]))
    });
    (own, length(gradient).round())
}

/// A sphere seen from 1e5 radii: position, and hit or miss at the limb.
#[test]
fn sphere_from_afar() {
    let world = single(Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)), None);
    let mut random = Random(31);
    for _ in 0..20_000 {
        let b = random.range(-1.2, 1.2);
        let ray = Ray::new(DVec3::new(-1e5, b, 0.0), DVec3::X);
        let hit = world.closest(&ray, f64::INFINITY);
        assert_eq!(hit.is_some(), b.abs() < 1.0, "impact parameter {b}");
        let Some(hit) = hit else { continue };
        let p = world.surface(&ray, &hit).p;
        let depth = ((1.0 - b) * (1.0 + b)).sqrt();
        // The ray's own coordinates round at 1e5; the slope magnifies.
        assert!((p.y - b).abs() <= 1e-10, "{p} for {b}");
        assert!((p.x + depth).abs() * depth <= 1e-10, "{p} for {b}");
    }
}

/// A tube hit from afar, nearly along its axis.
#[test]
fn cylinder_at_grazing_incidence() {
    let world = single(
        Shape::Cylinder(Cylinder::new(DVec3::ZERO, DVec3::Z, 1.0, false)),
        None,
    );
    let mut random = Random(32);
    for _ in 0..20_000 {
        // Into the tube's mouth, against the inside of the wall.
        let slope = libm::exp10(random.range(-6.0, -0.5));
        let z = random.range(0.05, 0.95);
        let back = random.range(2.0, 100.0).min(1.9 / slope);
        let (s, c) = random.range(0.0, std::f64::consts::TAU).sin_cos();
        let out = DVec3::new(c, s, 0.0);
        let dir = DVec3::new(c * slope, s * slope, 1.0).normalize();
        let origin = out * (1.0 - back * slope) + DVec3::Z * (z - back);
        let ray = Ray::new(origin, dir);
        let hit = world.closest(&ray, f64::INFINITY).expect("meets the wall");
        let point = world.surface(&ray, &hit);
        assert!(
            (point.p.z - z).abs() <= 1e-13 * back / slope,
            "{} for {z}, slope {slope:e}",
            point.p.z
        );
        assert!(
            point.ng.dot(out) > 0.999_999,
            "the normal points away from the axis"
        );
    }
}

//! The error that a hit states really bounds its distance from the surface.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use nephroid::{
    geometry::{
        Aabb, Ray, Shape, SurfacePoint, Transform, TriangleMesh, World,
        shape::{
            Conic, Cuboid, Cylinder, Disc, Ellipsoid, Plane, Quad, Quadric, Sphere, Torus, Triangle,
        },
    },
    numeric::Frame,
};
use proptest::prelude::*;

use crate::{
    exact::{Dd, Vec3Dd, add, cross, dot, length, sub, vec},
    scenes::{Random, single},
};

/// How many kinds of shapes there are.
const KINDS: u64 = 13;

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
    match kind {
        6..=8 => conic(random, kind, at, size),
        9 => ellipsoid(random, at, size),
        10 => torus(random, at, size),
        11 => quadric(random, at, size),
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
        5 => cylinder(at, at + random.direction() * size, r),
        _ => {
            let bounds = Aabb {
                min: at - DVec3::splat(r),
                max: at + DVec3::new(0.3, 0.5, 1.0) * size,
            };
            let face = move |p: Vec3Dd, part: u32| {
                let axis = part as usize / 2;
                let sides = [bounds.min[axis], bounds.max[axis]];
                p[axis] - Dd::of(sides[part as usize % 2])
            };
            Case {
                shape: Shape::Cuboid(Cuboid::new(bounds)),
                distance: Box::new(face),
            }
        }
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

/// A frustum or cone (6), paraboloid (7) or hyperboloid (8), capped.
fn conic(random: &mut Random, kind: u64, at: DVec3, size: f64) -> Case {
    let end = at + random.direction() * random.range(0.4, 1.5) * size;
    let r = random.range(0.4, 1.0) * size;
    let top = if random.below(2) == 0 {
        0.0
    } else {
        random.range(0.3, 1.0) * size
    };
    let [top, waist] = match kind {
        6 => [top, 0.0],
        7 => [0.0, 0.0],
        _ => [r, random.range(0.1, 0.9) * r],
    };
    let shape = match kind {
        6 => Conic::cone(at, end, [r, top], true),
        7 => Conic::paraboloid(at, end, r, true),
        _ => Conic::hyperboloid(at, end, [r, r], waist, true),
    };
    let axis = sub(vec(end), vec(at));
    let [r, top, waist] = [r, top, waist].map(Dd::of);
    let two = Dd::of(2.0);
    let distance = move |p: Vec3Dd, part: u32| {
        let long = length(axis);
        let from = sub(p, vec(at));
        let z = dot(from, axis) / long;
        let across = length(cross(from, axis)) / long;
        // Squared radius and half its derivative.
        let (square, half) = match kind {
            6 => {
                let slope = (top - r) / long;
                let radius = r + slope * z;
                (radius * radius, radius * slope)
            }
            7 => (r * r * (long - z) / long, Dd::of(-0.5) * r * r / long),
            _ => {
                let k = two * two * (r * r - waist * waist) / (long * long);
                let w = z - long / two;
                (waist * waist + k * w * w, k * w)
            }
        };
        match part {
            0 => {
                let gradient = (across * across + half * half).sqrt();
                (across * across - square) / (two * gradient)
            }
            1 => z,
            _ => z - long,
        }
    };
    Case {
        shape: Shape::Conic(shape),
        distance: Box::new(distance),
    }
}

fn ellipsoid(random: &mut Random, at: DVec3, size: f64) -> Case {
    let axes = DVec3::from_array([0; 3].map(|_| libm::exp10(random.range(-1.5, 0.0)) * size));
    let turn = DMat3::from_quat(random.rotation());
    let columns = [
        turn.x_axis * axes.x,
        turn.y_axis * axes.y,
        turn.z_axis * axes.z,
    ];
    let map = DAffine3 {
        matrix3: DMat3::from_cols(columns[0], columns[1], columns[2]),
        translation: at,
    };
    let distance = move |p: Vec3Dd, _: u32| {
        // To first order, from the unit sphere.
        let (own, _) = back(&map, p, vec(DVec3::X));
        let radius = length(own);
        let unit = own.map(|c| c / radius);
        let (_, gradient) = back(&map, p, unit);
        (radius - Dd::of(1.0)) / Dd::of(gradient)
    };
    Case {
        shape: Shape::Ellipsoid(Arc::new(Ellipsoid::new(at, axes, turn).expect("regular"))),
        distance: Box::new(distance),
    }
}

fn torus(random: &mut Random, at: DVec3, size: f64) -> Case {
    let axis = random.direction() * 1.7;
    let minor = libm::exp10(random.range(-3.0, -0.1)) * size;
    let distance = move |p: Vec3Dd, _: u32| {
        let from = sub(p, vec(at));
        let long = length(vec(axis));
        let z = dot(from, vec(axis)) / long;
        let out = length(cross(from, vec(axis))) / long - Dd::of(size);
        (out * out + z * z).sqrt() - Dd::of(minor)
    };
    Case {
        shape: Shape::Torus(Torus::new(at, axis, size, minor)),
        distance: Box::new(distance),
    }
}

/// A round quadric, which exists in a part of its box only.
fn quadric(random: &mut Random, at: DVec3, size: f64) -> Case {
    let mut c = [0.0; 10].map(|_: f64| random.range(-0.3, 0.3));
    for c in &mut c[..3] {
        *c += 1.5;
    }
    // About `at`, and then about the origin: rounded, as a user would.
    let [x, y, z] = at.to_array();
    let linear = [6, 7, 8].map(|i| c[i] * size);
    c[9] = -size * size;
    c[9] += c[0] * x * x + c[1] * y * y + c[2] * z * z + c[3] * x * y + c[4] * y * z + c[5] * x * z
        - linear[0] * x
        - linear[1] * y
        - linear[2] * z;
    c[6] = linear[0] - 2.0 * c[0] * x - c[3] * y - c[5] * z;
    c[7] = linear[1] - 2.0 * c[1] * y - c[3] * x - c[4] * z;
    c[8] = linear[2] - 2.0 * c[2] * z - c[4] * y - c[5] * x;
    let bounds = Aabb {
        min: at - DVec3::splat(2.0 * size),
        max: at + DVec3::splat(0.3 * size),
    };
    let distance = move |p: Vec3Dd, _: u32| {
        let [x, y, z] = p;
        let c = c.map(Dd::of);
        let two = Dd::of(2.0);
        let value = c[0] * x * x
            + c[1] * y * y
            + c[2] * z * z
            + c[3] * x * y
            + c[4] * y * z
            + c[5] * x * z
            + c[6] * x
            + c[7] * y
            + c[8] * z
            + c[9];
        let gradient = [
            two * c[0] * x + c[3] * y + c[5] * z + c[6],
            two * c[1] * y + c[3] * x + c[4] * z + c[7],
            two * c[2] * z + c[4] * y + c[5] * x + c[8],
        ];
        value / length(gradient)
    };
    Case {
        shape: Shape::Quadric(Arc::new(Quadric::new(&c, bounds, true))),
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
    fn stated_errors_hold(seed: u64, kind in 0u64..KINDS, exponent in -8.0..8.0f64, away in 0u32..6) {
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
    fn stated_errors_hold_under_transforms(seed: u64, kind in 0u64..KINDS, away in 0u32..6) {
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

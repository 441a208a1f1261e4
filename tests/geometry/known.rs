//! Closed shapes beside what they are: how far a place is outside of them, by
//! formulas that know nothing of rays.

use glam::{DMat3, DVec3};
use nephroid::geometry::{
    Aabb, Shape,
    shape::{Body, Conic, Cuboid, Cylinder, Ellipsoid, Quadric, Solid, Sphere, Torus},
};
use std::sync::Arc;

use crate::scenes::{Random, instance};

/// A shape, and a function that is negative inside, positive outside, and near
/// the surface about as large as the distance from it.
pub(crate) struct Known {
    pub(crate) name: &'static str,
    pub(crate) shape: Shape,
    pub(crate) level: Box<dyn Fn(DVec3) -> f64>,
}

/// The kinds that [`known`] makes.
pub(crate) const KIND_NAMES: [&str; 11] = [
    "cone",
    "frustum",
    "paraboloid",
    "ellipsoid",
    "box",
    "quadric in a box",
    "two spheres",
    "hyperboloid",
    "torus",
    "thin torus",
    "drilled ball",
];
/// How many these are.
pub(crate) const KINDS: u64 = KIND_NAMES.len() as u64;
/// So many of these, the first ones, are convex.
pub(crate) const CONVEX: u64 = 7;

fn heights(base: DVec3, end: DVec3, p: DVec3) -> (f64, f64, f64) {
    let axis = (end - base).normalize();
    let z = axis.dot(p - base);
    ((p - base - axis * z).length(), z, (end - base).length())
}

/// A shape between two planes that is narrower than `radius(z)` at height `z`.
fn turned(
    name: &'static str,
    conic: Conic,
    [base, end]: [DVec3; 2],
    radius: impl Fn(f64) -> f64 + 'static,
) -> Known {
    let level = move |p: DVec3| {
        let (across, z, length) = heights(base, end, p);
        let r = radius(z.clamp(0.0, length));
        (across - r).max(-z).max(z - length)
    };
    Known {
        name,
        shape: Shape::Conic(conic),
        level: Box::new(level),
    }
}

/// A closed shape of about the given size around `at`; the kind counts modulo
/// [`KINDS`].
pub(crate) fn known(random: &mut Random, kind: u64, at: DVec3, size: f64) -> Known {
    let end = at + random.direction() * random.range(0.4, 1.5) * size;
    let r = random.range(0.5, 1.0) * size;
    let length = (end - at).length();
    match kind % KINDS {
        0 => {
            let conic = Conic::cone(at, end, [r, 0.0], true);
            turned("cone", conic, [at, end], move |z| r * (1.0 - z / length))
        }
        1 => {
            let top = random.range(0.2, 1.2) * size;
            let conic = Conic::cone(at, end, [r, top], true);
            turned("frustum", conic, [at, end], move |z| {
                r + (top - r) * z / length
            })
        }
        2 => {
            let conic = Conic::paraboloid(at, end, r, true);
            turned("paraboloid", conic, [at, end], move |z| {
                r * (1.0 - z / length).sqrt()
            })
        }
        3 => ellipsoid(random, at, size),
        4 => cuboid(random, at, size),
        5 => quadric(random, at, size),
        6 => {
            let middle = [at, at + (end - at) * (0.7 * r / length)];
            let [a, b] = middle;
            let list = [a, b].map(|c| instance(Shape::Sphere(Sphere::new(c, r))));
            let solid = Solid::new(Body::Intersection(list.into())).expect("they overlap");
            Known {
                name: "two spheres",
                shape: Shape::Solid(Arc::new(solid)),
                level: Box::new(move |p| (p.distance(a) - r).max(p.distance(b) - r)),
            }
        }
        7 => {
            let waist = random.range(0.2, 0.95) * r;
            let conic = Conic::hyperboloid(at, end, [r, r], waist, true);
            let k = 4.0 * (r * r - waist * waist) / (length * length);
            turned("hyperboloid", conic, [at, end], move |z| {
                (waist * waist + k * (z - 0.5 * length) * (z - 0.5 * length)).sqrt()
            })
        }
        8 | 9 => torus(random, at, size, if kind % KINDS == 9 { 0.02 } else { 0.6 }),
        _ => drilled(random, at, size),
    }
}

fn ellipsoid(random: &mut Random, at: DVec3, size: f64) -> Known {
    let axes = DVec3::from_array([0; 3].map(|_| random.range(0.4, 1.0) * size));
    let turn = DMat3::from_quat(random.rotation());
    let level = move |p: DVec3| {
        let x = (turn.transpose() * (p - at)) / axes;
        (x.length() - 1.0) * axes.min_element()
    };
    Known {
        name: "ellipsoid",
        shape: Shape::Ellipsoid(Arc::new(Ellipsoid::new(at, axes, turn).expect("regular"))),
        level: Box::new(level),
    }
}

fn cuboid(random: &mut Random, at: DVec3, size: f64) -> Known {
    let half = DVec3::from_array([0; 3].map(|_| random.range(0.3, 1.0) * size));
    Known {
        name: "box",
        shape: Shape::Cuboid(Cuboid::new(Aabb {
            min: at - half,
            max: at + half,
        })),
        level: Box::new(move |p| ((p - at).abs() - half).max_element()),
    }
}

/// A round quadric within a box that cuts it.
fn quadric(random: &mut Random, at: DVec3, size: f64) -> Known {
    let [a, b, c] = [0; 3].map(|_| random.range(0.5, 1.5));
    let [x, y, z] = at.to_array();
    let coefficients = [
        a,
        b,
        c,
        0.0,
        0.0,
        0.0,
        -2.0 * a * x,
        -2.0 * b * y,
        -2.0 * c * z,
        a * x * x + b * y * y + c * z * z - size * size,
    ];
    let bounds = Aabb {
        min: at - DVec3::splat(0.8 * size),
        max: at + DVec3::new(0.6, 0.9, 2.0) * size,
    };
    let parts = [
        Shape::Quadric(Arc::new(Quadric::new(&coefficients, bounds, false))),
        Shape::Cuboid(Cuboid::new(bounds)),
    ];
    let solid = Solid::new(Body::Intersection(parts.map(instance).into())).expect("bounded");
    let level = move |p: DVec3| {
        let x = p - at;
        let round = (a * x.x * x.x + b * x.y * x.y + c * x.z * x.z - size * size) / (3.0 * size);
        let cut = (bounds.min - p).max(p - bounds.max).max_element();
        round.max(cut)
    };
    Known {
        name: "quadric in a box",
        shape: Shape::Solid(Arc::new(solid)),
        level: Box::new(level),
    }
}

fn torus(random: &mut Random, at: DVec3, size: f64, thickest: f64) -> Known {
    let axis = random.direction();
    let minor = random.range(0.3, 1.0) * thickest * size;
    let level = move |p: DVec3| {
        let z = axis.dot(p - at);
        let out = (p - at - axis * z).length() - size;
        (out * out + z * z).sqrt() - minor
    };
    Known {
        name: "torus",
        shape: Shape::Torus(Torus::new(at, axis, size, minor)),
        level: Box::new(level),
    }
}

/// A ball with a hole and a piece cut off.
fn drilled(random: &mut Random, at: DVec3, size: f64) -> Known {
    let axis = random.direction();
    let r = random.range(0.2, 0.5) * size;
    let corner = at + random.vector(0.3) * size;
    let far = at + DVec3::splat(3.0 * size);
    let hole = Cylinder::new(at - axis * 2.0 * size, at + axis * 2.0 * size, r, true);
    let cut = Cuboid::new(Aabb {
        min: corner,
        max: far,
    });
    let parts = [
        Shape::Sphere(Sphere::new(at, size)),
        Shape::Cylinder(hole),
        Shape::Cuboid(cut),
    ];
    let solid = Solid::new(Body::Difference(parts.map(instance).into())).expect("bounded");
    let level = move |p: DVec3| {
        let z = axis.dot(p - at);
        let hole = (p - at - axis * z).length() - r;
        let piece = (corner - p).max(p - far).max_element();
        (p.distance(at) - size).max(-hole).max(-piece)
    };
    Known {
        name: "drilled ball",
        shape: Shape::Solid(Arc::new(solid)),
        level: Box::new(level),
    }
}

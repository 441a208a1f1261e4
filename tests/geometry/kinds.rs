//! Random surfaces of every kind beside what they are by their own numbers,
//! for hunts in which polynomials of 32 digits judge.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use nephroid::{
    geometry::{
        Aabb, Shape,
        shape::{Body, Conic, Cuboid, Cylinder, Ellipsoid, Quadric, Solid, Sphere, Torus},
    },
    numeric::gamma,
};

use crate::{
    composed::{compose, implicit},
    exact::{Dd, Vec3Dd, cross, dot, vec},
    field::{Field, Term, across, between, from, half_space, square},
    scenes::{Random, instance},
    truth::{Tree, Truth},
};

/// The kinds that [`kind`] makes.
pub(crate) const KIND_NAMES: [&str; 25] = [
    "sphere",
    "cylinder",
    "tube",
    "cone",
    "frustum",
    "open cone",
    "paraboloid",
    "open paraboloid",
    "hyperboloid",
    "open hyperboloid",
    "ellipsoid",
    "flat ellipsoid",
    "box",
    "quadric, open",
    "quadric in a box",
    "torus",
    "thin torus",
    "lens",
    "union",
    "drilled ball",
    "nested solid",
    "formula: sphere",
    "formula: ellipsoid",
    "formula: torus",
    "formula: tanglecube",
];

/// Roundings of the numbers of a simple shape and of its crossings, over its
/// size.
fn simple() -> [f64; 2] {
    [0.0, gamma(32)]
}

/// The same of a solid: crossings count as one within its own rounding.
fn composed() -> [f64; 2] {
    [gamma(48), gamma(64)]
}

pub(crate) fn one(x: f64) -> Dd {
    Dd::of(x)
}

pub(crate) fn square_of<'a>(x: f64) -> Term<'a> {
    Term::constant(one(x) * one(x))
}

/// The field of a sphere.
pub(crate) fn ball(center: DVec3, radius: f64) -> Field {
    Field::of(move |x| square(&from(x, center)) - square_of(radius))
}

/// Between two points on an axis: how far across and along, the latter from 0
/// to 1, by a function of the two that is below zero inside; then the planes
/// at both ends.
pub(crate) fn turned(
    base: DVec3,
    end: DVec3,
    side: impl for<'a> FnOnce(Term<'a>, Term<'a>) -> Term<'a>,
) -> Vec<Field> {
    let axis = between(base, end);
    let back = axis.map(|a| one(0.0) - a);
    let length2 = dot(axis, axis);
    let side = Field::of(move |x| {
        let x = from(x, base);
        let s = across(&x, axis).times(one(1.0) / length2);
        let z2 = s.squared().times(length2);
        side(square(&x) - z2, s)
    });
    vec![side, half_space(base, back), half_space(end, axis)]
}

pub(crate) fn constant<'a>(x: f64) -> Term<'a> {
    Term::constant(one(x))
}

/// The six faces of a box.
pub(crate) fn faces(b: Aabb) -> Vec<Field> {
    let face = |i: usize| {
        let normal = DVec3::AXES[i / 2] * if i.is_multiple_of(2) { -1.0 } else { 1.0 };
        half_space(if i.is_multiple_of(2) { b.min } else { b.max }, vec(normal))
    };
    (0..6).map(face).collect()
}

pub(crate) fn torus_field(center: DVec3, axis: DVec3, major: f64, minor: f64) -> Field {
    let axis = vec(axis);
    let length2 = dot(axis, axis);
    let (r2, s2) = (one(major) * one(major), one(minor) * one(minor));
    Field::of(move |x| {
        let x = from(x, center);
        let all = square(&x);
        let z2 = across(&x, axis).squared().times(one(1.0) / length2);
        (all + Term::constant(r2 - s2)).squared() - (all - z2).times(one(4.0) * r2)
    })
}

/// All fields from a number on, each below zero.
pub(crate) fn all_from(first: usize, count: usize) -> Tree {
    Tree::All((first..first + count).map(Tree::Below).collect())
}

/// A closed shape of fields that are all below zero inside.
pub(crate) fn closed(shape: Shape, fields: Vec<Field>, size: f64) -> (Shape, Truth) {
    let tree = all_from(0, fields.len());
    let truth = Truth {
        fields,
        tree,
        open: false,
        slack: simple(),
        size,
    };
    (shape, truth)
}

/// A surface where the first field is zero, within the others.
fn opened(shape: Shape, fields: Vec<Field>, size: f64) -> (Shape, Truth) {
    let tree = all_from(1, fields.len() - 1);
    let truth = Truth {
        fields,
        tree,
        open: true,
        slack: simple(),
        size,
    };
    (shape, truth)
}

pub(crate) fn solid(body: Body, fields: Vec<Field>, tree: Tree, size: f64) -> (Shape, Truth) {
    let shape = Shape::Solid(Arc::new(Solid::new(body).expect("bounded")));
    let truth = Truth {
        fields,
        tree,
        open: false,
        slack: composed(),
        size,
    };
    (shape, truth)
}

/// A surface of a kind, of about the given size around `at`.
pub(crate) fn kind(random: &mut Random, name: &str, at: DVec3, size: f64) -> (Shape, Truth) {
    let end = at + random.direction() * random.range(0.4, 1.5) * size;
    let r = random.range(0.5, 1.0) * size;
    let reach = 4.0 * size;
    match name {
        "sphere" => closed(Shape::Sphere(Sphere::new(at, r)), vec![ball(at, r)], reach),
        "cylinder" | "tube" => {
            let capped = name == "cylinder";
            let shape = Shape::Cylinder(Cylinder::new(at, end, r, capped));
            let fields = turned(at, end, move |across2, _| across2 - square_of(r));
            bounded(shape, capped, fields, reach)
        }
        "cone" | "frustum" | "open cone" => {
            let top = if name == "frustum" {
                random.range(0.2, 1.2) * size
            } else {
                0.0
            };
            let capped = name != "open cone";
            let shape = Shape::Conic(Conic::cone(at, end, [r, top], capped));
            let fields = turned(at, end, move |across2, s| {
                across2 - (constant(r) + s.times(one(top) - one(r))).squared()
            });
            bounded(shape, capped, fields, reach)
        }
        "paraboloid" | "open paraboloid" => {
            let capped = name == "paraboloid";
            let shape = Shape::Conic(Conic::paraboloid(at, end, r, capped));
            let fields = turned(at, end, move |across2, s| {
                across2 - (constant(1.0) - s).times(one(r) * one(r))
            });
            bounded(shape, capped, fields, reach)
        }
        "hyperboloid" | "open hyperboloid" => {
            let waist = random.range(0.2, 0.95) * r;
            let top = random.range(1.0, 1.5) * r;
            let capped = name == "hyperboloid";
            let shape = Shape::Conic(Conic::hyperboloid(at, end, [r, top], waist, capped));
            let w2 = one(waist) * one(waist);
            let [a, b] = [r, top].map(|r| (one(r) * one(r) - w2).sqrt());
            let fields = turned(at, end, move |across2, s| {
                across2 - Term::constant(w2) - (s.times(a + b) - Term::constant(a)).squared()
            });
            bounded(shape, capped, fields, reach)
        }
        "ellipsoid" => ellipsoid(random, at, size, 0.4),
        "flat ellipsoid" => ellipsoid(random, at, size, 1e-3),
        "box" => {
            let b = cuboid(random, at, size);
            closed(Shape::Cuboid(Cuboid::new(b)), faces(b), reach)
        }
        "quadric, open" | "quadric in a box" => quadric(random, name, at, size),
        "torus" | "thin torus" => {
            let axis = random.direction();
            let thickest = if name == "torus" { 0.9 } else { 0.02 };
            let minor = random.range(0.3, 1.0) * thickest * size;
            let shape = Shape::Torus(Torus::new(at, axis, size, minor));
            closed(shape, vec![torus_field(at, axis, size, minor)], reach)
        }
        formula if formula.starts_with("formula") => implicit(random, formula, at, size),
        composed => compose(random, composed, at, size),
    }
}

fn bounded(shape: Shape, capped: bool, fields: Vec<Field>, size: f64) -> (Shape, Truth) {
    if capped {
        closed(shape, fields, size)
    } else {
        opened(shape, fields, size)
    }
}

pub(crate) fn cuboid(random: &mut Random, at: DVec3, size: f64) -> Aabb {
    let [a, b] = [0; 2].map(|_| DVec3::from_array([0; 3].map(|_| random.range(0.3, 1.0) * size)));
    Aabb {
        min: at - a,
        max: at + b,
    }
}

fn ellipsoid(random: &mut Random, at: DVec3, size: f64, least: f64) -> (Shape, Truth) {
    let axes = DVec3::from_array([0; 3].map(|_| random.range(least, 1.0) * size));
    let axes = if least < 0.1 {
        axes.with_z(least * size)
    } else {
        axes
    };
    let turn = DMat3::from_quat(random.rotation());
    let shape = Shape::Ellipsoid(Arc::new(Ellipsoid::new(at, axes, turn).expect("regular")));
    // The inverse of the map from the unit sphere: its columns' cross products
    // over their volume.
    let columns: [Vec3Dd; 3] = std::array::from_fn(|i| vec(turn.col(i)).map(|x| x * one(axes[i])));
    let volume = dot(columns[0], cross(columns[1], columns[2]));
    let rows: [Vec3Dd; 3] = std::array::from_fn(|i| {
        cross(columns[(i + 1) % 3], columns[(i + 2) % 3]).map(|x| x / volume)
    });
    let field = Field::of(move |x| {
        let x = from(x, at);
        square(&rows.map(|row| across(&x, row))) - constant(1.0)
    });
    closed(shape, vec![field], 4.0 * size)
}

/// A quadric by its coefficients, as they are written.
fn quadric(random: &mut Random, name: &str, at: DVec3, size: f64) -> (Shape, Truth) {
    let open = name == "quadric, open";
    let [a, b, c] = [0; 3].map(|_| random.range(0.5, 1.5));
    let [x, y, z] = at.to_array();
    let bounds = Aabb {
        min: at - DVec3::splat(0.8 * size),
        max: at + DVec3::new(0.6, 0.9, 2.0) * size,
    };
    let (a, b, c, d) = if open {
        // A saddle or a bowl.
        let tilt = random.range(-1.0, 1.0);
        (a, random.range(-1.0, 1.0), 0.0, tilt)
    } else {
        (a, b, c, 0.0)
    };
    let lift = if open { size } else { 0.0 };
    let coefficients = [
        a,
        b,
        c,
        d,
        0.0,
        0.0,
        -2.0 * a * x - d * y,
        -2.0 * b * y - d * x,
        -2.0 * c * z - lift,
        a * x * x + b * y * y + c * z * z + d * x * y + lift * z
            - if open { 0.0 } else { size * size },
    ];
    let q = coefficients;
    let field = Field::of(move |x| {
        let products = [
            x[0] * x[0],
            x[1] * x[1],
            x[2] * x[2],
            x[0] * x[1],
            x[1] * x[2],
            x[0] * x[2],
            x[0],
            x[1],
            x[2],
        ];
        let terms = products.iter().zip(q).map(|(&p, c)| p.times(one(c)));
        terms.fold(constant(q[9]), |sum, term| sum + term)
    });
    let mut fields = vec![field];
    fields.extend(faces(bounds));
    let quadric = Shape::Quadric(Arc::new(Quadric::new(&coefficients, bounds, open)));
    if open {
        return opened(quadric, fields, 4.0 * size);
    }
    let parts = [quadric, Shape::Cuboid(Cuboid::new(bounds))];
    let body = Body::Intersection(parts.map(instance).into());
    solid(body, fields, all_from(0, 7), 4.0 * size)
}

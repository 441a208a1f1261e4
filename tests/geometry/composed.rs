//! Solids of several shapes and surfaces of formulas, beside what they are.

use std::sync::Arc;

use glam::DVec3;
use nephroid::{
    formula::Formula,
    geometry::{
        Aabb, Shape,
        shape::{Body, Cuboid, Cylinder, Implicit, RootFinder, Sphere, Torus, implicit::TOLERANCE},
    },
    numeric::Frame,
};

use crate::{
    field::{Field, Term, from},
    kinds::{all_from, ball, closed, cuboid, faces, one, solid, square_of, torus_field, turned},
    scenes::{Random, instance},
    truth::{Tree, Truth},
};

fn not(tree: Tree) -> Tree {
    Tree::Not(Box::new(tree))
}

/// Solids of several shapes.
pub(crate) fn compose(random: &mut Random, name: &str, at: DVec3, size: f64) -> (Shape, Truth) {
    let axis = random.direction();
    let reach = 6.0 * size;
    let aside = random.direction() * 0.5 * size;
    let b = cuboid(random, at + aside, size);
    let hole = random.range(0.2, 0.5) * size;
    let ends = [at - axis * 2.0 * size, at + axis * 2.0 * size];
    let rod = Shape::Cylinder(Cylinder::new(ends[0], ends[1], hole, true));
    let mut rod_fields = turned(ends[0], ends[1], move |across2, _| {
        across2 - square_of(hole)
    });
    let sphere = Shape::Sphere(Sphere::new(at, size));
    let block = Shape::Cuboid(Cuboid::new(b));
    let mut fields = vec![ball(at, size)];
    match name {
        // Two spherical faces and an edge.
        "lens" => {
            let radii = [0; 2].map(|_| random.range(1.1, 3.0) * size);
            let thick = random.range(0.1, 0.5) * size;
            let side = if random.below(2) == 0 { 1.0 } else { -1.0 };
            let centers = [
                at + axis * (radii[0] - thick),
                at + axis * (thick - side * radii[1]),
            ];
            let [a, c] = [0, 1].map(|i| instance(Shape::Sphere(Sphere::new(centers[i], radii[i]))));
            let edge = Cylinder::new(at - axis * size, at + axis * size, size, true);
            let edge = instance(Shape::Cylinder(edge));
            fields = vec![ball(centers[0], radii[0]), ball(centers[1], radii[1])];
            fields.extend(turned(
                at - axis * size,
                at + axis * size,
                move |across2, _| across2 - square_of(size),
            ));
            let second = if side > 0.0 {
                Tree::Below(1)
            } else {
                not(Tree::Below(1))
            };
            let tree = Tree::All(vec![Tree::Below(0), second, all_from(2, 3)]);
            let body = if side > 0.0 {
                Body::Intersection(vec![a, c, edge])
            } else {
                Body::Difference(vec![Body::Intersection(vec![a, edge]), c])
            };
            solid(body, fields, tree, reach)
        }
        "union" => {
            fields.extend(faces(b));
            let body = Body::Union([sphere, block].map(instance).into());
            let tree = Tree::Any(vec![Tree::Below(0), all_from(1, 6)]);
            solid(body, fields, tree, reach)
        }
        "drilled ball" => {
            fields.extend(faces(b));
            fields.append(&mut rod_fields);
            let body = Body::Difference([sphere, block, rod].map(instance).into());
            let tree = Tree::All(vec![
                Tree::Below(0),
                not(all_from(1, 6)),
                not(all_from(7, 3)),
            ]);
            solid(body, fields, tree, reach)
        }
        // A ball and a block but for what a rod has in common with a ring.
        _ => {
            let minor = random.range(0.2, 0.5) * size;
            let across_axis = Frame::around(axis).s;
            let ring = Shape::Torus(Torus::new(at, across_axis, size, minor));
            fields.extend(faces(b));
            fields.append(&mut rod_fields);
            fields.push(torus_field(at, across_axis, size, minor));
            let common = Body::Intersection([rod, ring].map(instance).into());
            let both = Body::Union([sphere, block].map(instance).into());
            let tree = Tree::All(vec![
                Tree::Any(vec![Tree::Below(0), all_from(1, 6)]),
                not(Tree::All(vec![all_from(7, 3), Tree::Below(10)])),
            ]);
            solid(Body::Difference(vec![both, common]), fields, tree, reach)
        }
    }
}

/// Where a formula is zero, written about its own place.
pub(crate) fn implicit(random: &mut Random, name: &str, at: DVec3, size: f64) -> (Shape, Truth) {
    let [x, y, z] = ["x", "y", "z"];
    let about = |i: usize| format!("({} - ({:?}))", [x, y, z][i], at[i]);
    let [x, y, z] = [0, 1, 2].map(about);
    let (text, field): (String, Field) = match name {
        "formula: sphere" => {
            let text = format!("{x}^2 + {y}^2 + {z}^2 - {size:?}^2");
            (text, ball(at, size))
        }
        "formula: ellipsoid" => {
            let [a, b, c] = [0; 3].map(|_| random.range(0.5, 3.0));
            let text = format!("{a:?}*{x}^2 + {b:?}*{y}^2 + {c:?}*{z}^2 - {size:?}^2*0.5");
            let field = Field::of(move |x| {
                let x = from(x, at);
                let terms = [a, b, c];
                let sum = (0..3).map(|i| x[i].squared().times(one(terms[i])));
                sum.reduce(|p, q| p + q).expect("three") - square_of(size).times(one(0.5))
            });
            (text, field)
        }
        "formula: torus" => {
            let minor = random.range(0.1, 0.8) * size;
            let text = format!(
                "({x}^2 + {y}^2 + {z}^2 + ({size:?}^2 - {minor:?}^2))^2 - 4*{size:?}^2*({x}^2 + {y}^2)"
            );
            (text, torus_field(at, DVec3::Z, size, minor))
        }
        _ => {
            // Five lobes' width of a tanglecube is about the size.
            let text = format!(
                "{x}^4 - 5*{s:?}^2*{x}^2 + {y}^4 - 5*{s:?}^2*{y}^2 + {z}^4 - 5*{s:?}^2*{z}^2 + 11.8*{s:?}^4",
                s = 0.4 * size
            );
            let s2 = one(0.4 * size) * one(0.4 * size);
            let field = Field::of(move |x| {
                let squares = from(x, at).map(Term::squared);
                let terms = squares.map(|q| q.squared() - q.times(one(5.0) * s2));
                terms[0] + terms[1] + terms[2] + Term::constant(one(11.8) * s2 * s2)
            });
            (text, field)
        }
    };
    let bounds = Aabb {
        min: at - DVec3::splat(2.0 * size),
        max: at + DVec3::splat(2.0 * size),
    };
    let formula = Formula::parse(&text).expect("a formula");
    let shape = Implicit::new(formula, bounds, RootFinder::Interval).expect("a surface");
    let reach = 8.0 * size;
    let (shape, mut truth) = closed(Shape::Implicit(Arc::new(shape)), vec![field], reach);
    // Its root finder looks at nothing smaller.
    truth.slack[1] += TOLERANCE;
    (shape, truth)
}

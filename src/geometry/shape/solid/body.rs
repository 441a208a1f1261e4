//! How a solid is put together, where it can be, and when a place is inside.

use super::{Operand, Shape};
use crate::geometry::{Aabb, BoundingSphere, Instance, Transform};

/// How a solid is put together.
#[derive(Clone, Debug)]
pub enum Body {
    /// A closed shape, or an unbounded one that parts space in two: a plane,
    /// whose inside is behind its normal, or a quadric that is not cut.
    Shape(Box<Instance>),
    /// What is in any of them.
    Union(Vec<Body>),
    /// What is in all of them.
    Intersection(Vec<Body>),
    /// What is in the first and in none of the others.
    Difference(Vec<Body>),
}

impl Body {
    /// A shape, sent to the solid's space by a map.
    pub fn of(shape: Shape, transform: Option<Transform>) -> Self {
        Self::Shape(Box::new(Instance { shape, transform }))
    }
}

/// The expression that says what is inside, over a word with a bit for each
/// operand.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Operand(u64),
    Any(Vec<Node>),
    All(Vec<Node>),
    Without(Vec<Node>),
}

impl Node {
    pub(super) fn holds(&self, inside: u64) -> bool {
        match self {
            Self::Operand(bit) => inside & bit != 0,
            Self::Any(list) => list.iter().any(|n| n.holds(inside)),
            Self::All(list) => list.iter().all(|n| n.holds(inside)),
            Self::Without(list) => {
                let (first, rest) = list.split_first().expect("checked when it was built");
                first.holds(inside) && !rest.iter().any(|n| n.holds(inside))
            }
        }
    }
}

/// Where a body can be: everywhere, or within a box.
type Extent = Option<Aabb>;

/// Lists the shapes of a body, and says where it can be.
pub(super) fn collect(body: Body, subtracted: bool, operands: &mut Vec<Operand>) -> (Node, Extent) {
    let mut members = |list: Vec<Body>, later_subtracted: bool| -> (Vec<Node>, Vec<Extent>) {
        let with_sign = |(i, member)| {
            let subtracted = subtracted != (later_subtracted && i > 0);
            collect(member, subtracted, operands)
        };
        list.into_iter().enumerate().map(with_sign).unzip()
    };
    match body {
        Body::Shape(instance) => {
            let extent = instance.bounds();
            let node = Node::Operand(1u64.checked_shl(operands.len() as u32).unwrap_or(0));
            operands.push(Operand {
                instance: *instance,
                subtracted,
            });
            (node, extent)
        }
        Body::Union(list) => {
            let (nodes, extents) = members(list, false);
            let all: Option<Vec<Aabb>> = extents.into_iter().collect();
            let around = all.map(|b| b.into_iter().fold(Aabb::EMPTY, Aabb::union));
            (Node::Any(nodes), around)
        }
        Body::Intersection(list) => {
            let (nodes, extents) = members(list, false);
            let common = extents.into_iter().flatten().reduce(Aabb::intersection);
            (Node::All(nodes), common)
        }
        Body::Difference(list) => {
            let (nodes, extents) = members(list, true);
            (Node::Without(nodes), extents.into_iter().next().flatten())
        }
    }
}

/// The smallest of the spheres around the box and around operands within which
/// the whole must lie.
pub(super) fn smallest_sphere(tree: &Node, operands: &[Operand], bounds: Aabb) -> BoundingSphere {
    fn around(node: &Node, operands: &[Operand], best: &mut BoundingSphere) {
        match node {
            Node::Operand(bit) => {
                let instance = &operands[bit.trailing_zeros() as usize].instance;
                if let Some(sphere) = instance.bounding_sphere()
                    && sphere.radius < best.radius
                {
                    *best = sphere;
                }
            }
            Node::All(list) => list.iter().for_each(|n| around(n, operands, best)),
            Node::Without(list) => around(&list[0], operands, best),
            Node::Any(list) => {
                if let [only] = list.as_slice() {
                    around(only, operands, best);
                }
            }
        }
    }
    let mut best = bounds.bounding_sphere();
    around(tree, operands, &mut best);
    best
}

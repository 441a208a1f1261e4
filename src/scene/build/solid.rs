//! Solids made of others.

use std::sync::Arc;

use glam::DAffine3;

use super::Builder;
use crate::{
    geometry::{
        Shape, Surface,
        shape::{Body, Cuboid, Solid, SolidError},
    },
    scene::{
        description::{Operand, ShapeDescription, SolidShape},
        outline::{Kind, NodeId},
    },
};

impl<'d> Builder<'d> {
    /// A shape that is made of others.
    pub(super) fn solid(&mut self, node: NodeId, shape: &'d ShapeDescription) -> Option<Shape> {
        let body = self.body(node, shape, DAffine3::IDENTITY)?;
        let mistake = match Solid::new(body) {
            Ok(solid) => return Some(Shape::Solid(Arc::new(solid))),
            Err(mistake) => mistake,
        };
        let (label, help) = match mistake {
            SolidError::TooMany(_) => ("counted with those of its parts", "make two objects of it"),
            SolidError::TooFine(_) => ("counted in its finest mesh", "use a coarser mesh"),
            SolidError::Unbounded => (
                "a plane is a half-space here",
                "intersect it with something that has bounds, such as a Box",
            ),
            SolidError::Empty => (
                "their bounds do not overlap",
                "move them together, or make a Union of them",
            ),
        };
        self.report.reject(node, mistake.to_string(), label, help)
    }

    /// A shape as part of a solid, sent to the solid's space by `place`.
    fn body(&mut self, node: NodeId, shape: &'d ShapeDescription, place: DAffine3) -> Option<Body> {
        match shape {
            ShapeDescription::Union(s) => self.members(node, s, place).map(Body::Union),
            ShapeDescription::Intersection(s) => {
                self.members(node, s, place).map(Body::Intersection)
            }
            ShapeDescription::Difference(s) => self.members(node, s, place).map(Body::Difference),
            ShapeDescription::Quadric(s) => {
                let (quadric, bounds) = self.quadric_and_box(node, s, false)?;
                let both = [
                    Shape::Quadric(Arc::new(quadric)),
                    Shape::Cuboid(Cuboid::new(bounds)),
                ];
                let both = both.map(|shape| self.placed(node, shape, place));
                let both: Option<Vec<Body>> = both.into_iter().collect();
                both.map(Body::Intersection)
            }
            ShapeDescription::Lens(s) => {
                let lens = self.lens(node, s)?;
                self.moved(node, lens, place)
            }
            _ => {
                let shape = self.shape(node, shape)?;
                self.check_operand(node, &shape)?;
                self.placed(node, shape, place)
            }
        }
    }

    /// The operands in the field `of`, all of whose mistakes are found.
    fn members(&mut self, node: NodeId, s: &'d SolidShape, place: DAffine3) -> Option<Vec<Body>> {
        let list = self.report.field(node, "of");
        if s.of.is_empty() {
            let label = "expected at least one solid";
            let help = "write `of: [(shape: ..), (shape: ..)]`";
            return self
                .report
                .reject(list, "a solid made of nothing", label, help);
        }
        let members: Vec<Option<Body>> = (0..s.of.len())
            .map(|i| {
                let node = self.report.outline.item(list, i).unwrap_or(list);
                self.member(node, &s.of[i], place)
            })
            .collect();
        members.into_iter().collect()
    }

    fn member(&mut self, node: NodeId, operand: &'d Operand, place: DAffine3) -> Option<Body> {
        let own = match &operand.at {
            None => DAffine3::IDENTITY,
            Some(steps) => {
                let at = self.report.field(node, "at");
                let places: Vec<NodeId> = if self.report.outline.kind(at) == Kind::List {
                    self.report.outline.children(at).collect()
                } else {
                    vec![at]
                };
                let steps: Vec<_> = places.into_iter().zip(&steps.0).collect();
                self.steps(at, &steps)?
            }
        };
        let shape = self.report.field(node, "shape");
        self.body(shape, &operand.shape, place * own)
    }

    fn placed(&mut self, node: NodeId, shape: Shape, place: DAffine3) -> Option<Body> {
        let transform = self.regular(node, place).ok()?;
        Some(Body::of(shape, transform))
    }

    /// A body whose shapes stand where they were made, sent elsewhere.
    fn moved(&mut self, node: NodeId, body: Body, place: DAffine3) -> Option<Body> {
        let mut all = |list: Vec<Body>| -> Option<Vec<Body>> {
            list.into_iter()
                .map(|b| self.moved(node, b, place))
                .collect()
        };
        Some(match body {
            Body::Shape(instance) => return self.placed(node, instance.shape, place),
            Body::Union(list) => Body::Union(all(list)?),
            Body::Intersection(list) => Body::Intersection(all(list)?),
            Body::Difference(list) => Body::Difference(all(list)?),
        })
    }

    /// Operands must say what is inside them.
    fn check_operand(&mut self, node: NodeId, shape: &Shape) -> Option<()> {
        match shape {
            Shape::Plane(_) => Some(()),
            Shape::Mesh(mesh) if shape.is_closed() && mesh.signed_volume() < 0.0 => {
                let label = "the faces are clockwise seen from outside";
                let help = "reverse the order of every face's vertices (most tools call it \
                            `flip normals`)";
                let message = "a mesh turned inside out in a solid";
                self.report.reject(node, message, label, help)
            }
            shape if shape.is_closed() => Some(()),
            shape => {
                let label = "nothing is inside of this";
                let help = match shape {
                    Shape::Cylinder(_) | Shape::Conic(_) => "write `capped: true`",
                    Shape::Mesh(_) => "close the mesh",
                    _ => "use a closed shape, or a Plane for all that is behind it",
                };
                let message = "a solid made of something that is not closed";
                self.report.reject(node, message, label, help)
            }
        }
    }
}

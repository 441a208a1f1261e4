//! Objects: a shape, a material, a place; and whether glass is closed.

use super::{Builder, BuiltObject};
use crate::{
    geometry::{Instance, Shape, Surface},
    material::Material,
    scene::{
        Object,
        description::{ObjectDescription, Part},
        outline::NodeId,
    },
};

impl<'d> Builder<'d> {
    pub(super) fn objects(&mut self) -> Vec<BuiltObject> {
        let mut list = Vec::with_capacity(self.description.objects.len());
        for (index, part) in self.description.objects.iter().enumerate() {
            if self.report.diagnostics.is_full() {
                break;
            }
            list.extend(self.object(index, part));
        }
        list
    }

    /// Checks all parts of an object, so that all its mistakes are found.
    fn object(&mut self, index: usize, part: &'d Part<ObjectDescription>) -> Option<BuiltObject> {
        let Part { node, value: d } = part;
        let name = d
            .name
            .clone()
            .unwrap_or_else(|| format!("objects[{index}]"));
        let shape = d.shape.as_ref().and_then(|s| self.shape(s.node, &s.value));
        let material = d.material.as_ref().and_then(|m| self.chosen_material(m));
        let transform = self.placement(d.at.as_ref());
        let (shape, material, transform) = (shape?, material?, transform.ok()?);
        let material = match material {
            Material::Dielectric {
                ior,
                thin: false,
                priority,
            } => {
                self.check_closed(*node, d, &shape)?;
                self.check_priority(*node, d, priority)?;
                Material::Dielectric {
                    ior,
                    thin: false,
                    priority: priority.filter(|_| !d.open),
                }
            }
            other => other,
        };
        let object = Object {
            name,
            material,
            light: None,
        };
        Some(BuiltObject {
            object,
            instance: Instance { shape, transform },
            node: *node,
        })
    }

    /// An open surface is no body: it has no overlaps to win.
    fn check_priority(
        &mut self,
        node: NodeId,
        d: &ObjectDescription,
        priority: Option<i8>,
    ) -> Option<()> {
        if !d.open || priority.is_none_or(|p| p == 0) {
            return Some(());
        }
        let place = self.report.field(node, "material");
        let label = "the object says `open: true`";
        let help = "only closed bodies can overlap: close the shape, or leave `priority` out of \
                    the material and say with `outside` which index is in front of the surface";
        let message = "an open surface with a priority";
        self.report.reject(place, message, label, help)
    }

    /// Glass must enclose its medium, or say that it doesn't.
    fn check_closed(&mut self, node: NodeId, d: &ObjectDescription, shape: &Shape) -> Option<()> {
        let place = self.report.field(node, "shape");
        if d.open {
            return Some(());
        }
        if !shape.is_closed() {
            let (label, close) = match shape {
                Shape::Mesh(mesh) => (super::mesh::describe_opening(mesh), "close the mesh"),
                Shape::Cylinder(_) | Shape::Conic(_) | Shape::Quadric(_) => (
                    "this surface has open ends".to_owned(),
                    "write `capped: true`",
                ),
                Shape::Implicit(_) => (
                    "not proven to close within its bounds".to_owned(),
                    "widen `bounds` until the formula is above 0 all over their faces",
                ),
                _ => (
                    "a flat sheet has no inside".to_owned(),
                    "use a closed shape",
                ),
            };
            let help = format!(
                "{close}; or write `open: true` in the object if this is the surface of a larger body \
                 (its normal then points to the outside medium); or `thin: true` in the material for a pane"
            );
            let message = "glass that does not enclose anything";
            return self.report.reject(place, message, label, help);
        }
        if let Shape::Mesh(mesh) = shape
            && mesh.signed_volume() < 0.0
        {
            let help =
                "reverse the order of every face's vertices (most tools call it `flip normals`)";
            let label = "the faces are clockwise seen from outside";
            return self
                .report
                .reject(place, "a glass mesh turned inside out", label, help);
        }
        Some(())
    }
}

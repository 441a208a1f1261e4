//! Objects: a shape, a material, a place; and whether glass is closed.

use super::{Builder, BuiltObject};
use crate::{
    geometry::{Instance, Shape, Surface},
    material::Material,
    scene::{
        Object,
        decode::short,
        description::{ObjectDescription, Part, ShapeDescription},
        mesh_words::openings,
        outline::NodeId,
    },
};

/// What becomes one instance.
pub(super) struct Piece<'d> {
    /// The name of a part, and where its material stands.
    pub(super) name: Option<(NodeId, &'d str)>,
    pub(super) shape: Shape,
    pub(super) material: Material,
}

/// How the mesh of an object is closed.
fn close_mesh(d: &ObjectDescription) -> &'static str {
    match d.shape.as_ref().map(|part| &part.value) {
        Some(ShapeDescription::HeightField(_)) => "give the height field a `depth`",
        _ => "close the mesh",
    }
}

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

    /// Checks all parts of an object, so that all its mistakes are found. A
    /// mesh with materials by name becomes one object for each of them.
    fn object(&mut self, index: usize, part: &'d Part<ObjectDescription>) -> Vec<BuiltObject> {
        let Part { node, value: d } = part;
        let name = d
            .name
            .clone()
            .unwrap_or_else(|| format!("objects[{index}]"));
        let pieces = match &d.materials {
            None => self.whole(d),
            Some(materials) => self.cut_by_names(d, materials),
        };
        let transform = self.placement(d.at.as_ref());
        let (Some(pieces), Ok(transform)) = (pieces, transform) else {
            return vec![];
        };
        let mut built = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let Some(material) = self.material_on(*node, d, &piece) else {
                continue;
            };
            let name = match piece.name {
                None => name.clone(),
                Some((_, part)) => format!("{name}/{part}"),
            };
            built.push(BuiltObject {
                object: Object {
                    name,
                    material,
                    light: None,
                },
                instance: Instance {
                    shape: piece.shape,
                    transform,
                },
                node: *node,
            });
        }
        built
    }

    /// The material of a piece, if its shape can have it.
    fn material_on(
        &mut self,
        node: NodeId,
        d: &ObjectDescription,
        piece: &Piece,
    ) -> Option<Material> {
        match piece.material {
            Material::Dielectric {
                ior,
                thin: false,
                priority,
            } => {
                if !d.open {
                    self.check_closed(node, d, piece)?;
                }
                self.check_priority(node, d, priority)?;
                Some(Material::Dielectric {
                    ior,
                    thin: false,
                    priority: priority.filter(|_| !d.open),
                })
            }
            other => Some(other),
        }
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

    fn whole(&mut self, d: &'d ObjectDescription) -> Option<Vec<Piece<'d>>> {
        let shape = d.shape.as_ref().and_then(|s| self.shape(s.node, &s.value));
        let material = d.material.as_ref().and_then(|m| self.chosen_material(m));
        Some(vec![Piece {
            name: None,
            shape: shape?,
            material: material?,
        }])
    }

    /// Glass must enclose its medium.
    fn check_closed(&mut self, node: NodeId, d: &ObjectDescription, piece: &Piece) -> Option<()> {
        let place = match piece.name {
            None => self.report.field(node, "shape"),
            Some((place, _)) => place,
        };
        let part = match piece.name {
            None => String::new(),
            Some((_, name)) => format!(": the part \"{}\"", short(name)),
        };
        if !piece.shape.is_closed() {
            let (label, close) = match &piece.shape {
                Shape::Mesh(mesh) => (openings(mesh.defects()).join("; "), close_mesh(d)),
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
            let message = format!("glass that does not enclose anything{part}");
            return self.report.reject(place, message, label, help);
        }
        if let Shape::Mesh(mesh) = &piece.shape
            && mesh.signed_volume() < 0.0
        {
            let help =
                "reverse the order of every face's vertices (most tools call it `flip normals`)";
            let label = "the faces are clockwise seen from outside";
            let message = format!("a glass mesh turned inside out{part}");
            return self.report.reject(place, message, label, help);
        }
        Some(())
    }
}

//! Materials by the names that a mesh file gives to its parts.

use std::collections::BTreeSet;

use super::{Builder, object::Piece};
use crate::{
    geometry::Shape,
    scene::{
        decode::{list, short, suggest},
        description::{MeshFields, ObjectDescription, PartMaterials, ShapeDescription},
        mesh_file::Names,
        outline::NodeId,
    },
};

impl<'d> Builder<'d> {
    /// One piece for each named part of a mesh, and one for the rest.
    pub(super) fn cut_by_names(
        &mut self,
        d: &'d ObjectDescription,
        chosen: &'d PartMaterials,
    ) -> Option<Vec<Piece<'d>>> {
        let rest = d.material.as_ref().map(|m| self.chosen_material(m));
        let materials: Vec<_> = (chosen.value.iter())
            .map(|(_, part)| {
                let choice = part.value.as_ref()?;
                self.material_of(part.node, choice)
            })
            .collect();
        let shape = d.shape.as_ref()?;
        let ShapeDescription::Mesh(fields) = &shape.value else {
            let help = "only mesh files have named parts; use `material`";
            let label = "expected a shape `Mesh(file: ..)`";
            let message = "materials by name for a shape without named parts";
            return self.report.reject(chosen.node, message, label, help);
        };
        self.check_names(shape.node, fields, chosen)?;
        let keys = chosen.value.iter().map(|(name, _)| name.clone()).collect();
        let parts = self.mesh_parts(shape.node, fields, keys)?;
        let used = parts.iter().filter_map(|(key, _)| *key).collect();
        self.check_effect(chosen, &used);
        let mut pieces = Vec::with_capacity(parts.len());
        for (key, mesh) in parts {
            let shape = Shape::Mesh(mesh);
            let (name, material) = match key {
                Some(k) => {
                    let (name, part) = &chosen.value[k];
                    (Some((part.node, name.as_str())), materials[k])
                }
                None => (None, self.material_of_rest(chosen, rest)?),
            };
            pieces.push(Piece {
                name,
                shape,
                material: material?,
            });
        }
        Some(pieces)
    }

    /// Every name must be one of the file.
    fn check_names(
        &mut self,
        node: NodeId,
        fields: &'d MeshFields,
        chosen: &PartMaterials,
    ) -> Option<()> {
        let names = self.mesh_names(node, fields)?;
        let known: BTreeSet<&str> = Names::all(&names);
        let known: Vec<&str> = known.into_iter().collect();
        let mut all_known = true;
        for (name, part) in &chosen.value {
            if known.binary_search(&name.as_str()).is_ok() {
                continue;
            }
            all_known = false;
            let label = match known.as_slice() {
                [] => "the mesh names no parts".to_owned(),
                some => format!("the mesh has {}", list(some)),
            };
            let message = format!("the mesh has no part named \"{}\"", short(name));
            let diagnostic = self
                .report
                .about_key(part.node, message)
                .with_label(label)
                .with_help("names are those of materials, groups, objects or nodes in the file");
            self.report.push(suggest(diagnostic, name, &known));
        }
        all_known.then_some(())
    }

    /// Every name must get triangles.
    fn check_effect(&mut self, chosen: &PartMaterials, used: &BTreeSet<usize>) {
        let idle = (chosen.value.iter().enumerate()).filter(|(k, _)| !used.contains(k));
        for (_, (name, part)) in idle {
            let message = format!("the part \"{}\" gets no triangles", short(name));
            let diagnostic = self
                .report
                .about_key(part.node, message)
                .with_label("all of them go by other names given here")
                .with_help("materials go before groups and nodes, these before objects and meshes");
            self.report.push(diagnostic);
        }
    }

    /// The material of triangles that go by none of the names.
    fn material_of_rest<T>(&mut self, chosen: &PartMaterials, rest: Option<T>) -> Option<T> {
        if rest.is_none() {
            let message = "some triangles of the mesh go by none of these names";
            let label = "they need a `material`";
            let help = "add `material: ..` to the object";
            return self.report.reject(chosen.node, message, label, help);
        }
        rest
    }
}

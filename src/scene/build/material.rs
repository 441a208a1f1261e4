//! Materials.

use super::Builder;
use crate::{
    material::Material,
    scene::{
        decode::{list, short, suggest},
        description::{MaterialChoice, MaterialDescription, Part},
        outline::NodeId,
    },
};

/// Largest index of refraction.
const MAX_IOR: f64 = 100.0;

impl<'d> Builder<'d> {
    pub(super) fn named_materials(&mut self) {
        for (name, part) in &self.description.materials {
            if self.report.diagnostics.is_full() {
                break;
            }
            let material = part
                .value
                .as_ref()
                .and_then(|m| self.material(part.node, m));
            self.materials.insert(name, material);
        }
    }

    fn material(&mut self, node: NodeId, description: &MaterialDescription) -> Option<Material> {
        match *description {
            MaterialDescription::Diffuse { reflectance } => {
                let reflectance = self.report.reflectance(node, reflectance)?;
                Some(Material::Diffuse { reflectance })
            }
            MaterialDescription::Mirror { reflectance } => {
                let reflectance = self.report.reflectance(node, reflectance)?;
                Some(Material::Mirror { reflectance })
            }
            MaterialDescription::Dielectric { ior, thin } => {
                if (1.0..=MAX_IOR).contains(&ior.0) {
                    return Some(Material::Dielectric { ior: ior.0, thin });
                }
                let place = self.report.field(node, "ior");
                let message = if ior.0 < 1.0 {
                    "an index of refraction below 1"
                } else {
                    "an index of refraction that nothing has"
                };
                let label = format!("expected 1 to {MAX_IOR}");
                let help = "the index is that of the medium behind the surface; water has 1.33, glass about 1.5";
                self.report.reject(place, message, label, help)
            }
        }
    }

    /// The material an object asks for.
    pub(super) fn chosen_material(&mut self, part: &'d Part<MaterialChoice>) -> Option<Material> {
        match &part.value {
            MaterialChoice::Inline(description) => self.material(part.node, description),
            MaterialChoice::Named(name) => {
                if let Some(material) = self.materials.get(name.as_str()) {
                    return *material;
                }
                self.dangling(part.node, "material", "materials", name);
                None
            }
        }
    }

    /// Reports a name that no entry of a section has.
    pub(super) fn dangling(&mut self, place: NodeId, what: &str, section: &str, name: &str) {
        let description = self.description;
        let names: Vec<&str> = match section {
            "materials" => names_of(&description.materials),
            _ => names_of(&description.meshes),
        };
        let label = match names.as_slice() {
            [] => format!("`{section}` is empty"),
            some => format!("`{section}` has {}", list(some)),
        };
        let message = format!("there is no {what} named \"{}\"", short(name));
        let diagnostic = self
            .report
            .about(place, message)
            .with_label(label)
            .with_help(format!("add it to `{section}`"));
        self.report.push(suggest(diagnostic, name, &names));
    }
}

/// The first names of a section: enough to look for the one that was meant.
fn names_of<T>(entries: &[(String, T)]) -> Vec<&str> {
    const MOST: usize = 1000;
    entries
        .iter()
        .take(MOST)
        .map(|(name, _)| name.as_str())
        .collect()
}

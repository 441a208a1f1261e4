//! Materials.

use super::Builder;
use crate::{
    material::Material,
    scene::{
        decode::{list, short, suggest},
        description::{Description, MaterialChoice, MaterialDescription, Number, Part},
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
            MaterialDescription::Dielectric {
                ior,
                outside,
                priority,
                thin,
            } => {
                let ior = self.index(node, "ior", ior);
                let outside = outside.map(|n| self.index(node, "outside", n));
                let priority = priority.map(|p| self.priority(node, p));
                self.check_alone(node, outside.is_some(), priority.is_some(), thin)?;
                let takes_part = outside.is_none() && !thin;
                Some(Material::Dielectric {
                    ior: ior? / outside.unwrap_or(Some(1.0))?,
                    thin,
                    priority: match priority.unwrap_or(Some(0))? {
                        p if takes_part => Some(p),
                        _ => None,
                    },
                })
            }
        }
    }

    /// An index of refraction.
    fn index(&mut self, node: NodeId, key: &str, value: Number) -> Option<f64> {
        if (1.0..=MAX_IOR).contains(&value.0) {
            return Some(value.0);
        }
        let place = self.report.field(node, key);
        let message = if value.0 < 1.0 {
            "an index of refraction below 1"
        } else {
            "an index of refraction that nothing has"
        };
        let label = format!("expected 1 to {MAX_IOR}");
        let help = if key == "ior" {
            "the index is that of the medium behind the surface; water has 1.33, glass about 1.5"
        } else {
            "the index is that of the medium in front of the surface, towards its normal; \
             leave it out for air"
        };
        self.report.reject(place, message, label, help)
    }

    /// Which medium wins an overlap.
    fn priority(&mut self, node: NodeId, value: Number) -> Option<i8> {
        let p = value.0;
        if p == p.round() && (f64::from(i8::MIN)..=f64::from(i8::MAX)).contains(&p) {
            return Some(p as i8);
        }
        let place = self.report.field(node, "priority");
        let label = format!("expected a whole number from {} to {}", i8::MIN, i8::MAX);
        let help = "where bodies overlap, the medium of the higher number is there; \
                    only their order matters";
        let message = "this is not a priority";
        self.report.reject(place, message, label, help)
    }

    /// A surface that says what is on both sides, or is a pane, has no
    /// overlaps to win.
    fn check_alone(
        &mut self,
        node: NodeId,
        outside: bool,
        priority: bool,
        thin: bool,
    ) -> Option<()> {
        if !priority {
            return Some(());
        }
        if outside {
            let fields = [("outside", true), ("priority", true)];
            self.report.exactly_one(node, &fields)?;
        }
        if thin {
            let place = self.report.field(node, "priority");
            let label = "a pane has no inside";
            let help = "remove `priority`; or remove `thin: true` if this is the surface of a body";
            let message = "a thin pane with a priority";
            return self.report.reject(place, message, label, help);
        }
        Some(())
    }

    /// The material an object asks for.
    pub(super) fn chosen_material(&mut self, part: &'d Part<MaterialChoice>) -> Option<Material> {
        self.material_of(part.node, &part.value)
    }

    /// The material that is chosen at a place.
    pub(super) fn material_of(
        &mut self,
        node: NodeId,
        choice: &'d MaterialChoice,
    ) -> Option<Material> {
        match choice {
            MaterialChoice::Inline(description) => self.material(node, description),
            MaterialChoice::Named(name) => {
                if let Some(material) = self.materials.get(name.as_str()) {
                    return *material;
                }
                self.dangling(node, "material", "materials", name);
                None
            }
        }
    }

    /// Reports a name that no entry of a section has.
    pub(super) fn dangling(&mut self, place: NodeId, what: &str, section: &str, name: &str) {
        let description = self.description;
        let names: Vec<&str> = match section {
            "materials" => names_of(&description.materials),
            "objects" => named_objects(description),
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

/// Names in which the one that was meant is looked for.
const MOST: usize = 1000;

/// The first names of objects.
fn named_objects(description: &Description) -> Vec<&str> {
    let names = description
        .objects
        .iter()
        .filter_map(|o| o.value.name.as_deref());
    names.take(MOST).collect()
}

/// The first names of a section: enough to look for the one that was meant.
fn names_of<T>(entries: &[(String, T)]) -> Vec<&str> {
    entries
        .iter()
        .take(MOST)
        .map(|(name, _)| name.as_str())
        .collect()
}

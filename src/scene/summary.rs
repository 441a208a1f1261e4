//! What a scene contains, in a few lines.

use std::{
    collections::{BTreeMap, HashSet},
    fmt,
};

use super::Scene;
use crate::{
    geometry::{Shape, TriangleMesh},
    light::Light,
    material::Material,
};

/// Counts of what a scene contains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Image width and height in pixels.
    pub resolution: [u32; 2],
    /// Objects, without the bodies of lights.
    pub objects: usize,
    /// Objects that can cast caustics.
    pub casters: usize,
    /// Objects by material.
    pub materials: BTreeMap<&'static str, usize>,
    /// Triangles of all instances.
    pub triangles: u64,
    /// Triangles in memory: meshes shared by several instances count once.
    pub stored_triangles: u64,
    /// Lights by kind.
    pub lights: BTreeMap<&'static str, usize>,
}

impl Summary {
    /// Counts what a scene contains.
    pub fn of(scene: &Scene) -> Self {
        let mut summary = Self {
            resolution: scene.resolution,
            objects: 0,
            casters: 0,
            materials: BTreeMap::new(),
            triangles: 0,
            stored_triangles: 0,
            lights: BTreeMap::new(),
        };
        let mut seen = HashSet::new();
        for (object, instance) in scene.objects.iter().zip(scene.world.instances()) {
            let shape = &instance.shape;
            if let Shape::Solid(solid) = shape {
                let operands = solid.operands().map(|i| &i.shape);
                operands.for_each(|s| summary.count_triangles(s, &mut seen));
            }
            summary.count_triangles(shape, &mut seen);
            if object.light.is_none() {
                summary.objects += 1;
                summary.casters += usize::from(object.material.casts_caustics());
                *summary
                    .materials
                    .entry(material_kind(&object.material))
                    .or_default() += 1;
            }
        }
        for light in &scene.lights {
            *summary.lights.entry(light_kind(&light.light)).or_default() += 1;
        }
        summary
    }

    /// Adds the triangles of a shape, those in memory unless they are in `seen`.
    fn count_triangles(&mut self, shape: &Shape, seen: &mut HashSet<*const TriangleMesh>) {
        let (count, new) = match shape {
            Shape::Mesh(mesh) => {
                let new = seen.insert(std::sync::Arc::as_ptr(mesh));
                (mesh.triangle_count() as u64, new)
            }
            Shape::Triangle(_) => (1, true),
            _ => return,
        };
        self.triangles += count;
        self.stored_triangles += if new { count } else { 0 };
    }

    /// Number of lights.
    pub fn light_count(&self) -> usize {
        self.lights.values().sum()
    }
}

fn material_kind(material: &Material) -> &'static str {
    match material {
        Material::Diffuse { .. } => "diffuse",
        Material::Mirror { .. } => "mirror",
        Material::Dielectric { thin: false, .. } => "dielectric",
        Material::Dielectric { thin: true, .. } => "thin dielectric",
        Material::Black => "black",
    }
}

fn light_kind(light: &Light) -> &'static str {
    match light {
        Light::Point(_) => "point",
        Light::Spot(_) => "spot",
        Light::Beam(_) => "beam",
        Light::Sun(_) => "sun",
        Light::Sphere(_) => "sphere",
        Light::Quad(_) => "quad",
        Light::Disc(_) => "disc",
    }
}

/// `3 (2 diffuse, 1 mirror)`.
fn counted(kinds: &BTreeMap<&'static str, usize>) -> String {
    let total: usize = kinds.values().sum();
    if total == 0 {
        return "none".to_owned();
    }
    let parts: Vec<String> = kinds
        .iter()
        .map(|(kind, n)| format!("{n} {kind}"))
        .collect();
    format!("{total} ({})", parts.join(", "))
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.resolution;
        writeln!(f, "image      {width} x {height} pixels")?;
        writeln!(f, "objects    {}", counted(&self.materials))?;
        writeln!(f, "casters    {}", self.casters)?;
        match (self.triangles, self.stored_triangles) {
            (0, _) => writeln!(f, "triangles  none")?,
            (n, stored) if n == stored => writeln!(f, "triangles  {n}")?,
            (n, stored) => writeln!(f, "triangles  {n}, {stored} in memory")?,
        }
        write!(f, "lights     {}", counted(&self.lights))?;
        if self.lights.is_empty() {
            write!(f, ": the picture will be black")?;
        }
        Ok(())
    }
}

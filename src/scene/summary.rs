//! What a scene contains, in a few lines.

use std::{
    collections::{BTreeMap, HashMap},
    fmt,
    sync::Arc,
};

use super::{Scene, mesh_words::openings};
use crate::{
    geometry::{Shape, Surface, TriangleMesh, mesh::Defects},
    light::Light,
    material::Material,
};

/// A mesh in memory, which several objects may share.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSummary {
    /// The first object that shows it.
    pub name: String,
    /// How many objects show it.
    pub places: usize,
    /// Vertices, each as often as it has different normals.
    pub vertices: usize,
    /// Triangles of some area.
    pub triangles: usize,
    /// How they fail to join.
    pub defects: Defects,
    /// Triangles of zero area, which were dropped.
    pub dropped: usize,
    /// Corners whose normal is on the other side than the face's.
    pub disagreeing: usize,
    /// Whether vertex normals shade it.
    pub is_smooth: bool,
    /// The volume within, in cubic metres before the object is placed, if the
    /// mesh is closed; negative if its faces look inward.
    pub volume: Option<f64>,
}

impl MeshSummary {
    fn of(name: &str, mesh: &TriangleMesh) -> Self {
        Self {
            name: name.to_owned(),
            places: 1,
            vertices: mesh.vertex_count(),
            triangles: mesh.triangle_count(),
            defects: *mesh.defects(),
            dropped: mesh.dropped_triangles(),
            disagreeing: mesh.disagreeing_normals(),
            is_smooth: mesh.is_smooth(),
            volume: mesh.is_closed().then(|| mesh.signed_volume()),
        }
    }

    /// What is worth a look, in words; none for a sound closed mesh.
    pub fn remarks(&self) -> Vec<String> {
        let mut list = openings(&self.defects);
        if self.volume.is_some_and(|v| v < 0.0) {
            list.push("the faces are clockwise seen from outside: turned inside out".to_owned());
        }
        let counted = [
            (
                self.defects.doubled,
                ["face repeats another one", "faces repeat other ones"],
            ),
            (
                self.dropped,
                [
                    "face of zero area was dropped",
                    "faces of zero area were dropped",
                ],
            ),
            (
                self.disagreeing,
                [
                    "corner has a normal on the other side than its face; the face's is used",
                    "corners have normals on the other side than their faces; the faces' are used",
                ],
            ),
        ];
        for (count, [one, many]) in counted {
            match count {
                0 => {}
                1 => list.push(format!("1 {one}")),
                n => list.push(format!("{n} {many}")),
            }
        }
        list
    }
}

impl fmt::Display for MeshSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            vertices,
            triangles,
            ..
        } = self;
        write!(f, "{name}: {vertices} vertices, {triangles} triangles, ")?;
        f.write_str(if self.is_smooth {
            "smooth, "
        } else {
            "faceted, "
        })?;
        match self.volume {
            Some(volume) => write!(f, "closed around {volume:.4e} m3")?,
            None => f.write_str("not closed")?,
        }
        if self.places > 1 {
            write!(f, ", in {} places", self.places)?;
        }
        Ok(())
    }
}

/// Most meshes that are told of in full.
const MESHES_SHOWN: usize = 20;

/// Counts of what a scene contains.
#[derive(Clone, Debug, PartialEq)]
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
    /// The meshes in memory, in the order of their first objects.
    pub meshes: Vec<MeshSummary>,
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
            meshes: Vec::new(),
            lights: BTreeMap::new(),
        };
        let mut seen = HashMap::new();
        for (object, instance) in scene.objects.iter().zip(scene.world.instances()) {
            let shape = &instance.shape;
            if let Shape::Solid(solid) = shape {
                let operands = solid.operands().map(|i| &i.shape);
                operands.for_each(|s| summary.count_triangles(&object.name, s, &mut seen));
            }
            summary.count_triangles(&object.name, shape, &mut seen);
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

    /// Adds the triangles of a shape of an object; `seen` numbers the meshes
    /// that are known.
    fn count_triangles(
        &mut self,
        name: &str,
        shape: &Shape,
        seen: &mut HashMap<*const TriangleMesh, usize>,
    ) {
        match shape {
            Shape::Mesh(mesh) => {
                let count = mesh.triangle_count() as u64;
                self.triangles += count;
                let number = *seen.entry(Arc::as_ptr(mesh)).or_insert(self.meshes.len());
                match self.meshes.get_mut(number) {
                    Some(known) => known.places += 1,
                    None => {
                        self.stored_triangles += count;
                        self.meshes.push(MeshSummary::of(name, mesh));
                    }
                }
            }
            Shape::Triangle(_) => {
                self.triangles += 1;
                self.stored_triangles += 1;
            }
            _ => {}
        }
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
        for (i, mesh) in self.meshes.iter().take(MESHES_SHOWN).enumerate() {
            let head = if i == 0 { "meshes" } else { "" };
            writeln!(f, "{head:<10} {mesh}")?;
            for remark in mesh.remarks() {
                writeln!(f, "           - {remark}")?;
            }
        }
        if let Some(more) = self
            .meshes
            .len()
            .checked_sub(MESHES_SHOWN)
            .filter(|&n| n > 0)
        {
            writeln!(f, "           ... and {more} more")?;
        }
        write!(f, "lights     {}", counted(&self.lights))?;
        if self.lights.is_empty() {
            write!(f, ": the picture will be black")?;
        }
        Ok(())
    }
}

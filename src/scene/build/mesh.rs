//! Meshes: named ones, files, lists of vertices, generators.

use std::{collections::HashMap, sync::Arc};

use glam::DVec3;

use super::{Builder, SharedMesh};
use crate::{
    geometry::{TriangleMesh, mesh::MeshError},
    scene::{
        MAX_LENGTH,
        description::{MeshFields, MeshSource, TorusKnot, Triple, Waves},
        generate,
        mesh_file::{self, MeshData},
        outline::NodeId,
    },
};

impl<'d> Builder<'d> {
    pub(super) fn named_meshes(&mut self) {
        for (name, part) in &self.description.meshes {
            if self.report.diagnostics.is_full() {
                break;
            }
            let node = part.node;
            let mesh = part.value.as_ref().and_then(|source| match source {
                MeshSource::File(path) => self.mesh_from_file(node, path),
                MeshSource::Mesh(fields) if fields.named.is_some() => {
                    let place = self.report.field(node, "named");
                    let label = "expected a file or vertices";
                    let help = "objects can name the other mesh themselves";
                    self.report
                        .reject(place, "a mesh that is only another one's name", label, help)
                }
                MeshSource::Mesh(fields) => self.mesh_shape(node, fields),
                MeshSource::Waves(waves) => self.waves(node, waves),
                MeshSource::TorusKnot(knot) => self.torus_knot(node, knot),
            });
            self.meshes.insert(name, mesh);
        }
    }

    /// The mesh of `Mesh(..)`.
    pub(super) fn mesh_shape(&mut self, node: NodeId, fields: &'d MeshFields) -> SharedMesh {
        let forms = [
            ("file", fields.file.is_some()),
            ("named", fields.named.is_some()),
            ("vertices", fields.vertices.is_some()),
        ];
        let which = self.report.exactly_one(node, &forms)?;
        let strangers = [
            ("triangles", fields.triangles.is_some()),
            ("normals", fields.normals.is_some()),
        ];
        if let (true, Some((key, _))) = (which < 2, strangers.iter().find(|(_, given)| *given)) {
            let place = self.report.field(node, key);
            let diagnostic = self
                .report
                .about_key(
                    place,
                    format!("`{key}` does not go with `{}`", forms[which].0),
                )
                .with_label("belongs to `vertices`")
                .with_help("remove it");
            self.report.push(diagnostic);
            return None;
        }
        match which {
            0 => self.mesh_from_file(self.report.field(node, "file"), fields.file.as_deref()?),
            1 => {
                let name = fields.named.as_deref()?;
                if let Some(mesh) = self.meshes.get(name) {
                    return mesh.clone();
                }
                let place = self.report.field(node, "named");
                self.dangling(place, "mesh", "meshes", name);
                None
            }
            _ => self.mesh_in_place(node, fields),
        }
    }

    /// Each file is read once, and its mistakes are reported once.
    fn mesh_from_file(&mut self, place: NodeId, file: &str) -> SharedMesh {
        if let Some(mesh) = self.files.get(file) {
            return mesh.clone();
        }
        let path = self.base_dir.join(file);
        let (line, column) = self
            .report
            .source
            .position(self.report.outline.span(place).start);
        let used = format!("used at {}:{line}:{column}", self.report.source.name());
        let mesh = match mesh_file::read(&path) {
            Ok(data) => match TriangleMesh::new(data.vertices, data.normals, data.triangles) {
                Ok(mesh) => Some(Arc::new(mesh)),
                Err(e) => self.report.reject(
                    place,
                    format!("the mesh file {} is broken: {e}", path.display()),
                    "this file",
                    mesh_help(&e),
                ),
            },
            Err(diagnostic) if !path.is_file() => self.report.reject(
                place,
                format!("cannot use {}: {}", path.display(), diagnostic.message),
                "expected an OBJ or PLY file",
                "paths are relative to the scene file's directory",
            ),
            Err(diagnostic) => {
                self.report.push(diagnostic.with_note(used));
                None
            }
        };
        self.files.insert(file.to_owned(), mesh.clone());
        mesh
    }

    fn mesh_in_place(&mut self, node: NodeId, fields: &MeshFields) -> SharedMesh {
        let triangles = self.required(node, "triangles", fields.triangles.clone())?;
        let vertices = fields.vertices.as_deref()?;
        let place = self.report.field(node, "vertices");
        for (i, vertex) in vertices.iter().enumerate() {
            if DVec3::from(*vertex).abs().max_element() > MAX_LENGTH {
                let place = self.report.outline.item(place, i).unwrap_or(place);
                self.report.point_here(place, *vertex)?;
            }
        }
        let to_vectors = |list: &[Triple]| list.iter().map(|t| DVec3::from(*t)).collect();
        let normals = fields.normals.as_deref().map(to_vectors);
        match TriangleMesh::new(to_vectors(vertices), normals, triangles) {
            Ok(mesh) => Some(Arc::new(mesh)),
            Err(e) => {
                let place = match &e {
                    MeshError::IndexOutOfRange { triangle, .. } => {
                        let list = self.report.field(node, "triangles");
                        self.report.outline.item(list, *triangle).unwrap_or(list)
                    }
                    MeshError::NormalCount { .. } => self.report.field(node, "normals"),
                    _ => self.report.field(node, "triangles"),
                };
                self.report
                    .reject(place, format!("a broken mesh: {e}"), "here", mesh_help(&e))
            }
        }
    }

    pub(super) fn waves(&mut self, node: NodeId, waves: &Waves) -> SharedMesh {
        for (key, [from, to]) in [("x", waves.x.0), ("y", waves.y.0)] {
            let place = self.report.field(node, key);
            self.report.point_here(place, Triple([from, to, 0.0]))?;
            if to - from < crate::scene::MIN_LENGTH {
                let label = "expected `(from, to)` with `to` above `from`";
                return self.report.reject(
                    place,
                    format!("the range of {key} is empty"),
                    label,
                    "swap the two",
                );
            }
        }
        self.budget(node, "cells", generate::wave_triangles(waves))?;
        let heights = waves.waves.iter().map(|w| w.amplitude.0.abs());
        let slopes = waves.waves.iter().map(|w| {
            let [kx, ky] = w.k.0;
            w.amplitude.0.abs() * kx.abs().max(ky.abs())
        });
        // A slope beyond this has a normal that is horizontal to rounding.
        let steepest = slopes.sum::<f64>();
        if heights.sum::<f64>() + waves.level.0.abs() > MAX_LENGTH || steepest > MAX_LENGTH {
            let place = self.report.field(node, "waves");
            let label = "the sum of all heights or slopes is out of range";
            let help = "amplitudes are in metres, wave vectors in radians per metre";
            return self
                .report
                .reject(place, "waves too high or too steep", label, help);
        }
        self.generated(node, generate::waves(waves))
    }

    pub(super) fn torus_knot(&mut self, node: NodeId, knot: &TorusKnot) -> SharedMesh {
        self.report.point(node, "center", knot.center)?;
        let lengths = [
            ("scale", knot.scale),
            ("tube", knot.tube),
            ("ring", knot.ring),
            ("height", knot.height),
        ];
        for (key, value) in lengths {
            self.report.length(node, key, value)?;
        }
        let counts = [
            ("p", knot.p, 1, 1000),
            ("q", knot.q, 1, 1000),
            ("segments", knot.segments, 3, u32::MAX),
            ("sides", knot.sides, 3, u32::MAX),
        ];
        for (key, count, least, most) in counts {
            if !(least..=most).contains(&count) {
                let place = self.report.field(node, key);
                let label = format!("expected at least {least} and at most {most}");
                return self
                    .report
                    .reject(place, format!("`{key}` is out of range"), label, "");
            }
        }
        self.budget(node, "segments", generate::knot_triangles(knot))?;
        if knot.ring.0 <= 1.0 {
            let place = self.report.field(node, "ring");
            let label = "expected more than 1, the radius of the winding itself";
            return self
                .report
                .reject(place, "a knot that runs into itself", label, "such as 2");
        }
        self.generated(node, generate::torus_knot(knot))
    }

    /// Takes triangles from what generators may make in one scene.
    fn budget(&mut self, node: NodeId, key: &str, triangles: u64) -> Option<()> {
        if triangles > 0 && triangles <= self.triangles_left {
            self.triangles_left -= triangles;
            return Some(());
        }
        let place = self.report.field(node, key);
        let message = if triangles == 0 {
            "a mesh without triangles".to_owned()
        } else {
            format!("a mesh of {triangles} triangles")
        };
        let label = format!(
            "expected 1 to {} triangles in all generated meshes",
            generate::MAX_TRIANGLES
        );
        self.report.reject(
            place,
            message,
            label,
            "make the mesh coarser, or finer if it has none",
        )
    }

    fn generated(&mut self, node: NodeId, data: MeshData) -> SharedMesh {
        match TriangleMesh::new(data.vertices, data.normals, data.triangles) {
            Ok(mesh) => Some(Arc::new(mesh)),
            Err(e) => {
                self.report
                    .reject(node, format!("a broken mesh: {e}"), "here", mesh_help(&e))
            }
        }
    }
}

fn mesh_help(error: &MeshError) -> &'static str {
    match error {
        MeshError::IndexOutOfRange { .. } => "vertices are counted from 0",
        MeshError::NormalCount { .. } => "give one normal per vertex, or leave the normals out",
        MeshError::Empty | MeshError::AllDegenerate(_) => {
            "a mesh needs at least one triangle of some area"
        }
        _ => "",
    }
}

/// How far a mesh is from being closed, in words.
pub(super) fn describe_opening(mesh: &TriangleMesh) -> String {
    let mut balance: HashMap<[[u64; 3]; 2], i64> = HashMap::new();
    // Vertices are compared by position; adding 0 makes one zero of two.
    let key = |p: DVec3| p.to_array().map(|c| (c + 0.0).to_bits());
    for part in 0..mesh.triangle_count() as u32 {
        let t = mesh.triangle(part).map(key);
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            if a < b {
                *balance.entry([a, b]).or_default() += 1;
            } else {
                *balance.entry([b, a]).or_default() -= 1;
            }
        }
    }
    match balance.values().filter(|&&n| n != 0).count() {
        0 => "some edges belong to more than two faces".to_owned(),
        1 => "one edge lacks a second face".to_owned(),
        n => format!("{n} edges lack a second face"),
    }
}

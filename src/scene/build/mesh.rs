//! Meshes: named ones, files, lists of vertices, generators.

use std::sync::Arc;

use glam::DVec3;

use super::{
    Builder, SharedMesh,
    stock::{Cut, Origin, Request, Shading, mesh_help},
};
use crate::{
    geometry::mesh::MeshError,
    scene::{
        MAX_LENGTH,
        description::{HeightField, MeshFields, MeshSource, Smooth, TorusKnot, Triple, Waves},
        generate,
        mesh_file::{MeshData, Names},
        outline::NodeId,
    },
};

/// An entry of `meshes`.
#[derive(Clone)]
pub(super) struct Named<'d> {
    origin: Origin,
    /// The file as written, if it is one.
    file: Option<&'d str>,
    /// Where it is written.
    place: NodeId,
    shading: Shading,
}

impl<'d> Builder<'d> {
    /// Reads what stands in `meshes`; those that no object shows are built to
    /// find their mistakes.
    pub(super) fn named_meshes(&mut self) {
        for (name, part) in &self.description.meshes {
            if self.report.diagnostics.is_full() {
                break;
            }
            let node = part.node;
            let named = part
                .value
                .as_ref()
                .and_then(|source| self.named_mesh(name, node, source));
            let unused = named
                .as_ref()
                .filter(|named| !self.stock.is_wanted(&named.origin))
                .cloned();
            self.meshes.insert(name, named);
            if let Some(named) = unused {
                self.named_parts(&named, Request::default());
            }
        }
    }

    fn named_mesh(
        &mut self,
        name: &str,
        node: NodeId,
        source: &'d MeshSource,
    ) -> Option<Named<'d>> {
        let file = |builder: &mut Self, place, file: &'d str, shading| Named {
            origin: builder.stock.origin_of(builder.base_dir, file),
            file: Some(file),
            place,
            shading,
        };
        let data = match source {
            MeshSource::File(path) => return Some(file(self, node, path, Shading::AsGiven)),
            MeshSource::Mesh(fields) if fields.named.is_some() => {
                let place = self.report.field(node, "named");
                let label = "expected a file or vertices";
                let help = "objects can name the other mesh themselves";
                return self.report.reject(
                    place,
                    "a mesh that is only another one's name",
                    label,
                    help,
                );
            }
            MeshSource::Mesh(fields) => {
                let which = self.mesh_form(node, fields);
                let shading = self.shading(node, fields);
                if let (Some(0), Some(path)) = (which, fields.file.as_deref()) {
                    let place = self.report.field(node, "file");
                    return Some(file(self, place, path, shading?));
                }
                which.and_then(|_| self.mesh_in_place(node, fields))
            }
            MeshSource::Waves(waves) => self.waves(node, waves),
            MeshSource::TorusKnot(knot) => self.torus_knot(node, knot),
            MeshSource::HeightField(field) => self.height_field(node, field),
        };
        let origin = Origin::Named(name.to_owned());
        let is_good = data.is_some();
        self.stock.keep(origin.clone(), data);
        let shading = match source {
            MeshSource::Mesh(fields) => Shading::of(fields.smooth),
            _ => Shading::AsGiven,
        };
        is_good.then_some(Named {
            origin,
            file: None,
            place: node,
            shading,
        })
    }

    fn named_parts(&mut self, named: &Named<'d>, mut request: Request) -> Option<Vec<Cut>> {
        match named.file {
            Some(file) => self.file_parts(named.place, file, request),
            None => {
                let node = named.place;
                self.parts(named.origin.clone(), &mut request, |builder, e| {
                    builder.broken_in_place::<()>(node, e);
                })
            }
        }
    }

    /// Which of `file`, `named` and `vertices` is given, with nothing that
    /// does not go with it.
    fn mesh_form(&mut self, node: NodeId, fields: &MeshFields) -> Option<usize> {
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
        Some(which)
    }

    fn shading(&mut self, node: NodeId, fields: &MeshFields) -> Option<Shading> {
        if let Some(Smooth::Angle(degrees)) = fields.smooth
            && !(0.0..=180.0).contains(&degrees.0)
        {
            let place = self.report.field(node, "smooth");
            let label = "expected an angle from 0 to 180 degrees";
            let help = "30 keeps most edges of man-made things; `true` is 180";
            return self
                .report
                .reject(place, "a crease angle out of range", label, help);
        }
        Some(Shading::of(fields.smooth))
    }

    /// The mesh of `Mesh(..)`.
    pub(super) fn mesh_shape(&mut self, node: NodeId, fields: &'d MeshFields) -> SharedMesh {
        let parts = self.mesh_parts(node, fields, vec![])?;
        parts.into_iter().next().map(|(_, mesh)| mesh)
    }

    /// The mesh of `Mesh(..)`, cut by names.
    pub(super) fn mesh_parts(
        &mut self,
        node: NodeId,
        fields: &'d MeshFields,
        keys: Vec<String>,
    ) -> Option<Vec<Cut>> {
        let which = self.mesh_form(node, fields);
        let shading = self.shading(node, fields)?;
        let request = Request { shading, keys };
        match which? {
            0 => {
                let place = self.report.field(node, "file");
                self.file_parts(place, fields.file.as_deref()?, request)
            }
            1 => {
                let named = self.named_by(node, fields)?;
                let shading = fields.smooth.map_or(named.shading, |_| request.shading);
                self.named_parts(&named, Request { shading, ..request })
            }
            _ => {
                let data = self.mesh_in_place(node, fields)?;
                match self.lone_mesh(data, request.shading) {
                    Ok(mesh) => Some(vec![(None, mesh?)]),
                    Err(e) => self.broken_in_place(node, &e),
                }
            }
        }
    }

    /// The entry of `meshes` that is named.
    fn named_by(&mut self, node: NodeId, fields: &MeshFields) -> Option<Named<'d>> {
        let name = fields.named.as_deref()?;
        if let Some(named) = self.meshes.get(name) {
            return named.clone();
        }
        let place = self.report.field(node, "named");
        self.dangling(place, "mesh", "meshes", name);
        None
    }

    /// The names in the file behind `Mesh(..)`; empty if it is no file.
    pub(super) fn mesh_names(
        &mut self,
        node: NodeId,
        fields: &'d MeshFields,
    ) -> Option<Arc<Names>> {
        if let Some(file) = &fields.file {
            let place = self.report.field(node, "file");
            return self.names_in(place, file);
        }
        if fields.named.is_some() {
            let named = self.named_by(node, fields)?;
            if let Some(file) = named.file {
                return self.names_in(named.place, file);
            }
        }
        Some(Arc::default())
    }

    fn mesh_in_place(&mut self, node: NodeId, fields: &MeshFields) -> Option<MeshData> {
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
        Some(MeshData {
            vertices: to_vectors(vertices),
            normals: fields.normals.as_deref().map(to_vectors),
            triangles,
            names: Names::default(),
        })
    }

    /// Reports what is wrong with a mesh whose numbers stand in the scene.
    fn broken_in_place<T>(&mut self, node: NodeId, e: &MeshError) -> Option<T> {
        let place = match e {
            MeshError::IndexOutOfRange { triangle, .. } => {
                let list = self.report.field(node, "triangles");
                self.report.outline.item(list, *triangle).unwrap_or(list)
            }
            MeshError::NormalCount { .. } => self.report.field(node, "normals"),
            _ => self.report.field(node, "triangles"),
        };
        self.report
            .reject(place, format!("a broken mesh: {e}"), "here", mesh_help(e))
    }

    fn waves(&mut self, node: NodeId, waves: &Waves) -> Option<MeshData> {
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
        Some(generate::waves(waves))
    }

    fn torus_knot(&mut self, node: NodeId, knot: &TorusKnot) -> Option<MeshData> {
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
        Some(generate::torus_knot(knot))
    }

    /// Takes triangles from what generators may make in one scene.
    pub(super) fn budget(&mut self, node: NodeId, key: &str, triangles: u64) -> Option<()> {
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
            crate::scene::MAX_TRIANGLES
        );
        self.report.reject(
            place,
            message,
            label,
            "make the mesh coarser, or finer if it has none",
        )
    }

    /// The mesh of `Waves(..)`.
    pub(super) fn waves_shape(&mut self, node: NodeId, waves: &Waves) -> SharedMesh {
        let data = self.waves(node, waves)?;
        self.generated(node, data)
    }

    /// The mesh of `TorusKnot(..)`.
    pub(super) fn torus_knot_shape(&mut self, node: NodeId, knot: &TorusKnot) -> SharedMesh {
        let data = self.torus_knot(node, knot)?;
        self.generated(node, data)
    }

    /// The mesh of `HeightField(..)`.
    pub(super) fn height_field_shape(&mut self, node: NodeId, field: &HeightField) -> SharedMesh {
        let data = self.height_field(node, field)?;
        self.generated(node, data)
    }

    fn generated(&mut self, node: NodeId, data: MeshData) -> SharedMesh {
        match self.lone_mesh(data, Shading::AsGiven) {
            Ok(mesh) => mesh,
            Err(e) => self.broken_in_place(node, &e),
        }
    }
}

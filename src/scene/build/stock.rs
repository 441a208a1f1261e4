//! Meshes on their way from a file to the objects that show it: read once,
//! cut by names and shaded as often as asked for in different ways, shared by
//! all who ask for the same.

use std::{
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{Builder, SharedMesh, placement::sin_cos_degrees};
use crate::{
    geometry::{
        TriangleMesh,
        mesh::{MeshError, crease::creased, validate},
    },
    scene::{
        description::{Description, MeshSource, ShapeDescription, Smooth},
        mesh_file::{self, Loading, MeshData, Names},
        outline::NodeId,
    },
};

/// Where a mesh comes from.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Origin {
    /// A file, by a path that is the same for all ways to write it.
    File(PathBuf),
    /// An entry of `meshes` that is not a file.
    Named(String),
}

/// Which normals shade a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum Shading {
    /// Those of the file, if it has any.
    #[default]
    AsGiven,
    /// Those of the file, or else made from all faces at a vertex.
    Round,
    Faceted,
    /// Made from the faces; the bits of the crease angle in degrees.
    Crease(u64),
}

impl Shading {
    pub(super) fn of(smooth: Option<Smooth>) -> Self {
        match smooth {
            None => Self::AsGiven,
            Some(Smooth::Flag(true)) => Self::Round,
            Some(Smooth::Flag(false)) => Self::Faceted,
            Some(Smooth::Angle(degrees)) => Self::Crease(degrees.0.to_bits()),
        }
    }
}

/// What is asked of a mesh: how it is shaded and by which names it is cut.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Request {
    pub(super) shading: Shading,
    pub(super) keys: Vec<String>,
}

/// A part of a mesh: which of the names it goes by, if any.
pub(super) type Cut = (Option<usize>, Arc<TriangleMesh>);

/// What was read from an origin.
struct Read {
    /// `None` once nobody else will ask for it.
    data: Option<MeshData>,
    has_normals: bool,
    names: Arc<Names>,
}

#[derive(Default)]
pub(super) struct Stock {
    /// Paths as written, and as they are compared.
    paths: HashMap<String, PathBuf>,
    /// What objects will ask for and have not yet.
    wanted: HashMap<Origin, HashSet<Request>>,
    /// `None` for what is broken and has been reported.
    read: HashMap<Origin, Option<Read>>,
    built: HashMap<(Origin, Request), Option<Vec<Cut>>>,
}

impl Stock {
    /// Looks through a scene for what will be asked for, so that the data of
    /// a file can go when its last mesh is built.
    pub(super) fn for_scene(description: &Description, base_dir: &Path) -> Self {
        let mut stock = Self::default();
        let named: HashMap<&str, &MeshSource> = (description.meshes.iter())
            .filter_map(|(name, part)| Some((name.as_str(), part.value.as_ref()?)))
            .collect();
        for object in &description.objects {
            let shape = object.value.shape.as_ref().map(|s| &s.value);
            let Some(ShapeDescription::Mesh(fields)) = shape else {
                continue;
            };
            let (file, smooth) = match (&fields.file, &fields.named) {
                (Some(file), _) => (Some(file), fields.smooth),
                (None, Some(name)) => match named.get(name.as_str()) {
                    Some(MeshSource::File(file)) => (Some(file), fields.smooth),
                    Some(MeshSource::Mesh(f)) => (f.file.as_ref(), fields.smooth.or(f.smooth)),
                    _ => (None, fields.smooth),
                },
                (None, None) => continue,
            };
            let origin = match (file, &fields.named) {
                (Some(file), _) => stock.origin_of(base_dir, file),
                (None, Some(name)) => Origin::Named(name.clone()),
                (None, None) => continue,
            };
            let keys = object.value.materials.iter().flat_map(|m| &m.value);
            let request = Request {
                shading: Shading::of(smooth),
                keys: keys.map(|(name, _)| name.clone()).collect(),
            };
            stock.wanted.entry(origin).or_default().insert(request);
        }
        stock
    }

    pub(super) fn origin_of(&mut self, base_dir: &Path, file: &str) -> Origin {
        let same = self.paths.entry(file.to_owned()).or_insert_with(|| {
            let path = base_dir.join(file);
            path.canonicalize().unwrap_or(path)
        });
        Origin::File(same.clone())
    }

    pub(super) fn is_wanted(&self, origin: &Origin) -> bool {
        self.wanted.get(origin).is_some_and(|w| !w.is_empty())
    }

    /// Keeps what an entry of `meshes` gives.
    pub(super) fn keep(&mut self, origin: Origin, data: Option<MeshData>) {
        let read = data.map(|mut data| Read {
            has_normals: data.normals.is_some(),
            names: Arc::new(std::mem::take(&mut data.names)),
            data: Some(data),
        });
        self.read.insert(origin, read);
    }

    /// The data of an origin, for one who asks; a copy while others will.
    fn take(&mut self, origin: &Origin, request: &Request) -> Option<MeshData> {
        let others = self.wanted.get_mut(origin).is_some_and(|wanted| {
            wanted.remove(request);
            !wanted.is_empty()
        });
        let read = self.read.get_mut(origin)?.as_mut()?;
        let mut data = if others {
            read.data.clone()?
        } else {
            read.data.take()?
        };
        if !request.keys.is_empty() {
            data.names = (*read.names).clone();
        }
        Some(data)
    }
}

impl Builder<'_> {
    /// The names in a mesh file; `None` if the file is broken.
    pub(super) fn names_in(&mut self, place: NodeId, file: &str) -> Option<Arc<Names>> {
        let origin = self.stock.origin_of(self.base_dir, file);
        self.read(place, &origin, file)?;
        let read = self.stock.read.get(&origin)?.as_ref()?;
        Some(read.names.clone())
    }

    /// The parts of a mesh file, made for the first who asks. Each file is
    /// read once, and its mistakes are reported once.
    pub(super) fn file_parts(
        &mut self,
        place: NodeId,
        file: &str,
        mut request: Request,
    ) -> Option<Vec<Cut>> {
        let origin = self.stock.origin_of(self.base_dir, file);
        self.read(place, &origin, file)?;
        let path = self.base_dir.join(file);
        self.parts(origin, &mut request, |builder, e| {
            let message = format!("the mesh file {} is broken: {e}", path.display());
            builder
                .report
                .reject::<()>(place, message, "this file", mesh_help(e));
        })
    }

    /// The parts of an entry of `meshes` that was kept; `explain` reports
    /// what is wrong with it.
    pub(super) fn parts(
        &mut self,
        origin: Origin,
        request: &mut Request,
        explain: impl FnOnce(&mut Self, &MeshError),
    ) -> Option<Vec<Cut>> {
        let asked = request.clone();
        let read = self.stock.read.get(&origin)?.as_ref()?;
        if request.shading == Shading::Round && read.has_normals {
            request.shading = Shading::AsGiven;
        }
        let key = (origin, request.clone());
        if let Some(parts) = self.stock.built.get(&key) {
            let known = parts.clone();
            if let Some(wanted) = self.stock.wanted.get_mut(&key.0) {
                wanted.remove(&asked);
            }
            return known;
        }
        let data = self.stock.take(&key.0, &asked)?;
        let parts = match cut(data, request, self.watch) {
            Ok(parts) => Some(parts),
            Err(e) => {
                explain(self, &e);
                None
            }
        };
        self.stock.built.insert(key, parts.clone());
        parts
    }

    /// Reads a file if that was not done; `None` if it is broken.
    fn read(&mut self, place: NodeId, origin: &Origin, file: &str) -> Option<()> {
        if let Some(read) = self.stock.read.get(origin) {
            return read.as_ref().map(|_| ());
        }
        let path = self.base_dir.join(file);
        let data = match mesh_file::read(&path, self.watch, &self.inputs) {
            Ok(data) => Some(data),
            Err(diagnostic) if !path.is_file() => self.report.reject(
                place,
                format!("cannot use {}: {}", path.display(), diagnostic.message),
                format!(
                    "expected a file whose name ends in {}",
                    mesh_file::EXTENSIONS
                ),
                "paths are relative to the scene file's directory",
            ),
            Err(diagnostic) => {
                let span = self.report.outline.span(place);
                let (line, column) = self.report.source.position(span.start);
                let used = format!("used at {}:{line}:{column}", self.report.source.name());
                self.report.push(diagnostic.with_note(used));
                None
            }
        };
        let is_good = data.is_some();
        self.stock.keep(origin.clone(), data);
        is_good.then_some(())
    }

    /// A mesh that only one object shows, with nothing to cut.
    pub(super) fn lone_mesh(
        &self,
        data: MeshData,
        shading: Shading,
    ) -> Result<SharedMesh, MeshError> {
        let request = Request {
            shading,
            keys: vec![],
        };
        let parts = cut(data, &request, self.watch)?;
        Ok(parts.into_iter().next().map(|(_, mesh)| mesh))
    }
}

/// Cuts a mesh into parts and shades each.
fn cut(data: MeshData, request: &Request, watch: mesh_file::Watch) -> Result<Vec<Cut>, MeshError> {
    let parts = if request.keys.is_empty() {
        vec![(None, data)]
    } else {
        let keys: Vec<&str> = request.keys.iter().map(String::as_str).collect();
        data.split(&keys)
    };
    let build = |(key, data): (Option<usize>, MeshData)| {
        watch(Loading::Building {
            triangles: data.triangles.len(),
        });
        let data = shaded(data, request.shading)?;
        let mesh = TriangleMesh::new(data.vertices, data.normals, data.triangles)?;
        Ok((key, Arc::new(mesh)))
    };
    parts.into_iter().map(build).collect()
}

fn shaded(data: MeshData, shading: Shading) -> Result<MeshData, MeshError> {
    let cosine = match shading {
        Shading::AsGiven => return Ok(data),
        Shading::Round if data.normals.is_some() => return Ok(data),
        Shading::Faceted => {
            return Ok(MeshData {
                normals: None,
                ..data
            });
        }
        Shading::Round => -1.0,
        Shading::Crease(bits) => sin_cos_degrees(f64::from_bits(bits)).1,
    };
    validate(&data.vertices, None, &data.triangles)?;
    let made = creased(&data.vertices, &data.triangles, cosine);
    Ok(MeshData {
        vertices: made.positions,
        normals: Some(made.normals),
        triangles: made.triangles,
        names: data.names,
    })
}

pub(super) fn mesh_help(error: &MeshError) -> &'static str {
    match error {
        MeshError::IndexOutOfRange { .. } => "vertices are counted from 0",
        MeshError::NormalCount { .. } => "give one normal per vertex, or leave the normals out",
        MeshError::Empty | MeshError::AllDegenerate(_) => {
            "a mesh needs at least one triangle of some area"
        }
        _ => "",
    }
}

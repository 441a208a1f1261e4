//! Mesh files: Wavefront OBJ, Stanford PLY, STL and glTF 2.0.
//!
//! The readers are the project's own because every mistake is reported with
//! its line and column (text) or byte offset (binary). They never reserve
//! memory for what a header merely claims, check every index, and accept only
//! finite numbers. Polygons become fans of triangles. Large files are read in
//! chunks by all threads; the result does not depend on how many.

mod fault;
mod gltf;
mod lines;
mod names;
mod obj;
mod ply;
mod progress;
mod stl;

use std::{fs::File, io::Read, path::Path};

use glam::DVec3;

use super::{Inputs, diagnostics::Diagnostic};
use fault::Fault;
use progress::Progress;

pub use names::Names;
pub use progress::{Loading, Watch};

/// Largest mesh file, in bytes.
pub const MAX_MESH_BYTES: u64 = 8 << 30;
/// Largest coordinate of a vertex, in metres.
const MAX_COORDINATE: f64 = super::MAX_LENGTH;
/// What the name of a mesh file ends in.
pub(super) const EXTENSIONS: &str = ".obj, .ply, .stl, .gltf or .glb";

/// A mesh as a file or a generator gives it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Positions in metres.
    pub vertices: Vec<DVec3>,
    /// One unit normal per vertex.
    pub normals: Option<Vec<DVec3>>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// What the file calls its triangles.
    pub names: Names,
}

impl MeshData {
    /// The triangles that go by each of `keys`, and those that go by none, as
    /// meshes of their own: the latter first, those without triangles left
    /// out. Vertices stand in the order of their first use.
    pub(super) fn split(&self, keys: &[&str]) -> Vec<(Option<usize>, Self)> {
        let mut lists: Vec<Vec<[u32; 3]>> = vec![Vec::new(); keys.len() + 1];
        let mut from = 0;
        let rest = [(self.triangles.len(), None)];
        for (end, key) in self.names.runs_by(keys).into_iter().chain(rest) {
            lists[key.map_or(0, |k| k + 1)].extend_from_slice(&self.triangles[from..end]);
            from = end;
        }
        let mut renamed = vec![u32::MAX; self.vertices.len()];
        let lists = lists.into_iter().enumerate();
        lists
            .filter(|(_, triangles)| !triangles.is_empty())
            .map(|(i, triangles)| {
                (
                    i.checked_sub(1),
                    self.with_triangles(triangles, &mut renamed),
                )
            })
            .collect()
    }

    /// Some triangles and the vertices that they use; `renamed` is full of
    /// `u32::MAX` and left so.
    fn with_triangles(&self, mut triangles: Vec<[u32; 3]>, renamed: &mut [u32]) -> Self {
        let mut old = Vec::new();
        for corner in triangles.iter_mut().flatten() {
            let name = &mut renamed[*corner as usize];
            if *name == u32::MAX {
                *name = old.len() as u32;
                old.push(*corner as usize);
            }
            *corner = *name;
        }
        for &i in &old {
            renamed[i] = u32::MAX;
        }
        let pick = |list: &Vec<DVec3>| old.iter().map(|&i| list[i]).collect();
        Self {
            vertices: pick(&self.vertices),
            normals: self.normals.as_ref().map(pick),
            triangles,
            names: Names::default(),
        }
    }
}

/// Reads a mesh file; the extension decides the format. `inputs` takes note of
/// it and of the files that it names.
///
/// # Errors
/// What is wrong with the file, and where.
pub fn read(path: &Path, watch: Watch, inputs: &Inputs) -> Result<MeshData, Box<Diagnostic>> {
    let name = path.display().to_string();
    let bytes =
        read_bytes(path).map_err(|message| Box::new(Diagnostic::of_file(&name, message)))?;
    inputs.add(path, &bytes);
    parse_watched(&name, &bytes, watch, inputs)
}

/// Reads a mesh from the bytes of a file; the name's extension decides the
/// format. Other files that the bytes name are looked for beside it.
///
/// # Errors
/// What is wrong with the bytes, and where.
pub fn parse(name: &str, bytes: &[u8]) -> Result<MeshData, Box<Diagnostic>> {
    parse_watched(name, bytes, &|_| {}, &Inputs::default())
}

fn parse_watched(
    name: &str,
    bytes: &[u8],
    watch: Watch,
    inputs: &Inputs,
) -> Result<MeshData, Box<Diagnostic>> {
    let path = Path::new(name);
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    let progress = Progress::new(watch, name, bytes.len());
    let folder = path.parent().unwrap_or(Path::new(""));
    let result = match extension.to_ascii_lowercase().as_str() {
        "obj" => obj::parse(bytes, lines::CHUNK, &progress),
        "ply" => ply::parse(bytes, lines::CHUNK, &progress),
        "stl" => stl::parse(bytes, &progress),
        "gltf" => gltf::parse_text(bytes, folder, inputs),
        "glb" => gltf::parse_binary(bytes, folder, inputs),
        _ => Err(Fault::file(format!(
            "the name of a mesh file ends in {EXTENSIONS}"
        ))),
    };
    let result = result.and_then(|mesh| {
        if mesh.triangles.is_empty() {
            return Err(Fault::file("the mesh has no faces"));
        }
        Ok(mesh)
    });
    result.map_err(|fault| Box::new(fault.into_diagnostic(name, bytes)))
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let unreadable = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => "there is no such mesh file".to_owned(),
        _ => format!("cannot read the mesh file: {e}"),
    };
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err("this is not a regular file".to_owned());
    }
    if metadata.len() > MAX_MESH_BYTES {
        return Err(format!(
            "the file is larger than {} GiB",
            MAX_MESH_BYTES >> 30
        ));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(MAX_MESH_BYTES)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    Ok(bytes)
}

/// Adds a polygon as a fan around its first vertex.
fn push_fan(triangles: &mut Vec<[u32; 3]>, polygon: &[u32]) {
    for i in 2..polygon.len() {
        triangles.push([polygon[0], polygon[i - 1], polygon[i]]);
    }
}

/// A position, if its coordinates are finite and within the language's range.
fn position(c: [f64; 3]) -> Option<DVec3> {
    // NaN fails the comparison, too.
    c.iter()
        .all(|x| x.abs() <= MAX_COORDINATE)
        .then(|| DVec3::from_array(c))
}

/// A normal of unit length; the zero vector stands for "none".
fn unit_normal(c: [f64; 3]) -> Option<DVec3> {
    let n = DVec3::from_array(c);
    if !n.is_finite() {
        return None;
    }
    let largest = n.abs().max_element();
    Some(if largest > 0.0 {
        (n / largest).normalize()
    } else {
        DVec3::ZERO
    })
}

/// Replaces missing (zero) normals by the mean direction of the adjacent
/// faces, weighted by area; without any normals there is nothing to fill.
fn fill_normals(vertices: &[DVec3], triangles: &[[u32; 3]], normals: &mut [DVec3]) {
    if normals.iter().all(|n| *n != DVec3::ZERO) {
        return;
    }
    let mut sums = vec![DVec3::ZERO; normals.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| vertices[i as usize]);
        let face = (b - a).cross(c - a);
        for i in t {
            sums[*i as usize] += face;
        }
    }
    for (n, sum) in normals.iter_mut().zip(sums) {
        if *n == DVec3::ZERO {
            *n = sum.try_normalize().unwrap_or(DVec3::Z);
        }
    }
}

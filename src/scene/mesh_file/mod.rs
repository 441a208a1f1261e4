//! Mesh files: Wavefront OBJ and Stanford PLY.
//!
//! The readers are the project's own because every mistake is reported with
//! its line and column (text) or byte offset (binary). They never reserve
//! memory for what a header merely claims, check every index, and accept only
//! finite numbers. Polygons become fans of triangles.

mod obj;
mod ply;

use std::{fs::File, io::Read, ops::Range, path::Path};

use glam::DVec3;

use super::diagnostics::Diagnostic;

/// Largest mesh file, in bytes.
pub const MAX_MESH_BYTES: u64 = 2 << 30;
/// Largest coordinate of a vertex, in metres.
const MAX_COORDINATE: f64 = super::MAX_LENGTH;

/// A mesh as a file or a generator gives it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Positions in metres.
    pub vertices: Vec<DVec3>,
    /// One unit normal per vertex.
    pub normals: Option<Vec<DVec3>>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// What is wrong with a mesh file.
#[derive(Clone, Debug)]
pub(super) struct Fault {
    at: FaultPlace,
    message: String,
    label: String,
}

#[derive(Clone, Debug)]
enum FaultPlace {
    File,
    /// Bytes to mark in a text.
    Text(Range<usize>),
    /// Offset in a binary file.
    Byte(usize),
}

impl Fault {
    fn file(message: impl Into<String>) -> Self {
        Self {
            at: FaultPlace::File,
            message: message.into(),
            label: String::new(),
        }
    }

    fn text(span: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Self {
        Self {
            at: FaultPlace::Text(span),
            message: message.into(),
            label: label.into(),
        }
    }

    fn byte(offset: usize, message: impl Into<String>) -> Self {
        Self {
            at: FaultPlace::Byte(offset),
            message: message.into(),
            label: String::new(),
        }
    }

    fn into_diagnostic(self, file: &str, bytes: &[u8]) -> Diagnostic {
        match self.at {
            FaultPlace::File => Diagnostic::of_file(file, self.message),
            FaultPlace::Byte(offset) => Diagnostic::at_byte(file, offset, self.message),
            FaultPlace::Text(span) => {
                let start = bytes[..span.start]
                    .iter()
                    .rposition(|&b| b == b'\n')
                    .map_or(0, |i| i + 1);
                let line = bytes[..start].split(|&b| b == b'\n').count();
                let rest = &bytes[start..];
                let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
                let text = String::from_utf8_lossy(&rest[..end]);
                let place = (line, span.start - start + 1);
                Diagnostic::in_line(file, text.trim_end(), place, span, self.message)
            }
        }
        .with_label(self.label)
    }
}

/// Reads a mesh file; the extension decides the format.
///
/// # Errors
/// What is wrong with the file, and where.
pub fn read(path: &Path) -> Result<MeshData, Box<Diagnostic>> {
    let name = path.display().to_string();
    let bytes =
        read_bytes(path).map_err(|message| Box::new(Diagnostic::of_file(&name, message)))?;
    parse(&name, &bytes)
}

/// Reads a mesh from the bytes of a file; the name's extension decides the
/// format.
///
/// # Errors
/// What is wrong with the bytes, and where.
pub fn parse(name: &str, bytes: &[u8]) -> Result<MeshData, Box<Diagnostic>> {
    let extension = Path::new(name)
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    let result = match extension.to_ascii_lowercase().as_str() {
        "obj" => obj::parse(bytes),
        "ply" => ply::parse(bytes),
        _ => Err(Fault::file("the name of a mesh file ends in .obj or .ply")),
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
            "the mesh file is larger than {} GiB",
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

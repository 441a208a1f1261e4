//! What makes a mesh impossible.

use glam::DVec3;

use crate::geometry::bvh::MAX_PRIMITIVES;

/// Most vertices of a mesh.
const MAX_VERTICES: usize = 1 << 31;

/// What is wrong with a mesh; indices count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No vertices or no triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// More triangles than the acceleration structure can address.
    #[error("the mesh has {0} triangles, more than {MAX_PRIMITIVES}")]
    TooLarge(usize),
    /// More vertices than edges can name.
    #[error("the mesh has {0} vertices, more than {MAX_VERTICES}")]
    TooManyVertices(usize),
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {index}, but there are only {vertices}")]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {0} has a coordinate that is not finite")]
    NonFinitePosition(usize),
    /// There are normals, but not one per vertex.
    #[error("there are {normals} normals for {vertices} vertices")]
    NormalCount {
        /// How many normals.
        normals: usize,
        /// How many vertices.
        vertices: usize,
    },
    /// A component of a normal is infinite or not a number.
    #[error("normal {0} has a component that is not finite")]
    NonFiniteNormal(usize),
    /// Every triangle has zero area.
    #[error("all {0} triangles have zero area")]
    AllDegenerate(usize),
}

/// Checks that numbers are finite and indices exist.
///
/// # Errors
/// The first defect found.
pub fn validate(
    positions: &[DVec3],
    normals: Option<&[DVec3]>,
    triangles: &[[u32; 3]],
) -> Result<(), MeshError> {
    let vertices = positions.len();
    if vertices == 0 || triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    if triangles.len() > MAX_PRIMITIVES {
        return Err(MeshError::TooLarge(triangles.len()));
    }
    if vertices > MAX_VERTICES {
        return Err(MeshError::TooManyVertices(vertices));
    }
    if let Some(i) = positions.iter().position(|p| !p.is_finite()) {
        return Err(MeshError::NonFinitePosition(i));
    }
    if let Some(normals) = normals {
        if normals.len() != vertices {
            return Err(MeshError::NormalCount {
                normals: normals.len(),
                vertices,
            });
        }
        if let Some(i) = normals.iter().position(|n| !n.is_finite()) {
            return Err(MeshError::NonFiniteNormal(i));
        }
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertices) {
            return Err(MeshError::IndexOutOfRange {
                triangle,
                index,
                vertices,
            });
        }
    }
    Ok(())
}

//! What can be wrong with a mesh, and whether it is closed.

use std::collections::HashMap;

use glam::DVec3;

use crate::geometry::bvh::MAX_PRIMITIVES;

/// What is wrong with a mesh; indices count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No vertices or no triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// More triangles than the acceleration structure can address.
    #[error("the mesh has {0} triangles, more than {MAX_PRIMITIVES}")]
    TooLarge(usize),
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

pub(super) fn check(
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

/// See [`TriangleMesh::is_closed`](super::TriangleMesh::is_closed). Triangles with two corners at the same
/// place have no inside edge to offer and are left out.
pub(super) fn is_closed(positions: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    let mut first_at = HashMap::with_capacity(positions.len());
    let welded: Vec<u32> = positions
        .iter()
        .enumerate()
        .map(|(i, p)| {
            // Adding zero makes -0 and 0 the same place.
            let place = (*p + DVec3::ZERO).to_array().map(f64::to_bits);
            *first_at.entry(place).or_insert(i as u32)
        })
        .collect();
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for t in triangles {
        let [a, b, c] = t.map(|i| welded[i as usize]);
        if a != b && b != c && c != a {
            // Key of the undirected edge, then its direction.
            edges.extend([(a, b), (b, c), (c, a)].map(|(i, j)| (i.min(j), i.max(j), i < j)));
        }
    }
    edges.sort_unstable();
    edges.chunks(2).all(|pair| {
        let [(a, b, first), (c, d, second)] = pair else {
            return false;
        };
        (a, b) == (c, d) && first != second
    }) && edges
        .windows(3)
        .all(|w| (w[0].0, w[0].1) != (w[2].0, w[2].1))
}

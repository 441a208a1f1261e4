//! Triangle meshes.

use std::collections::HashMap;

use glam::DVec3;

use super::{
    Aabb, BoundingSphere, Transform,
    bvh::{Bvh, MAX_PRIMITIVES},
    shape::{ShapeHit, ShapePoint, ShearedRay, point_at, triangle_normal},
};
use crate::numeric::gamma;

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

/// Triangles with shared vertices, and a tree over them.
///
/// Triangles are kept in the order of the tree's leaves and vertices in the
/// order of their first use, so that neighbours in space are neighbours in
/// memory; a part number is an index into this order.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    positions: Vec<DVec3>,
    normals: Option<Vec<DVec3>>,
    triangles: Vec<[u32; 3]>,
    bvh: Bvh,
    bounds: Aabb,
    sphere: BoundingSphere,
    closed: bool,
    dropped: usize,
    disagreeing: usize,
}

impl TriangleMesh {
    /// Checks the mesh and builds its tree.
    ///
    /// `normals`, one per vertex, need not have unit length. Triangles of
    /// zero area (to rounding: their normal would mean nothing) are dropped
    /// and counted, and so are the corners where a vertex normal is zero or
    /// points away from the triangle's side: shading uses the geometric
    /// normal there.
    ///
    /// # Errors
    ///
    /// The first defect found, see [`MeshError`].
    pub fn new(
        positions: Vec<DVec3>,
        normals: Option<Vec<DVec3>>,
        mut triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        check(&positions, normals.as_deref(), &triangles)?;
        let closed = is_closed(&positions, &triangles);
        let count = triangles.len();
        triangles.retain(|t| triangle_normal(&t.map(|i| positions[i as usize])).is_some());
        if triangles.is_empty() {
            return Err(MeshError::AllDegenerate(count));
        }
        let dropped = count - triangles.len();
        let corner_box = |i: usize| Aabb::around(triangles[i].map(|v| positions[v as usize]));
        let (bvh, order) = Bvh::build(triangles.len(), 4, corner_box);
        let mut mesh = Self {
            triangles: order.iter().map(|&i| triangles[i as usize]).collect(),
            positions,
            normals: normals.map(|n| n.into_iter().map(super::transform::unit).collect()),
            bvh,
            bounds: Aabb::EMPTY,
            sphere: BoundingSphere {
                center: DVec3::ZERO,
                radius: 0.0,
            },
            closed,
            dropped,
            disagreeing: 0,
        };
        mesh.sort_vertices();
        let box_around = Aabb::around(mesh.positions.iter().copied());
        let margin = gamma(16) * box_around.max_abs();
        mesh.bounds = box_around.padded(margin);
        mesh.sphere = BoundingSphere::around(mesh.positions.iter().copied());
        mesh.sphere.radius += 2.0 * margin;
        mesh.disagreeing = mesh.count_disagreeing();
        Ok(mesh)
    }

    /// The tree over the triangles.
    pub(super) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Renumbers the vertices in the order of their first use; unused ones
    /// go.
    fn sort_vertices(&mut self) {
        const UNUSED: u32 = u32::MAX;
        let mut renamed = vec![UNUSED; self.positions.len()];
        let mut old = Vec::with_capacity(self.positions.len());
        for corner in self.triangles.iter_mut().flatten() {
            let name = &mut renamed[*corner as usize];
            if *name == UNUSED {
                *name = old.len() as u32;
                old.push(*corner as usize);
            }
            *corner = *name;
        }
        self.positions = old.iter().map(|&i| self.positions[i]).collect();
        if let Some(normals) = &mut self.normals {
            *normals = old.iter().map(|&i| normals[i]).collect();
        }
    }

    fn count_disagreeing(&self) -> usize {
        let Some(normals) = &self.normals else {
            return 0;
        };
        let wrong = |t: &[u32; 3]| {
            let ng = triangle_normal(&self.corners(t)).unwrap_or(DVec3::ZERO);
            t.iter()
                .filter(|&&i| normals[i as usize].dot(ng) <= 0.0)
                .count()
        };
        self.triangles.iter().map(wrong).sum()
    }

    #[inline]
    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        triangle.map(|i| self.positions[i as usize])
    }

    /// The vertices of a part.
    #[inline]
    pub fn triangle(&self, part: u32) -> [DVec3; 3] {
        self.corners(&self.triangles[part as usize])
    }

    /// How many triangles there are, those of zero area left out.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// How many triangles of zero area were dropped.
    pub fn dropped_triangles(&self) -> usize {
        self.dropped
    }

    /// At how many triangle corners the vertex normal was zero or on the
    /// other side than the triangle's normal.
    pub fn disagreeing_normals(&self) -> usize {
        self.disagreeing
    }

    /// True if shading normals come from the vertices.
    pub fn is_smooth(&self) -> bool {
        self.normals.is_some()
    }

    /// True if every edge belongs to exactly two triangles that run through
    /// it in opposite directions; vertices at the same place count as one.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The volume enclosed, in cubic metres: negative if a closed mesh is
    /// wound so that its normals point inward. For an open mesh the number
    /// depends on the place and means nothing.
    pub fn signed_volume(&self) -> f64 {
        let center = self.bounds.center();
        let tetrahedron = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(t).map(|p| p - center);
            a.dot(b.cross(c))
        };
        self.triangles.iter().map(tetrahedron).sum::<f64>() / 6.0
    }

    /// See [`Shape::intersect`](super::Shape::intersect).
    #[inline]
    pub fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        let ray = ShearedRay::new(origin, dir);
        match ray.axis() {
            0 => self.closest_along::<0>(&ray, dir, t_max, leaving),
            1 => self.closest_along::<1>(&ray, dir, t_max, leaving),
            _ => self.closest_along::<2>(&ray, dir, t_max, leaving),
        }
    }

    #[inline(never)]
    fn closest_along<const AXIS: usize>(
        &self,
        ray: &ShearedRay,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        // No part has this number: there are at most 2^28.
        let leaving = leaving.unwrap_or(u32::MAX);
        let mut best = None;
        self.bvh
            .closest(ray.origin(), dir, t_max, |slots, mut t_best| {
                for (slot, triangle) in slots.clone().zip(&self.triangles[slots]) {
                    let part = slot as u32;
                    if part == leaving {
                        continue;
                    }
                    if let Some((t, uv)) = ray.hit_along::<AXIS>(&self.corners(triangle), t_best) {
                        t_best = t;
                        best = Some(ShapeHit { t, part, uv });
                    }
                }
                t_best
            });
        best
    }

    /// See [`Shape::occludes`](super::Shape::occludes).
    #[inline]
    pub fn occludes(&self, origin: DVec3, dir: DVec3, t_max: f64, leaving: Option<u32>) -> bool {
        let ray = ShearedRay::new(origin, dir);
        match ray.axis() {
            0 => self.any_along::<0>(&ray, dir, t_max, leaving),
            1 => self.any_along::<1>(&ray, dir, t_max, leaving),
            _ => self.any_along::<2>(&ray, dir, t_max, leaving),
        }
    }

    #[inline(never)]
    fn any_along<const AXIS: usize>(
        &self,
        ray: &ShearedRay,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> bool {
        let leaving = leaving.unwrap_or(u32::MAX);
        self.bvh.any(ray.origin(), dir, t_max, |slots| {
            slots
                .clone()
                .zip(&self.triangles[slots])
                .any(|(slot, triangle)| {
                    slot as u32 != leaving
                        && ray
                            .hit_along::<AXIS>(&self.corners(triangle), t_max)
                            .is_some()
                })
        })
    }

    /// See [`Shape::surface`](super::Shape::surface).
    #[inline]
    pub fn surface(&self, _origin: DVec3, _dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let triangle = &self.triangles[hit.part as usize];
        let corners = self.corners(triangle);
        let (p, error) = point_at(&corners, hit.uv);
        // Degenerate triangles were dropped; the fallback is never taken.
        let ng = triangle_normal(&corners).unwrap_or(DVec3::Z);
        ShapePoint {
            p,
            error,
            ng,
            ns: self.shading_normal(triangle, ng, hit.uv),
        }
    }

    /// The interpolated normal. Each corner's normal is on the side of `ng`
    /// or replaced by it, and weights are not negative: so is their sum.
    fn shading_normal(&self, triangle: &[u32; 3], ng: DVec3, uv: [f64; 2]) -> DVec3 {
        let Some(normals) = &self.normals else {
            return ng;
        };
        let [a, b, c] = triangle.map(|i| {
            let n = normals[i as usize];
            if n.dot(ng) > 0.0 { n } else { ng }
        });
        let ns = (a * (1.0 - uv[0] - uv[1]).max(0.0) + b * uv[0] + c * uv[1]).normalize_or(ng);
        if ns.dot(ng) > 0.0 { ns } else { ng }
    }

    /// See [`Shape::bounds`](super::Shape::bounds).
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// See [`Shape::bounding_sphere`](super::Shape::bounding_sphere).
    pub fn bounding_sphere(&self) -> BoundingSphere {
        self.sphere
    }

    /// The world box around the transformed vertices.
    pub(super) fn bounds_under(&self, transform: &Transform) -> Aabb {
        let farthest = self.bounds.min.abs().max(self.bounds.max.abs());
        let margin = transform.point_error(farthest, gamma(16) * farthest.max_element());
        Aabb::around(self.positions.iter().map(|&p| transform.point(p))).padded(margin)
    }
}

fn check(
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

/// See [`TriangleMesh::is_closed`]. Triangles with two corners at the same
/// place have no inside edge to offer and are left out.
fn is_closed(positions: &[DVec3], triangles: &[[u32; 3]]) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The cube `[-1, 1]^3`, wound outward.
    fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let positions = Aabb {
            min: DVec3::NEG_ONE,
            max: DVec3::ONE,
        }
        .corners();
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let split = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        (
            positions.to_vec(),
            faces.into_iter().flat_map(split).collect(),
        )
    }

    fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> TriangleMesh {
        TriangleMesh::new(positions, None, triangles).unwrap()
    }

    #[test]
    fn defects_are_named_with_their_place() {
        let (p, t) = cube();
        let error = |p: &[DVec3], n: Option<Vec<DVec3>>, t: &[[u32; 3]]| {
            TriangleMesh::new(p.to_vec(), n, t.to_vec()).unwrap_err()
        };
        assert_eq!(error(&[], None, &t), MeshError::Empty);
        assert_eq!(error(&p, None, &[]), MeshError::Empty);
        let mut bad = t.clone();
        bad[3][1] = 8;
        let expected = MeshError::IndexOutOfRange {
            triangle: 3,
            index: 8,
            vertices: 8,
        };
        assert_eq!(error(&p, None, &bad), expected);
        for x in [f64::NAN, f64::INFINITY] {
            let mut bad = p.clone();
            bad[5].y = x;
            assert_eq!(error(&bad, None, &t), MeshError::NonFinitePosition(5));
            let mut bad = p.clone();
            bad[2].z = x;
            assert_eq!(error(&p, Some(bad), &t), MeshError::NonFiniteNormal(2));
        }
        let expected = MeshError::NormalCount {
            normals: 7,
            vertices: 8,
        };
        assert_eq!(error(&p, Some(p[1..].to_vec()), &t), expected);
        assert_eq!(
            error(&p, None, &[[0, 0, 1], [2, 2, 2]]),
            MeshError::AllDegenerate(2)
        );
    }

    #[test]
    fn degenerate_triangles_are_dropped_and_counted() {
        let (mut p, mut t) = cube();
        // Collinear, twice the same corner, and a sliver below rounding.
        p.extend([DVec3::splat(0.0), DVec3::splat(0.5), DVec3::splat(0.25)]);
        p.push(DVec3::new(0.25, 0.25, 0.25f64.next_up()));
        t.extend([[8, 9, 10], [0, 0, 1], [8, 9, 11]]);
        let m = mesh(p, t);
        assert_eq!((m.triangle_count(), m.dropped_triangles()), (12, 3));
        // Small and thin ones are sound.
        let thin = [DVec3::ZERO, DVec3::X * 1e-200, DVec3::Y * 1e-210];
        assert_eq!(mesh(thin.to_vec(), vec![[0, 1, 2]]).triangle_count(), 1);
        let large = [DVec3::ZERO, DVec3::X * 1e200, DVec3::Y * 1e190];
        assert_eq!(mesh(large.to_vec(), vec![[0, 1, 2]]).triangle_count(), 1);
    }

    #[test]
    fn closed_or_open() {
        let (p, t) = cube();
        assert!(mesh(p.clone(), t.clone()).is_closed());
        assert!(!mesh(p.clone(), t[1..].to_vec()).is_closed(), "a hole");
        let mut flipped = t.clone();
        flipped[4].swap(0, 1);
        assert!(!mesh(p.clone(), flipped).is_closed(), "one triangle turned");
        // Every triangle with vertices of its own: welded by place, zeros of
        // either sign being one place.
        let shift = |v: DVec3| v + DVec3::ONE;
        let mut soup: Vec<_> = t.iter().flatten().map(|&i| shift(p[i as usize])).collect();
        let names: Vec<_> = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let zero = soup.iter_mut().find(|v| v.x == 0.0).unwrap();
        zero.x = -0.0;
        assert!(mesh(soup, names).is_closed(), "welded");
        let twice = [t.clone(), t.clone()].concat();
        assert!(!mesh(p, twice).is_closed(), "four triangles at each edge");
    }

    #[test]
    fn volume_tells_the_winding() {
        let (p, mut t) = cube();
        let moved: Vec<_> = p.iter().map(|&v| v + DVec3::splat(1e3)).collect();
        assert!((mesh(moved, t.clone()).signed_volume() - 8.0).abs() < 1e-10);
        for triangle in &mut t {
            triangle.swap(0, 1);
        }
        assert!((mesh(p, t).signed_volume() + 8.0).abs() < 1e-14);
    }

    #[test]
    fn shading_normals_stay_on_the_geometric_side() {
        let (p, t) = cube();
        let mut normals = p.clone();
        normals[0] = DVec3::ZERO;
        normals[7] = -normals[7];
        let m = TriangleMesh::new(p, Some(normals), t).unwrap();
        let wrong = [0usize, 7].map(|i| {
            cube()
                .1
                .iter()
                .flatten()
                .filter(|&&j| j as usize == i)
                .count()
        });
        assert_eq!(m.disagreeing_normals(), wrong[0] + wrong[1]);
        assert!(m.is_smooth());
        for part in 0..12 {
            let ng = triangle_normal(&m.triangle(part)).unwrap();
            for uv in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.3], [0.5, 0.5]] {
                let point = m.surface(DVec3::ZERO, DVec3::X, &ShapeHit { t: 1.0, part, uv });
                assert_eq!(point.ng, ng);
                assert!(point.ns.dot(ng) > 0.0 && (point.ns.length() - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn normals_are_interpolated() {
        let p = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let tilted = DVec3::new(3.0, 0.0, 4.0);
        let m = TriangleMesh::new(
            p,
            Some(vec![DVec3::Z, tilted, DVec3::Z * 7.0]),
            vec![[0, 1, 2]],
        );
        let m = m.unwrap();
        let down = m
            .intersect(DVec3::new(0.5, 0.25, 1.0), DVec3::NEG_Z, 2.0, None)
            .unwrap();
        let point = m.surface(DVec3::ZERO, DVec3::X, &down);
        let expected = (DVec3::Z * 0.5 + tilted / 5.0 * 0.5).normalize();
        assert!((point.ns - expected).length() < 1e-15, "{}", point.ns);
        assert_eq!((point.p, point.ng), (DVec3::new(0.5, 0.25, 0.0), DVec3::Z));
    }
}

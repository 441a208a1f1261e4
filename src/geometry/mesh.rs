//! Triangle meshes.

mod check;
pub mod crease;
mod defects;
#[cfg(test)]
mod tests;
pub mod weld;

use glam::DVec3;

use super::{
    Aabb, BoundingSphere, Transform, Turning,
    bvh::Bvh,
    shape::{
        Pieces, Place, ShapeHit, ShapePoint, ShearedRay, Surface, point_at, sound_normal,
        triangle_normal,
    },
    transform::unit,
    turning::outer,
};
use crate::{built, numeric::gamma};

pub use self::{
    check::{MeshError, validate},
    defects::{Defects, Edges},
};

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
    defects: Defects,
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
        validate(&positions, normals.as_deref(), &triangles)?;
        let defects = Defects::of(&positions, &triangles);
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
            normals: normals
                .filter(|_| built::SHADING_NORMALS)
                .map(|n| n.into_iter().map(unit).collect()),
            bvh,
            bounds: Aabb::EMPTY,
            sphere: BoundingSphere {
                center: DVec3::ZERO,
                radius: 0.0,
            },
            defects,
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

    /// The corners of every triangle.
    pub(super) fn all_corners(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.triangles.iter().map(|t| self.corners(t))
    }

    #[inline]
    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        let [a, b, c] = *triangle;
        [
            self.positions[a as usize],
            self.positions[b as usize],
            self.positions[c as usize],
        ]
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

    /// How many vertices there are, those left out that no triangle uses.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// How the triangles, those of zero area included, fail to join.
    pub fn defects(&self) -> &Defects {
        &self.defects
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

    /// The geometric and the shading normal at a point of a part.
    pub(super) fn normals(&self, part: u32, uv: [f64; 2]) -> (DVec3, DVec3) {
        let triangle = &self.triangles[part as usize];
        self.normals_of(triangle, &self.corners(triangle), uv)
    }

    /// [`normals`](Self::normals) of a triangle with these corners.
    #[inline]
    fn normals_of(
        &self,
        triangle: &[u32; 3],
        corners: &[DVec3; 3],
        uv: [f64; 2],
    ) -> (DVec3, DVec3) {
        // Degenerate triangles were dropped.
        let ng = sound_normal(corners);
        let ns = if self.has_normals() {
            self.normal_between(triangle, ng, uv)
        } else {
            ng
        };
        (ng, ns)
    }

    /// Whether shading normals are given.
    #[inline]
    fn has_normals(&self) -> bool {
        built::SHADING_NORMALS && self.normals.is_some()
    }

    /// The shading normal on the side of `ng`. Apart from what others need: they
    /// keep more in registers.
    #[inline(never)]
    fn normal_between(&self, triangle: &[u32; 3], ng: DVec3, uv: [f64; 2]) -> DVec3 {
        let smooth = self
            .corner_normals(triangle, ng)
            .and_then(|n| between(&n, uv).try_normalize());
        smooth.filter(|ns| ns.dot(ng) > 0.0).unwrap_or(ng)
    }

    /// The normals at the corners, each on the side of `ng` or replaced by
    /// it; `None` if the mesh has none.
    #[inline]
    fn corner_normals(&self, triangle: &[u32; 3], ng: DVec3) -> Option<[DVec3; 3]> {
        let normals = self.normals.as_ref().filter(|_| built::SHADING_NORMALS)?;
        let [a, b, c] = *triangle;
        let at = |i: u32| {
            let n = normals[i as usize];
            if n.dot(ng) > 0.0 { n } else { ng }
        };
        Some([at(a), at(b), at(c)])
    }
}

impl Surface for TriangleMesh {
    #[inline]
    fn intersect(
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

    #[inline]
    fn occludes(&self, origin: DVec3, dir: DVec3, t_max: f64, leaving: Option<u32>) -> bool {
        let ray = ShearedRay::new(origin, dir);
        match ray.axis() {
            0 => self.any_along::<0>(&ray, dir, t_max, leaving),
            1 => self.any_along::<1>(&ray, dir, t_max, leaving),
            _ => self.any_along::<2>(&ray, dir, t_max, leaving),
        }
    }

    #[inline]
    fn surface(&self, _origin: DVec3, _dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let triangle = &self.triangles[hit.part as usize];
        let corners = self.corners(triangle);
        let (p, error) = point_at(&corners, hit.uv);
        let (ng, ns) = self.normals_of(triangle, &corners, hit.uv);
        ShapePoint { p, error, ng, ns }
    }

    /// The derivative of the normalised mean of the corners' normals.
    fn turning(&self, part: u32, uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        let triangle = &self.triangles[part as usize];
        let corners = self.corners(triangle);
        let ng = at().ng;
        let smooth = self.corner_normals(triangle, ng).and_then(|normals| {
            let mean = between(&normals, uv);
            let length = mean.length();
            let ns = mean.try_normalize().filter(|ns| ns.dot(ng) > 0.0)?;
            Some((normals, ns, length))
        });
        let Some(([a, b, c], ns, length)) = smooth else {
            return Turning::of_facet(&corners);
        };
        // The weight of a vertex grows away from the opposite edge. Only the
        // direction of that edge matters, so that its length may be anything.
        let (e, f) = (corners[1] - corners[0], corners[2] - corners[0]);
        let gradient = |to: DVec3, opposite: DVec3| {
            let across = (opposite / opposite.abs().max_element()).cross(ng);
            across / to.dot(across)
        };
        let turn = |n: DVec3| (n - ns * ns.dot(n)) / length;
        Turning::General(outer(turn(b - a), gradient(e, f)) + outer(turn(c - a), gradient(f, e)))
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.bounds)
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        Some(self.sphere)
    }

    /// The world box around the transformed vertices.
    fn bounds_under(&self, transform: &Transform) -> Option<Aabb> {
        let farthest = self.bounds.min.abs().max(self.bounds.max.abs());
        let margin = transform.point_error(farthest, gamma(16) * farthest.max_element());
        let corners = self.positions.iter().map(|&p| transform.point(p));
        Some(Aabb::around(corners).padded(margin))
    }

    /// True if every edge belongs to exactly two triangles that run through
    /// it in opposite directions; vertices at the same place count as one.
    fn is_closed(&self) -> bool {
        self.defects.is_closed()
    }

    /// By the boxes of a few neighbouring triangles; infinite if none is
    /// within reach, and zero if one is within a small part of it.
    fn distance_bound(&self, p: DVec3, within: f64) -> f64 {
        if !self.bvh.near(p, within, |_| true) {
            return f64::INFINITY;
        }
        let parts = [0.25, 0.0625, 0.015_625].map(|part| part * within);
        let clear = |reach: &f64| !self.bvh.near(p, *reach, |_| true);
        parts.into_iter().find(clear).unwrap_or(0.0)
    }

    /// Triangle by triangle: its plane and its box.
    fn may_meet(&self, region: &Aabb) -> bool {
        let (center, half) = (region.center(), region.half_diagonal());
        let meets = |triangle: &[u32; 3]| {
            let v = self.corners(triangle);
            let (e, f) = (v[1] - v[0], v[2] - v[0]);
            let normal = e.cross(f);
            let beside = (center - v[0]).dot(normal).abs();
            let rounding = gamma(16) * (center.abs() + v[0].abs()).element_sum();
            let most = half.dot(normal.abs()) + rounding * e.length() * f.length();
            beside <= most && Aabb::around(v).overlaps(region)
        };
        self.bvh.near(center, half.length(), |slots| {
            self.triangles[slots].iter().any(meets)
        })
    }

    fn pieces(&self) -> Pieces {
        Pieces::FLAT
    }
}

/// The mean of the corners' normals. Each is on the side of the geometric
/// normal, and weights are not negative: so is their sum.
#[inline]
fn between([a, b, c]: &[DVec3; 3], uv: [f64; 2]) -> DVec3 {
    *a * (1.0 - uv[0] - uv[1]).max(0.0) + *b * uv[0] + *c * uv[1]
}

//! The parallelogram.

use glam::DVec3;

use super::{Pieces, Place, ShapeHit, ShapePoint, Surface, plane_crossing};
use crate::{
    geometry::{Aabb, BoundingSphere, Turning, transform::unit},
    numeric::gamma,
};

/// A parallelogram: `corner + a u + b v` with `a` and `b` in `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    corner: DVec3,
    u: DVec3,
    v: DVec3,
    normal: DVec3,
    /// `dual_u . u = 1`, `dual_u . v = 0`, and the other way round.
    dual_u: DVec3,
    dual_v: DVec3,
}

impl Quad {
    /// A parallelogram from a corner and two edges, in metres, which must
    /// not be parallel. Its normal is the direction of `u x v`.
    pub fn new(corner: DVec3, u: DVec3, v: DVec3) -> Self {
        let normal = unit(u.cross(v));
        // u . (v x n) is the area.
        let (dual_u, dual_v) = (v.cross(normal), normal.cross(u));
        Self {
            corner,
            u,
            v,
            normal,
            dual_u: dual_u / dual_u.dot(u),
            dual_v: dual_v / dual_v.dot(v),
        }
    }

    /// The corner from which both edges start.
    pub fn corner(&self) -> DVec3 {
        self.corner
    }

    /// The two edges.
    pub fn edges(&self) -> [DVec3; 2] {
        [self.u, self.v]
    }

    /// Unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The coordinates `(a, b)` of the ray's point at `t`.
    #[inline]
    fn coordinates(&self, origin: DVec3, dir: DVec3, t: f64) -> (f64, f64) {
        let from = (origin - self.corner) + dir * t;
        (self.dual_u.dot(from), self.dual_v.dot(from))
    }

    fn corners(&self) -> [DVec3; 4] {
        let c = self.corner;
        [c, c + self.u, c + self.v, c + self.u + self.v]
    }
}

impl Surface for Quad {
    #[allow(clippy::inline_always, reason = "as there")]
    #[inline(always)]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        if leaving.is_some() {
            return None;
        }
        let t = plane_crossing(self.corner, self.normal, origin, dir, t_max)?;
        let (a, b) = self.coordinates(origin, dir, t);
        let inside = (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b);
        inside.then(|| ShapeHit::on(0, t))
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        // Whatever the coordinates' error, the point formed from them lies in
        // the plane: one product and two sums away from it.
        let (a, b) = self.coordinates(origin, dir, hit.t);
        let p = self.corner + (self.u * a + self.v * b);
        let terms = self.corner.abs() + (self.u * a).abs() + (self.v * b).abs();
        ShapePoint {
            p,
            error: gamma(3) * terms.max_element(),
            ng: self.normal,
            ns: self.normal,
        }
    }

    fn bounds(&self) -> Option<Aabb> {
        let b = Aabb::around(self.corners());
        let reach = self.corner.abs() + self.u.abs() + self.v.abs();
        Some(b.padded(gamma(8) * reach.max_element()))
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        let half = 0.5 * (self.u + self.v).length().max((self.u - self.v).length());
        let reach = self.corner.abs() + self.u.abs() + self.v.abs();
        Some(BoundingSphere {
            center: self.corner + (self.u + self.v) * 0.5,
            radius: half + gamma(8) * reach.max_element(),
        })
    }

    #[inline]
    fn turning(&self, _part: u32, _uv: [f64; 2], _at: impl Fn() -> Place) -> Turning {
        Turning::Flat
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        (p - self.corner).dot(self.normal).abs()
    }

    fn pieces(&self) -> Pieces {
        Pieces::FLAT
    }
}

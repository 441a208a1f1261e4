//! The unbounded plane.

use glam::DVec3;

use super::{Pieces, Place, ShapeHit, ShapePoint, Surface, plane_crossing};
use crate::{
    geometry::{Aabb, Turning, transform::unit},
    numeric::{U, gamma},
};

/// A plane through a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: DVec3,
    normal: DVec3,
}

impl Plane {
    /// The plane through `point` with the given normal of any length but
    /// zero.
    pub fn new(point: DVec3, normal: DVec3) -> Self {
        Self {
            point,
            normal: unit(normal),
        }
    }

    /// The point by which the plane was given.
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// Unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }
}

impl Surface for Plane {
    #[inline]
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
        plane_crossing(self.point, self.normal, origin, dir, t_max).map(|t| ShapeHit::on(0, t))
    }

    /// A plane is crossed once at most; behind its normal is inside.
    fn ends_inside(&self, origin: DVec3, dir: DVec3, leaving: Option<u32>) -> bool {
        let (height, along) = if leaving.is_some() {
            (0.0, self.normal.dot(dir))
        } else {
            (self.normal.dot(origin - self.point), self.normal.dot(dir))
        };
        // A crossing that lies infinitely far is none.
        if (height / along).is_finite() {
            along < 0.0
        } else {
            height < 0.0
        }
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let (p, error) = drop_onto(self.point, self.normal, origin + dir * hit.t);
        ShapePoint {
            p,
            error,
            ng: self.normal,
            ns: self.normal,
        }
    }

    #[inline]
    fn turning(&self, _part: u32, _uv: [f64; 2], _at: impl Fn() -> Place) -> Turning {
        Turning::Flat
    }

    fn bounds(&self) -> Option<Aabb> {
        None
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        (p - self.point).dot(self.normal).abs()
    }

    fn may_meet(&self, region: &Aabb) -> bool {
        let reach = region.half_diagonal().dot(self.normal.abs());
        let center = region.center();
        let rounding = gamma(16) * (center.abs() + self.point.abs()).element_sum();
        self.distance_bound(center, reach) <= reach + rounding
    }

    fn pieces(&self) -> Pieces {
        Pieces::FLAT
    }
}

/// Moves `p` onto the plane; returns the point and its error.
///
/// The height above the plane is a difference, a product and two sums away
/// from exact, the normal itself about five roundings from unit length and
/// direction: ten, relative to the distance from the plane's point. Forming
/// the coordinates of the result rounds once more.
#[inline]
pub(super) fn drop_onto(point: DVec3, normal: DVec3, p: DVec3) -> (DVec3, f64) {
    let from = p - point;
    let dropped = p - normal * normal.dot(from);
    let reach = from.x.abs() + from.y.abs() + from.z.abs();
    let error = gamma(10) * reach + U * dropped.abs().max_element();
    (dropped, error)
}

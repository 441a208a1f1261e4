//! The flat disc.

use glam::DVec3;

use super::{Pieces, Place, ShapeHit, ShapePoint, Surface, plane::drop_onto, plane_crossing};
use crate::{
    geometry::{Aabb, BoundingSphere, Turning, transform::unit},
    numeric::gamma,
};

/// A disc around a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    center: DVec3,
    normal: DVec3,
    radius: f64,
}

impl Disc {
    /// A disc with a normal of any length but zero and a radius above zero,
    /// in metres.
    pub fn new(center: DVec3, normal: DVec3, radius: f64) -> Self {
        Self {
            center,
            normal: unit(normal),
            radius,
        }
    }

    /// Centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Radius in metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Surface for Disc {
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
        let t = plane_crossing(self.center, self.normal, origin, dir, t_max)?;
        let from = (origin - self.center) + dir * t;
        (from.length_squared() <= self.radius * self.radius).then(|| ShapeHit::on(0, t))
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let (p, error) = drop_onto(self.center, self.normal, origin + dir * hit.t);
        ShapePoint {
            p,
            error,
            ng: self.normal,
            ns: self.normal,
        }
    }

    fn bounds(&self) -> Option<Aabb> {
        let half = circle_half_widths(self.normal) * self.radius;
        let b = Aabb {
            min: self.center - half,
            max: self.center + half,
        };
        Some(b.padded(gamma(20) * (b.max_abs() + 3.0 * self.radius)))
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        Some(BoundingSphere {
            center: self.center,
            radius: self.radius,
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
        (p - self.center).dot(self.normal).abs()
    }

    fn pieces(&self) -> Pieces {
        Pieces::FLAT
    }
}

/// Half-widths along the axes of the unit circle around a unit normal:
/// `sqrt(1 - n_i^2)`, without the subtraction.
pub(super) fn circle_half_widths(n: DVec3) -> DVec3 {
    let sq = n * n;
    DVec3::new(
        (sq.y + sq.z).sqrt(),
        (sq.z + sq.x).sqrt(),
        (sq.x + sq.y).sqrt(),
    )
}

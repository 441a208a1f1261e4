//! The glowing parallelogram.

use glam::DVec3;

use crate::spectrum::Rgb;

use super::DirectSample;

/// A parallelogram of constant radiance on the side of `u x v`.
#[derive(Clone, Debug)]
pub struct QuadLight {
    /// One corner, metres.
    pub corner: DVec3,
    /// First edge, metres.
    pub u: DVec3,
    /// Second edge, metres.
    pub v: DVec3,
    /// Emitted radiance, W/m2/sr.
    pub radiance: Rgb,
}

impl QuadLight {
    /// Area in m2.
    pub fn area(&self) -> f64 {
        self.u.cross(self.v).length()
    }

    /// Unit normal of the emitting side.
    pub fn normal(&self) -> DVec3 {
        self.u.cross(self.v).normalize()
    }

    /// The point at edge coordinates `u` in the unit square. Pdf per area:
    /// one over the area.
    pub fn point(&self, u: [f64; 2]) -> DVec3 {
        self.corner + self.u * u[0] + self.v * u[1]
    }

    pub(super) fn sample_direct(&self, p: DVec3, u: [f64; 2]) -> Option<DirectSample> {
        // u x v is the normal times the area.
        let area_normal = self.u.cross(self.v);
        DirectSample::to_point(p, self.point(u), |wi, d2| {
            self.radiance * ((-wi).dot(area_normal).max(0.0) / d2)
        })
    }
}

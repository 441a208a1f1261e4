//! The glowing disc.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    numeric::{Frame, VectorPair},
    sampling::warp,
    spectrum::Rgb,
};

use super::DirectSample;

/// A disc of constant radiance on the side of its normal.
#[derive(Clone, Debug)]
pub struct DiscLight {
    /// Centre, metres.
    pub center: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Radius in metres, above 0.
    pub radius: f64,
    /// Emitted radiance, W/m2/sr.
    pub radiance: Rgb,
}

impl DiscLight {
    /// The point that `u` in the unit square maps to. Pdf per area: one over
    /// the area.
    pub fn point(&self, u: [f64; 2]) -> DVec3 {
        let p = warp::disc(u) * self.radius;
        let frame = Frame::around(self.normal);
        self.center + frame.s * p.x + frame.t * p.y
    }

    /// Derivatives of [`point`](Self::point) by `u`.
    pub fn point_derivatives(&self, u: [f64; 2]) -> VectorPair {
        let frame = Frame::around(self.normal);
        frame.pair_to_world(warp::disc_mapped(u).by) * self.radius
    }

    pub(super) fn sample_direct(&self, p: DVec3, u: [f64; 2]) -> Option<DirectSample> {
        let area = PI * self.radius * self.radius;
        DirectSample::to_point(p, self.point(u), |wi, d2| {
            self.radiance * ((-wi).dot(self.normal).max(0.0) * area / d2)
        })
    }
}

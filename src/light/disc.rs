//! The glowing disc.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    numeric::Frame,
    sampling::warp::{self, Mapped},
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
        self.point_mapped(u).at
    }

    /// [`point`](Self::point) with the patch of a cell around `u`.
    pub fn point_mapped(&self, u: [f64; 2]) -> Mapped<DVec3> {
        let local = warp::disc_mapped(u);
        let p = local.at * self.radius;
        let frame = Frame::around(self.normal);
        Mapped {
            at: self.center + frame.s * p.x + frame.t * p.y,
            by: frame.pair_to_world(local.by) * self.radius,
            room: local.room,
        }
    }

    pub(super) fn sample_direct(&self, p: DVec3, u: [f64; 2]) -> Option<DirectSample> {
        let area = PI * self.radius * self.radius;
        DirectSample::to_point(p, self.point(u), |wi, d2| {
            self.radiance * ((-wi).dot(self.normal).max(0.0) * area / d2)
        })
    }
}

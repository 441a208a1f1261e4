//! The glowing disc.

use glam::DVec3;

use crate::spectrum::Rgb;

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

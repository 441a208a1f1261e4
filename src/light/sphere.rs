//! The glowing sphere.

use glam::DVec3;

use crate::spectrum::Rgb;

/// A sphere of constant outward radiance.
#[derive(Clone, Debug)]
pub struct SphereLight {
    /// Centre, metres.
    pub center: DVec3,
    /// Radius in metres, above 0.
    pub radius: f64,
    /// Emitted radiance, W/m2/sr.
    pub radiance: Rgb,
}

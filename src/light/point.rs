//! The isotropic point light.

use glam::DVec3;

use crate::spectrum::Rgb;

/// Equal intensity in all directions.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Position in metres.
    pub position: DVec3,
    /// Radiant intensity, W/sr.
    pub intensity: Rgb,
}

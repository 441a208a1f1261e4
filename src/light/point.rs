//! The isotropic point light.

use glam::DVec3;

use crate::spectrum::Rgb;

use super::DirectSample;

/// Equal intensity in all directions.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Position in metres.
    pub position: DVec3,
    /// Radiant intensity, W/sr.
    pub intensity: Rgb,
}

impl PointLight {
    pub(super) fn sample_direct(&self, p: DVec3) -> Option<DirectSample> {
        DirectSample::to_point(p, self.position, |_, d2| self.intensity / d2)
    }
}

//! The collimated beam.

use glam::DVec3;

use crate::spectrum::Rgb;

/// Parallel light through a disc: it starts on the disc and travels along the
/// axis.
#[derive(Clone, Debug)]
pub struct Beam {
    /// Centre of the disc on which the beam starts, metres.
    pub center: DVec3,
    /// Unit direction of travel, normal to the disc.
    pub axis: DVec3,
    /// Radius of the cross-section in metres, above 0.
    pub radius: f64,
    /// Irradiance on a surface facing the beam, W/m2.
    pub irradiance: Rgb,
}

//! The sun: light from infinity within a cone of directions.

use glam::DVec3;

use crate::{numeric::trig, spectrum::Rgb};

/// Light from infinity, of constant radiance within a cone of directions; a
/// zero angle makes it an ideal parallel light with hard shadows.
#[derive(Clone, Debug)]
pub struct Sun {
    /// Unit direction of travel of the light from the sun's centre.
    pub axis: DVec3,
    /// Sine of half the angular diameter, in `[0, 1)`.
    pub sin_half: f64,
    /// Irradiance on a surface that faces the sun's centre, W/m2.
    pub irradiance: Rgb,
}

impl Sun {
    /// A sun shining along `axis` with an angular diameter in degrees,
    /// `0 <= angular_diameter < 180`.
    pub fn new(axis: DVec3, angular_diameter: f64, irradiance: Rgb) -> Self {
        Self {
            axis: axis.normalize(),
            sin_half: trig::sin_cos(0.5 * angular_diameter.to_radians()).0,
            irradiance,
        }
    }
}

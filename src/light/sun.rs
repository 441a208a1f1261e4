//! The sun: light from infinity within a cone of directions.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    numeric::{Frame, VectorPair, trig},
    sampling::warp,
    spectrum::Rgb,
};

use super::{DirectSample, Source};

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

    /// Radiance within the cone, W/m2/sr: irradiance over the projected solid
    /// angle `pi sin^2`. Black for an ideal parallel light, whose radiance is
    /// not finite.
    pub fn radiance(&self) -> Rgb {
        let projected = PI * self.sin_half * self.sin_half;
        if projected > 0.0 {
            self.irradiance / projected
        } else {
            Rgb::BLACK
        }
    }

    /// A direction of travel, uniform in solid angle over the cone, and the
    /// irradiance that it stands for on a surface facing it: radiance over
    /// pdf, in W/m2.
    pub fn sample_travel(&self, u: [f64; 2]) -> (DVec3, Rgb) {
        if self.sin_half == 0.0 {
            return (self.axis, self.irradiance);
        }
        let q = warp::one_minus_cos(self.sin_half);
        let dir = Frame::around(self.axis).to_world(warp::cone(u, q));
        (dir, self.radiance() / warp::cone_pdf(q))
    }

    /// Derivatives of the direction of [`sample_travel`](Self::sample_travel)
    /// by `u`; zero for an ideal parallel light.
    pub fn travel_derivatives(&self, u: [f64; 2]) -> VectorPair {
        if self.sin_half == 0.0 {
            return VectorPair::ZERO;
        }
        let q = warp::one_minus_cos(self.sin_half);
        let frame = Frame::around(self.axis);
        frame.pair_to_world(warp::cone_mapped(u, q).0.by)
    }

    pub(super) fn sample_direct(&self, u: [f64; 2]) -> Option<DirectSample> {
        let (dir, weight) = self.sample_travel(u);
        (!weight.is_black()).then_some(DirectSample {
            source: Source::Direction(-dir),
            wi: -dir,
            weight,
        })
    }

    pub(super) fn sky_radiance(&self, dir: DVec3) -> Rgb {
        let q = warp::one_minus_cos(self.sin_half);
        // 1 - cos of the angle to the sun's centre, without cancellation.
        let away = 0.5 * (dir + self.axis).length_squared();
        if away < q {
            self.radiance()
        } else {
            Rgb::BLACK
        }
    }
}

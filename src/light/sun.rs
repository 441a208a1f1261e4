//! The sun: light from infinity within a cone of directions.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    numeric::{Frame, trig},
    sampling::warp::{self, Mapped},
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

    /// A direction of travel, uniform in solid angle over the cone.
    pub fn travel(&self, u: [f64; 2]) -> Mapped<DVec3> {
        if self.sin_half == 0.0 {
            return Mapped::fixed(self.axis);
        }
        let q = warp::one_minus_cos(self.sin_half);
        let local = warp::cone_mapped(u, q).0;
        let frame = Frame::around(self.axis);
        Mapped {
            at: frame.to_world(local.at),
            by: frame.pair_to_world(local.by),
            room: local.room,
        }
    }

    /// The irradiance that one direction of [`travel`](Self::travel) stands for
    /// on a surface facing it: radiance over pdf, in W/m2.
    pub fn travelling(&self) -> Rgb {
        if self.sin_half == 0.0 {
            return self.irradiance;
        }
        let q = warp::one_minus_cos(self.sin_half);
        self.radiance() / warp::cone_pdf(q)
    }

    pub(super) fn sample_direct(&self, u: [f64; 2]) -> Option<DirectSample> {
        let (dir, weight) = (self.travel(u).at, self.travelling());
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

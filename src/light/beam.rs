//! The collimated beam.

use glam::DVec3;

use crate::spectrum::Rgb;

use super::{DirectSample, Source};

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

impl Beam {
    /// Irradiance on a surface facing the beam at `p`, W/m2.
    pub fn irradiance_at(&self, p: DVec3) -> Rgb {
        let f = p - self.center;
        let along = f.dot(self.axis);
        let across = (f - self.axis * along).length_squared();
        if along >= 0.0 && across <= self.radius * self.radius {
            self.irradiance
        } else {
            Rgb::BLACK
        }
    }

    pub(super) fn sample_direct(&self, p: DVec3) -> Option<DirectSample> {
        let weight = self.irradiance_at(p);
        // The shadow ray ends where the light starts, on the disc.
        let along = (p - self.center).dot(self.axis);
        let source = Source::Point(p - self.axis * along);
        (!weight.is_black() && along > 0.0).then_some(DirectSample {
            source,
            wi: -self.axis,
            weight,
        })
    }
}

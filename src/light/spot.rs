//! The spot light: a point that shines into a cone with a soft edge.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::{numeric::trig, spectrum::Rgb};

use super::DirectSample;

/// A point that shines into a cone: full intensity inside the inner angle,
/// none outside the outer one, a cubic ramp in the cosine between.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// Position in metres.
    pub position: DVec3,
    /// Unit axis of the cone.
    pub axis: DVec3,
    /// Cosine of the angle up to which the intensity is full.
    pub cos_inner: f64,
    /// Cosine of the angle beyond which it is zero; below `cos_inner`.
    pub cos_outer: f64,
    /// Radiant intensity on the axis, W/sr.
    pub intensity: Rgb,
}

impl SpotLight {
    /// A spot with half-angles `inner <= outer` in degrees, `0 < outer <= 180`.
    pub fn new(position: DVec3, axis: DVec3, inner: f64, outer: f64, intensity: Rgb) -> Self {
        Self {
            position,
            axis: axis.normalize(),
            cos_inner: trig::sin_cos(inner.to_radians()).1,
            cos_outer: trig::sin_cos(outer.to_radians()).1,
            intensity,
        }
    }

    /// Power divided by axis intensity, in sr: the integral of the falloff
    /// over the sphere. The ramp `3 x^2 - 2 x^3` has mean one half.
    pub fn effective_solid_angle(&self) -> f64 {
        TAU * ((1.0 - self.cos_inner) + 0.5 * (self.cos_inner - self.cos_outer))
    }

    pub(super) fn sample_direct(&self, p: DVec3) -> Option<DirectSample> {
        DirectSample::to_point(p, self.position, |wi, d2| self.intensity_along(-wi) / d2)
    }

    /// Radiant intensity in the unit direction `dir`, W/sr.
    pub fn intensity_along(&self, dir: DVec3) -> Rgb {
        self.intensity * self.falloff(dir.dot(self.axis))
    }

    /// Fraction of the axis intensity sent at the given cosine to the axis.
    pub fn falloff(&self, cos: f64) -> f64 {
        if cos >= self.cos_inner {
            1.0
        } else if cos <= self.cos_outer {
            0.0
        } else {
            let x = (cos - self.cos_outer) / (self.cos_inner - self.cos_outer);
            x * x * (3.0 - 2.0 * x)
        }
    }
}

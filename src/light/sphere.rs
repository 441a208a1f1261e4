//! The glowing sphere.

use glam::DVec3;

use crate::{numeric::Frame, sampling::warp, spectrum::Rgb};

use super::{DirectSample, Source};

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

impl SphereLight {
    /// Uniform over the cone of directions to the sphere, at any distance and
    /// size; the target is the point of the sphere that is met first. Nothing
    /// arrives inside.
    pub(super) fn sample_direct(&self, p: DVec3, u: [f64; 2]) -> Option<DirectSample> {
        let to = self.center - p;
        let d = to.length();
        if !(d > self.radius && d.is_finite()) {
            return None;
        }
        let s = self.radius / d;
        let q = warp::one_minus_cos(s);
        let local = warp::cone(u, q);
        let wi = Frame::around(to / d).to_world(local).normalize();
        // sin^2 and cos to the axis give the distance to the near side.
        let sin2 = local.x * local.x + local.y * local.y;
        let chord = (self.radius * self.radius - d * d * sin2).max(0.0).sqrt();
        // Of the two distances along wi, the near one without cancellation:
        // (d^2 - r^2) / (d cos + chord).
        let near = (d - self.radius) * (d + self.radius) / (d * local.z + chord);
        let weight = self.radiance / warp::cone_pdf(q);
        (!weight.is_black()).then_some(DirectSample {
            source: Source::Point(p + wi * near),
            wi,
            weight,
        })
    }
}

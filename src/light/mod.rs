//! Light sources: what they send to a point, how they are seen, what they
//! emit in all.
//!
//! Conventions:
//! - `wi` points from the lit point towards the light; emission directions
//!   point away from the light.
//! - Radiance in W/m2/sr, intensity in W/sr, irradiance in W/m2 (on a surface
//!   facing the beam), power in W, each per colour channel.
//! - `Quad` and `Disc` emit on the side of their normal, `Sphere` outward.
//! - A [`DirectSample`]'s weight is the incident radiance divided by the pdf
//!   of its direction per solid angle; for point-like and parallel lights, the
//!   irradiance on a surface facing the light. Either way, reflected radiance
//!   is `weight * f * cos`, with visibility still to be found.

mod beam;
mod disc;
mod point;
mod quad;
mod sphere;
mod spot;
mod sun;

pub use beam::Beam;
pub use disc::DiscLight;
pub use point::PointLight;
pub use quad::QuadLight;
pub use sphere::SphereLight;
pub use spot::SpotLight;
pub use sun::Sun;

use glam::DVec3;

use crate::{built, spectrum::Rgb};

/// A light source, validated.
#[derive(Clone, Debug)]
pub enum Light {
    /// Equal intensity in all directions from one point.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(SpotLight),
    /// Parallel light of finite circular cross-section.
    Beam(Beam),
    /// Light from infinity within a cone of directions.
    Sun(Sun),
    /// A glowing sphere.
    Sphere(SphereLight),
    /// A glowing parallelogram, one-sided.
    Quad(QuadLight),
    /// A glowing disc, one-sided.
    Disc(DiscLight),
}

/// Where a shadow ray must reach for the light to arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A point in space.
    Point(DVec3),
    /// Infinity in a unit direction.
    Direction(DVec3),
}

/// One sampled connection from a point to a light.
#[derive(Clone, Copy, Debug)]
pub struct DirectSample {
    /// Where the light comes from.
    pub source: Source,
    /// Unit direction towards the light.
    pub wi: DVec3,
    /// Incident radiance over pdf; see the room's conventions.
    pub weight: Rgb,
}

impl DirectSample {
    /// A connection from `p` to a point of the light, with `weight` computed
    /// from the unit direction and the squared distance. `None` if the points
    /// coincide.
    fn to_point(p: DVec3, target: DVec3, weight: impl FnOnce(DVec3, f64) -> Rgb) -> Option<Self> {
        let to = target - p;
        let d2 = to.length_squared();
        if !(d2 > 0.0 && d2.is_finite()) {
            return None;
        }
        let wi = to / d2.sqrt();
        let weight = weight(wi, d2);
        (!weight.is_black() && weight.is_finite()).then_some(Self {
            source: Source::Point(target),
            wi,
            weight,
        })
    }
}

impl Light {
    /// Samples the light that arrives at `p` if nothing is in the way.
    /// `None` if none can arrive.
    pub fn sample_direct(&self, p: DVec3, u: [f64; 2]) -> Option<DirectSample> {
        self.sample_direct_of::<true>(p, u)
    }

    /// The same, where lights of a scene may have extent or do not (`SOFT`).
    #[inline]
    pub(crate) fn sample_direct_of<const SOFT: bool>(
        &self,
        p: DVec3,
        u: [f64; 2],
    ) -> Option<DirectSample> {
        let soft = SOFT && built::SOFT_SHADOWS;
        match self {
            Self::Point(l) => built::HARD_SHADOWS.then(|| l.sample_direct(p))?,
            Self::Spot(l) => built::HARD_SHADOWS.then(|| l.sample_direct(p))?,
            Self::Beam(l) => built::HARD_SHADOWS.then(|| l.sample_direct(p))?,
            Self::Sun(l) => self.is_built().then(|| l.sample_direct(u))?,
            Self::Sphere(l) => soft.then(|| l.sample_direct(p, u))?,
            Self::Quad(l) => soft.then(|| l.sample_direct(p, u))?,
            Self::Disc(l) => soft.then(|| l.sample_direct(p, u))?,
        }
    }

    /// Whether the light is seen under a solid angle, so that its shadows are
    /// soft and samples of it differ.
    #[inline]
    pub fn has_extent(&self) -> bool {
        match self {
            Self::Point(_) | Self::Spot(_) | Self::Beam(_) => false,
            Self::Sun(l) => l.sin_half > 0.0,
            Self::Sphere(_) | Self::Quad(_) | Self::Disc(_) => true,
        }
    }

    /// Whether this build has the kind of shadows that the light casts.
    fn is_built(&self) -> bool {
        let (soft, hard) = (built::SOFT_SHADOWS, built::HARD_SHADOWS);
        soft && hard || if self.has_extent() { soft } else { hard }
    }

    /// Radiance emitted from the light's surface into a direction at `cos_out`
    /// to the surface's normal. Black for lights that are not shapes.
    pub fn surface_radiance(&self, cos_out: f64) -> Rgb {
        match self {
            Self::Sphere(SphereLight { radiance, .. })
            | Self::Quad(QuadLight { radiance, .. })
            | Self::Disc(DiscLight { radiance, .. })
                if cos_out > 0.0 =>
            {
                *radiance
            }
            _ => Rgb::BLACK,
        }
    }

    /// Radiance seen along a ray in unit direction `dir` that meets nothing.
    pub fn sky_radiance(&self, dir: DVec3) -> Rgb {
        match self {
            Self::Sun(l) => l.sky_radiance(dir),
            _ => Rgb::BLACK,
        }
    }

    /// Emitted power in W; `None` for the sun, which has no bounds.
    pub fn power(&self) -> Option<Rgb> {
        use std::f64::consts::PI;
        Some(match self {
            Self::Point(l) => l.intensity * (4.0 * PI),
            Self::Spot(l) => l.intensity * l.effective_solid_angle(),
            Self::Beam(l) => l.irradiance * (PI * l.radius * l.radius),
            Self::Sun(_) => return None,
            Self::Sphere(l) => l.radiance * (4.0 * PI * PI * l.radius * l.radius),
            Self::Quad(l) => l.radiance * (PI * l.area()),
            Self::Disc(l) => l.radiance * (PI * PI * l.radius * l.radius),
        })
    }
}

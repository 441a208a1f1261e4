//! Light sources.
//!
//! Conventions:
//! - Directions `wi` point from the lit point towards the light; emission
//!   directions point away from the light.
//! - Radiance in W/m2/sr, intensity in W/sr, irradiance in W/m2 (on a surface
//!   facing the beam), power in W, each per colour channel.
//! - `Quad` and `Disc` emit on the side of their normal, `Sphere` outward.

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

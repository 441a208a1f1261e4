//! Lights as written.

use serde::Deserialize;

use super::{Colour, Number, Pair, QuadShape, Triple};

/// One entry of `lights`.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "light")]
pub enum LightDescription {
    /// Equal intensity in all directions from one point.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(SpotLight),
    /// A beam, or a sun.
    Directional(DirectionalLight),
    /// A glowing sphere.
    Sphere(SphereLight),
    /// A glowing parallelogram.
    Quad(QuadLight),
    /// A glowing disc.
    Disc(DiscLight),
}

impl LightDescription {
    /// The light's own name.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Point(l) => l.name.as_deref(),
            Self::Spot(l) => l.name.as_deref(),
            Self::Directional(l) => l.name.as_deref(),
            Self::Sphere(l) => l.name.as_deref(),
            Self::Quad(l) => l.name.as_deref(),
            Self::Disc(l) => l.name.as_deref(),
        }
    }
}

/// `Point(position: .., power: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Point")]
pub struct PointLight {
    /// Name in messages and reports.
    pub name: Option<String>,
    /// Position.
    pub position: Triple,
    /// Total power in W.
    pub power: Option<Colour>,
    /// Intensity in W/sr.
    pub intensity: Option<Colour>,
}

/// `Spot(position: .., look_at: .., inner: .., outer: .., power: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Spot")]
pub struct SpotLight {
    /// Name in messages and reports.
    pub name: Option<String>,
    /// Position.
    pub position: Triple,
    /// A point on the axis.
    pub look_at: Option<Triple>,
    /// Direction of the axis.
    pub direction: Option<Triple>,
    /// Half-angle of full intensity in degrees.
    pub inner: Number,
    /// Half-angle beyond which there is no light, in degrees.
    pub outer: Number,
    /// Total power in W.
    pub power: Option<Colour>,
    /// Intensity on the axis in W/sr.
    pub intensity: Option<Colour>,
}

/// `Directional(direction: .., irradiance: .., beam: ..)` or with an
/// `angular_diameter`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Directional")]
pub struct DirectionalLight {
    /// Name in messages and reports.
    pub name: Option<String>,
    /// Direction of travel.
    pub direction: Triple,
    /// Irradiance on a surface that faces the light, W/m2.
    pub irradiance: Colour,
    /// The cross-section of a beam.
    pub beam: Option<BeamSection>,
    /// The apparent diameter of a sun in degrees.
    pub angular_diameter: Option<Number>,
}

/// `(center: .., radius: ..)`: where a beam starts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Beam")]
pub struct BeamSection {
    /// Centre of the disc from which the beam starts.
    pub center: Triple,
    /// Radius of the disc.
    pub radius: Number,
}

/// `Sphere(center: .., radius: .., radiance: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Sphere")]
pub struct SphereLight {
    /// Name in messages and reports.
    pub name: Option<String>,
    /// Centre.
    pub center: Triple,
    /// Radius.
    pub radius: Number,
    /// Emitted radiance in W/m2/sr.
    pub radiance: Option<Colour>,
    /// Total power in W.
    pub power: Option<Colour>,
}

/// `Quad(.., radiance: ..)`, with the geometry of the shape.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Quad")]
pub struct QuadLight {
    /// Name in messages and reports.
    pub name: Option<String>,
    /// One corner.
    pub corner: Option<Triple>,
    /// First edge.
    pub u: Option<Triple>,
    /// Second edge.
    pub v: Option<Triple>,
    /// Centre of a rectangle.
    pub center: Option<Triple>,
    /// Width and height of a rectangle.
    pub size: Option<Pair>,
    /// A point towards which the normal points.
    pub facing: Option<Triple>,
    /// The normal.
    pub normal: Option<Triple>,
    /// Emitted radiance in W/m2/sr.
    pub radiance: Option<Colour>,
    /// Total power in W.
    pub power: Option<Colour>,
}

impl QuadLight {
    /// The geometry alone.
    pub fn shape(&self) -> QuadShape {
        QuadShape {
            corner: self.corner,
            u: self.u,
            v: self.v,
            center: self.center,
            size: self.size,
            facing: self.facing,
            normal: self.normal,
        }
    }
}

/// `Disc(center: .., facing: .., radius: .., radiance: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Disc")]
pub struct DiscLight {
    /// Name in messages and reports.
    pub name: Option<String>,
    /// Centre.
    pub center: Triple,
    /// A point towards which the normal points.
    pub facing: Option<Triple>,
    /// The normal.
    pub normal: Option<Triple>,
    /// Radius.
    pub radius: Number,
    /// Emitted radiance in W/m2/sr.
    pub radiance: Option<Colour>,
    /// Total power in W.
    pub power: Option<Colour>,
}

//! Shapes as written.

use serde::Deserialize;

use super::{ImplicitShape, MeshFields, Number, Pair, TorusKnot, Triple, Waves};

/// What an object's `shape` field says.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "shape")]
pub enum ShapeDescription {
    /// An unbounded plane.
    Plane(PlaneShape),
    /// A parallelogram.
    Quad(QuadShape),
    /// A flat disc.
    Disc(DiscShape),
    /// A sphere.
    Sphere(SphereShape),
    /// A circular tube.
    Cylinder(CylinderShape),
    /// One triangle.
    Triangle(TriangleShape),
    /// A mesh from a file, by name, or in place.
    Mesh(MeshFields),
    /// A sheet of waves.
    Waves(Waves),
    /// A torus knot.
    TorusKnot(TorusKnot),
    /// Where a formula is zero.
    Implicit(ImplicitShape),
}

impl ShapeDescription {
    /// The name by which the language calls it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Plane(_) => "Plane",
            Self::Quad(_) => "Quad",
            Self::Disc(_) => "Disc",
            Self::Sphere(_) => "Sphere",
            Self::Cylinder(_) => "Cylinder",
            Self::Triangle(_) => "Triangle",
            Self::Mesh(_) => "Mesh",
            Self::Waves(_) => "Waves",
            Self::TorusKnot(_) => "TorusKnot",
            Self::Implicit(_) => "Implicit",
        }
    }
}

/// `Plane(point: .., normal: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Plane")]
pub struct PlaneShape {
    /// Any point of the plane.
    pub point: Triple,
    /// Its normal.
    pub normal: Triple,
}

/// `Quad(corner: .., u: .., v: ..)` or `Quad(center: .., size: .., ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Quad")]
pub struct QuadShape {
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
}

/// `Disc(center: .., normal: .., radius: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Disc")]
pub struct DiscShape {
    /// Centre.
    pub center: Triple,
    /// A point towards which the normal points.
    pub facing: Option<Triple>,
    /// The normal.
    pub normal: Option<Triple>,
    /// Radius.
    pub radius: Number,
}

/// `Sphere(center: .., radius: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Sphere")]
pub struct SphereShape {
    /// Centre.
    pub center: Triple,
    /// Radius.
    pub radius: Number,
}

/// `Cylinder(base: .., end: .., radius: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Cylinder")]
pub struct CylinderShape {
    /// One end of the axis.
    pub base: Triple,
    /// The other end.
    pub end: Triple,
    /// Radius.
    pub radius: Number,
    /// Whether discs close the ends.
    #[serde(default)]
    pub capped: bool,
}

/// `Triangle(a: .., b: .., c: ..)`, counter-clockwise around its normal.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Triangle")]
pub struct TriangleShape {
    /// First corner.
    pub a: Triple,
    /// Second corner.
    pub b: Triple,
    /// Third corner.
    pub c: Triple,
}

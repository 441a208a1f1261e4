//! Shapes as written.

use serde::Deserialize;

use super::{
    BoxShape, ConeShape, EllipsoidShape, HeightField, HyperboloidShape, ImplicitShape, LensShape,
    MeshFields, Number, Pair, ParaboloidShape, QuadricShape, SolidShape, TorusKnot, TorusShape,
    Triple, Waves,
};

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
    /// A cone, pointed or cut off.
    Cone(ConeShape),
    /// A paraboloid of revolution.
    Paraboloid(ParaboloidShape),
    /// A hyperboloid of revolution, of one sheet.
    Hyperboloid(HyperboloidShape),
    /// A squashed and turned sphere.
    Ellipsoid(EllipsoidShape),
    /// A polynomial of second degree.
    Quadric(QuadricShape),
    /// A ring.
    Torus(TorusShape),
    /// A box.
    Box(BoxShape),
    /// What is in any of several solids.
    Union(SolidShape),
    /// What is in all of several solids.
    Intersection(SolidShape),
    /// What is in the first of several solids only.
    Difference(SolidShape),
    /// A lens with two spherical faces.
    Lens(LensShape),
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
    /// A height field.
    HeightField(HeightField),
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
            Self::Cone(_) => "Cone",
            Self::Paraboloid(_) => "Paraboloid",
            Self::Hyperboloid(_) => "Hyperboloid",
            Self::Ellipsoid(_) => "Ellipsoid",
            Self::Quadric(_) => "Quadric",
            Self::Torus(_) => "Torus",
            Self::Box(_) => "Box",
            Self::Union(_) => "Union",
            Self::Intersection(_) => "Intersection",
            Self::Difference(_) => "Difference",
            Self::Lens(_) => "Lens",
            Self::Triangle(_) => "Triangle",
            Self::Mesh(_) => "Mesh",
            Self::Waves(_) => "Waves",
            Self::TorusKnot(_) => "TorusKnot",
            Self::Implicit(_) => "Implicit",
            Self::HeightField(_) => "HeightField",
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

//! Cone, paraboloid, hyperboloid, ellipsoid, quadric, torus and box as
//! written.

use serde::Deserialize;

use super::{Number, Rotations, Triple};

/// `Cone(base: .., apex: .., radius: ..)`, or cut off at `end` with a
/// `top_radius`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Cone")]
pub struct ConeShape {
    /// Middle of the base.
    pub base: Triple,
    /// The tip.
    pub apex: Option<Triple>,
    /// Middle of the top of a cone that is cut off.
    pub end: Option<Triple>,
    /// Radius at the base.
    pub radius: Number,
    /// Radius at `end`.
    pub top_radius: Option<Number>,
    /// Whether discs close the ends.
    #[serde(default)]
    pub capped: bool,
}

/// `Paraboloid(base: .., apex: .., radius: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Paraboloid")]
pub struct ParaboloidShape {
    /// Middle of the rim.
    pub base: Triple,
    /// The vertex.
    pub apex: Triple,
    /// Radius of the rim.
    pub radius: Number,
    /// Whether a disc closes the rim.
    #[serde(default)]
    pub capped: bool,
}

/// `Hyperboloid(base: .., end: .., radius: .., waist: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Hyperboloid")]
pub struct HyperboloidShape {
    /// Middle of one rim.
    pub base: Triple,
    /// Middle of the other rim.
    pub end: Triple,
    /// Radius at `base`.
    pub radius: Number,
    /// Radius at `end`; that at `base` unless given.
    pub end_radius: Option<Number>,
    /// Smallest radius between them.
    pub waist: Number,
    /// Whether discs close the ends.
    #[serde(default)]
    pub capped: bool,
}

/// `Ellipsoid(center: .., semi_axes: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Ellipsoid")]
pub struct EllipsoidShape {
    /// Centre.
    pub center: Triple,
    /// Half the widths along x, y and z, before it is turned.
    pub semi_axes: Triple,
    /// Rotations about axes through the centre.
    pub rotate: Option<Rotations>,
}

/// `Quadric(coefficients: (..), bounds: (.., ..))`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Quadric")]
pub struct QuadricShape {
    /// Of x^2, y^2, z^2, xy, yz, xz, x, y, z and 1.
    pub coefficients: [Number; 10],
    /// Two opposite corners of the box that cuts it.
    pub bounds: [Triple; 2],
    /// Whether the box's faces close it.
    #[serde(default)]
    pub capped: bool,
}

/// `Torus(center: .., axis: .., major: .., minor: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Torus")]
pub struct TorusShape {
    /// Centre of the hole.
    pub center: Triple,
    /// Direction through the hole.
    #[serde(default = "super::z_axis")]
    pub axis: Triple,
    /// From the centre to the middle of the tube.
    pub major: Number,
    /// Radius of the tube.
    pub minor: Number,
}

/// `Box(min: .., max: ..)` or `Box(center: .., size: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Box")]
pub struct BoxShape {
    /// Corner of smallest coordinates.
    pub min: Option<Triple>,
    /// Corner of largest coordinates.
    pub max: Option<Triple>,
    /// Middle.
    pub center: Option<Triple>,
    /// Lengths of the edges along x, y and z.
    pub size: Option<Triple>,
}

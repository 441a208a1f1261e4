//! Solids made of others, and the lens, as written.

use serde::Deserialize;

use super::{Number, ShapeDescription, Steps};

/// `Union(of: [..])`, `Intersection(of: [..])`, `Difference(of: [..])`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Solid")]
pub struct SolidShape {
    /// The shapes it is made of; of a difference the first is what the others
    /// are taken from.
    pub of: Vec<Operand>,
}

/// `(shape: .., at: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Operand")]
pub struct Operand {
    /// A closed shape, or a plane for all that is behind it.
    pub shape: ShapeDescription,
    /// Steps that place it within the solid.
    pub at: Option<Steps>,
}

/// `Lens(r1: .., r2: .., thickness: .., aperture: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Lens")]
pub struct LensShape {
    /// Radius of the face at negative z: positive if its centre is at larger
    /// z; flat unless given.
    pub r1: Option<Number>,
    /// Radius of the face at positive z, by the same rule.
    pub r2: Option<Number>,
    /// Thickness on the axis.
    pub thickness: Number,
    /// Diameter.
    pub aperture: Number,
}

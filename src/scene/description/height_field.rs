//! Height fields as written.

use serde::Deserialize;

use super::{Cells, Number, Pair};

/// `HeightField(..)`: a surface `z = f(x, y)` over a rectangle, from an image
/// or a formula: exactly one of `heights` and `formula`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "HeightField")]
pub struct HeightField {
    /// Path of a 16-bit grey PNG or an EXR image, relative to the scene file.
    pub heights: Option<String>,
    /// z in metres as a formula in x and y.
    pub formula: Option<String>,
    /// Channel of an EXR image; by default the only one, or `Y`.
    pub channel: Option<String>,
    /// Extent along x in metres: where the first and the last column stand.
    pub x: Pair,
    /// Extent along y in metres: where the last and the first row stand.
    pub y: Pair,
    /// Heights in metres of the values 0 and 1; for a PNG, of black and white.
    pub range: Option<Pair>,
    /// Grid cells along x and y; by default one from pixel to pixel, and 256
    /// for a formula.
    pub cells: Option<Cells>,
    /// Depth in metres, below z = 0, of a flat bottom that closes the field
    /// to a solid body.
    pub depth: Option<Number>,
    /// Whether light sees the normals of the smooth surface, or facets.
    #[serde(default = "yes")]
    pub smooth: bool,
}

fn yes() -> bool {
    true
}

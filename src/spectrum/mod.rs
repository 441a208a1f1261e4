//! Colour: linear RGB triples today; spectral colour will live beside it.
//!
//! [`Rgb`] is a plain triple of linear sRGB coefficients without a unit of its
//! own: it stands for radiance, flux or reflectance as the name of the
//! variable says.

mod rgb;
mod srgb;

pub use rgb::Rgb;
pub use srgb::{srgb_code, srgb_linear};

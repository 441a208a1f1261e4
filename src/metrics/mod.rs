//! How far a picture is from the truth, and whether numbers drawn at random
//! come from where they should.
//!
//! Image errors compare linear RGB, unweighted over pixels and channels. The
//! reference is always the second argument. Statistical tests return p-values:
//! the probability, if all is right, of a result at least as far off as the one
//! seen.

mod chi_square;
mod gamma;
mod image_error;
mod slope;

pub use chi_square::{ChiSquare, chi_square, sidak};
pub use gamma::upper_gamma;
pub use image_error::{SizeMismatch, mean_ratio, relmse, relmse_trimmed, rmse};
pub use slope::{Slope, fit_slope};

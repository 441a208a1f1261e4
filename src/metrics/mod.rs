//! How far a picture is from the truth, and whether numbers drawn at random
//! come from where they should.
//!
//! Image errors compare linear RGB, unweighted over pixels and channels; FLIP
//! and SSIM compare what a screen shows. The reference is always the second
//! argument, and of unequal sizes nothing is computed. [`Comparison`] has all of
//! them at once, for regions too. Statistical tests return p-values: the
//! probability, if all is right, of a result at least as far off as the one
//! seen.

mod chi_square;
mod colour_map;
mod comparison;
mod convolve;
mod flip;
mod gamma;
mod hdr_flip;
mod image_error;
mod noise;
mod opponent;
mod plane;
mod slope;
mod ssim;
mod statement;
mod student;
mod trend;

pub use chi_square::{ChiSquare, chi_square, sidak};
pub use colour_map::magma;
pub use comparison::{Comparison, Light, Map, Metric, Score};
pub use flip::flip;
pub use gamma::upper_gamma;
pub use hdr_flip::{Exposures, hdr_flip};
pub use image_error::{
    SizeMismatch, absolute_errors, mae, mean_ratio, relative_errors, relmse, relmse_trimmed, rmse,
    squared_errors,
};
pub use noise::relative_noise;
pub use plane::{Plane, Region};
pub use slope::{Slope, fit_slope};
pub use ssim::Ssim;
pub use statement::{Figures, Statement};
pub use student::student_quantile;
pub use trend::Trend;

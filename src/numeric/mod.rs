//! Floating point: counted error bounds, stable roots, frames, exact sums,
//! intervals that contain the truth, splines, and the transcendental functions
//! whose bits reach pixels.
//!
//! Conventions: `U` is the unit roundoff of `f64` (2^-53). A bound is always
//! an absolute error unless its name ends in `_rel`. Nothing in this room
//! knows about rendering.

pub mod bounds;
pub mod dyadic;
pub mod exact;
pub mod frame;
pub mod interval;
pub mod polynomial;
pub mod products;
pub mod quadratic;
pub mod spline;
pub mod trig;
pub mod vector_pair;

pub use bounds::{U, gamma};
pub use dyadic::DyadicSum;
pub use exact::ExactSum;
pub use frame::Frame;
pub use interval::Interval;
pub use products::{difference_of_products, two_product, two_sum};
pub use quadratic::{Roots, quadratic};
pub use spline::SplineSurface;
pub use vector_pair::VectorPair;

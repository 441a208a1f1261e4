//! Addressed low-discrepancy samples, warps with their pdfs, discrete tables,
//! learned distributions.
//!
//! Contract: a sample is a pure function of an address (seed, stream, index,
//! dimension); there is no generator state and nothing depends on which
//! thread asks. All numbers lie in `[0, 1)`. Each warp states its pdf and the
//! measure of it.

mod discrete;
mod guide;
mod hash;
mod joe_kuo;
mod sobol;
mod stream;
pub mod warp;

pub use discrete::Discrete;
pub use guide::{GUIDE_DIMENSIONS, GUIDE_PAIRS, Guide, Guided, Weighed};
pub use hash::{mix, mix2};
pub use sobol::{DIMENSIONS, sobol, sobol_owen};
pub use stream::{LOW_DISCREPANCY, Purpose, Sequence, Stream};

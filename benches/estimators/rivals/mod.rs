//! Estimators from the literature, on the same scenes, pixels and metric.
//!
//! They are spared whatever could be spared them: their photons come from the
//! closed forms (no tree of triangles, no derivatives, no ledger), only photons
//! of one number each are kept, the floor is known to be flat, and what SPPM
//! hashes is the grid of pixels itself. Their random numbers are independent,
//! as published. One rival is spared nothing: SPPM as this renderer has it.

mod knn;
mod photons;
mod rendered;
mod sppm;

pub(crate) use knn::knn;
pub(crate) use rendered::rendered;
pub(crate) use sppm::sppm;

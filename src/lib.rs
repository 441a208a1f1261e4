//! nephroid: a photon-mapping renderer for caustics that states what accuracy
//! costs in time.

pub mod film;
pub mod metrics;
pub mod numeric;
pub mod spectrum;

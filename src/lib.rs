//! nephroid: a photon-mapping renderer for caustics that states what accuracy
//! costs in time.

pub mod film;
pub mod light;
pub mod metrics;
pub mod numeric;
pub mod optics;
pub mod sampling;
pub mod spectrum;

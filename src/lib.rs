//! nephroid: a photon-mapping renderer for caustics that states what accuracy
//! costs in time.

pub mod geometry;
pub mod numeric;
pub mod spectrum;

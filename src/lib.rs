//! nephroid: a photon-mapping renderer for caustics that states what accuracy
//! costs in time.

pub mod camera;
pub mod geometry;
pub mod light;
pub mod material;
pub mod numeric;
pub mod scene;
pub mod spectrum;

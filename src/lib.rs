//! nephroid: a photon-mapping renderer for caustics that states what accuracy
//! costs in time.

mod built;
pub mod camera;
pub mod design;
pub mod film;
pub mod formula;
pub mod geometry;
pub mod light;
pub mod material;
pub mod metrics;
pub mod numeric;
pub mod optics;
pub mod photon;
pub mod plan;
pub mod reference;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod spectrum;
pub mod study;
pub mod survey;
pub mod transport;

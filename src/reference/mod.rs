//! Reference methods: other ways to the same picture, as independent truth.
//!
//! Contract: a pass is a pure function of (scene, settings, seed, method, pass
//! index), the same bits for any number of threads. All methods share the
//! geometry, the optics, the materials, the lights and the camera with the
//! renderer, and `transport`'s steps at mirrors and glass and its shadow rays;
//! none of them knows the photon map, its emission or its estimates. Every
//! method's file says which paths it owns and which it cannot see; where a
//! path is owned, it ends in the layer in which the renderer puts it.
//!
//! Passes belong to replicates as in `render`, so the spread of the
//! replicates is the noise.

mod bdpt;
mod driver;
mod flight;
mod forward;
mod light;
mod method;
mod metropolis;
mod naive;
mod path;
mod random;
mod setup;
mod sources;
mod whitted;

pub use driver::{Outcome, Reference, Report, render};
pub use forward::Forward;
pub use method::Method;
pub use naive::Pinhole;

//! Reference methods: other ways to the same picture, as independent truth.
//!
//! Contract: a pass is a pure function of (scene, settings, seed, method, pass
//! index), the same bits for any number of threads. Some methods carry
//! something from pass to pass ([`Passes`]); it never passes from one replicate
//! to another, and what it is before a pass is a pure function, too. All methods share the
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
mod eye;
mod flight;
mod forward;
mod light;
mod memory;
mod method;
mod metropolis;
mod naive;
mod options;
mod path;
mod photon_map;
mod photons;
mod radiosity;
mod random;
mod setup;
mod sources;
mod sppm;
mod whitted;

pub use driver::{Memory, Outcome, Passes, Reference, Report, go_on, render};
pub use forward::Forward;
pub use memory::{Refused, check};
pub use method::Method;
pub use naive::Pinhole;
pub use options::Options;

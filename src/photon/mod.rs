//! Photons: emitted towards what can make a caustic, traced through specular
//! steps, stored where they land, gathered as irradiance.
//!
//! Flow of a pass: [`Emitter`] turns an addressed stream into a first ray
//! with its flux; [`trace`] follows it (a pure function); [`shoot`] runs
//! fixed chunks in parallel and puts the photons in path order; [`PhotonMap`]
//! builds the tree (the only file that knows the kd-tree crate) and answers
//! density queries, which [`gather`] asks with regard to the walls around. Flux
//! is in W and already divided by every probability; division by the number of
//! emitted paths happens once, in the estimate. A [`Rehearsal`] teaches an
//! emitter where photons are needed.

mod aim;
mod companion;
mod domain;
mod emit;
mod footprint;
mod gather;
mod groups;
mod guide;
mod map;
mod shoot;
mod tally;
mod trace;
mod trial;

pub use aim::Aim;
pub use emit::{Emission, Emitter};
pub use footprint::Footprint;
pub use gather::{gather, is_wall};
pub(crate) use groups::grouped;
pub use guide::{Lesson, Origin, Rehearsal};
pub use map::{BYTES_PER_PHOTON, Ellipse, Gathered, Kernels, PhotonMap, Query, Vicinity};
pub(crate) use shoot::shoot_for;
pub use shoot::{Shot, shoot};
pub use tally::{LightTally, Tally};
pub use trace::{PHOTONS_PER_PATH, Photon, Step, Turn, trace};
pub use trial::{Story, Trial};

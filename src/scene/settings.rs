//! How to render: the `render` block of a scene file with defaults filled in.

use serde::{Deserialize, Serialize};

use super::effect::{Choice, Choices, Effect};

/// The points at which a render looks: what low discrepancy buys can be seen
/// by doing without.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, PartialEq, Eq)]
#[serde(rename = "sampler")]
pub enum Sampler {
    /// One Owen-scrambled Sobol sequence for each replicate, continued from
    /// round to round.
    #[default]
    Sobol,
    /// Every path at random, independent of all others.
    Independent,
}

/// The area over which a photon's light is spread: what derivatives buy can
/// be seen by doing without.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, PartialEq, Eq)]
#[serde(rename = "kernel")]
pub enum Kernel {
    /// An ellipse as the photon's derivatives tell, where they do.
    #[default]
    Footprint,
    /// A circle for every photon, in proportion to what a pixel sees.
    Circle,
}

/// What decides where photons and shadow rays go: what is learned from pilots
/// can be seen by doing without.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, PartialEq, Eq)]
#[serde(rename = "guidance")]
pub enum Guidance {
    /// Pilots find out what the picture needs.
    #[default]
    Learned,
    /// Power alone: photons in proportion to the power that a light sends
    /// towards each caster, spread evenly over what may reach it; shadow rays
    /// by the power of the lights.
    Power,
}

/// Settings of a render. Every one has a default that needs no thought; the
/// command line may override each.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Number of passes, at least 1. A round has eight.
    pub passes: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Photon paths emitted per pass; `None` lets the program choose.
    pub photons: Option<u64>,
    /// Kernel radius of the first round in pixel footprints, above 0.
    pub radius: f64,
    /// The points at which photons and camera look.
    pub sampler: Sampler,
    /// The area over which a photon's light is spread.
    pub kernel: Kernel,
    /// What decides where photons and shadow rays go.
    pub guidance: Guidance,
    /// Whether light between diffuse surfaces is simulated.
    pub indirect: bool,
    /// What the user says about effects; see [`Settings::choice`].
    pub effects: Choices,
    /// Longest chain of surface interactions of a photon or camera path.
    pub max_depth: u32,
    /// Memory that the film and the photons of a pass may take together, in
    /// bytes.
    pub memory: u64,
    /// Exposure of the PNG in stops (powers of two); `None` exposes so that
    /// the mean of the picture becomes a middle grey.
    pub exposure: Option<f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            passes: 128,
            seed: 0,
            photons: None,
            radius: 2.0,
            sampler: Sampler::default(),
            kernel: Kernel::default(),
            guidance: Guidance::default(),
            indirect: true,
            effects: Choices::default(),
            max_depth: 64,
            memory: 8 << 30,
            exposure: None,
        }
    }
}

impl Settings {
    /// What the user says about an effect; `indirect: false` is one way to
    /// leave indirect light out.
    pub fn choice(&self, effect: Effect) -> Choice {
        if effect == Effect::Indirect && !self.indirect {
            Choice::Off
        } else {
            self.effects.of(effect)
        }
    }
}

//! The photon ledger: every launched watt is accounted for.

use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

/// What became of the photons of one light. Amounts are sums of flux (mean of
/// the colour channels) over all launched paths, in W times paths; `paths`
/// and the counts are numbers of paths.
///
/// The balance, to rounding: `launched + reflected + roulette_gain +
/// shading_change = stored + direct + absorbed + escaped + roulette_loss +
/// truncated`. A stored photon has landed for good; what the surface sends on
/// of it is booked anew as `reflected`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LightTally {
    /// Paths launched, those of zero flux included.
    pub paths: u64,
    /// Photons stored.
    pub photons: u64,
    /// Paths ended by the depth limit.
    pub truncated_paths: u64,
    /// Paths that met a surface after launch.
    pub landed_paths: u64,
    /// Flux launched.
    pub launched: f64,
    /// Flux sent on by diffuse surfaces after it was stored.
    pub reflected: f64,
    /// Flux added to survivors of the roulette.
    pub roulette_gain: f64,
    /// Flux added (or, if negative, taken) by shading normals.
    pub shading_change: f64,
    /// Flux stored in the map.
    pub stored: f64,
    /// Flux that landed without having been bent: the shadow rays' share.
    pub direct: f64,
    /// Flux absorbed by mirrors, black surfaces and bodies of lights.
    pub absorbed: f64,
    /// Flux that left the scene.
    pub escaped: f64,
    /// Flux of paths that the roulette ended.
    pub roulette_loss: f64,
    /// Flux of paths that the depth limit ended.
    pub truncated: f64,
}

impl LightTally {
    /// The ledger with every amount of flux multiplied by `k`; counts stay.
    #[must_use]
    pub fn scaled(&self, k: f64) -> Self {
        Self {
            launched: self.launched * k,
            reflected: self.reflected * k,
            roulette_gain: self.roulette_gain * k,
            shading_change: self.shading_change * k,
            stored: self.stored * k,
            direct: self.direct * k,
            absorbed: self.absorbed * k,
            escaped: self.escaped * k,
            roulette_loss: self.roulette_loss * k,
            truncated: self.truncated * k,
            ..*self
        }
    }

    /// Left side of the balance minus the right side.
    pub fn imbalance(&self) -> f64 {
        (self.launched + self.reflected + self.roulette_gain + self.shading_change)
            - (self.stored
                + self.direct
                + self.absorbed
                + self.escaped
                + self.roulette_loss
                + self.truncated)
    }
}

impl AddAssign for LightTally {
    fn add_assign(&mut self, o: Self) {
        self.paths = self.paths.saturating_add(o.paths);
        self.photons = self.photons.saturating_add(o.photons);
        self.truncated_paths = self.truncated_paths.saturating_add(o.truncated_paths);
        self.landed_paths = self.landed_paths.saturating_add(o.landed_paths);
        self.launched += o.launched;
        self.reflected += o.reflected;
        self.roulette_gain += o.roulette_gain;
        self.shading_change += o.shading_change;
        self.stored += o.stored;
        self.direct += o.direct;
        self.absorbed += o.absorbed;
        self.escaped += o.escaped;
        self.roulette_loss += o.roulette_loss;
        self.truncated += o.truncated;
    }
}

/// One tally a light.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// In the order of the scene's lights.
    pub lights: Vec<LightTally>,
}

impl Tally {
    /// An empty ledger for so many lights.
    pub fn new(lights: usize) -> Self {
        Self {
            lights: vec![LightTally::default(); lights],
        }
    }

    /// Adds another ledger of the same lights.
    pub fn merge(&mut self, other: &Self) {
        for (a, b) in self.lights.iter_mut().zip(&other.lights) {
            *a += *b;
        }
    }

    /// All lights together.
    pub fn total(&self) -> LightTally {
        self.lights
            .iter()
            .fold(LightTally::default(), |mut sum, l| {
                sum += *l;
                sum
            })
    }
}

//! Derivatives of a ray by the coordinates of its sample (Igehy, *Tracing Ray
//! Differentials*, 1999; for photons Schjoth et al., 2007).
//!
//! A photon is one of many that share a light's emission. How far its
//! neighbours land from it follows from the derivatives of its ray: they turn
//! a cell of the sample space into a patch of the receiver.

use glam::DVec3;

/// Pairs of coordinates that a path can depend on: a direction, a point on the
/// light, the direction of a diffuse bounce.
pub const MAX_PAIRS: usize = 3;

/// Derivatives of a ray by two coordinates of the unit cube from which it was
/// drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// Change of the ray's origin, metres for the whole range of a coordinate.
    pub dp: [DVec3; 2],
    /// Change of its unit direction, perpendicular to it.
    pub dd: [DVec3; 2],
}

/// Derivatives of a ray by all coordinates of its sample, in pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differential {
    pairs: [Pair; MAX_PAIRS],
    count: usize,
    /// Probability of the discrete choices on the path so far: light, target,
    /// lobe, roulette. Neighbours of this path are rarer by this factor.
    pub chance: f64,
}

impl Differential {
    /// No derivatives yet; every choice was certain.
    pub fn new() -> Self {
        Self {
            pairs: [Pair::default(); MAX_PAIRS],
            count: 0,
            chance: 1.0,
        }
    }

    /// Adds a pair of coordinates; pairs beyond [`MAX_PAIRS`] are ignored.
    #[inline]
    pub fn push(&mut self, pair: Pair) {
        if let Some(slot) = self.pairs.get_mut(self.count) {
            *slot = pair;
            self.count += 1;
        }
    }

    /// The pairs.
    #[inline]
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs[..self.count]
    }

    /// The pairs, to change them.
    #[inline]
    pub fn pairs_mut(&mut self) -> &mut [Pair] {
        &mut self.pairs[..self.count]
    }
}

impl Default for Differential {
    fn default() -> Self {
        Self::new()
    }
}

//! Derivatives of a ray by the coordinates of its sample (Igehy, *Tracing Ray
//! Differentials*, 1999; for photons Schjoth et al., 2007).
//!
//! A photon is one of many that share a light's emission. How far its
//! neighbours land from it follows from the derivatives of its ray: they turn
//! a cell of the sample space into a patch of the receiver.

use glam::{DVec2, DVec3};

use crate::{geometry::Turning, numeric::VectorPair};

/// Pairs of coordinates that a path can depend on: a direction, a point on the
/// light, the direction of a diffuse bounce.
pub const MAX_PAIRS: usize = 3;

/// Derivatives of a ray along the two sides of a cell in the unit cube from which
/// it was drawn; any two steps whose parallelogram has the area of the coordinates'
/// serve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// Change of the ray's origin, metres for a step as long as the whole range.
    pub dp: VectorPair,
    /// Change of its unit direction, perpendicular to it.
    pub dd: VectorPair,
}

/// How a ray changed its direction at a surface; what the derivatives of the
/// step need to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bend {
    /// Not at all.
    Straight,
    /// Mirrored.
    Mirror {
        /// Unit normal on the side from which the ray came.
        n: DVec3,
        /// How `n` follows the surface's shading normal: 1 or -1, 0 where it
        /// does not.
        turn: f64,
    },
    /// Refracted.
    Refract {
        /// As for a mirror.
        n: DVec3,
        /// As for a mirror.
        turn: f64,
        /// Index ahead over index behind.
        eta: f64,
        /// Cosine of the refracted ray to `n`, above 0.
        cos_t: f64,
    },
}

/// Derivatives of a ray by all coordinates of its sample, in pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differential {
    pairs: [Pair; MAX_PAIRS],
    count: usize,
    strain: [f64; MAX_PAIRS],
    room: [DVec2; MAX_PAIRS],
    kernel: [f64; MAX_PAIRS],
    /// Area of the cells of all pairs but the first; 0 where sheets are not counted.
    others: f64,
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
            strain: [0.0; MAX_PAIRS],
            room: [DVec2::INFINITY; MAX_PAIRS],
            kernel: [1.0; MAX_PAIRS],
            others: 1.0,
            chance: 1.0,
        }
    }

    /// Adds a pair of coordinates, and how far each is from the end of its
    /// range: neighbours end there. Pairs beyond [`MAX_PAIRS`] are ignored.
    #[inline]
    pub fn push(&mut self, pair: Pair, room: DVec2) {
        if let Some(slot) = self.pairs.get_mut(self.count) {
            *slot = pair;
            self.room[self.count] = room;
            self.count += 1;
        }
    }

    /// The pairs.
    #[inline]
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs[..self.count]
    }

    /// Makes the cells of a pair's coordinates larger by `edge` on either side,
    /// above 0, and kernels larger by `kernel` than their cell asks for.
    #[inline]
    pub fn stretch(&mut self, pair: usize, edge: f64, kernel: f64) {
        if pair >= self.count {
            return;
        }
        let Pair { dp, dd } = &mut self.pairs[pair];
        (*dp, *dd) = (*dp * edge, *dd * edge);
        self.room[pair] /= edge;
        self.kernel[pair] = kernel;
        if pair > 0 {
            self.others *= edge * edge;
        }
    }

    /// By what kernels are larger along each pair's coordinates than their cell
    /// asks for, 1 where nothing was said.
    #[inline]
    pub fn kernel(&self) -> &[f64] {
        &self.kernel[..self.count]
    }

    /// Says that no whole number of sheets comes of the source ([`Self::sheet`] is 0).
    #[inline]
    pub fn without_sheet(&mut self) {
        self.others = 0.0;
    }

    /// Area in m² of a receiver over which the first pair of coordinates spreads a
    /// path's light while the others stay as they are, times the number of paths:
    /// the mean of the sum of such areas, one for each path that lands there, is the
    /// receiver's area times the sheets that lie over it (see
    /// [`Gathered::sheets`](crate::photon::Gathered::sheets)). The ray must have been
    /// transferred to the receiver. May not be finite.
    #[inline]
    pub fn sheet(&self) -> f64 {
        let [s, t] = self.pairs[0].dp.to_array();
        s.cross(t).length() * self.others / self.chance
    }

    /// How far each pair's coordinates are from the end of their range.
    #[inline]
    pub fn room(&self) -> &[DVec2] {
        &self.room[..self.count]
    }

    /// Largest squared strain of each pair so far, for the whole range of its
    /// coordinates: the angle by which a normal turned, or the way over the
    /// size of a facet. Derivatives mean little over a cell that is strained by
    /// about one.
    #[inline]
    pub fn strains(&self) -> &[f64] {
        &self.strain[..self.count]
    }

    /// The pairs, to change them.
    #[inline]
    pub fn pairs_mut(&mut self) -> &mut [Pair] {
        &mut self.pairs[..self.count]
    }

    /// Follows the ray of unit direction `d` over `t` metres to a surface of
    /// geometric normal `ng`: origins move along the surface.
    #[inline]
    pub fn transfer(&mut self, d: DVec3, t: f64, ng: DVec3) {
        let along = d / d.dot(ng);
        for pair in self.pairs_mut() {
            let v = pair.dp + pair.dd * t;
            pair.dp = v - VectorPair::along(along, v.dot(ng));
        }
    }

    /// Turns with the ray of direction `d` as it is reflected or refracted at
    /// a surface whose normal turns by `turning`. The ray must have been
    /// transferred to the surface.
    #[inline]
    pub fn bend(&mut self, d: DVec3, bend: &Bend, turning: &Turning) {
        match *bend {
            Bend::Straight => {}
            Bend::Mirror { n, turn } => {
                let c = d.dot(n);
                self.turn(turning, |dn, dd| {
                    let dn = dn * turn;
                    let dc = dd.dot(n) + dn.dot(d);
                    dd - (VectorPair::along(n, dc) + dn * c) * 2.0
                });
            }
            Bend::Refract {
                n,
                turn,
                eta,
                cos_t,
            } => {
                let r = 1.0 / eta;
                let ci = -d.dot(n);
                // eta^2 cos_t^2 = cos_i^2 - (1 - eta)(1 + eta).
                let slope = ci * r * r / cos_t;
                let k = r * ci - cos_t;
                self.turn(turning, |dn, dd| {
                    let dn = dn * turn;
                    let dc = dd.dot(n) + dn.dot(d);
                    dd * r + VectorPair::along(n, dc * (slope - r)) + dn * k
                });
            }
        }
    }

    /// Puts new changes of direction in the place of the old ones: a function
    /// of the change of the normal and the old one. Books how much of the
    /// surface a cell covers.
    #[inline]
    fn turn(&mut self, turning: &Turning, new: impl Fn(VectorPair, VectorPair) -> VectorPair) {
        for (pair, strain) in self.pairs[..self.count].iter_mut().zip(&mut self.strain) {
            let dn = turning.of_pair(pair.dp);
            let squared = match turning {
                Turning::Facet { size } => pair.dp.length_squared() / (size * size),
                _ => dn.length_squared(),
            };
            *strain = strain.max(squared.x).max(squared.y);
            pair.dd = new(dn, pair.dd);
        }
    }

    /// Goes on from a diffuse surface in a direction drawn anew: what was a
    /// change of direction ends here, and `dd` begins a pair of its own, with
    /// `room` to the end of its range.
    pub fn restart(&mut self, dd: VectorPair, room: DVec2) {
        for pair in self.pairs_mut() {
            pair.dd = VectorPair::ZERO;
        }
        let dp = VectorPair::ZERO;
        self.push(Pair { dp, dd }, room);
    }
}

impl Default for Differential {
    fn default() -> Self {
        Self::new()
    }
}

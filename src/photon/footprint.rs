//! The patch of a receiver that a photon stands for.
//!
//! A photon path is one of `n` that fill the sample space evenly; each has a
//! cell of volume `1 / n`, divided by the probability of the choices on its way
//! (paths that chose as it did are rarer). The derivatives turn the cell into
//! a patch; the photon's kernel is an ellipse of that shape, larger by a
//! constant, so that kernels overlap evenly however the light was stretched.
//!
//! Each pair of coordinates may have a cell of its own size: only the volume
//! is given. The sizes are chosen so that no pair spreads light further than
//! the others, which makes the patch smallest; a pair that moves the photon
//! less than that even over its whole range (a light so small that it looks
//! like a point) counts with its whole range.

use glam::{DVec2, DVec3, Vec2Swizzles};

use crate::{
    numeric::Frame,
    transport::{Differential, differential::MAX_PAIRS},
};

/// Semi-axes of a photon's kernel in the first round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Major semi-axis in the surface's tangent plane, metres.
    pub major: DVec3,
    /// Length of the minor one, metres.
    pub minor: f64,
    /// How far the light goes before it turns back at a fold, metres along the
    /// minor axis on the side of `-n x major`, where `n` is the normal of the
    /// photon; infinite where none is near.
    pub fold: f64,
}

/// The end of a kernel's minor axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rim {
    /// Pairs of coordinates that lead there, from those of the photon.
    pub(super) steps: [DVec2; MAX_PAIRS],
    /// The way there as the derivatives have it, metres.
    pub(super) way: DVec3,
}

/// Kernel semi-axes over those of the cell's patch, by the number of pairs of
/// coordinates that share its volume. A cell that is spread over more
/// dimensions is wider from the start and holds more of its neighbours.
const OVERLAP: [f64; MAX_PAIRS + 1] = [1.0, 2.6, 0.8, 0.3];

/// Most strain of a kernel (see [`Differential::strains`]) for which
/// the derivatives are believed.
const MOST_STRAIN: f64 = 0.5;

impl Footprint {
    /// The footprint of a photon that arrived with these derivatives on a
    /// surface of normal `n`, one of `paths` paths. Where the derivatives do
    /// not hold over as much as a kernel, their shape means little: it is a
    /// circle of the same area. `None` where there are none, or the patch has
    /// no area.
    pub fn new(differential: &Differential, paths: f64, n: DVec3) -> Option<Self> {
        Self::with_rim(differential, paths, n).map(|f| f.0)
    }

    /// The same, and the rim of its kernel where folds can matter.
    pub(super) fn with_rim(
        differential: &Differential,
        paths: f64,
        n: DVec3,
    ) -> Option<(Self, Option<Rim>)> {
        let pairs = differential.pairs();
        if pairs.is_empty() {
            return None;
        }
        let sizes = cell_sizes(differential, paths);
        let frame = Frame::around(n);
        let mut sides = [Sides::default(); MAX_PAIRS];
        let mut steps = [DVec2::ZERO; MAX_PAIRS];
        let mut strain = 0.0;
        let scale = OVERLAP[sizes.sharing];
        for (i, pair) in pairs.iter().enumerate() {
            let h = scale * sizes.squared[i].sqrt();
            strain += sizes.squared[i] * differential.strains()[i];
            // No kernel reaches past the last photon of its light.
            let h = DVec2::splat(differential.kernel()[i] * h).min(differential.room()[i]);
            steps[i] = h;
            sides[i] = Sides {
                s: pair.dp.dot(frame.s) * h,
                t: pair.dp.dot(frame.t) * h,
            };
        }
        let (major, minor) = ellipse(&sides[..pairs.len()])?;
        if strain * scale * scale <= MOST_STRAIN * MOST_STRAIN {
            let across = major.perp().normalize();
            for (step, side) in steps.iter_mut().zip(&sides) {
                *step *= (side.s * across.x + side.t * across.y) / minor;
            }
            // Spread over more dimensions, light has no sharp folds.
            let rim = (minor > 0.0 && sizes.sharing == 1).then(|| Rim {
                steps,
                way: (frame.s * across.x + frame.t * across.y) * minor,
            });
            let footprint = Self {
                major: frame.s * major.x + frame.t * major.y,
                minor,
                fold: f64::INFINITY,
            };
            return Some((footprint, rim));
        }
        let radius = (major.length() * minor).sqrt();
        let circle = Self {
            major: frame.s * radius,
            minor: radius,
            fold: f64::INFINITY,
        };
        (radius > 0.0).then_some((circle, None))
    }
}

impl Footprint {
    /// The semi-axes of the kernel when all kernels are drawn in by `shrink`. It
    /// reaches no further than a fold.
    pub(super) fn kernel(&self, shrink: f64) -> (f64, f64) {
        (
            self.major.length() * shrink,
            (self.minor * shrink).min(self.fold),
        )
    }

    /// Learns where the light that would be at the rim is in truth: `off`
    /// metres beyond it. Between photon and rim a path is taken for a parabola.
    pub(super) fn learn(&mut self, rim: &Rim, off: DVec3) {
        let off = off.dot(rim.way) / self.minor;
        if off == 0.0 || !off.is_finite() {
            return;
        }
        // At x(s) = minor s + off s^2 for s from -1 to 1; it turns back at
        // s = -minor / (2 off).
        self.fold = 0.25 * self.minor * (self.minor / off.abs());
        if off < 0.0 {
            self.major = -self.major;
        }
    }
}

/// Squared edge of each pair's cell, and how many pairs share the volume.
struct CellSizes {
    squared: [f64; MAX_PAIRS],
    sharing: usize,
}

fn cell_sizes(differential: &Differential, paths: f64) -> CellSizes {
    let pairs = differential.pairs();
    let mut squared = [1.0; MAX_PAIRS];
    let mut reach = [0.0; MAX_PAIRS];
    for (reach, pair) in reach.iter_mut().zip(pairs) {
        *reach = pair.dp.length_squared().element_sum();
    }
    let volume = 1.0 / (paths * differential.chance);
    let mut open: u32 = (1 << pairs.len()) - 1;
    loop {
        let members = || (0..pairs.len()).filter(|i| open & (1 << i) != 0);
        let sharing = open.count_ones() as usize;
        // All sharing pairs spread light equally far: squared[i] * reach(i) = spread.
        let spread = members().map(|i| reach[i]).product::<f64>() * volume;
        let spread = match sharing {
            0 => {
                return CellSizes {
                    squared,
                    sharing: 1,
                };
            }
            1 => spread,
            2 => spread.sqrt(),
            _ => libm::cbrt(spread),
        };
        let within = members()
            .filter(|&i| reach[i] <= spread)
            .fold(0, |s, i| s | 1 << i);
        if within == 0 || (within == open && sharing == 1) {
            for i in members() {
                squared[i] = (spread / reach[i]).min(1.0);
            }
            return CellSizes { squared, sharing };
        }
        // These count with their whole range; the others share what is left.
        open &= !within;
    }
}

/// The two vectors by which a cell's sides move a photon, in coordinates of a
/// tangent frame.
#[derive(Clone, Copy, Default)]
struct Sides {
    s: DVec2,
    t: DVec2,
}

impl Sides {
    /// The sum of the squared areas between these vectors and two others.
    #[inline]
    fn areas_squared(&self, o: &Self) -> f64 {
        let straight = self.s * o.t - self.t * o.s;
        let crossed = self.s * o.t.yx() - self.t * o.s.yx();
        straight.length_squared() + crossed.length_squared()
    }
}

/// The ellipse whose matrix is the sum of the vectors' outer products: its
/// major semi-axis and the length of the minor one. `None` if it is not finite
/// or a point.
fn ellipse(cell: &[Sides]) -> Option<(DVec2, f64)> {
    let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
    // The determinant as a sum of squares (Cauchy and Binet): no cancellation
    // where light is focused to a line.
    let mut determinant = 0.0;
    for (i, v) in cell.iter().enumerate() {
        a += v.s.length_squared();
        b += v.s.dot(v.t);
        c += v.t.length_squared();
        determinant += (v.s.x * v.t.y - v.t.x * v.s.y).powi(2);
        for w in &cell[..i] {
            determinant += v.areas_squared(w);
        }
    }
    let half = 0.5 * (a - c);
    let root = (half * half + b * b).sqrt();
    let major = 0.5 * (a + c) + root;
    if !(major > 0.0 && major.is_finite()) {
        return None;
    }
    // Of the two ways to write the eigenvector, the one without cancellation.
    let axis = if half >= 0.0 {
        DVec2::new(half + root, b)
    } else {
        DVec2::new(b, root - half)
    };
    let axis = axis.try_normalize().unwrap_or(DVec2::X);
    Some((axis * major.sqrt(), (determinant / major).sqrt()))
}

//! Which place of the picture gets the light of which place of the lens.
//!
//! Of all maps that carry an even density into that of the picture the optimal
//! one, which moves light least in the mean of squares, is the gradient of a
//! convex function (Y. Brenier, *Polar Factorization and Monotone
//! Rearrangement of Vector-Valued Functions*, 1991). It never crosses itself,
//! and a lens can make it. We look for its inverse, from the picture to the
//! lens, `x = grad v(y)`: its potential solves the Monge-Ampere equation
//!
//! `det D2v(y) = g(y)`, the normal part of `x` being that of `y` on the edges,
//!
//! whose right side, the picture, does not depend on the solution.

use rayon::prelude::*;

use super::poisson::Poisson;
use crate::numeric::SplineSurface;

/// Steps of the iteration, at most.
const MAX_STEPS: usize = 2000;
/// Mirrored samples around the potential, so that its spline is as good at
/// the edges as inside: an error at its end shrinks by 0.27 a sample.
const MARGIN: usize = 8;
/// How near the search for a place comes, in cells.
const PLACED: f64 = 1e-9;
/// Steps of that search, at most.
const MAX_NEWTON: usize = 60;

/// An even density carried into that of a picture, both over one rectangle.
#[derive(Clone, Debug)]
pub struct Transport {
    size: [usize; 2],
    spacing: [f64; 2],
    /// `v - |y|^2 / 2` in its margin, in units of length squared.
    potential: SplineSurface,
    /// How many steps it took.
    pub steps: usize,
    /// Root mean square of `det D2v / g - 1` on the grid.
    pub residual: f64,
}

impl Transport {
    /// For a picture of `density` (above zero everywhere, of mean 1) at the
    /// middles of `size` cells of side `spacing`, until the residual is below
    /// `tolerance` or no longer falls.
    ///
    /// The iteration is that of J.-D. Benamou, B. Froese and A. Oberman, *Two
    /// Numerical Methods for the Elliptic Monge-Ampere Equation*, ESAIM M2AN
    /// 44(4), 2010, section 4: with `(laplacian v)^2 = |D2v|^2 + 2 det D2v`
    /// the equation reads `laplacian v = sqrt(|D2v|^2 + 2 g)`, whose right
    /// side is taken from the step before. The root keeps `v` convex.
    pub fn new(size: [usize; 2], spacing: [f64; 2], density: &[f64], tolerance: f64) -> Self {
        let poisson = Poisson::new(size, spacing);
        let mut w = vec![0.0; density.len()];
        let mut best = (f64::INFINITY, w.clone());
        let (mut scale, mut steps, mut since_best) = (1.0, 0, 0);
        while steps < MAX_STEPS && since_best < 40 && best.0 > tolerance {
            let hessian = hessians(size, spacing, &w);
            let residual = residual(&hessian, density);
            since_best += 1;
            if residual < best.0 {
                if residual < 0.99 * best.0 {
                    since_best = 0;
                }
                best = (residual, w.clone());
            }
            let mut right = right_side(&hessian, density, &mut scale);
            poisson.solve(&mut right);
            w = right;
            steps += 1;
        }
        let (residual, w) = best;
        Self {
            size,
            spacing,
            potential: with_margin(size, &w),
            steps,
            residual,
        }
    }

    /// The place in the picture to which the light at `x` goes, from `guess`:
    /// the least point of `v(y) - x . y`, by Newton's method with a line
    /// search (J. Nocedal, S. Wright, *Numerical Optimization*, 2006, sections
    /// 3.1 and 3.4). Places beyond the edges come from rounding and are moved
    /// onto them.
    pub fn target(&self, x: [f64; 2], guess: [f64; 2]) -> [f64; 2] {
        let goal = PLACED * self.spacing[0].min(self.spacing[1]);
        let mut here = self.place(x, self.inside(guess));
        for _ in 0..MAX_NEWTON {
            if here.miss() <= goal {
                break;
            }
            let step = here.step();
            // Decrease along the step, to first order.
            let promised = here.off[0] * step[0] + here.off[1] * step[1];
            let tried = (0..24).map(|halvings| {
                let length = 1.0 / f64::from(1u32 << halvings);
                let y = [0, 1].map(|k| here.y[k] + length * step[k]);
                (length, self.place(x, self.inside(y)))
            });
            let better = |(length, there): &(f64, Place)| {
                there.miss() < 0.5 * here.miss()
                    || there.value < here.value - 1e-4 * length * promised
            };
            let Some((_, next)) = tried.into_iter().find(better) else {
                break;
            };
            here = next;
        }
        here.y
    }

    /// What is known at `y` of the search for `x`.
    fn place(&self, x: [f64; 2], y: [f64; 2]) -> Place {
        let [hx, hy] = self.spacing;
        let margin = MARGIN as f64 - 0.5;
        let jet = self.potential.at(y[0] / hx + margin, y[1] / hy + margin);
        let [gx, gy] = jet.gradient;
        let [xx, xy, yy] = jet.hessian;
        let d = [y[0] - x[0], y[1] - x[1]];
        Place {
            y,
            // Less |x|^2 / 2, which does not count, it loses no digits.
            value: jet.value + 0.5 * (d[0] * d[0] + d[1] * d[1]),
            off: [-d[0] - gx / hx, -d[1] - gy / hy],
            hessian: [1.0 + xx / (hx * hx), xy / (hx * hy), 1.0 + yy / (hy * hy)],
        }
    }

    fn inside(&self, y: [f64; 2]) -> [f64; 2] {
        let extent = self.extent();
        [0, 1].map(|k| y[k].clamp(0.0, extent[k]))
    }

    /// Width and height of the rectangle.
    pub fn extent(&self) -> [f64; 2] {
        [0, 1].map(|k| self.size[k] as f64 * self.spacing[k])
    }
}

/// A place in the picture and how it serves a place `x` on the lens.
struct Place {
    y: [f64; 2],
    /// `v(y) - x . y`, less what does not depend on `y`.
    value: f64,
    /// `x - grad v(y)`: downhill.
    off: [f64; 2],
    /// Second derivatives of `v`: xx, xy, yy.
    hessian: [f64; 3],
}

impl Place {
    fn miss(&self) -> f64 {
        self.off[0].abs().max(self.off[1].abs())
    }

    /// Newton's step; where `v` is not convex, for its spline overshoots at
    /// the edges of dark places, it is bent until it is.
    fn step(&self) -> [f64; 2] {
        let [mut xx, xy, mut yy] = self.hessian;
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let least = mean - (half * half + xy * xy).sqrt();
        if least <= 0.0 {
            xx += 0.1 - least;
            yy += 0.1 - least;
        }
        let det = xx * yy - xy * xy;
        let [a, b] = self.off;
        [(yy * a - xy * b) / det, (xx * b - xy * a) / det]
    }
}

/// `v_xx`, `v_xy` and `v_yy` at every point, by central differences with
/// mirrored edges.
fn hessians(size: [usize; 2], spacing: [f64; 2], w: &[f64]) -> Vec<[f64; 3]> {
    let [nx, ny] = size;
    let [hx, hy] = spacing;
    (0..w.len())
        .into_par_iter()
        .map(|k| {
            let (i, j) = (k % nx, k / nx);
            let (left, right) = (i.saturating_sub(1), (i + 1).min(nx - 1));
            let (low, high) = (j.saturating_sub(1), (j + 1).min(ny - 1));
            let at = |i: usize, j: usize| w[j * nx + i];
            let c = at(i, j);
            [
                1.0 + (at(left, j) - 2.0 * c + at(right, j)) / (hx * hx),
                (at(right, high) - at(left, high) - at(right, low) + at(left, low))
                    / (4.0 * hx * hy),
                1.0 + (at(i, low) - 2.0 * c + at(i, high)) / (hy * hy),
            ]
        })
        .collect()
}

/// Root mean square of `det D2v / g - 1`.
fn residual(hessians: &[[f64; 3]], density: &[f64]) -> f64 {
    let square = |([xx, xy, yy], g): (&[f64; 3], &f64)| {
        let off = (xx * yy - xy * xy) / g - 1.0;
        off * off
    };
    let sum: f64 = hessians.iter().zip(density).map(square).sum();
    (sum / density.len() as f64).sqrt()
}

/// `sqrt(|D2v|^2 + 2 s g) - 2`; a step of Newton's method for `s` keeps its
/// mean at zero, without which there is no solution.
fn right_side(hessians: &[[f64; 3]], density: &[f64], scale: &mut f64) -> Vec<f64> {
    let squares: Vec<f64> = hessians
        .par_iter()
        .map(|[xx, xy, yy]| xx * xx + 2.0 * xy * xy + yy * yy)
        .collect();
    let root = |(a, g): (&f64, &f64), s: f64| (a + 2.0 * s * g).sqrt();
    let (mut sum, mut slope) = (0.0, 0.0);
    for pair in squares.iter().zip(density) {
        let r = root(pair, *scale);
        sum += r - 2.0;
        slope += pair.1 / r;
    }
    *scale = (*scale - sum / slope).max(0.5 * *scale);
    squares
        .par_iter()
        .zip(density)
        .map(|pair| root(pair, *scale) - 2.0)
        .collect()
}

/// The samples with mirrored ones around them, and the spline through all.
fn with_margin(size: [usize; 2], w: &[f64]) -> SplineSurface {
    let inside = |k: usize, n: usize| {
        // ... 1 0 | 0 1 2 ... n-1 | n-1 n-2 ...
        let at = (k + 2 * n * MARGIN - MARGIN) % (2 * n);
        at.min(2 * n - 1 - at)
    };
    let full = size.map(|n| n + 2 * MARGIN);
    let samples: Vec<f64> = (0..full[0] * full[1])
        .map(|k| {
            let (i, j) = (inside(k % full[0], size[0]), inside(k / full[0], size[1]));
            w[j * size[0] + i]
        })
        .collect();
    SplineSurface::new(full, &samples)
}

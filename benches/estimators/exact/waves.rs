//! Vertical light through a wavy surface of water.
//!
//! The surface is a sum of sine waves. A vertical ray that comes down at
//! `(x, y)` is bent once, by the exact normal, and lands on the floor.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{Reference, Window, reflectance};

/// Index of the water.
pub(crate) const INDEX: f64 = 1.33;

/// Cells of the reference's lattice along a side, each sampled at a grid of
/// points of its own whose place turns from cell to cell.
const CELLS: usize = 2048;
const POINTS: usize = 12;

/// Rows of cells in a task.
const ROWS: usize = 32;

/// One wave: height `amplitude * sin(k . (x, y) + phase)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave {
    /// Largest height in metres.
    pub(crate) amplitude: f64,
    /// Wave vector in radians per metre.
    pub(crate) k: DVec2,
    /// Phase in radians.
    pub(crate) phase: f64,
}

/// A square sheet of waves above a floor, lit from above by 1 W/m2.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    /// Half the width of the sheet in metres.
    pub(crate) half: f64,
    /// Mean height above the floor in metres.
    pub(crate) height: f64,
    /// The waves.
    pub(crate) waves: Vec<Wave>,
}

impl Sheet {
    /// Fourteen waves of equal steepness, their lengths in geometric
    /// progression and their directions turned by the golden angle.
    pub(crate) fn bumpy() -> Self {
        let golden = TAU * (1.0 - 0.5 * (5f64.sqrt() - 1.0));
        let wave = |j: u32| {
            let j = f64::from(j);
            let k = 5.0 * 1.12f64.powf(j);
            Wave {
                amplitude: 0.06 / k,
                k: DVec2::from_angle(golden * j) * k,
                phase: 1.7 * j,
            }
        };
        Self {
            half: 1.0,
            height: 1.2,
            waves: (0..14).map(wave).collect(),
        }
    }

    /// Where the light that comes down at `(x, y)` lands, and the share that
    /// is not reflected.
    pub(crate) fn landing(&self, x: f64, y: f64) -> (DVec2, f64) {
        let (mut z, mut slope) = (self.height, DVec2::ZERO);
        for wave in &self.waves {
            let (sin, cos) = (wave.k.x * x + wave.k.y * y + wave.phase).sin_cos();
            z += wave.amplitude * sin;
            slope += wave.k * (wave.amplitude * cos);
        }
        let cos_i = 1.0 / (1.0 + slope.length_squared()).sqrt();
        let normal = DVec3::new(-slope.x, -slope.y, 1.0) * cos_i;
        let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (INDEX * INDEX)).sqrt();
        let dir = DVec3::NEG_Z / INDEX + normal * (cos_i / INDEX - cos_t);
        let landed = DVec2::new(x, y) - dir.truncate() * (z / dir.z);
        (landed, 1.0 - reflectance(cos_i, cos_t, INDEX))
    }

    /// Irradiance on the floor.
    pub(crate) fn reference(&self, window: Window) -> Reference {
        let pixels = (window.pixels * window.pixels) as usize;
        let parts = (0..CELLS / ROWS).into_par_iter().map(|task| {
            let mut halves = [vec![0.0; pixels], vec![0.0; pixels]];
            let mut below = self.row(task * ROWS);
            for row in task * ROWS..(task + 1) * ROWS {
                let above = self.row(row + 1);
                for column in 0..CELLS {
                    let corners = [
                        below[column],
                        below[column + 1],
                        above[column],
                        above[column + 1],
                    ];
                    self.cell(corners, row * CELLS + column, window, &mut halves);
                }
                below = above;
            }
            halves
        });
        let parts: Vec<[Vec<f64>; 2]> = parts.collect();
        let [a, b] = [0, 1].map(|half| {
            let sum = |pixel| parts.iter().map(|p| p[half][pixel]).sum::<f64>();
            let scale = 2.0 * window.per_metre() * window.per_metre();
            window.image((0..pixels).map(|pixel| sum(pixel) * scale))
        });
        Reference::of_halves(&a, &b)
    }

    /// Landings along a line of the lattice.
    fn row(&self, row: usize) -> Vec<DVec3> {
        let at = |i: usize| self.half * (2.0 * i as f64 / CELLS as f64 - 1.0);
        let landed = |i| {
            let (p, share) = self.landing(at(i), at(row));
            p.extend(share)
        };
        (0..=CELLS).map(landed).collect()
    }

    /// Divides a cell's light among the pixels; its points go to the one half
    /// and the other like the squares of a chessboard.
    fn cell(&self, corners: [DVec3; 4], number: usize, window: Window, halves: &mut [Vec<f64>; 2]) {
        // The additive sequence of Roberts (2018): the root of x^3 = x + 1.
        const ROOT: f64 = 1.324_717_957_244_75;
        let area = 2.0 * self.half / CELLS as f64;
        let flux = area * area / (POINTS * POINTS) as f64;
        let shift = [1, 2].map(|power| (number as f64 / ROOT.powi(power)).fract());
        let [a, b, c, d] = corners;
        for j in 0..POINTS {
            let v = (j as f64 + shift[1]) / POINTS as f64;
            let (left, right) = (a.lerp(c, v), b.lerp(d, v));
            for i in 0..POINTS {
                let p = left.lerp(right, (i as f64 + shift[0]) / POINTS as f64);
                if let Some(pixel) = window.pixel(p.x, p.y) {
                    halves[(i + j) % 2][pixel] += flux * p.z;
                }
            }
        }
    }
}

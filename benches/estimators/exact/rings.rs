//! Rings of light divided among square pixels.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::Window;

/// Flux of concentric rings, summed over the pixels that they cross. The
/// window is symmetric, so one eighth of it is enough: angles from 0 to 45
/// degrees from the x axis.
#[derive(Clone)]
pub(crate) struct Rings {
    window: Window,
    /// Pixels along half a side.
    half: usize,
    /// Flux of that eighth, row by row away from the centre.
    flux: Vec<f64>,
}

impl Rings {
    /// No light yet.
    pub(crate) fn new(window: Window) -> Self {
        let half = window.pixels as usize / 2;
        Self {
            window,
            half,
            flux: vec![0.0; half * half],
        }
    }

    /// Adds a ring of the given radius in metres, whose flux is spread evenly
    /// over its angles.
    pub(crate) fn add(&mut self, radius: f64, flux: f64) {
        let r = radius * self.window.per_metre();
        let half = self.half as f64;
        if r.is_nan() || r * r >= 2.0 * half * half {
            return;
        }
        // Where the ring enters the window, and in which pixel.
        let mut angle = if r > half { (half / r).acos() } else { 0.0 };
        let mut column = (r as usize).min(self.half - 1);
        let mut row = ((r * angle.sin()) as usize).min(self.half - 1);
        let crossing = |column: usize, row: usize| {
            let left = (column as f64 / r).min(1.0).acos();
            let up = ((row + 1) as f64 / r).min(1.0).asin();
            (left, up)
        };
        let (mut left, mut up) = crossing(column, row);
        while angle < FRAC_PI_4 {
            let next = left.min(up).min(FRAC_PI_4).max(angle);
            self.flux[row * self.half + column] += flux * (next - angle) / TAU;
            angle = next;
            if left <= up {
                // Left of the first column lie angles beyond 90 degrees.
                column = column.saturating_sub(1);
                left = (column as f64 / r).min(1.0).acos();
            } else {
                row += 1;
                if row == self.half {
                    break;
                }
                up = ((row + 1) as f64 / r).min(1.0).asin();
            }
        }
    }

    /// Adds all of another window's light.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (ours, theirs) in self.flux.iter_mut().zip(&other.flux) {
            *ours += theirs;
        }
    }

    /// Irradiance of each pixel, row by row.
    pub(crate) fn irradiance(&self) -> impl Iterator<Item = f64> + '_ {
        let half = self.half;
        let away = move |i: usize| if i < half { half - 1 - i } else { i - half };
        let per_area = self.window.per_metre() * self.window.per_metre();
        let side = 2 * half;
        (0..side * side).map(move |i| {
            let (a, b) = (away(i % side), away(i / side));
            (self.flux[b * half + a] + self.flux[a * half + b]) * per_area
        })
    }
}

/// Light by its distance from the centre, in rings so thin that a pixel is
/// many of them. Each ring remembers the mean distance of its light.
#[derive(Clone)]
pub(crate) struct Radial {
    window: Window,
    /// Flux, and flux times distance in metres.
    bins: Vec<[f64; 2]>,
}

impl Radial {
    const BINS_PER_PIXEL: u32 = 32;

    /// No light yet.
    pub(crate) fn new(window: Window) -> Self {
        let bins = f64::from(window.pixels / 2 * Self::BINS_PER_PIXEL) * 2f64.sqrt();
        Self {
            window,
            bins: vec![[0.0; 2]; bins as usize + 1],
        }
    }

    /// Adds flux at a distance in metres.
    pub(crate) fn add(&mut self, radius: f64, flux: f64) {
        let bin = radius * self.window.per_metre() * f64::from(Self::BINS_PER_PIXEL);
        if let Some([sum, moment]) = self.bins.get_mut(bin as usize) {
            *sum += flux;
            *moment += flux * radius;
        }
    }

    /// Adds all of another's light.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (ours, theirs) in self.bins.iter_mut().zip(&other.bins) {
            ours[0] += theirs[0];
            ours[1] += theirs[1];
        }
    }

    /// The light as rings.
    pub(crate) fn rings(&self) -> Rings {
        let mut rings = Rings::new(self.window);
        for &[flux, moment] in &self.bins {
            if flux > 0.0 {
                rings.add(moment / flux, flux);
            }
        }
        rings
    }
}

//! Separable filters over planes.
//!
//! A kernel has an odd number of weights, the middle one for the pixel itself;
//! the others weigh its neighbours in order, left to right or top to bottom.
//! Beyond the edge the picture goes on with its outermost pixels.

use rayon::prelude::*;

use super::plane::Plane;
use crate::numeric::trig::exp;

/// Weights `f(-radius)`, ..., `f(radius)`.
pub(super) fn kernel(radius: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i64;
    (-radius..=radius).map(|i| f(i as f64)).collect()
}

/// A Gaussian exp(-x^2 / (2 sigma^2)) with its weights' sum scaled to one.
pub(super) fn gaussian(radius: usize, sigma: f64) -> Vec<f64> {
    normalized(kernel(radius, |x| exp(-x * x / (2.0 * sigma * sigma)))).0
}

/// The weights scaled to a sum of one, and the sum that they had.
pub(super) fn normalized(weights: Vec<f64>) -> (Vec<f64>, f64) {
    let sum: f64 = weights.iter().sum();
    (weights.into_iter().map(|w| w / sum).collect(), sum)
}

/// The plane filtered along its rows by `across` and along its columns by
/// `down`.
pub(super) fn convolve(plane: &Plane, across: &[f64], down: &[f64]) -> Plane {
    along_columns(&along_rows(plane, across), down)
}

/// The plane filtered along its rows.
pub(super) fn along_rows(plane: &Plane, weights: &[f64]) -> Plane {
    let (width, height) = (plane.width(), plane.height());
    let mut values = vec![0.0; width * height];
    // A plane without columns has no rows to fill.
    let rows = values.par_chunks_mut(width.max(1)).enumerate();
    rows.for_each(|(y, out)| {
        let padded = pad(plane.row(y), weights.len() / 2);
        for (i, &weight) in weights.iter().enumerate() {
            add(out, weight, &padded[i..]);
        }
    });
    Plane::new(width, height, values)
}

/// The plane filtered along its columns.
pub(super) fn along_columns(plane: &Plane, weights: &[f64]) -> Plane {
    let (width, height) = (plane.width(), plane.height());
    let radius = weights.len() / 2;
    let mut values = vec![0.0; width * height];
    let rows = values.par_chunks_mut(width.max(1)).enumerate();
    rows.for_each(|(y, out)| {
        for (i, &weight) in weights.iter().enumerate() {
            let row = (y + i).saturating_sub(radius).min(height - 1);
            add(out, weight, plane.row(row));
        }
    });
    Plane::new(width, height, values)
}

fn add(out: &mut [f64], weight: f64, values: &[f64]) {
    for (sum, value) in out.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// The row with `radius` copies of its ends on either side.
fn pad(row: &[f64], radius: usize) -> Vec<f64> {
    let (first, last) = (row[0], row[row.len() - 1]);
    let mut padded = vec![first; radius];
    padded.extend_from_slice(row);
    padded.resize(row.len() + 2 * radius, last);
    padded
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the definition, a double loop with clamped places, on a plane
    /// that is narrower than the kernel.
    #[test]
    fn agrees_with_its_definition() {
        let (width, height) = (3, 7);
        let values = (0..21).map(|i| f64::from(i * i % 13)).collect();
        let plane = Plane::new(width, height, values);
        let across = [0.5, -1.0, 2.0, 0.25, 3.0];
        let down = [1.0, 0.125, -0.5];
        let filtered = convolve(&plane, &across, &down);
        let clamped = |x: i64, y: i64| {
            let (x, y) = (x.clamp(0, 2) as usize, y.clamp(0, 6) as usize);
            plane.row(y)[x]
        };
        for y in 0..height as i64 {
            for x in 0..width as i64 {
                let mut sum = 0.0;
                for (j, b) in (-1..).zip(down) {
                    for (i, a) in (-2..).zip(across) {
                        sum += a * b * clamped(x + i, y + j);
                    }
                }
                assert_eq!(filtered.row(y as usize)[x as usize], sum, "{x} {y}");
            }
        }
    }

    #[test]
    fn a_gaussian_keeps_what_is_even() {
        let weights = gaussian(5, 1.5);
        let plane = Plane::new(4, 4, vec![2.0; 16]);
        let filtered = convolve(&plane, &weights, &weights);
        for value in filtered.values() {
            // Twenty-two products and sums of weights whose sum is one.
            assert!((value - 2.0).abs() <= 2.0 * crate::numeric::gamma(48));
        }
        assert!((weights[6] / weights[5] - (-1.0f64 / 4.5).exp()).abs() < 1e-15);
    }
}

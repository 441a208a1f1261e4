//! Poisson's equation on a rectangle whose edges let nothing through.
//!
//! The five-point Laplacian with mirrored edges has cosines as its
//! eigenvectors (G. Strang, *The Discrete Cosine Transform*, SIAM Review
//! 41(1), 1999, the transform DCT-2). Transforms go by a complex one of the
//! same length (J. Makhoul, *A Fast Cosine Transform in One and Two
//! Dimensions*, IEEE Trans. ASSP 28(1), 1980). Sides are powers of two.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::numeric::trig::sin_cos;

/// Solver for one size of grid.
#[derive(Clone, Debug)]
pub struct Poisson {
    size: [usize; 2],
    spacing: [f64; 2],
    transforms: [Cosines; 2],
}

impl Poisson {
    /// For `size[0]` values a row, `spacing` apart along x and y.
    ///
    /// # Panics
    /// If a side is not a power of two.
    pub fn new(size: [usize; 2], spacing: [f64; 2]) -> Self {
        Self {
            size,
            spacing,
            transforms: size.map(Cosines::new),
        }
    }

    /// Replaces `f` by the `w` of zero mean with `laplacian w = f - mean f`,
    /// where each edge mirrors its neighbours.
    pub fn solve(&self, f: &mut Vec<f64>) {
        let [nx, ny] = self.size;
        self.transforms[0].forward(f);
        let mut columns = transposed(f, nx);
        self.transforms[1].forward(&mut columns);
        let [ex, ey] = [0, 1].map(|axis| eigenvalues(self.size[axis], self.spacing[axis]));
        columns
            .par_chunks_mut(ny)
            .zip(&ex)
            .for_each(|(column, ex)| {
                for (value, ey) in column.iter_mut().zip(&ey) {
                    *value /= ex + ey;
                }
            });
        // The mean: 0 / 0 above.
        columns[0] = 0.0;
        self.transforms[1].inverse(&mut columns);
        *f = transposed(&columns, ny);
        self.transforms[0].inverse(f);
    }
}

/// What second differences of spacing `h` do to the cosines.
fn eigenvalues(n: usize, h: f64) -> Vec<f64> {
    let value = |k: usize| {
        let (sin, _) = sin_cos(0.5 * PI * k as f64 / n as f64);
        -4.0 * sin * sin / (h * h)
    };
    (0..n).map(value).collect()
}

fn transposed(values: &[f64], width: usize) -> Vec<f64> {
    let height = values.len() / width;
    (0..values.len())
        .into_par_iter()
        .map(|k| values[(k % height) * width + k / height])
        .collect()
}

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn conjugate(a: Complex) -> Complex {
    [a[0], -a[1]]
}

/// The cosine transform of rows of `n` values.
#[derive(Clone, Debug)]
struct Cosines {
    n: usize,
    /// `exp(-2 pi i k / n)`, k below n / 2.
    turns: Vec<Complex>,
    /// `exp(-pi i k / 2 n)`.
    quarter_turns: Vec<Complex>,
}

impl Cosines {
    fn new(n: usize) -> Self {
        assert!(n.is_power_of_two(), "a side of {n} is not a power of two");
        let turn = |angle: f64| {
            let (sin, cos) = sin_cos(angle);
            [cos, -sin]
        };
        Self {
            n,
            turns: (0..n / 2)
                .map(|k| turn(2.0 * PI * k as f64 / n as f64))
                .collect(),
            quarter_turns: (0..n)
                .map(|k| turn(0.5 * PI * k as f64 / n as f64))
                .collect(),
        }
    }

    /// `X[k] = sum over j of x[j] cos(pi k (2 j + 1) / 2 n)` in every row.
    fn forward(&self, rows: &mut [f64]) {
        let n = self.n;
        rows.par_chunks_mut(n).for_each(|row| {
            let mut line: Vec<Complex> = (0..n).map(|k| [row[fold(k, n)], 0.0]).collect();
            self.fourier(&mut line);
            for ((x, v), q) in row.iter_mut().zip(&line).zip(&self.quarter_turns) {
                *x = times(*v, *q)[0];
            }
        });
    }

    /// The inverse of [`forward`](Self::forward).
    fn inverse(&self, rows: &mut [f64]) {
        let n = self.n;
        rows.par_chunks_mut(n).for_each(|row| {
            // The conjugate of Makhoul's spectrum: an inverse transform is the
            // forward one of conjugates.
            let spectrum = |k: usize| {
                let mirrored = if k == 0 { 0.0 } else { row[n - k] };
                times([row[k], mirrored], self.quarter_turns[k])
            };
            let mut line: Vec<Complex> = (0..n).map(spectrum).collect();
            self.fourier(&mut line);
            for (k, v) in line.iter().enumerate() {
                row[fold(k, n)] = conjugate(*v)[0] / n as f64;
            }
        });
    }

    /// The discrete Fourier transform in place (Cooley and Tukey, radix 2).
    fn fourier(&self, line: &mut [Complex]) {
        let n = self.n;
        if n == 1 {
            return;
        }
        let shift = usize::BITS - n.trailing_zeros();
        for i in 0..n {
            let j = i.reverse_bits() >> shift;
            if i < j {
                line.swap(i, j);
            }
        }
        let mut half = 1;
        while half < n {
            let stride = n / (2 * half);
            for block in line.chunks_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                    let turned = times(*b, self.turns[k * stride]);
                    *b = [a[0] - turned[0], a[1] - turned[1]];
                    *a = [a[0] + turned[0], a[1] + turned[1]];
                }
            }
            half *= 2;
        }
    }
}

/// Even places first, then the odd ones backwards.
fn fold(k: usize, n: usize) -> usize {
    if 2 * k < n { 2 * k } else { 2 * (n - k) - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without pattern.
    fn noise(n: usize) -> Vec<f64> {
        (0..n)
            .map(|k| ((k * k * 7919 + k * 104_729) % 1009) as f64 / 1009.0 - 0.5)
            .collect()
    }

    #[test]
    fn the_transform_is_its_definition_and_has_an_inverse() {
        for n in [1, 2, 4, 16, 64] {
            let cosines = Cosines::new(n);
            let x = noise(3 * n);
            let mut rows = x.clone();
            cosines.forward(&mut rows);
            for (row, known) in rows.chunks(n).zip(x.chunks(n)) {
                for (k, found) in row.iter().enumerate() {
                    let term = |(j, x): (usize, &f64)| {
                        let angle = PI * (k * (2 * j + 1)) as f64 / (2 * n) as f64;
                        x * sin_cos(angle).1
                    };
                    let sum: f64 = known.iter().enumerate().map(term).sum();
                    assert!((found - sum).abs() < 1e-13 * n as f64, "{n}: {k}");
                }
            }
            cosines.inverse(&mut rows);
            for (found, known) in rows.iter().zip(&x) {
                assert!((found - known).abs() < 1e-14 * n as f64);
            }
        }
    }

    /// The Laplacian of the solution, applied at each point, is what was
    /// asked for.
    #[test]
    fn the_solution_solves() {
        let ([nx, ny], [hx, hy]) = ([32, 8], [0.5, 0.25]);
        let f = noise(nx * ny);
        let mean = f.iter().sum::<f64>() / f.len() as f64;
        let mut w = f.clone();
        Poisson::new([nx, ny], [hx, hy]).solve(&mut w);
        let at = |i: usize, j: usize| w[j.min(ny - 1) * nx + i.min(nx - 1)];
        for j in 0..ny {
            for i in 0..nx {
                let c = at(i, j);
                let xx = at(i + 1, j) - 2.0 * c + at(i.saturating_sub(1), j);
                let yy = at(i, j + 1) - 2.0 * c + at(i, j.saturating_sub(1));
                let found = xx / (hx * hx) + yy / (hy * hy);
                assert!((found - (f[j * nx + i] - mean)).abs() < 1e-12);
            }
        }
        assert!(w.iter().sum::<f64>().abs() < 1e-12);
    }
}

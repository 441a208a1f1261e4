//! A smooth surface through samples on a grid: the cubic spline along both
//! axes.
//!
//! The spline passes through every sample and has continuous second
//! derivatives (C. de Boor, *A Practical Guide to Splines*, 2001, chapter IV;
//! the tensor product in chapter XVII). Between samples `h` apart its value is
//! off by `O(h^4)` and its gradient by `O(h^3)`. At the ends of a row the slope
//! is that of the cubic through the four samples there, so that polynomials up
//! to degree three are reproduced to rounding.

use rayon::prelude::*;

/// What is kept of a sample: value, slopes along x and y, mixed derivative.
type Node = [f64; 4];

/// A surface `f(x, y)`; samples stand at whole numbers, from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineSurface {
    size: [usize; 2],
    nodes: Vec<Node>,
}

/// A value with its derivatives, in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// `df/dx` and `df/dy`.
    pub gradient: [f64; 2],
    /// `d2f/dx2`, `d2f/dxdy` and `d2f/dy2`.
    pub hessian: [f64; 3],
}

impl SplineSurface {
    /// The surface through `samples`, `size[0]` a row, rows along y.
    ///
    /// # Panics
    /// If an axis has fewer than two samples, or their number is not the
    /// product of both.
    pub fn new(size: [usize; 2], samples: &[f64]) -> Self {
        let [nx, ny] = size;
        assert!(nx >= 2 && ny >= 2, "a surface needs two samples an axis");
        assert_eq!(samples.len(), nx * ny, "one sample per grid point");
        let mut nodes: Vec<Node> = samples.iter().map(|&f| [f, 0.0, 0.0, 0.0]).collect();
        let row = Slopes::new(nx);
        nodes
            .par_chunks_mut(nx)
            .for_each(|line| row.fill(line, 0, 1));
        // Columns, through their own copy: neighbours in memory.
        let mut columns = transposed(&nodes, nx);
        let column = Slopes::new(ny);
        columns.par_chunks_mut(ny).for_each(|line| {
            column.fill(line, 0, 2);
            column.fill(line, 1, 3);
        });
        let nodes = transposed(&columns, ny);
        Self { size, nodes }
    }

    /// The number of samples along x and y.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The surface at a point; beyond the samples the outermost cells go on.
    pub fn at(&self, x: f64, y: f64) -> Jet {
        let [nx, ny] = self.size;
        let (i, u) = cell(x, nx);
        let (j, v) = cell(y, ny);
        let row = j * nx + i;
        let corners = [row, row + 1, row + nx, row + nx + 1].map(|k| &self.nodes[k]);
        let (hu, hv) = (hermite(u), hermite(v));
        // Along x first: value and slope along y, at the lower and upper edge.
        let along = |order: usize, a: &Node, b: &Node, of: usize| {
            let w = &hu[order];
            w[0] * a[of] + w[1] * b[of] + w[2] * a[of + 1] + w[3] * b[of + 1]
        };
        let derivative = |order_x: usize, order_y: usize| {
            let w = &hv[order_y];
            let edge = |of: usize, k: usize| {
                let [a, b] = [corners[2 * k], corners[2 * k + 1]];
                // The nodes hold f, fx, fy, fxy: a slope along x follows its
                // value.
                along(order_x, a, b, of)
            };
            w[0] * edge(0, 0) + w[1] * edge(0, 1) + w[2] * edge(2, 0) + w[3] * edge(2, 1)
        };
        Jet {
            value: derivative(0, 0),
            gradient: [derivative(1, 0), derivative(0, 1)],
            hessian: [derivative(2, 0), derivative(1, 1), derivative(0, 2)],
        }
    }
}

/// The cell that holds a coordinate, and the place in it.
fn cell(x: f64, n: usize) -> (usize, f64) {
    // Negative numbers and NaN become 0.
    let i = (x as usize).min(n - 2);
    (i, x - i as f64)
}

/// Weights of the values at 0 and 1 and the slopes at 0 and 1 in a cubic at
/// `t`, then those for its first and second derivative.
fn hermite(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [
            s * s * (1.0 + 2.0 * t),
            t * t * (1.0 + 2.0 * s),
            t * s * s,
            -t * t * s,
        ],
        [
            -6.0 * t * s,
            6.0 * t * s,
            s * (s - 2.0 * t),
            t * (t - 2.0 * s),
        ],
        [
            6.0 * (t - s),
            6.0 * (s - t),
            2.0 * (t - 2.0 * s),
            2.0 * (2.0 * t - s),
        ],
    ]
}

fn transposed(nodes: &[Node], width: usize) -> Vec<Node> {
    let height = nodes.len() / width;
    (0..nodes.len())
        .into_par_iter()
        .map(|k| nodes[(k % height) * width + k / height])
        .collect()
}

/// The slopes of cubic splines through `n` samples.
struct Slopes {
    /// Factors of the elimination, the same for every row.
    factors: Vec<f64>,
}

impl Slopes {
    fn new(n: usize) -> Self {
        let mut factors = Vec::with_capacity(n);
        let mut last = 0.0;
        for _ in 2..n {
            last = 1.0 / (4.0 - last);
            factors.push(last);
        }
        Self { factors }
    }

    /// Puts the slopes of component `of` into component `into`. Inside,
    /// `s[i-1] + 4 s[i] + s[i+1] = 3 (f[i+1] - f[i-1])`, solved by elimination.
    fn fill(&self, line: &mut [Node], of: usize, into: usize) {
        let n = line.len();
        let f = |line: &[Node], i: usize| line[i][of];
        let first = end_slope(n, |i| f(line, i));
        let last = -end_slope(n, |i| f(line, n - 1 - i));
        line[0][into] = first;
        line[n - 1][into] = last;
        for i in 1..n - 1 {
            let mut right = 3.0 * (f(line, i + 1) - f(line, i - 1)) - line[i - 1][into];
            if i == n - 2 {
                right -= last;
            }
            line[i][into] = right * self.factors[i - 1];
        }
        for i in (1..n.saturating_sub(2)).rev() {
            line[i][into] -= self.factors[i - 1] * line[i + 1][into];
        }
    }
}

/// The slope at sample 0 of the polynomial through the first four samples, or
/// through all if there are fewer.
fn end_slope(n: usize, f: impl Fn(usize) -> f64) -> f64 {
    let d = |i: usize| f(i) - f(0);
    match n {
        2 => d(1),
        3 => 2.0 * d(1) - 0.5 * d(2),
        _ => 3.0 * d(1) - 1.5 * d(2) + d(3) / 3.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::trig::sin_cos;

    fn sampled(size: [usize; 2], f: impl Fn(f64, f64) -> f64) -> SplineSurface {
        let [nx, ny] = size;
        let samples: Vec<f64> = (0..nx * ny)
            .map(|k| f((k % nx) as f64, (k / nx) as f64))
            .collect();
        SplineSurface::new(size, &samples)
    }

    #[test]
    fn cubics_are_reproduced() {
        // Sizes down to those that a polynomial of degree 3 needs.
        for size in [[4, 4], [7, 5], [4, 12]] {
            let surface = sampled(size, |x, y| {
                (1.0 - x + 0.5 * x * x - 0.1 * x * x * x) * (2.0 + y - 0.25 * y * y * y)
            });
            for (x, y) in [(0.0, 0.0), (0.3, 2.9), (2.5, 1.25), (3.0, 3.0)] {
                let (p, dp, ddp) = (
                    1.0 - x + 0.5 * x * x - 0.1 * x * x * x,
                    -1.0 + x - 0.3 * x * x,
                    1.0 - 0.6 * x,
                );
                let (q, dq, ddq) = (2.0 + y - 0.25 * y * y * y, 1.0 - 0.75 * y * y, -1.5 * y);
                let jet = surface.at(x, y);
                let known = [p * q, dp * q, p * dq, ddp * q, dp * dq, p * ddq];
                let found = [[jet.value, jet.gradient[0], jet.gradient[1]], jet.hessian];
                for (k, f) in known.into_iter().zip(found.concat()) {
                    assert!((k - f).abs() < 1e-11, "{size:?} ({x}, {y}): {f} for {k}");
                }
            }
        }
    }

    #[test]
    fn few_samples_make_planes_and_parabolas() {
        let plane = sampled([2, 2], |x, y| 3.0 + 2.0 * x - y + x * y);
        assert_eq!(plane.at(0.25, 0.5).value, 3.0 + 0.5 - 0.5 + 0.125);
        let bowl = sampled([3, 2], |x, _| x * x);
        assert!((bowl.at(1.25, 0.7).gradient[0] - 2.5).abs() < 1e-15);
        assert!((bowl.at(0.25, 0.7).value - 0.0625).abs() < 1e-15);
    }

    /// Halving the distance of the samples takes the error of the gradient
    /// down by eight, that of the value by sixteen.
    #[test]
    fn errors_fall_with_the_third_and_fourth_power() {
        let errors = |n: usize| {
            let h = 2.0 / (n - 1) as f64;
            let surface = sampled([n, n], |x, y| {
                sin_cos(2.0 * x * h).0 * sin_cos(1.0 + y * h).0
            });
            let (mut value, mut slope) = (0.0f64, 0.0f64);
            for k in 0..400 {
                let (x, y) = ((k % 20) as f64 / 19.3, (k / 20) as f64 / 19.7);
                let (s, c) = sin_cos(4.0 * x);
                let w = sin_cos(1.0 + 2.0 * y).0;
                let jet = surface.at(2.0 * x / h, 2.0 * y / h);
                value = value.max((jet.value - s * w).abs());
                slope = slope.max((jet.gradient[0] / h - 2.0 * c * w).abs());
            }
            (value, slope)
        };
        let (coarse, fine) = (errors(17), errors(33));
        assert!(fine.0 < coarse.0 / 12.0, "{coarse:?} {fine:?}");
        assert!(fine.1 < coarse.1 / 6.5, "{coarse:?} {fine:?}");
        assert!(fine.0 < 1e-4 && fine.0 > 1e-9);
    }

    /// From cell to cell, the second derivative does not jump.
    #[test]
    fn cells_join_smoothly() {
        let surface = sampled([6, 6], |x, y| ((x * 7.3 + y * y * 3.1) as i64 % 5) as f64);
        for k in 1..5 {
            let (x, y) = (k as f64, 2.37);
            let (before, after) = (surface.at(x - 1e-12, y), surface.at(x, y));
            for (a, b) in before.hessian.into_iter().zip(after.hessian) {
                assert!((a - b).abs() < 1e-9, "at {x}: {a} and {b}");
            }
        }
    }
}

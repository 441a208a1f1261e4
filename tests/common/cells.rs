//! Chi-square tests of counts in cells.
//!
//! The level is one false alarm in a hundred runs over all tests together
//! (Sidak), and seeds are fixed.

use std::f64::consts::TAU;

use glam::DVec3;
use nephroid::{
    metrics::{chi_square, sidak},
    sampling::warp,
};

/// At least the number of chi-square tests in all files together.
const TESTS: usize = 150;

/// Draws per test.
pub(crate) const DRAWS: u64 = 40_000;

/// Asserts that counts follow what is expected up to a factor.
pub(crate) fn assert_follows(observed: &[u64], weights: &[f64], what: &str) {
    let draws: u64 = observed.iter().sum();
    let total: f64 = weights.iter().sum();
    let expected: Vec<f64> = weights.iter().map(|w| w / total * draws as f64).collect();
    let test = chi_square(observed, &expected, 5.0).unwrap_or_else(|| panic!("{what}: no cells"));
    assert!(
        test.p_value > sidak(0.01, TESTS),
        "{what}: chi-square {} with {} degrees of freedom, p = {:e}",
        test.statistic,
        test.degrees,
        test.p_value
    );
}

/// Counts of points of the unit square in `N x N` cells.
pub(crate) struct Grid<const N: usize>(pub(crate) Vec<u64>);

impl<const N: usize> Grid<N> {
    /// All cells empty.
    pub(crate) fn new() -> Self {
        Self(vec![0; N * N])
    }

    /// The cell of a point; rounding may put it on the upper edge.
    pub(crate) fn cell([x, y]: [f64; 2]) -> usize {
        assert!(
            (-1e-9..=1.0 + 1e-9).contains(&x) && (-1e-9..=1.0 + 1e-9).contains(&y),
            "({x}, {y}) lies outside the domain"
        );
        let index = |v: f64| ((v * N as f64) as usize).min(N - 1);
        index(y) * N + index(x)
    }

    /// The counts of all points.
    pub(crate) fn of(points: impl Iterator<Item = [f64; 2]>) -> Self {
        let mut grid = Self::new();
        for p in points {
            grid.0[Self::cell(p)] += 1;
        }
        grid
    }
}

/// Asserts that the points are uniform on the unit square.
pub(crate) fn assert_uniform(points: impl Iterator<Item = [f64; 2]>, what: &str) {
    let grid = Grid::<16>::of(points);
    assert_follows(&grid.0, &[1.0; 256], what);
}

/// The angle of (x, y) as a fraction of a turn.
pub(crate) fn turn(x: f64, y: f64) -> f64 {
    y.atan2(x) / TAU + 0.5
}

/// 1 - cos of the angle to z, also where the cosine rounds to 1.
pub(crate) fn height(d: DVec3) -> f64 {
    if d.z > 0.0 {
        warp::one_minus_cos(d.x.hypot(d.y))
    } else {
        1.0 - d.z
    }
}

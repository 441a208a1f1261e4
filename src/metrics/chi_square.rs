//! Pearson's chi-square test of counts against expected counts.

use super::gamma::upper_gamma;

/// The outcome of a chi-square test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    /// Sum over the cells of (observed - expected)^2 / expected.
    pub statistic: f64,
    /// Degrees of freedom: cells after pooling, less one.
    pub degrees: u32,
    /// Probability of a statistic at least this large if the expected counts
    /// are right.
    pub p_value: f64,
}

/// Tests whether `observed` counts follow `expected` counts. The expected
/// counts are scaled by the caller, so that their sum is the number of draws.
///
/// The statistic follows its law only where counts are not tiny, so cells that
/// expect fewer than `min_expected` (5 is the custom) are pooled, the smallest
/// first; if the pool stays below `min_expected`, the smallest other cell joins
/// it. A draw in a cell that expects exactly nothing is a plain contradiction:
/// the statistic is then infinite and the p-value 0.
///
/// `None` if fewer than two cells remain: there is nothing to test.
///
/// # Panics
/// If the lists differ in length or an expected count is negative or not
/// finite.
pub fn chi_square(observed: &[u64], expected: &[f64], min_expected: f64) -> Option<ChiSquare> {
    assert_eq!(observed.len(), expected.len(), "one expectation per cell");
    assert!(
        expected.iter().all(|e| e.is_finite() && *e >= 0.0),
        "expected counts are finite and not negative"
    );
    let mut cells: Vec<(f64, f64)> = observed
        .iter()
        .zip(expected)
        .map(|(&o, &e)| (o as f64, e))
        .collect();
    let impossible = cells.iter().any(|&(o, e)| e == 0.0 && o > 0.0);
    cells.retain(|&(_, e)| e > 0.0);
    let cells = pool(cells, min_expected);
    if impossible {
        return Some(ChiSquare {
            statistic: f64::INFINITY,
            degrees: cells.len().saturating_sub(1) as u32,
            p_value: 0.0,
        });
    }
    if cells.len() < 2 {
        return None;
    }
    let degrees = (cells.len() - 1) as u32;
    let statistic = cells.iter().map(|(o, e)| (o - e) * (o - e) / e).sum();
    Some(ChiSquare {
        statistic,
        degrees,
        p_value: upper_gamma(0.5 * f64::from(degrees), 0.5 * statistic),
    })
}

/// The significance level of each of `tests` independent tests for which the
/// chance of any false alarm among them is `alpha`: 1 - (1 - alpha)^(1/tests)
/// (Sidak 1967), in a form that keeps its digits for small `alpha`.
///
/// # Panics
/// If `tests` is 0.
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    assert!(tests > 0, "a correction needs at least one test");
    -libm::expm1(libm::log1p(-alpha) / tests as f64)
}

/// Joins the cells that expect less than `least` into one.
fn pool(mut cells: Vec<(f64, f64)>, least: f64) -> Vec<(f64, f64)> {
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    let small = cells.partition_point(|&(_, e)| e < least);
    if small == 0 {
        return cells;
    }
    let mut kept = cells.split_off(small);
    let sum = |(o, e): (f64, f64), &(p, f): &(f64, f64)| (o + p, e + f);
    let mut pooled = cells.iter().fold((0.0, 0.0), sum);
    if pooled.1 < least && !kept.is_empty() {
        let smallest = kept.remove(0);
        pooled = sum(pooled, &smallest);
    }
    kept.push(pooled);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper 5 % and 1 % points of the chi-square law, as tabulated with three
    /// decimals: the p-values must be that probability to the table's accuracy.
    #[test]
    fn tabulated_quantiles() {
        for (degrees, five, one) in [
            (1u32, 3.841, 6.635),
            (2, 5.991, 9.210),
            (5, 11.070, 15.086),
            (10, 18.307, 23.209),
            (30, 43.773, 50.892),
            (100, 124.342, 135.807),
        ] {
            let p = |x: f64| upper_gamma(0.5 * f64::from(degrees), 0.5 * x);
            assert!((p(five) - 0.05).abs() < 2e-5, "{degrees}: {}", p(five));
            assert!((p(one) - 0.01).abs() < 4e-6, "{degrees}: {}", p(one));
        }
    }

    /// A die thrown 60 times: 5 8 9 8 10 20 against 10 each.
    #[test]
    fn a_loaded_die() {
        let test = chi_square(&[5, 8, 9, 8, 10, 20], &[10.0; 6], 5.0).unwrap();
        assert_eq!(test.degrees, 5);
        assert!((test.statistic - 13.4).abs() < 1e-14);
        assert!((test.p_value - 0.019905).abs() < 1e-6, "{}", test.p_value);
    }

    #[test]
    fn small_cells_are_pooled() {
        // 1 + 2 + 3 expected make one cell of 6 with 9 observed.
        let test = chi_square(&[4, 3, 2, 10, 11], &[1.0, 2.0, 3.0, 12.0, 12.0], 5.0).unwrap();
        assert_eq!(test.degrees, 2);
        let expected = 9.0 / 6.0 + 4.0 / 12.0 + 1.0 / 12.0;
        assert!((test.statistic - expected).abs() < 1e-14);
        // A pool that stays too small takes the smallest other cell along.
        let test = chi_square(&[1, 10, 11, 12], &[1.0, 8.0, 12.0, 13.0], 5.0).unwrap();
        assert_eq!(test.degrees, 2);
        let expected = 4.0 / 9.0 + 1.0 / 12.0 + 1.0 / 13.0;
        assert!((test.statistic - expected).abs() < 1e-14);
    }

    #[test]
    fn what_cannot_be_is_refused_outright() {
        let test = chi_square(&[1, 9, 10], &[0.0, 10.0, 10.0], 5.0).unwrap();
        assert_eq!(test.p_value, 0.0);
        assert!(chi_square(&[0, 20], &[0.0, 20.0], 5.0).is_none());
        assert!(chi_square(&[2, 2], &[2.0, 2.0], 5.0).is_none());
    }

    #[test]
    fn sidak_keeps_the_joint_level() {
        assert_eq!(sidak(0.05, 1), 0.05);
        assert!((sidak(0.05, 10) - 0.005_116_196_891_823_743).abs() < 1e-15);
        let tiny = sidak(1e-15, 1000);
        assert!((tiny - 1e-18).abs() < 1e-30, "{tiny:e}");
    }
}

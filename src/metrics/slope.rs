//! Rates of convergence: a straight line through points on log-log paper.

/// A fitted power law y = e^intercept x^slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// The exponent.
    pub slope: f64,
    /// Natural logarithm of the value at x = 1.
    pub intercept: f64,
    /// Standard error of the exponent, from the scatter about the line with
    /// n - 2 degrees of freedom.
    pub standard_error: f64,
}

/// Least squares fit of ln y over ln x. `None` with fewer than three points,
/// with fewer than two different abscissae, or if a value is not a finite
/// number above zero.
///
/// # Panics
/// If `xs` and `ys` differ in length.
pub fn fit_slope(xs: &[f64], ys: &[f64]) -> Option<Slope> {
    assert_eq!(xs.len(), ys.len(), "each x needs its y");
    let n = xs.len();
    let usable = |v: &f64| v.is_finite() && *v > 0.0;
    if n < 3 || !xs.iter().all(usable) || !ys.iter().all(usable) {
        return None;
    }
    let us: Vec<f64> = xs.iter().map(|&x| libm::log(x)).collect();
    let vs: Vec<f64> = ys.iter().map(|&y| libm::log(y)).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n as f64;
    let (u_mean, v_mean) = (mean(&us), mean(&vs));
    let points = || us.iter().zip(&vs).map(|(u, v)| (u - u_mean, v - v_mean));
    let uu: f64 = points().map(|(u, _)| u * u).sum();
    if xs.iter().all(|&x| x == xs[0]) || uu == 0.0 {
        return None;
    }
    let slope = points().map(|(u, v)| u * v).sum::<f64>() / uu;
    let scatter: f64 = points()
        .map(|(u, v)| (v - slope * u) * (v - slope * u))
        .sum();
    Some(Slope {
        slope,
        intercept: v_mean - slope * u_mean,
        standard_error: (scatter / (n - 2) as f64 / uu).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_exactly() {
        let xs = [1.0, 2.0, 4.0, 8.0, 64.0];
        let ys = xs.map(|x: f64| 3.0 * x.powi(-2));
        let fit = fit_slope(&xs, &ys).unwrap();
        assert!((fit.slope + 2.0).abs() < 1e-14);
        assert!((fit.intercept - 3.0f64.ln()).abs() < 1e-14);
        assert!(fit.standard_error < 1e-14);
    }

    /// ln x = 0, 1, 2 and ln y = 0, 1, 0: slope 0; the residuals are -1/3, 2/3,
    /// -1/3, their squares sum to 2/3, one degree of freedom, sum of squared
    /// abscissae 2: standard error sqrt(1/3).
    #[test]
    fn scatter_gives_the_standard_error() {
        let e = std::f64::consts::E;
        let fit = fit_slope(&[1.0, e, e * e], &[1.0, e, 1.0]).unwrap();
        assert!(fit.slope.abs() < 1e-15);
        assert!((fit.intercept - 1.0 / 3.0).abs() < 1e-15);
        assert!((fit.standard_error - (1.0f64 / 3.0).sqrt()).abs() < 1e-14);
    }

    #[test]
    fn what_cannot_be_fitted_is_none() {
        assert!(fit_slope(&[1.0, 2.0], &[1.0, 2.0]).is_none());
        assert!(fit_slope(&[2.0; 4], &[1.0, 2.0, 3.0, 4.0]).is_none());
        assert!(fit_slope(&[1.0, 2.0, 3.0], &[1.0, 0.0, 2.0]).is_none());
        assert!(fit_slope(&[1.0, 2.0, f64::NAN], &[1.0, 1.0, 2.0]).is_none());
    }
}

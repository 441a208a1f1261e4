//! Student's t distribution: how sure a mean of few values is.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use crate::numeric::trig::{sin_cos, tan};

/// The t for which a variable of Student's distribution with `freedom`
/// degrees of freedom lies in -t..=t with probability `confidence`.
///
/// From the finite series for whole degrees of freedom (M. Abramowitz, I.
/// Stegun, *Handbook of Mathematical Functions*, 26.7.3 and 26.7.4), solved by
/// bisection for the angle atan(t / freedom^(1/2)).
///
/// # Panics
/// If there is no degree of freedom, or `confidence` is not between 0 and 1.
pub fn student_quantile(confidence: f64, freedom: u32) -> f64 {
    assert!(freedom > 0, "no degree of freedom");
    assert!(
        confidence > 0.0 && confidence < 1.0,
        "a confidence of {confidence}"
    );
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return tan(low) * f64::from(freedom).sqrt();
        }
        if within(middle, freedom) < confidence {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// The probability of values up to tan(`angle`) `freedom`^(1/2) either side.
fn within(angle: f64, freedom: u32) -> f64 {
    let (sine, cosine) = sin_cos(angle);
    let odd = freedom % 2 == 1;
    // The term of the series with the power `k` of the cosine has the factor
    // (k - 1) / k more than the one with k - 2, in both series.
    let (mut power, mut term) = if odd { (1, cosine) } else { (0, 1.0) };
    let mut sum = 0.0;
    while power + 2 <= freedom {
        sum += term;
        power += 2;
        let k = f64::from(power);
        term *= cosine * cosine * (k - 1.0) / k;
    }
    if odd {
        FRAC_2_PI * (angle + sine * sum)
    } else {
        sine * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Percentage points of the printed tables, to their three digits.
    #[test]
    fn the_printed_tables() {
        for (confidence, freedom, expected) in [
            (0.90, 1, 6.314),
            (0.90, 2, 2.920),
            (0.90, 3, 2.353),
            (0.90, 4, 2.132),
            (0.90, 7, 1.895),
            (0.90, 30, 1.697),
            (0.95, 5, 2.571),
            (0.95, 10, 2.228),
            (0.99, 8, 3.355),
            (0.99, 9, 3.250),
        ] {
            let t = student_quantile(confidence, freedom);
            assert!((t - expected).abs() < 6e-4, "{confidence}, {freedom}: {t}");
        }
    }

    /// One degree of freedom is Cauchy's distribution, two have a closed form,
    /// and many are the normal distribution.
    #[test]
    fn closed_forms() {
        for confidence in [0.1, 0.5, 0.9, 0.999] {
            let cauchy = (FRAC_PI_2 * confidence).tan();
            assert!((student_quantile(confidence, 1) / cauchy - 1.0).abs() < 1e-12);
            let two = confidence * (2.0 / (1.0 - confidence * confidence)).sqrt();
            assert!((student_quantile(confidence, 2) / two - 1.0).abs() < 1e-12);
        }
        assert!((student_quantile(0.95, 100_000) - 1.959_96).abs() < 1e-4);
    }
}

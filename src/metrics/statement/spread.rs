//! How errors are spread over pixels that each know their variance.

use std::f64::consts::FRAC_1_SQRT_2;

/// Steps of an octave into which variances are sorted.
const STEPS: f64 = 16.0;
/// Halvings between which a quantile is sought: to a part in 2^40.
const HALVINGS: u32 = 60;

/// Normal errors of many variances at once.
pub(super) struct Spread {
    /// Roots of the variances, and how many pixels have each.
    classes: Vec<(f64, f64)>,
    pixels: f64,
}

impl Spread {
    /// Pixels of these variances.
    pub(super) fn of(variances: impl Iterator<Item = f64>) -> Self {
        let mut exponents: Vec<i32> = variances
            // `as` saturates: what is zero comes to the very first class.
            .map(|v| (STEPS * libm::log2(v)).round() as i32)
            .collect();
        exponents.sort_unstable();
        let pixels = exponents.len() as f64;
        let classes = exponents.chunk_by(|a, b| a == b).map(|class| {
            let root = libm::exp2(0.5 * f64::from(class[0]) / STEPS);
            (root, class.len() as f64)
        });
        Self {
            classes: classes.collect(),
            pixels,
        }
    }

    /// The part of the pixels whose errors exceed `error`, in the mean.
    pub(super) fn beyond(&self, error: f64) -> f64 {
        let beyond = |&(root, count): &(f64, f64)| {
            if root > 0.0 {
                count * libm::erfc(error / root * FRAC_1_SQRT_2)
            } else {
                0.0
            }
        };
        self.classes.iter().map(beyond).sum::<f64>() / self.pixels
    }

    /// The error that this part of the pixels does not exceed.
    pub(super) fn quantile(&self, part: f64) -> f64 {
        let largest = self.classes.last().map_or(0.0, |c| c.0);
        let (mut low, mut high) = (0.0, 40.0 * largest);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.beyond(middle) > 1.0 - part {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_the_normal_distribution() {
        let spread = Spread::of(std::iter::repeat_n(4.0, 50));
        for (part, expected) in [(0.95, 1.959_964), (0.99, 2.575_829)] {
            let found = spread.quantile(part);
            assert!((found / (2.0 * expected) - 1.0).abs() < 1e-6, "{found}");
            assert!((spread.beyond(found) - (1.0 - part)).abs() < 1e-9);
        }
        // A tenth of noisy pixels among exact ones: half of the worst 5 % ...
        let mixed = Spread::of((0..100).map(|i| if i < 10 { 1.0 } else { 0.0 }));
        assert!(
            (mixed.quantile(0.95) - 0.674_49).abs() < 1e-4,
            "median of |z|"
        );
        assert_eq!(mixed.quantile(0.8), 40.0 * 0.5f64.powi(60));
    }
}

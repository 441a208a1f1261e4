//! How errors are spread over pixels that each know their variance.

use std::f64::consts::FRAC_1_SQRT_2;

/// Steps of an octave into which variances are sorted.
const STEPS: f64 = 16.0;
/// No finite variance is more octaves above or below one.
const OCTAVES: f64 = 1100.0;
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
        let (mut none, mut exponents) = (0, Vec::new());
        for variance in variances {
            if variance > 0.0 {
                let octaves = libm::log2(variance).min(OCTAVES);
                exponents.push((STEPS * octaves).round() as i32);
            } else {
                none += 1;
            }
        }
        // There are few: to count them is faster than to sort.
        let least = exponents.iter().copied().min().unwrap_or(0);
        let most = exponents.iter().copied().max().unwrap_or(0);
        let mut counts = vec![0u32; (most - least) as usize + 1];
        for exponent in &exponents {
            counts[(exponent - least) as usize] += 1;
        }
        let counted = counts.iter().zip(least..).filter(|(count, _)| **count > 0);
        let classes = counted.map(|(&count, exponent)| {
            let root = libm::exp2(0.5 * f64::from(exponent) / STEPS);
            (root, f64::from(count))
        });
        Self {
            pixels: (none + exponents.len()) as f64,
            classes: std::iter::once((0.0, none as f64)).chain(classes).collect(),
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

    /// Errors that no float holds, or none at all, ask for no more memory than others.
    #[test]
    fn any_variance_is_counted() {
        let variances = [f64::INFINITY, f64::MAX, 5e-324, 0.0, f64::NAN];
        let spread = Spread::of(variances.into_iter());
        assert_eq!(spread.pixels, 5.0);
        assert_eq!(spread.classes.len(), 4);
        assert_eq!(Spread::of(std::iter::empty()).pixels, 0.0);
    }
}

//! More camera samples where a pass is noisy.
//!
//! Most of a picture's error sits in few pixels: penumbras, silhouettes, dark
//! places next to bright ones. After the first sample of every pixel a pass
//! looks at the spread among a pixel's *neighbours*, and takes more samples of
//! the pixel where they differ much. The pixel's own sample has no say in how
//! many follow, so the mean of all of them is unbiased; and since the pixels'
//! random numbers are independent, nothing is learned that a pass would have to
//! remember.

use super::share::trimmed_by;

/// Pixels to each side that count as neighbours.
pub(super) const REACH: u32 = 2;

/// Numbers of further samples: powers of two, so that those of a round and of
/// later ones with the same number are whole nets.
const LEVELS: [u32; 6] = [1, 2, 4, 8, 16, 32];

/// Error that photons leave, over their noise: kernels are drawn in so fast that
/// blur adds half as much.
const WITH_BLUR: f64 = 1.5;

/// Least and most of the error of one sample a pixel that counts as the photons'
/// part, which more samples leave. More samples were seen to mend less than their
/// number says: with less than a tenth `hall_of_mirrors` and `solids` took up to
/// twice the time for the same error. And bright spots of a few pixels, which a
/// pilot misses, want samples whatever it found elsewhere: with a half `cup` and
/// `glass_sphere` got fewer than served them.
const LEFT: [f64; 2] = [0.1, 0.25];

/// Factor on error times work that a step towards more samples has to bring.
const WORTH: f64 = 0.97;

/// Part of the places, those with the largest variance, that is left out: little,
/// since a variance among 25 pixels relative to their mean is at most 25.
const OUTLIERS: f64 = 0.002;

/// With fewer neighbours nothing is known of their spread.
const FEWEST: usize = 5;

/// How a pass spends its further samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refinement {
    /// Where a pixel is dark, its error counts relative to this squared
    /// radiance: a hundredth of that of the picture's mean.
    floor: f64,
    /// Relative variance at which one sample is enough.
    enough: f64,
}

impl Refinement {
    /// For a picture of mean radiance `mean` and the relative variances of
    /// some of its pixels, of which a pass's photons alone leave `photons`,
    /// where a pass costs `overhead` camera samples a pixel beside its samples.
    pub(super) fn new(mean: f64, variances: &[f64], photons: f64, overhead: f64) -> Self {
        Self {
            floor: floor(mean),
            enough: threshold(variances, photons, overhead),
        }
    }

    /// No further samples anywhere.
    pub(super) fn none() -> Self {
        Self {
            floor: 0.0,
            enough: f64::INFINITY,
        }
    }

    /// How many further samples a pixel with such neighbours gets.
    pub(super) fn further(&self, neighbours: &[f64]) -> u32 {
        further(self.variance(neighbours), self.enough)
    }

    /// Variance of the neighbours' radiances relative to their mean.
    pub(super) fn variance(&self, neighbours: &[f64]) -> f64 {
        variance(neighbours, self.floor)
    }
}

/// Squared radiance relative to which dark pixels count in a picture of this mean.
pub(super) fn floor(mean: f64) -> f64 {
    0.01 * mean * mean
}

/// See [`Refinement::variance`]; 0 for too few neighbours or where all are
/// black.
pub(super) fn variance(neighbours: &[f64], floor: f64) -> f64 {
    if neighbours.len() < FEWEST {
        return 0.0;
    }
    let n = neighbours.len() as f64;
    let mean = neighbours.iter().sum::<f64>() / n;
    let sum: f64 = neighbours.iter().map(|x| (x - mean) * (x - mean)).sum();
    let relative = sum / (n - 1.0) / (mean * mean + floor);
    if relative.is_finite() { relative } else { 0.0 }
}

/// With `1 + n` samples a pixel of variance `v` adds `v / (1 + n)` to the
/// error; for a given amount of work the sum is least where `v / (1 + n)^2` is
/// the same for all.
fn further(variance: f64, enough: f64) -> u32 {
    let wanted = (variance / enough).sqrt() - 1.0;
    LEVELS
        .into_iter()
        .rfind(|&n| f64::from(n) <= wanted)
        .unwrap_or(0)
}

/// The variance at which one sample is enough: of the powers of two, the one
/// with the least error times work of a pass.
fn threshold(variances: &[f64], photons: f64, overhead: f64) -> f64 {
    let mean = trimmed_by(OUTLIERS, variances.iter().copied());
    if mean.is_nan() || mean <= 0.0 {
        return f64::INFINITY;
    }
    let [least, most] = LEFT.map(|part| part * mean);
    let photons = (WITH_BLUR * photons).clamp(least, most);
    let product = |enough: f64| {
        let samples = |v: f64| 1.0 + f64::from(further(v, enough));
        let error = trimmed_by(OUTLIERS, variances.iter().map(|&v| v / samples(v)));
        let work = variances.iter().map(|&v| samples(v)).sum::<f64>() / variances.len() as f64;
        (photons + error) * (overhead + work)
    };
    let mut best = (f64::INFINITY, product(f64::INFINITY));
    for k in (-12..=6).rev() {
        let enough = mean * 2f64.powi(k);
        let found = product(enough);
        // More samples a pass must be worth it, so that passes stay short.
        if found < WORTH * best.1 {
            best = (enough, found);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_samples_grow_like_the_deviation() {
        for (variance, n) in [
            (0.0, 0),
            (1.0, 0),
            (3.9, 0),
            (4.0, 1),
            (9.0, 2),
            (25.0, 4),
            (289.0, 16),
            (1e9, 32),
        ] {
            assert_eq!(further(variance, 1.0), n, "{variance}");
        }
        assert_eq!(further(1e30, f64::INFINITY), 0);
        assert_eq!(further(0.0, 0.0), 0, "0 / 0 is no reason");
    }

    #[test]
    fn variance_is_relative_and_of_the_sample() {
        let relative = variance(&[1.0, 2.0, 3.0, 4.0, 5.0], 0.0);
        assert!((relative - 2.5 / 9.0).abs() < 1e-15);
        let scaled = variance(&[1e-9, 2e-9, 3e-9, 4e-9, 5e-9], 0.0);
        assert!((scaled - relative).abs() < 1e-12);
        assert_eq!(variance(&[1.0, 9.0, 1.0, 9.0], 0.0), 0.0, "too few to tell");
        assert_eq!(variance(&[0.0; 24], 0.0), 0.0, "black");
        assert_eq!(variance(&[1.0, 2.0, 3.0, 4.0, f64::INFINITY], 0.0), 0.0);
        assert!((variance(&[0.0, 0.0, 0.0, 0.0, 5.0], 4.0) - 1.0).abs() < 1e-15);
    }

    /// A few noisy pixels among many quiet ones get samples, and the product
    /// of error and work falls by much; even noise calls for none, unless the
    /// rest of a pass is dear.
    #[test]
    fn samples_go_where_they_pay() {
        let uneven: Vec<f64> = (0..1000)
            .map(|i| if i % 20 == 0 { 1.0 } else { 1e-3 })
            .collect();
        let enough = threshold(&uneven, 0.01, 1.0);
        assert_eq!(further(1e-3, enough), 0);
        assert!(further(1.0, enough) >= 8, "{enough}");
        let even = vec![0.5; 1000];
        assert_eq!(further(0.5, threshold(&even, 0.1, 0.0)), 0);
        assert!(further(0.5, threshold(&even, 0.1, 20.0)) >= 4);
        assert_eq!(threshold(&[0.0; 100], 0.0, 1.0), f64::INFINITY);
        assert_eq!(threshold(&[], 0.0, 1.0), f64::INFINITY);
    }

    /// What photons leave is not mended by samples: the more it is, the fewer
    /// follow. Less than a tenth of the error is not believed, nor more than a
    /// quarter.
    #[test]
    fn samples_give_way_to_photons() {
        let spread: Vec<f64> = (1..=1000).map(|i| f64::from(i) / 1000.0).collect();
        let enough =
            [0.0, 0.03, 0.06, 0.09, 1.0, f64::INFINITY].map(|p| threshold(&spread, p, 2.0));
        assert!(enough.is_sorted(), "{enough:?}");
        assert_eq!(enough[0], enough[1]);
        assert!(enough[1] < enough[3], "{enough:?}");
        assert_eq!(enough[3], enough[5]);
    }
}

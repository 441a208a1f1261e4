//! Noise, from the spread of the replicates.
//!
//! Eight replicates tell a pixel's variance with seven degrees of freedom:
//! only up to a factor of two or three, and not at all where light comes
//! rarely and none of them has met it. So it is moderated by the mean over
//! the 5 x 5 pixels around, which counts like eight further degrees of freedom
//! (G. Smyth, *Linear Models and Empirical Bayes Methods*, Stat. Appl. Genet.
//! Mol. Biol. 3(1), 2004): a variance of one's own, but none that is far below
//! what happens next door. Variances are pooled relative to the picture's
//! squared brightness, so that a pixel in a shadow does not get the noise of
//! the light beside it.

use rayon::prelude::*;

use crate::{
    film::{Film, Image, REPLICATES},
    spectrum::Rgb,
};

use super::{Ground, box_kernel, convolve, relative};
use crate::metrics::{plane::Plane, student_quantile};

/// Degrees of freedom of a pixel's own variance.
const OWN: f64 = (REPLICATES - 1) as f64;
/// Degrees of freedom as which the pixels around count.
const AROUND: f64 = 8.0;
/// How far the pixels around reach, to either side.
const REACH: usize = 2;

/// What Student's t with 7 + 8 degrees of freedom exceeds, to either side, with
/// a probability of 0.1.
pub(super) fn two_sided() -> f64 {
    student_quantile(0.9, (OWN + AROUND) as u32)
}

/// What Student's t with 7 degrees of freedom exceeds with a probability of
/// 0.1.
pub(super) fn one_sided() -> f64 {
    student_quantile(0.8, OWN as u32)
}

/// Variances of the picture, relative to its squared brightness.
pub(super) struct Noise {
    /// As each pixel knows it alone: without bias.
    pub(super) own: Plane,
    /// Moderated by the pixels around.
    pub(super) pooled: Plane,
    /// Squared deviations of each replicate from their mean.
    pub(super) deviations: Vec<[f64; REPLICATES]>,
}

impl Noise {
    pub(super) fn of(film: &Film, ground: &Ground) -> Self {
        let own = ground.plane(|i| relative(film.variance_at(i), ground.squares[i]));
        let around = convolve(&own, &box_kernel(REACH), &box_kernel(REACH));
        let pooled = Plane::join(&own, &around, |own, around| {
            (OWN * own + AROUND * around) / (OWN + AROUND)
        });
        let deviations = (0..ground.squares.len()).into_par_iter().map(|i| {
            let replicates = film.replicates_at(i);
            let sum = replicates.iter().fold(Rgb::BLACK, |sum, &r| sum + r);
            let mean = sum / REPLICATES as f64;
            replicates.map(|r| relative((r - mean) * (r - mean), ground.squares[i]))
        });
        Self {
            deviations: deviations.collect(),
            own,
            pooled,
        }
    }

    /// The standard error of every pixel and channel, moderated.
    pub(super) fn image(&self, film: &Film, ground: &Ground) -> Image {
        let pixels = self.own.values().iter().zip(self.pooled.values());
        let pixels = pixels.enumerate().map(|(i, (own, pooled))| {
            let around = (pooled - OWN / (OWN + AROUND) * own).max(0.0);
            let variance =
                film.variance_at(i) * (OWN / (OWN + AROUND)) + ground.squares[i] * around;
            variance.map(f64::sqrt)
        });
        Image::new(film.width(), film.height(), pixels.collect())
    }
}

/// The mean of the replicates without the smallest and the largest of each
/// channel.
pub(super) fn without_extremes(replicates: &[Rgb; REPLICATES]) -> Rgb {
    Rgb([0, 1, 2].map(|c| {
        let values = replicates.map(|r| r[c]);
        let (mut low, mut high, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for v in values {
            low = low.min(v);
            high = high.max(v);
            sum += v;
        }
        // Rounding must not leave less than nothing.
        ((sum - low - high) / (REPLICATES - 2) as f64).max(0.0)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_left_out() {
        let mut replicates: [Rgb; REPLICATES] = std::array::from_fn(|_| Rgb::grey(2.0));
        assert_eq!(without_extremes(&replicates), Rgb::grey(2.0));
        replicates[3] = Rgb::new(1e6, 0.0, 2.0);
        assert_eq!(without_extremes(&replicates), Rgb::grey(2.0));
        assert_eq!(without_extremes(&[Rgb::BLACK; REPLICATES]), Rgb::BLACK);
    }
}

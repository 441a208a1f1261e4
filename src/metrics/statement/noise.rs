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

use super::{Ground, box_kernel, coarse, convolve, present, relative};
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

/// What Student's t of so many values exceeds with a probability of 0.1.
pub(super) fn one_sided(values: usize) -> f64 {
    student_quantile(0.8, values.max(2) as u32 - 1)
}

/// Variances of the picture, relative to its squared brightness.
pub(super) struct Noise {
    /// As each pixel knows it alone: without bias.
    pub(super) own: Plane,
    /// Moderated by the pixels around.
    pub(super) pooled: Plane,
    /// Squared deviations of each replicate from their mean; zero for those
    /// without passes.
    pub(super) deviations: Vec<[f64; REPLICATES]>,
    /// The replicates that have passes.
    pub(super) present: Vec<usize>,
}

impl Noise {
    pub(super) fn of(film: &Film, ground: &Ground) -> Self {
        let apart = ground.deviations.par_iter().zip(&ground.squares);
        let squares = |(of, squares): (&Deviations, &Rgb)| {
            of.map(|d| {
                let d = Rgb(d.map(f64::from)) * ground.unit;
                relative(d * d, *squares)
            })
        };
        let deviations = apart.map(squares).collect();
        let own = ground.plane(|i| relative(ground.variances[i], ground.squares[i]));
        let around = convolve(&own, &box_kernel(REACH), &box_kernel(REACH));
        let pooled = Plane::join(&own, &around, |own, around| {
            (OWN * own + AROUND * around) / (OWN + AROUND)
        });
        Self {
            own,
            pooled,
            deviations,
            present: present(film),
        }
    }

    /// The standard error of every pixel and channel, moderated.
    pub(super) fn image(&self, ground: &Ground) -> Image {
        let pixels = self.own.values().iter().zip(self.pooled.values());
        let pixels = pixels.enumerate().map(|(i, (own, pooled))| {
            let around = (pooled - OWN / (OWN + AROUND) * own).max(0.0);
            let variance =
                ground.variances[i] * (OWN / (OWN + AROUND)) + ground.squares[i] * around;
            variance.map(|v| coarse(v.sqrt()))
        });
        Image::new(ground.width as u32, ground.height as u32, pixels.collect())
    }
}

/// How far each replicate is from the mean over those that have passes, in each
/// channel, in some unit; zero for those without.
pub(super) type Deviations = [[f32; 3]; REPLICATES];

/// The same of one pixel, in units of so many W/m2/sr.
pub(super) fn deviations(
    replicates: &[Rgb; REPLICATES],
    present: &[usize],
    unit: f64,
) -> Deviations {
    let sum = present
        .iter()
        .fold(Rgb::BLACK, |sum, &r| sum + replicates[r]);
    let mean = sum / present.len() as f64;
    let mut deviations = Deviations::default();
    for &r in present {
        deviations[r] = ((replicates[r] - mean) / unit).0.map(|d| d as f32);
    }
    deviations
}

/// The mean of those replicates that are present, without the smallest and
/// the largest of each channel.
pub(super) fn without_extremes(replicates: &[Rgb; REPLICATES], present: &[usize]) -> Rgb {
    let kept = present.len().saturating_sub(2).max(1);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut sum = [0.0; 3];
    for &r in present {
        for (c, v) in replicates[r].0.into_iter().enumerate() {
            // Films hold nothing but numbers, so one comparison does.
            low[c] = if v < low[c] { v } else { low[c] };
            high[c] = if v > high[c] { v } else { high[c] };
            sum[c] += v;
        }
    }
    // Rounding must not leave less than nothing.
    Rgb([0, 1, 2].map(|c| ((sum[c] - low[c] - high[c]) / kept as f64).max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_left_out() {
        let all: Vec<usize> = (0..REPLICATES).collect();
        let mut replicates: [Rgb; REPLICATES] = std::array::from_fn(|_| Rgb::grey(2.0));
        assert_eq!(without_extremes(&replicates, &all), Rgb::grey(2.0));
        replicates[3] = Rgb::new(1e6, 0.0, 2.0);
        assert_eq!(without_extremes(&replicates, &all), Rgb::grey(2.0));
        assert_eq!(
            without_extremes(&[Rgb::BLACK; REPLICATES], &all),
            Rgb::BLACK
        );
        // Those without passes are black, which is no estimate.
        replicates[5] = Rgb::BLACK;
        let some = [0, 1, 2, 3, 4];
        assert_eq!(without_extremes(&replicates, &some), Rgb::grey(2.0));
    }
}

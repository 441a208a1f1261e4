//! The error of a region, in figures.

use serde::Serialize;

use crate::film::REPLICATES;

use super::{
    blur::{Blur, block_sums},
    noise::{Noise, one_sided},
    spread::Spread,
};
use crate::metrics::plane::Plane;

/// Part of the pixels that may be worse than all that is said: single sparks
/// rule a mean of squares, and how bright the brightest are no sample tells.
const WORST: f64 = 0.001;

/// A normal deviate exceeds this with a probability of 0.1.
const NORMAL: f64 = 1.281_551_565_544_600_4;

/// The error of the lit pixels of a region; all numbers but `pixels` relative,
/// 0.05 for 5 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// How many pixels are lit.
    pub pixels: usize,
    /// Root of the relMSE without the worst 0.1 % of the pixels, as expected.
    pub error: f64,
    /// The same at 90 %: what `--error` holds against its target.
    pub bound: f64,
    /// The part of `error` that is noise.
    pub noise: f64,
    /// The same at 90 %.
    pub noise_bound: f64,
    /// The part of `error` that is bias.
    pub bias: f64,
    /// The same at 90 %.
    pub bias_bound: f64,
    /// How fast the bias falls: with this power of the kernels' scale, by the
    /// whole picture.
    pub bias_order: f64,
    /// Root of the relMSE of all pixels, as expected.
    pub error_of_all: f64,
    /// The same at 90 %.
    pub bound_of_all: f64,
    /// 95 % of the pixels have no larger error.
    pub percentile_95: f64,
    /// 99 % of the pixels have no larger error.
    pub percentile_99: f64,
    /// Part of the pixels whose error is expected to exceed the target, if
    /// there is one.
    pub outside: Option<f64>,
}

/// Standard deviation, relative to squared errors, of what is stated beyond what
/// the sums of a picture tell: measured over scenes whose truth is known.
const MODEL: f64 = 0.2;

/// A mean square, and what it is at most at 90 %.
struct Square {
    noise: f64,
    bias: f64,
    /// What noise, what bias, and what both may be more by what the model
    /// leaves out.
    more: [f64; 3],
}

impl Figures {
    /// The figures of a `region`; `None` where it has no pixels. `total` holds
    /// the squared errors of the pixels, pooled.
    pub(super) fn of(
        (noise, blur, total): (&Noise, &Blur, &Plane),
        region: &[bool],
        target: Option<f64>,
    ) -> Option<Self> {
        let expected = |i: &usize| noise.own.values()[*i] + blur.pooled.values()[*i];
        let mut all: Vec<usize> = (0..region.len()).filter(|&i| region[i]).collect();
        if all.is_empty() {
            return None;
        }
        let of_all = Square::of(noise, blur, &all);
        let spread = Spread::of(all.iter().map(|&i| total.values()[i]));
        let pixels = all.len();
        // Rounded down, as `relmse_trimmed` has it; at least one stays.
        let kept = ((pixels as f64 * (1.0 - WORST)) as usize).max(1);
        if kept < pixels {
            let worse = |a: &usize, b: &usize| expected(a).total_cmp(&expected(b)).then(a.cmp(b));
            all.select_nth_unstable_by(kept, worse);
            all.truncate(kept);
        }
        let kept = Square::of(noise, blur, &all);
        Some(Self {
            pixels,
            error: (kept.noise + kept.bias).sqrt(),
            bound: kept.bound().sqrt(),
            noise: kept.noise.sqrt(),
            noise_bound: (kept.noise + kept.more[0]).sqrt(),
            bias: kept.bias.sqrt(),
            bias_bound: (kept.bias + kept.more[1]).sqrt(),
            bias_order: blur.order,
            error_of_all: (of_all.noise + of_all.bias).sqrt(),
            bound_of_all: of_all.bound().sqrt(),
            percentile_95: spread.quantile(0.95),
            percentile_99: spread.quantile(0.99),
            outside: target.map(|target| spread.beyond(target)),
        })
    }
}

impl Square {
    /// Means over these pixels. What noise this picture has in all differs from
    /// the mean over pictures as much as the squared deviations of the
    /// replicates differ from each other: that bound holds whatever
    /// correlates the noise of neighbours, and for rare sparks.
    fn of(noise: &Noise, blur: &Blur, pixels: &[usize]) -> Self {
        let count = pixels.len() as f64;
        let mut deviations = [0.0; REPLICATES];
        let (mut bias, mut sum) = (blur.own.zeros(), 0.0);
        for &i in pixels {
            sum += noise.own.values()[i];
            for (sum, deviation) in deviations.iter_mut().zip(noise.deviations[i]) {
                *sum += deviation;
            }
            bias.values_mut()[i] = blur.own.values()[i];
        }
        let variance = sum / count;
        let deviations: Vec<f64> = noise.present.iter().map(|&r| deviations[r]).collect();
        let scatter = coefficient_of_variation(&deviations);
        let replicates = deviations.len();
        // The deviation of one more, of which these tell mean and spread.
        let more = 1.0 + 1.0 / replicates as f64;
        let noise_more = variance * one_sided(replicates) * scatter * more.sqrt();
        let blocks = block_sums(&bias);
        let sum: f64 = blocks.iter().sum();
        let bias = (sum / count).max(0.0);
        let by_blocks = blocks.iter().map(|b| b * b).sum::<f64>().sqrt() / count;
        let by_ratio = blur.doubt * bias;
        let bias_more = NORMAL * (by_blocks * by_blocks + by_ratio * by_ratio).sqrt();
        Self {
            noise: variance,
            bias,
            more: [noise_more, bias_more, NORMAL * MODEL * (variance + bias)],
        }
    }

    /// What the sum is at most at 90 %.
    fn bound(&self) -> f64 {
        let squares: f64 = self.more.iter().map(|m| m * m).sum();
        self.noise + self.bias + squares.sqrt()
    }
}

/// Standard deviation over mean; zero where all is.
fn coefficient_of_variation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    if mean > 0.0 {
        (squares / (count - 1.0)).sqrt() / mean
    } else {
        0.0
    }
}

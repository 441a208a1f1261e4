//! What the number of sheets tells of chance.
//!
//! Light that leaves a source (a point of it, for a sun one of its directions)
//! and takes the same specular steps falls on a receiver as a *sheet*, which folds
//! at caustics: one or several layers of it, and always whole ones, lie over a
//! point. Photons that stand for patches of the receiver tell of both at once, of
//! its light and of the sheets over it, with the same chance: where too many of
//! their kernels overlap, there is too much light by as much as there are too many
//! sheets. But of the sheets it is known that they are whole. Where their mean over
//! all passes is a whole number within its error, the light is corrected by what
//! the difference explains: a control variate (J. M. Hammersley and
//! D. C. Handscomb, *Monte Carlo Methods*, 1964, section 5.5) whose mean need not
//! be known in advance, only recognised.
//!
//! At folds and rims of light and in the half-shadow of a lamp the mean number is
//! none that is whole, and nothing is corrected. How likely a number is to be a whole
//! one, Bayes' rule says: chance makes a deviation of so many standard errors with
//! Student's density, and a fraction may be any. The correction counts by that
//! probability, which is the mean of what may be, and the doubt adds to the noise. The
//! 5 x 5 pixels around are asked, too, since a mean over them has less noise and
//! differs where a fold is near; the less likely of both answers counts. A fraction
//! that is too near to a whole number to be told from it is taken for it: the light is
//! then wrong by some standard errors at most, as gathered, and with more passes by
//! less.

use super::{
    PixelSample,
    accumulator::{Film, GROUPS, REPLICATES, group_of},
};
use crate::{film::Layer, spectrum::Rgb};

/// Fewest replicates from whose spread anything is told.
const FEWEST: usize = 4;

/// Largest standard error of a number of sheets that is taken for a whole one.
const SURE: f64 = 0.12;

/// How many places have a whole number, to each that has a fraction. So many where
/// eight replicates tell an error, less by the square of the degrees of freedom where
/// fewer do: errors that look too small by chance would count for too much.
const ODDS: f64 = 100.0;

/// What is less likely to be whole counts as a fraction.
const UNLIKELY: f64 = 0.01;

/// Student's density at 0: of 3 to 7 degrees of freedom it is 0.37 to 0.385.
const PEAK: f64 = 0.38;

/// How much of the light's relative deviation one of the sheets may explain.
const MOST: f64 = 1.5;

/// How many times the doubt about the slope counts against it.
const DOUBT: f64 = 2.0;

/// Squares are known to that part of those that are taken off.
const LEAST: f64 = 1e-9;

/// Sums are counted in 2^-32 of a sheet, so that their order leaves no trace.
const UNIT: f64 = 1.0 / (1u64 << 32) as f64;

/// Numbers above this are no counts of anything: some 2^21 passes with less fit
/// into a sum.
const LARGEST: f64 = 1024.0;

/// Sums over the passes of each replicate, of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sheets {
    /// Sheets in the pixel, and in those around.
    pub(super) sums: [[i64; REPLICATES]; 2],
    /// By how many sheets narrower kernels find fewer, of each group of replicates:
    /// weighted as those of the light are.
    pub(super) steps: [[i64; 2]; GROUPS],
    /// Passes that told nothing, all replicates together.
    pub(super) untold: u32,
}

impl Sheets {
    /// Adds what a pass of a replicate saw. Differences of kernels count `weight`
    /// times.
    pub(super) fn add(&mut self, replicate: usize, seen: &PixelSample, weight: f64) {
        let numbers = seen.sheets.map(|[sheets, weight]| sheets / weight);
        let steps = seen.sheet_steps.map(|step| step / seen.sheets[0][1]);
        // Not where nothing was looked at: 0 / 0 is no number.
        let known = numbers.iter().all(|n| (0.0..=LARGEST).contains(n))
            && steps.iter().all(|step| step.abs() <= LARGEST);
        if !known {
            self.untold = self.untold.saturating_add(1);
            return;
        }
        let add = |sum: &mut i64, number: f64| {
            *sum = sum.saturating_add((number / UNIT).round_ties_even() as i64);
        };
        for (sums, number) in self.sums.iter_mut().zip(numbers) {
            add(&mut sums[replicate], number);
        }
        for (sum, step) in self.steps[group_of(replicate)].iter_mut().zip(steps) {
            add(sum, weight * step);
        }
    }

    /// All sums, in the order of files.
    pub(super) fn counts(&self) -> impl Iterator<Item = i64> {
        let sums = self.sums.as_flattened().iter();
        sums.chain(self.steps.as_flattened()).copied()
    }

    /// The same, to change them.
    pub(super) fn counts_mut(&mut self) -> impl Iterator<Item = &mut i64> {
        let sums = self.sums.as_flattened_mut().iter_mut();
        sums.chain(self.steps.as_flattened_mut())
    }

    /// What narrower kernels find less of light by chance, summed over the passes of a
    /// group of replicates, if each sheet brings so much of it.
    pub(super) fn steps_by_chance(&self, group: usize, per_sheet: f64) -> [f64; 2] {
        self.steps[group].map(|sum| sum as f64 * UNIT * per_sheet)
    }

    /// Adds the sums of other passes.
    pub(super) fn merge(&mut self, other: &Self) {
        let theirs = other.counts();
        for (ours, theirs) in self.counts_mut().zip(theirs) {
            *ours = ours.saturating_add(theirs);
        }
        self.untold = self.untold.saturating_add(other.untold);
    }
}

/// Light that is there by chance, W/m2/sr: the picture is without it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Excess {
    /// In the picture.
    pub(super) mean: Rgb,
    /// In what each replicate sees.
    pub(super) replicates: [Rgb; REPLICATES],
    /// With each sheet: the mean over the channels.
    pub(super) per_sheet: f64,
    /// By what the standard error of the rest is larger than its spread says,
    /// since a slope was fitted to the same numbers, and may not have been meant.
    pub(super) widening: f64,
}

/// Means of the replicates, each with its number of passes as a weight.
struct Spread {
    deviations: [f64; REPLICATES],
    mean: f64,
    /// Weighted sum of the squared deviations.
    squares: f64,
    /// Standard error of the mean.
    error: f64,
}

impl Spread {
    fn of(values: [f64; REPLICATES], weights: &[f64; REPLICATES], used: usize) -> Self {
        let total: f64 = weights.iter().sum();
        let mean = values.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>() / total;
        let deviations = values.map(|v| v - mean);
        let squares = product(&deviations, &deviations, weights);
        Self {
            deviations,
            mean,
            squares,
            error: (squares / ((used - 1) as f64 * total)).sqrt(),
        }
    }

    /// How far the mean is from a number, in standard errors.
    fn off(&self, number: f64) -> f64 {
        (self.mean - number).abs() / self.error.max(f64::MIN_POSITIVE)
    }

    /// The probability that the mean of all passes that could be is that whole number,
    /// and not a fraction around it, of which each is as likely.
    fn likely(&self, whole: f64, freedom: f64) -> f64 {
        let t = self.off(whole);
        let by_chance = PEAK * libm::pow(1.0 + t * t / freedom, -0.5 * (freedom + 1.0));
        let known = freedom / (REPLICATES - 1) as f64;
        let odds = ODDS * known * known * by_chance / self.error.max(f64::MIN_POSITIVE);
        1.0 / (1.0 + 1.0 / odds)
    }
}

/// The weighted sum of products.
fn product(a: &[f64; REPLICATES], b: &[f64; REPLICATES], weights: &[f64; REPLICATES]) -> f64 {
    let terms = a.iter().zip(b).zip(weights);
    terms.map(|((a, b), w)| a * b * w).sum()
}

impl Film {
    /// What chance has brought into a pixel, if that can be told.
    pub(super) fn excess(&self, pixel: usize) -> Option<Excess> {
        let sheets = &self.sheets[pixel];
        let used = self.passes.iter().filter(|&&n| n > 0).count();
        if sheets.untold > 0 || used < FEWEST || sheets.sums[0] == [0; REPLICATES] {
            return None;
        }
        let weights = self.passes.map(|n| n as f64);
        let mean_of = |r: usize, sum: i64| sum as f64 * UNIT / weights[r].max(1.0);
        let [own, around] = sheets.sums.map(|sums| {
            let means = std::array::from_fn(|r| mean_of(r, sums[r]));
            Spread::of(means, &weights, used)
        });
        let whole = around.mean.round();
        let sure = own.error > 0.0 && own.error < SURE && own.mean > 0.0;
        if whole < 1.0 || !sure {
            return None;
        }
        let freedom = (used - 1) as f64;
        let believed = own.likely(whole, freedom);
        let believed = believed.min(around.likely(whole, freedom));
        let caustic = self.mean(&self.layers[pixel][Layer::Caustic as usize], self.passes());
        let scale = caustic.mean() / own.mean;
        if believed < UNLIKELY || scale <= 0.0 {
            return None;
        }
        // Of a sheet's share of the light, that much comes and goes with a sheet.
        let totals = std::array::from_fn(|r| {
            self.mean_of(&self.replicates[r][pixel], weights[r]).mean() / scale
        });
        let light = Spread::of(totals, &weights, used);
        let slope = product(&own.deviations, &light.deviations, &weights) / own.squares;
        let explained = slope * slope * own.squares;
        let doubt = (light.squares - explained).max(0.0) / (freedom - 1.0);
        // Drawn to none as far as chance may have made it (James and Stein 1961).
        let kept = (1.0 - DOUBT * doubt / explained).max(0.0);
        let slope = (slope * kept).min(MOST);
        // Not a number where nothing is explained.
        if slope.is_nan() || slope <= 0.0 {
            return None;
        }
        // What is left of the squares if that much is taken off.
        let left = |slope: f64| {
            let rest = light.squares + slope * slope * own.squares;
            let both = product(&own.deviations, &light.deviations, &weights);
            (rest - 2.0 * slope * both).max(0.0)
        };
        let t = own.off(whole);
        let fitted = freedom / (freedom - 1.0) * (1.0 + t * t / freedom);
        // The variance of what may be: of either case, and between them.
        let cases = believed * left(slope) * fitted + (1.0 - believed) * light.squares;
        let between = believed * (1.0 - believed) * (slope * t).powi(2) * own.squares;
        let slope = slope * believed;
        let by_chance = |number: f64| caustic * (slope * (number - whole) / own.mean);
        Some(Excess {
            mean: by_chance(own.mean),
            replicates: own.deviations.map(|d| by_chance(own.mean + d)),
            per_sheet: caustic.mean() * slope / own.mean,
            widening: ((cases + between) / left(slope).max(LEAST * light.squares)).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests;

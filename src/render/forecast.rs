//! What a render will cost, and what error it will have, before it has.
//!
//! After n passes noise² falls about like 1 / n: faster where the samples of
//! light and pixels fill their space evenly, more slowly where kernels shrink.
//! Bias² of order p falls like n^(-p/3), since all kernels follow the schedule.
//! Both are followed by a [`Trend`] in the logarithms of what the picture states; how steep they
//! are beforehand, and how certain that is, was measured over scenes
//! (`cargo bench --bench prediction`). Time is what passes have taken lately,
//! times their number.

use serde::Serialize;

use super::{REPLICATES, asking::rounds_asked};
use crate::{
    metrics::{Figures, Trend},
    numeric::trig::{exp, log},
};

/// Slope of the logarithm of noise² over that of the passes, its standard
/// deviation between scenes, and the variance by which it changes while the
/// logarithm of the passes grows by 1.
const NOISE: [f64; 3] = [-1.0, 0.2, 0.01];

/// The same of bias², the slope for each order of the bias: what the schedule
/// says.
const BIAS: [f64; 3] = [-1.0 / 3.0, 0.34, 0.01];

/// Standard deviations of logarithms of stated noise² and bias², beside what
/// the replicates tell: how they stray about such lines.
const STATED: [f64; 2] = [0.15, 0.2];

/// A normal deviate lies within so many standard deviations in nine cases of
/// ten, and is below so many in nine of ten.
const TWO_SIDED: f64 = 1.644_853_626_951_472_7;
const ONE_SIDED: f64 = 1.281_551_565_544_600_4;

/// Standard deviation of the logarithm of the time of a pass, from what passes
/// took before.
const PACE: f64 = 0.12;

/// How many times as many passes as were seen a forecast carries.
const REACH: f64 = 1000.0;

/// A number that is not known yet, and where it lies with a probability of
/// 0.9.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// As likely too small as too large.
    pub middle: f64,
    /// The number is below with a probability of 0.05.
    pub low: f64,
    /// The number is above with a probability of 0.05; `None` where there is
    /// no telling.
    pub high: Option<f64>,
}

/// What it takes until a picture states an error of at most a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Price {
    /// Nothing: it does.
    Held,
    /// So many passes in all, and seconds.
    Passes {
        /// The passes after which it is asked and found, a number of rounds.
        passes: Interval,
        /// Time from the start of the render to there.
        seconds: Interval,
    },
    /// More than can be told from what was seen.
    Beyond {
        /// The number of passes is larger than this with a probability of
        /// 0.95.
        passes: f64,
        /// Time for these.
        seconds: f64,
    },
}

/// How the error of a growing picture goes on; see the module's text.
#[derive(Clone, Copy, Debug)]
pub struct Forecast {
    noise: Trend,
    /// `None` before the order of the bias is known.
    bias: Option<Trend>,
    /// By how much of themselves noise², bias² and their sum may be larger, at
    /// 90 %.
    margins: [f64; 3],
    /// Passes when the error was last looked at.
    passes: u32,
    /// The bound that was stated then, if it was.
    stated: Option<f64>,
    pace: Pace,
}

impl Default for Forecast {
    fn default() -> Self {
        Self::new()
    }
}

impl Forecast {
    /// Nothing is seen yet.
    pub fn new() -> Self {
        let [slope, deviation, drift] = NOISE;
        Self {
            noise: Trend::new(slope, deviation, drift),
            bias: None,
            margins: [0.0; 3],
            passes: 0,
            stated: None,
            pace: Pace::default(),
        }
    }

    /// Takes note of the time that so many passes have taken in all: after
    /// every pass, so that the start does not count as pace.
    pub fn clock(&mut self, passes: u32, seconds: f64) {
        self.pace.clock(passes, seconds);
    }

    /// Takes note of the error after so many passes, which have to grow from
    /// call to call; before all replicates have one it is no stated error, and
    /// counts as what is seen early.
    pub fn observe(&mut self, passes: u32, figures: &Figures) {
        if passes <= self.passes {
            return;
        }
        let x = log(f64::from(passes));
        let squared = |f: f64| f * f;
        let noise = squared(figures.noise);
        let noise_more = squared(figures.noise_bound) - noise;
        if noise > 0.0 {
            // Of the mean over replicates less is unknown than of one picture.
            let unsure = noise_more / noise / ONE_SIDED;
            let variance = squared(unsure) / f64::from(REPLICATES) + squared(STATED[0]);
            self.noise.observe(x, log(noise), variance);
            self.margins[0] = noise_more / noise;
        }
        let bias = squared(figures.bias);
        let unsure = (squared(figures.bias_bound) - bias) / ONE_SIDED;
        // What is hidden by noise may be half as large as that.
        let shown = bias.max(0.5 * unsure);
        if shown > 0.0 {
            let [per_order, deviation, drift] = BIAS;
            let slope = per_order * figures.bias_order;
            let trend = self
                .bias
                .get_or_insert_with(|| Trend::new(slope, deviation, drift));
            let variance = squared(unsure / shown) + squared(STATED[1]);
            trend.observe(x, log(shown), variance);
            self.margins[1] = ONE_SIDED * unsure / shown;
        }
        let sum = noise + shown;
        if sum > 0.0 {
            let more = squared(figures.bound) - squared(figures.error);
            let known = squared(noise_more) + squared(ONE_SIDED * unsure);
            self.margins[2] = (squared(more) - known).max(0.0).sqrt() / sum;
        }
        self.passes = passes;
        self.stated = (passes >= REPLICATES).then_some(figures.bound);
    }

    /// The error after so many passes; `None` before anything was seen.
    pub fn error_after(&self, passes: u32) -> Option<Interval> {
        let [middle, deviation] = self.squared(f64::from(passes), false)?;
        Some(around(0.5 * middle, 0.5 * deviation))
    }

    /// The error after a time in seconds from the start of the render.
    pub fn error_at(&self, seconds: f64) -> Option<Interval> {
        let at = |pace: f64| self.pace.passes_at(seconds, pace);
        let [middle, deviation] = self.squared(at(1.0)?, false)?;
        // What a pass costs is not known for certain, either.
        let [fewer, _] = self.squared(at(exp(PACE))?, false)?;
        let deviation = libm::hypot(deviation, fewer - middle);
        Some(around(0.5 * middle, 0.5 * deviation))
    }

    /// What it takes until the picture states an error of at most `target` at
    /// 90 %, if it is asked as `--error` asks; `None` before anything was seen.
    pub fn price(&self, target: f64) -> Option<Price> {
        if self.stated.is_some_and(|bound| bound <= target) {
            return Some(Price::Held);
        }
        if self.passes == 0 {
            return None;
        }
        let goal = 2.0 * log(target);
        let reach = REACH * f64::from(self.passes);
        let mut found: [Option<f64>; 3] = [None; 3];
        let mut last = 0.0;
        let per_round = f64::from(REPLICATES);
        let ahead = rounds_asked().map(|r| f64::from(r) * per_round);
        let ahead = ahead.skip_while(|&n| n <= f64::from(self.passes));
        for passes in ahead.take_while(|&n| n <= reach) {
            last = passes;
            let [middle, deviation] = self.squared(passes, true)?;
            for (found, side) in found.iter_mut().zip([-1.0, 0.0, 1.0]) {
                if found.is_none() && middle + side * TWO_SIDED * deviation <= goal {
                    *found = Some(passes);
                }
            }
        }
        let seconds = |passes: f64, pace: f64| self.pace.seconds_for(passes, pace);
        let slow = exp(TWO_SIDED * PACE);
        let [Some(low), Some(middle), high] = found else {
            let passes = found[0].unwrap_or(last);
            let seconds = seconds(passes, 1.0 / slow)?;
            return Some(Price::Beyond { passes, seconds });
        };
        Some(Price::Passes {
            passes: Interval { middle, low, high },
            seconds: Interval {
                middle: seconds(middle, 1.0)?,
                low: seconds(low, 1.0 / slow)?,
                high: high.and_then(|high| seconds(high, slow)),
            },
        })
    }

    /// Expectation and standard deviation of the logarithm of error² after so
    /// many passes, or of its bound.
    fn squared(&self, passes: f64, bound: bool) -> Option<[f64; 2]> {
        let x = log(passes.max(f64::from(self.passes)));
        let noise = self.noise.at(x);
        let bias = self.bias.and_then(|b| b.at(x));
        let size = |part: Option<[f64; 2]>| part.map_or(0.0, |[y, _]| exp(y));
        let sizes = [size(noise), size(bias)];
        let sum = sizes[0] + sizes[1];
        if sum <= 0.0 {
            return None;
        }
        let more = if bound {
            let [a, b, c] = self.margins;
            libm::hypot(libm::hypot(a * sizes[0], b * sizes[1]), c * sum)
        } else {
            0.0
        };
        let variance = |part: Option<[f64; 2]>, size: f64| {
            part.map_or(0.0, |[_, v]| (size / sum) * (size / sum) * v)
        };
        let variance = variance(noise, sizes[0]) + variance(bias, sizes[1]);
        Some([log(sum + more), variance.sqrt()])
    }
}

/// The interval of what has a normal logarithm.
fn around(middle: f64, deviation: f64) -> Interval {
    Interval {
        middle: exp(middle),
        low: exp(middle - TWO_SIDED * deviation),
        high: Some(exp(middle + TWO_SIDED * deviation)),
    }
}

/// What passes cost.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    /// Passes and seconds: from where on the pace counts, the next such place,
    /// and the last pass.
    marks: [(u32, f64); 2],
    last: (u32, f64),
}

impl Pace {
    fn clock(&mut self, passes: u32, seconds: f64) {
        self.last = (passes, seconds);
        if self.marks[0].0 == 0 {
            // What comes before has the preparations in it.
            self.marks = [self.last; 2];
        } else if passes >= self.marks[1].0.saturating_mul(2) {
            self.marks = [self.marks[1], self.last];
        }
    }

    /// Seconds of a pass.
    fn per_pass(&self) -> Option<f64> {
        let [(first, start), _] = self.marks;
        let (passes, seconds) = self.last;
        if passes == 0 {
            return None;
        }
        Some(if passes > first {
            (seconds - start) / f64::from(passes - first)
        } else {
            seconds / f64::from(passes)
        })
    }

    /// Time from the start until there are so many passes, if each takes
    /// `factor` times as long as before.
    fn seconds_for(&self, passes: f64, factor: f64) -> Option<f64> {
        let ahead = (passes - f64::from(self.last.0)).max(0.0);
        Some(self.last.1 + ahead * factor * self.per_pass()?)
    }

    /// Passes that fit into a time, if each takes `factor` times as long as
    /// before; at least those that are done.
    fn passes_at(&self, seconds: f64, factor: f64) -> Option<f64> {
        let pace = factor * self.per_pass()?;
        let ahead = (seconds - self.last.1).max(0.0) / pace.max(f64::MIN_POSITIVE);
        Some(f64::from(self.last.0) + ahead)
    }
}

#[cfg(test)]
mod tests;

//! What a render will cost, and how good it will be, while it goes on.

use std::time::{Duration, Instant};

use nephroid::{
    metrics::Statement,
    render::{Forecast, Part, Price, Progress, REPLICATES, RoundReport, ends_asked_round},
};

use super::progress::{Goal, clock};

/// Errors of which people think.
pub(super) const LIST: [f64; 6] = [0.2, 0.1, 0.05, 0.02, 0.01, 0.005];

/// Passes after which there is something to tell, before the first round is
/// complete.
const EARLY: u32 = REPLICATES / 2;

/// The part of the time so far that a look at the picture may take, and what
/// the first one is thought to take, in seconds per pixel.
const SHARE: f64 = 0.005;
const PER_PIXEL: f64 = 1e-6;

/// Looks at a growing picture now and then.
pub(super) struct Outlook {
    is_heard: bool,
    forecast: Forecast,
    /// Seconds that the last look took.
    price: Option<f64>,
    /// What was seen after full rounds, the last time.
    last_round: Option<RoundReport>,
}

impl Outlook {
    /// Nothing is seen yet; whether anybody is told what is.
    pub(super) fn new(is_heard: bool) -> Self {
        Self {
            is_heard,
            forecast: Forecast::new(),
            price: None,
            last_round: None,
        }
    }

    /// Looks at what a pass has added, if it is time for that and does not
    /// cost much. What a render for an error states anyhow costs nothing; where the
    /// render will end inside the next round, the look is worth its price.
    pub(super) fn look(&mut self, progress: &Progress, part: &Part, goal: Goal) {
        let passes = progress.passes_done;
        let seconds = progress.elapsed.as_secs_f64();
        self.forecast.clock(passes, seconds);
        if !part.subject().is_by_photons() {
            return;
        }
        let film = part.film();
        let pixels = f64::from(film.width()) * f64::from(film.height());
        let is_cheap = self.price.unwrap_or(PER_PIXEL * pixels) <= SHARE * seconds;
        let is_time = ends_asked_round(passes) || passes == EARLY;
        let stated = progress.stated.filter(|stated| stated.passes == passes);
        let is_wanted = self.is_heard && is_time && is_cheap;
        if !(stated.is_some() || is_wanted || ends_inside_next(progress, goal)) {
            return;
        }
        let start = Instant::now();
        let figures = if passes.is_multiple_of(REPLICATES) {
            let look = || Statement::of(film, None).map(|s| RoundReport::of(passes, &s));
            self.last_round = stated.or_else(look);
            self.last_round.map(|stated| stated.lit)
        } else {
            Statement::early(film)
        };
        if stated.is_none() {
            self.price = Some(start.elapsed().as_secs_f64());
        }
        if let Some(figures) = figures {
            self.forecast.observe(passes, &figures);
        }
    }

    /// What was seen last after full rounds.
    pub(super) fn last_round(&self) -> Option<RoundReport> {
        self.last_round
    }

    /// When errors will be reached, if one is asked for, and which error a
    /// given number of passes or time will lead to.
    pub(super) fn words(&self, progress: &Progress, goal: Goal) -> Vec<String> {
        let mut words: Vec<String> = goal
            .error
            .into_iter()
            .flat_map(on_the_way)
            .filter_map(|target| self.when(target, progress.elapsed))
            .collect();
        let by_passes = goal.passes.and_then(|n| self.forecast.error_after(n));
        let by_time = goal.time.map(|time| time.as_secs_f64());
        let by_time = by_time.and_then(|seconds| self.forecast.error_at(seconds));
        // What comes first ends the render, and then the error is larger.
        let ends = by_passes.into_iter().chain(by_time);
        let end = ends.max_by(|a, b| a.middle.total_cmp(&b.middle));
        if let (Some(end), Some(high)) = (end, end.and_then(|e| e.high)) {
            let [low, middle, high] = [end.low, end.middle, high].map(percent);
            words.push(format!("about {middle} % at the end ({low} to {high})"));
        }
        words
    }

    fn when(&self, target: f64, elapsed: Duration) -> Option<String> {
        let percent = percent(target);
        match self.forecast.price(target)? {
            Price::Held => None,
            Price::Passes { seconds, .. } => {
                let left = length(seconds.middle).saturating_sub(elapsed);
                Some(format!("{percent} % in about {}", clock(left)))
            }
            Price::Beyond { seconds, .. } => {
                let left = length(seconds).saturating_sub(elapsed);
                Some(format!("{percent} % not before {}", clock(left)))
            }
        }
    }
}

/// Whether a full round ends here, and the render will end before the next does, as
/// far as that is known: how many passes a time holds may be mistaken by half a round.
fn ends_inside_next(progress: &Progress, goal: Goal) -> bool {
    let done = progress.passes_done;
    let by_passes = goal.passes.unwrap_or(u32::MAX);
    let left = progress.passes_total.min(by_passes).saturating_sub(done);
    let mistaken = if goal.time.is_some() {
        REPLICATES / 2
    } else {
        0
    };
    done.is_multiple_of(REPLICATES) && left > 0 && left < REPLICATES + mistaken
}

/// The error that is asked for, and a larger one that comes well before it.
fn on_the_way(target: f64) -> impl Iterator<Item = f64> {
    let before = LIST.into_iter().rev().find(|&e| e > 1.5 * target);
    before.into_iter().chain([target])
}

/// A length of time in seconds; the longest there is for what is longer.
pub(super) fn length(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
}

/// A relative error in per cent, with two digits that count.
pub(super) fn percent(error: f64) -> String {
    let percent = 100.0 * error;
    // 2 and 0.5, not 2.0 and 0.50.
    let digits = (1 - percent.log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{percent:.digits$}");
    match text.split_once('.') {
        Some((whole, part)) if part.chars().all(|c| c == '0') => whole.to_owned(),
        Some(_) => text.trim_end_matches('0').to_owned(),
        None => text,
    }
}

/// Figures of a picture that states an error without any doubt.
#[cfg(test)]
pub(super) fn stated(error: f64) -> nephroid::metrics::Figures {
    nephroid::metrics::Figures {
        pixels: 100,
        error,
        bound: error,
        noise: error,
        noise_bound: error,
        bias: 0.0,
        bias_bound: 0.0,
        bias_order: 2.0,
        error_of_all: error,
        bound_of_all: error,
        percentile_95: error,
        percentile_99: error,
        outside: None,
    }
}

/// The same after so many passes of full rounds.
#[cfg(test)]
pub(super) fn stated_after(passes: u32, error: f64) -> RoundReport {
    RoundReport {
        passes,
        lit: stated(error),
        caustics: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_in_per_cent() {
        for (error, text) in [
            (0.2, "20"),
            (0.05, "5"),
            (0.005, "0.5"),
            (0.01234, "1.2"),
            (0.000_456, "0.046"),
            (1.234, "123"),
            (0.0996, "10"),
        ] {
            assert_eq!(percent(error), text);
        }
    }

    /// Noise alone, 16 % after 8 passes of a second each: 8 % takes about four
    /// times as many, 4 % sixteen times.
    #[test]
    fn words_tell_of_targets_and_of_the_end() {
        let mut outlook = Outlook::new(true);
        for pass in 1..=8 {
            outlook.forecast.clock(pass, f64::from(pass));
        }
        let progress = Progress {
            passes_done: 8,
            passes_total: 100,
            photons_emitted: 0,
            elapsed: Duration::from_secs(8),
            stated: Some(stated_after(8, 0.16)),
        };
        let goal = |passes, seconds: Option<u64>, error| Goal {
            passes,
            time: seconds.map(Duration::from_secs),
            error,
        };
        let asked = goal(None, None, Some(0.041));
        assert!(
            outlook.words(&progress, asked).is_empty(),
            "nothing is seen"
        );
        outlook.forecast.observe(8, &stated(0.16));
        // Rounds 4 and 16 are rounds at which is asked.
        assert_eq!(
            outlook.words(&progress, goal(None, None, Some(0.081))),
            ["8.1 % in about 24s"],
        );
        assert_eq!(
            outlook.words(&progress, asked),
            ["10 % in about 16s", "4.1 % in about 2m 00s"]
        );
        let far = outlook.words(&progress, goal(None, None, Some(0.0001)));
        assert!(far[1].starts_with("0.01 % not before "), "{far:?}");
        // The end that comes first.
        let ends = outlook.words(&progress, goal(Some(32), Some(128), None));
        assert!(
            ends.len() == 1 && ends[0].starts_with("about 8 % at the end ("),
            "{ends:?}"
        );
        let ends = outlook.words(&progress, goal(Some(32), Some(16), None));
        assert!(ends[0].starts_with("about 11 % at the end ("), "{ends:?}");
    }

    #[test]
    fn the_last_full_round_is_known_beforehand() {
        let goal = |passes, seconds: Option<u64>| Goal {
            passes,
            time: seconds.map(Duration::from_secs),
            error: None,
        };
        let ends = |done, total, goal| {
            let progress = Progress {
                passes_done: done,
                passes_total: total,
                photons_emitted: 0,
                elapsed: Duration::from_secs(8),
                stated: None,
            };
            ends_inside_next(&progress, goal)
        };
        let by_passes = goal(Some(21), None);
        assert!(ends(16, 21, by_passes) && !ends(8, 21, by_passes) && !ends(17, 21, by_passes));
        assert!(!ends(16, 24, goal(Some(24), None)), "the next ends, too");
        assert!(
            !ends(16, 16, goal(Some(16), None)),
            "nothing comes after it"
        );
        // What passes take next is not certain; what is typed is.
        assert!(ends(16, 27, goal(None, Some(9))) && !ends(16, 28, goal(None, Some(9))));
        assert!(ends(16, u32::MAX, by_passes));
    }
}

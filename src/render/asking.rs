//! When a render is asked whether its error is small enough.

use std::f64::consts::SQRT_2;

use super::{Job, Part, REPLICATES, RoundReport};
use crate::metrics::Statement;

/// Asks the film of a growing part for its error, after the rounds 1, 2, 3, 4,
/// 6, 8, 11, 16, ..., each about 2^(1/2) times as many as before: whoever asks
/// after every round stops at the luckiest one. The rounds do not depend on
/// where a render was interrupted.
pub(super) struct Asking {
    target: Option<f64>,
    stated: Option<RoundReport>,
}

impl Asking {
    /// For what a job asks.
    pub(super) fn of(job: &Job) -> Self {
        Self {
            target: job.error,
            stated: None,
        }
    }

    /// Whether the part has come to a round at which it is asked, and states
    /// an error of at most the one asked for.
    pub(super) fn is_reached_by(&mut self, part: &Part) -> bool {
        let Some(target) = self.target else {
            return false;
        };
        let passes = part.passes();
        if !ends_asked_round(passes) {
            return false;
        }
        let statement = Statement::of(part.film(), None);
        self.stated = statement.map(|s| RoundReport::of(passes, &s));
        self.stated.is_some_and(|stated| stated.lit.bound <= target)
    }

    /// The error that was stated last.
    pub(super) fn stated(&self) -> Option<RoundReport> {
        self.stated
    }
}

/// The numbers of rounds after which a picture is asked for its error.
pub(super) fn rounds_asked() -> impl Iterator<Item = u32> {
    let next = |&rounds: &u32| {
        // `as` saturates.
        let next = (f64::from(rounds) * SQRT_2).round() as u32;
        (rounds < u32::MAX).then(|| next.max(rounds + 1))
    };
    std::iter::successors(Some(1), next)
}

/// Whether a picture is asked for its error after so many rounds.
fn is_asked(rounds: u32) -> bool {
    rounds_asked().find(|&r| r >= rounds) == Some(rounds)
}

/// Whether so many passes end a round after which a picture is asked for its
/// error: 1, 2, 3, 4, 6, 8, 11, 16, ... rounds.
pub fn ends_asked_round(passes: u32) -> bool {
    passes.is_multiple_of(REPLICATES) && is_asked(passes / REPLICATES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_are_spaced_geometrically() {
        let asked: Vec<u32> = (0..100).filter(|&r| is_asked(r)).collect();
        assert_eq!(asked, [1, 2, 3, 4, 6, 8, 11, 16, 23, 33, 47, 66, 93]);
        assert!(!is_asked(u32::MAX - 1) && is_asked(u32::MAX));
    }
}

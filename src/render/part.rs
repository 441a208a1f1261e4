//! A part of a picture: some of its passes, summed.
//!
//! It holds all that a report and a picture need, and grows in three ways that
//! lead to the same bits: pass by pass, from a checkpoint on, by merging with
//! other parts of the same picture.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{PassOutput, Progress, REPLICATES, Subject};
use crate::{
    film::{Film, PixelSample},
    numeric::{
        DyadicSum,
        dyadic::{Addend, Overlap},
        exact::Quantum,
    },
    photon::Tally,
};

/// Sums over passes that do not belong to pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Totals {
    pub(super) emitted: u64,
    pub(super) stored: u64,
    pub(super) photons_refused: u64,
    pub(super) truncated: u64,
    pub(super) queries: u64,
    pub(super) visited: u64,
    pub(super) tested: u64,
    pub(super) accepted: u64,
    pub(super) tally: Tally,
}

impl Totals {
    fn of(pass: &PassOutput) -> Self {
        Self {
            emitted: pass.emitted,
            stored: pass.stored,
            photons_refused: pass.refused,
            truncated: pass.truncated,
            queries: pass.queries,
            visited: pass.visited,
            tested: pass.tested,
            accepted: pass.accepted,
            tally: pass.tally.clone(),
        }
    }
}

impl Addend for Totals {
    fn add(&mut self, other: &Self) {
        let add = |ours: &mut u64, theirs: u64| *ours = ours.saturating_add(theirs);
        add(&mut self.emitted, other.emitted);
        add(&mut self.stored, other.stored);
        add(&mut self.photons_refused, other.photons_refused);
        add(&mut self.truncated, other.truncated);
        add(&mut self.queries, other.queries);
        add(&mut self.visited, other.visited);
        add(&mut self.tested, other.tested);
        add(&mut self.accepted, other.accepted);
        if self.tally.lights.is_empty() {
            self.tally = other.tally.clone();
        } else {
            self.tally.merge(&other.tally);
        }
    }
}

/// Some passes of a picture; see the module's text.
#[derive(Clone, Debug)]
pub struct Part {
    pub(super) subject: Subject,
    pub(super) film: Film,
    pub(super) totals: DyadicSum<Totals>,
    pub(super) seconds: f64,
}

/// Why two parts cannot be summed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MergeFault {
    /// They are not parts of one picture; how they differ.
    #[error("{0}")]
    Foreign(String),
    /// A pass is in both.
    #[error("pass {0} is in both")]
    Overlap(u32),
}

impl Part {
    /// A part of a subject's picture without any pass.
    pub fn new(subject: Subject) -> Self {
        let [_, _, width, height] = subject.window;
        // The subject says what the quantum of its scene said.
        let quantum =
            Quantum::of_unit(subject.quantum).unwrap_or_else(|| Quantum::for_typical(1.0));
        Self {
            film: Film::new(width, height, quantum),
            subject,
            totals: DyadicSum::default(),
            seconds: 0.0,
        }
    }

    /// What the passes are passes of.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// The sums per pixel.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The sums per pixel alone.
    pub fn into_film(self) -> Film {
        self.film
    }

    /// Wall time that the passes took, over all sessions and machines, in
    /// seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// States the time that the passes have taken.
    pub fn set_seconds(&mut self, seconds: f64) {
        self.seconds = seconds;
    }

    /// Number of passes.
    pub fn passes(&self) -> u32 {
        let passes: u64 = self
            .totals
            .runs()
            .iter()
            .map(|run| run.end - run.start)
            .sum();
        // As many as there are indices would be one more than fits.
        passes.min(u64::from(u32::MAX)) as u32
    }

    /// The passes, as runs without a gap; `start..end` without `end`.
    pub fn runs(&self) -> Vec<std::ops::Range<u64>> {
        self.totals.runs()
    }

    /// Photon paths emitted.
    pub fn photons_emitted(&self) -> u64 {
        let emitted = self.totals.sums().map(|totals| totals.emitted);
        emitted.fold(0, u64::saturating_add)
    }

    /// How far the part has come of so many passes.
    pub fn progress(&self, passes_total: u32) -> Progress {
        Progress {
            passes_done: self.passes(),
            passes_total,
            photons_emitted: self.photons_emitted(),
            elapsed: Duration::try_from_secs_f64(self.seconds).unwrap_or_default(),
            stated: None,
        }
    }

    /// Adds a pass of the renderer's own method.
    ///
    /// # Panics
    /// If the pass is there already, or has another size.
    pub fn add_pass(&mut self, index: u32, pass: &PassOutput) {
        self.add(index, &pass.samples, Totals::of(pass));
    }

    /// Adds a pass of a reference method, with so many paths from the lights.
    ///
    /// # Panics
    /// If the pass is there already, or has another size.
    pub(crate) fn add_samples(&mut self, index: u32, samples: &[PixelSample], emitted: u64) {
        let totals = Totals {
            emitted,
            ..Totals::default()
        };
        self.add(index, samples, totals);
    }

    fn add(&mut self, index: u32, samples: &[PixelSample], totals: Totals) {
        let pushed = self.totals.push(index, totals);
        assert!(pushed.is_ok(), "pass {index} is there already");
        self.film.add_pass(index, samples);
    }

    /// Adds all passes of another part of the same picture. The result is the
    /// part that would have rendered them all, to the bit, but for the time,
    /// which is the sum.
    ///
    /// # Errors
    /// If that is no part of the same picture, or a pass is in both; nothing is
    /// changed then.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeFault> {
        if let Some(difference) = self.subject.difference(&other.subject) {
            return Err(MergeFault::Foreign(difference));
        }
        let mut totals = self.totals.clone();
        let merged = totals.merge(&other.totals);
        merged.map_err(|Overlap(pass)| MergeFault::Overlap(pass))?;
        let merged = self.film.merge(&other.film);
        merged.map_err(|e| MergeFault::Foreign(e.to_string()))?;
        self.totals = totals;
        self.seconds += other.seconds;
        Ok(())
    }

    /// Whether all that was read from a file goes together.
    pub(super) fn is_sound(&self) -> bool {
        let [_, _, width, height] = self.subject.window;
        let lights = self.subject.lights.len();
        // Runs first: sums that are none have none.
        self.totals.is_sound()
            && self.film.replicate_passes() == passes_of_replicates(&self.totals.runs())
            && [self.film.width(), self.film.height()] == [width, height]
            && self.film.quantum().unit() == self.subject.quantum
            && self.totals.sums().all(|t| t.tally.lights.len() == lights)
            && self.seconds.is_finite()
            && self.seconds >= 0.0
    }
}

/// How many of the passes belong to each replicate.
fn passes_of_replicates(runs: &[std::ops::Range<u64>]) -> [u64; REPLICATES as usize] {
    let count = u64::from(REPLICATES);
    std::array::from_fn(|replicate| {
        // Indices below `end` that belong to the replicate.
        let below = |end: u64| (end + count - 1 - replicate as u64) / count;
        runs.iter()
            .map(|run| below(run.end) - below(run.start))
            .sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replicates_share_the_passes() {
        for (start, end) in [(0, 0), (0, 1), (0, 8), (3, 29), (5, 6), (64, 128)] {
            let mut counted = [0; 8];
            for i in start..end {
                counted[i as usize % 8] += 1;
            }
            assert_eq!(
                passes_of_replicates(&[start..end, end..end]),
                counted,
                "{start}..{end}"
            );
        }
        assert_eq!(
            passes_of_replicates(&[0..3, 8..9]),
            [2, 1, 1, 0, 0, 0, 0, 0]
        );
    }
}

//! Learning where photons are needed.
//!
//! A *rehearsal* traces photon paths and remembers where in the lights'
//! emission each began. The caller says what every photon was worth; the sum
//! over a path's photons is its score. [`Emitter::taught`] then spreads paths
//! in proportion to the scores found: over the lights, over the targets of
//! each, and over the cells of a [`Guide`] inside a target.
//!
//! Why in proportion: an estimate that is a sum over paths of `f / p`, where
//! `p` is the density of a path and `f` what it brings, has the least variance
//! with `p` proportional to the root of the mean of `f^2`. A score is `|f| / p`
//! at the density with which the path was drawn, so the mean score of the paths
//! that began in a cell times how many there were estimates the integral of
//! `|f|` there.

use rayon::prelude::*;

use crate::{
    sampling::{GUIDE_DIMENSIONS, Guide, Sequence, Stream, Weighed},
    transport::Context,
};

use super::{Aim, Emitter, LightTally, Photon, shoot::in_chunks, trace};

/// Part of all paths that goes to lights and targets by power, whatever the
/// scores say.
const BY_POWER: f64 = 0.1;

/// Mean square of the scores over the square of their mean, from which on it
/// is worth while to teach: the most by which the variance can fall. With less
/// to gain, the evenness of paths that nobody guided is worth more.
const WORTH_IT: f64 = 2.0;

/// Paths of a pass for which that holds; with fewer, guides have few cells and
/// have to promise as much more.
const MANY: f64 = 12_800.0;

/// Paths of a pass for each cell of a guide: kernels change their size from
/// cell to cell, and most of them should lie within one.
const PATHS_PER_CELL: f64 = 64.0;

/// Where in the emission a path began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// Index of the light.
    pub light: u32,
    /// Index of the target among those of the light.
    pub target: u32,
    /// The sample from which the start was drawn: direction, point.
    pub at: [f64; GUIDE_DIMENSIONS],
}

/// A path of a rehearsal and what it was worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lesson {
    /// Where the path began.
    pub origin: Origin,
    /// Its score, in any unit; what is not finite or not positive counts as
    /// nothing.
    pub score: f64,
}

/// Paths and their photons.
#[derive(Clone, Debug, Default)]
pub struct Rehearsal {
    /// Photons in path order.
    pub photons: Vec<Photon>,
    /// Where each path began, with the number of photons it left.
    paths: Vec<(Origin, usize)>,
}

impl Rehearsal {
    /// Traces paths `0 .. count` of a sequence. Half of them start as the
    /// emitter's paths do, half go to lights and targets in equal numbers: what
    /// gets little power may be all that is seen.
    pub fn new(ctx: &Context<'_>, emitter: &Emitter, sequence: Sequence, count: u64) -> Self {
        let Some(emitter) = &emitter.levelled() else {
            return Self::default();
        };
        let mut all = Self::default();
        for chunk in in_chunks(count, |chunk: &mut Self, index| {
            chunk.trace(ctx, emitter, sequence.at(index), count as f64);
        }) {
            all.photons.extend_from_slice(&chunk.photons);
            all.paths.extend_from_slice(&chunk.paths);
        }
        all
    }

    fn trace(&mut self, ctx: &Context<'_>, emitter: &Emitter, mut stream: Stream, paths: f64) {
        let (emission, origin) = emitter.emit_from(ctx, &mut stream);
        let before = self.photons.len();
        let mut ledger = LightTally::default();
        trace(
            ctx,
            &emission,
            paths,
            &mut stream,
            &mut ledger,
            &mut |photon| {
                self.photons.push(photon);
            },
        );
        self.paths.push((origin, self.photons.len() - before));
    }

    /// Number of paths.
    pub fn paths(&self) -> u64 {
        self.paths.len() as u64
    }

    /// Adds up what each path's photons were worth.
    pub fn lessons(&self, worth: impl Fn(&Photon) -> f64 + Send + Sync) -> Vec<Lesson> {
        let worths: Vec<f64> = self.photons.par_iter().map(worth).collect();
        let mut first = 0;
        self.paths
            .iter()
            .map(|&(origin, count)| {
                let score = worths[first..first + count].iter().sum();
                first += count;
                Lesson { origin, score }
            })
            .collect()
    }
}

impl Emitter {
    /// The same guides, with every target's share halfway to that of others.
    pub(super) fn levelled(&self) -> Option<Self> {
        let targets: usize = self.aims().iter().map(|a| a.powers().len()).sum();
        let (mut aims, mut shares) = (Vec::new(), Vec::new());
        for (i, aim) in self.aims().iter().enumerate() {
            let parts: Vec<f64> = (0..aim.powers().len())
                .map(|k| 0.5 * (self.share(i, k) + 1.0 / targets as f64))
                .collect();
            shares.push(parts.iter().sum());
            aims.push(aim.taught(&parts, Vec::new()));
        }
        Self::of(aims, &shares)
    }

    /// An emitter that spreads its paths in proportion to the scores, but for
    /// a tenth that goes on as power and chance will have it: every path that
    /// was possible stays so. A pass is to have so many `paths`. The lessons must
    /// come from rehearsals of this emitter. `None` if no path was worth anything, or nearly all were worth the
    /// same: then there is little to gain.
    #[must_use]
    pub fn taught(&self, lessons: &[Lesson], paths: u64) -> Option<Self> {
        let mut found: Vec<Vec<Vec<Weighed>>> = self
            .aims()
            .iter()
            .map(|aim| vec![Vec::new(); aim.powers().len()])
            .collect();
        let mut total = 0.0;
        for lesson in lessons {
            let Origin { light, target, at } = lesson.origin;
            let weight = if lesson.score.is_finite() {
                lesson.score.max(0.0)
            } else {
                0.0
            };
            total += weight;
            // A light that has no target gives none to learn from.
            if let Some(samples) = found[light as usize].get_mut(target as usize) {
                samples.push(Weighed { at, weight });
            }
        }
        let squares: f64 = found
            .iter()
            .flatten()
            .flatten()
            .map(|s| s.weight * s.weight)
            .sum();
        let worth = WORTH_IT * (MANY / paths as f64).max(1.0);
        if total == 0.0 || lessons.len() as f64 * squares < worth * total * total {
            return None;
        }
        let power: f64 = self.aims().iter().map(Aim::power_estimate).sum();
        let (mut all_parts, mut all_guides) = (Vec::new(), Vec::new());
        for (aim, found) in self.aims().iter().zip(&found) {
            let share = |(samples, own): (&Vec<Weighed>, &f64)| {
                let scores: f64 = samples.iter().map(|s| s.weight).sum();
                (1.0 - BY_POWER) * scores / total + BY_POWER * own / power
            };
            let parts: Vec<f64> = found.iter().zip(aim.powers()).map(share).collect();
            let guides = found
                .par_iter()
                .zip(&parts)
                .map(|(samples, part)| {
                    let cells = part * paths as f64 / PATHS_PER_CELL;
                    Guide::learn(samples, aim.dimensions(), cells as usize)
                })
                .collect();
            all_parts.push(parts);
            all_guides.push(guides);
        }
        Self::with_parts(self.aims(), all_parts, all_guides)
    }
}

//! Photon paths that are traced to be told about.

use std::ops::Range;

use crate::{
    geometry::Ray,
    sampling::{Sequence, Stream},
    scene::Kernel,
    transport::Context,
};

use super::{Emitter, LightTally, Photon, Step, Turn, shoot::in_chunks, trace::trace_watched};

/// What became of one photon path.
#[derive(Clone, Debug)]
pub struct Story {
    /// Index of the light.
    pub light: u32,
    /// How it began.
    pub ray: Ray,
    /// The first surface that it met.
    pub first: Option<Step>,
    /// The first surface that bent it.
    pub caster: Option<Step>,
    /// Surfaces that it met, up to the first that is not specular.
    pub surfaces: u32,
    /// Its photons, among those of the trial.
    pub photons: Range<usize>,
    /// The ledger of this path alone.
    pub ledger: LightTally,
}

/// Paths and their photons.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// Photons in path order, without footprints.
    pub photons: Vec<Photon>,
    /// One a path, in order.
    pub stories: Vec<Story>,
}

impl Trial {
    /// Traces paths `0 .. count` of a sequence. Half of them start as the
    /// emitter's do, half go to lights and targets in equal numbers.
    pub fn new(ctx: &Context<'_>, emitter: &Emitter, sequence: Sequence, count: u64) -> Self {
        let Some(emitter) = &emitter.levelled() else {
            return Self::default();
        };
        let mut all = Self::default();
        for chunk in in_chunks(count, |chunk: &mut Self, index| {
            chunk.trace(ctx, emitter, sequence.at(index), count as f64);
        }) {
            let before = all.photons.len();
            all.photons.extend_from_slice(&chunk.photons);
            all.stories
                .extend(chunk.stories.into_iter().map(|story| Story {
                    photons: story.photons.start + before..story.photons.end + before,
                    ..story
                }));
        }
        all
    }

    fn trace(&mut self, ctx: &Context<'_>, emitter: &Emitter, mut stream: Stream, paths: f64) {
        let (emission, _) = emitter.emit_from(ctx, &mut stream);
        let before = self.photons.len();
        let mut ledger = LightTally::default();
        let (mut first, mut caster, mut surfaces, mut ended) = (None, None, 0, false);
        // Nobody gathers these photons.
        trace_watched(
            ctx,
            Kernel::Circle,
            &emission,
            paths,
            &mut stream,
            &mut ledger,
            &mut |step| {
                first.get_or_insert(step);
                if step.turn == Turn::Bent {
                    caster.get_or_insert(step);
                }
                if !ended {
                    surfaces = step.depth + 1;
                }
                ended |= step.turn == Turn::Ended;
            },
            &mut |photon| self.photons.push(photon),
        );
        self.stories.push(Story {
            light: emission.light,
            ray: emission.ray,
            first,
            caster,
            surfaces,
            photons: before..self.photons.len(),
            ledger,
        });
    }
}

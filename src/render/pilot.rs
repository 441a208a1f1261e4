//! Pilots that teach the emitter where photons are needed.
//!
//! An *epoch* is a stretch of rounds that share one emitter. The pilot of an
//! epoch starts from the emitter of the one before; it is a pure function of
//! scene, settings, seed and epoch, so any pass can be computed without those
//! before it. The samples of pilots are no pass's, so passes stay unbiased.

use std::sync::OnceLock;

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    camera::Camera,
    photon::{Emitter, Photon, PhotonMap, Rehearsal},
    sampling::{Purpose, Sequence},
};

use super::{
    camera_walk::Gather,
    coordinates,
    importance::{Blocks, Importance, Reached, beam, reach},
    memory::FEWEST_PHOTONS,
    refine::Refinement,
    schedule::REPLICATES,
    tally::CameraTally,
};

/// Epochs of a render: later rounds keep what the last one learned. Its pilot
/// is as large as a pilot may be.
const EPOCHS: usize = 6;

/// Work of all pilots up to an epoch, as a part of that of the passes before
/// it (before pass 8 for the first). The rest to a twentieth is the pilots'
/// own: building maps, asking for importance.
const SHARE: f64 = 0.04;

/// Photon paths of a pilot: with fewer than the first number chance would
/// teach. It has no more than a pass, for which there is memory, or than the
/// second number, which needs little.
const PATHS: [u64; 2] = [1 << 12, 1 << 16];

/// Camera samples of a pilot: with fewer than the first number nothing is seen
/// well, with more than the second nothing better.
const SAMPLES: [u64; 2] = [1 << 8, 1 << 16];

/// Part of the picture's size by which a pilot looks past each of its edges:
/// kernels of photons beyond them reach in, and where photons become sparse
/// must lie out of sight.
const MARGIN: f64 = 0.15;

/// Photon paths that cost as much as a camera sample, roughly.
const PATHS_PER_SAMPLE: u64 = 4;

/// Number of a pilot's first sequence among those of the same purpose; each
/// epoch has three.
const FIRST_SEQUENCE: u32 = 16;

/// The same for the sequences by which photons are weighed against camera
/// samples; each epoch has eight.
const WEIGHING_SEQUENCE: u32 = 64;

/// Epoch of a round: 0 for rounds 0 and 1, then one for each doubling.
pub(super) fn epoch(round: u32) -> usize {
    (round.max(1).ilog2() as usize).min(EPOCHS - 1)
}

/// The round by whose kernels a pilot of an epoch looks; `None` before the
/// first.
pub(super) fn round(epoch: Option<usize>) -> u32 {
    epoch.map_or(0, first_round)
}

/// Number of the first of a pilot's eight sequences that weigh photons against
/// camera samples.
pub(super) fn sequence(epoch: Option<usize>) -> u32 {
    epoch.map_or(2, |e| WEIGHING_SEQUENCE + 8 * e as u32)
}

/// The first round of an epoch.
fn first_round(epoch: usize) -> u32 {
    if epoch == 0 { 0 } else { 1 << epoch }
}

/// Work of the pilot of an epoch, in passes.
fn passes(epoch: usize) -> f64 {
    // Epoch e takes effect after 2^e rounds; half of these are new since the
    // epoch before. The first must do with what the first round allows.
    let rounds = match epoch {
        0 | 1 => 1.0,
        e => 0.5 * f64::from(1u32 << e),
    };
    SHARE * rounds * f64::from(REPLICATES)
}

/// How the passes of an epoch spend their work.
#[derive(Clone)]
pub(super) struct Stage {
    pub(super) emitter: Emitter,
    /// Photon paths of a pass.
    pub(super) photons: u64,
    /// Where further camera samples pay.
    pub(super) refinement: Refinement,
    /// The first round, and the number of its first path.
    round: u32,
    path: u64,
}

impl Stage {
    /// Before all lessons.
    pub(super) fn new(emitter: Emitter, photons: u64, refinement: Refinement) -> Self {
        Self {
            emitter,
            photons,
            refinement,
            round: 0,
            path: 0,
        }
    }

    /// The number of the first path of a round, from the stage's own on.
    pub(super) fn first_path(&self, round: u32) -> u64 {
        self.path + u64::from(round - self.round) * self.photons
    }

    /// The stage of an epoch that follows this one. Its paths go on behind all
    /// paths of this one, at a whole number of passes: then a pass is a net.
    pub(super) fn next(
        &self,
        epoch: usize,
        emitter: Emitter,
        photons: u64,
        refinement: Refinement,
    ) -> Self {
        let round = first_round(epoch);
        Self {
            emitter,
            photons,
            refinement,
            round,
            path: self.first_path(round).next_multiple_of(photons),
        }
    }
}

/// The stages of all epochs, each learned when it is first asked for.
pub(super) struct Epochs {
    first: Stage,
    taught: [OnceLock<Option<Stage>>; EPOCHS],
}

impl Epochs {
    /// Epochs that build on what was not taught.
    pub(super) fn new(first: Stage) -> Self {
        Self {
            first,
            taught: Default::default(),
        }
    }

    /// The stage before all lessons.
    pub(super) fn first(&self) -> &Stage {
        &self.first
    }

    /// The stage of an epoch, below the largest number of them. `teach` runs
    /// the pilots of an epoch with the stage of the one before; where they
    /// teach nothing, the stage stays.
    pub(super) fn at(
        &self,
        epoch: usize,
        teach: &impl Fn(usize, &Stage) -> Option<Stage>,
    ) -> &Stage {
        let mut stage = &self.first;
        for (e, slot) in self.taught.iter().enumerate().take(epoch + 1) {
            let before = stage;
            if let Some(better) = slot.get_or_init(|| teach(e, before)) {
                stage = better;
            }
        }
        stage
    }
}

/// What a pilot needs to know of the render.
pub(super) struct Pilot<'a> {
    /// Camera samples without a map.
    pub(super) gather: Gather<'a>,
    pub(super) camera: &'a Camera,
    /// Of the whole picture.
    pub(super) resolution: [u32; 2],
    pub(super) seed: u64,
    /// Photon paths of a pass.
    pub(super) photons: u64,
    /// Factor on the photons' footprints.
    pub(super) shrink: f64,
}

impl Pilot<'_> {
    /// The emitter that an epoch's pilot makes of the one before; `None` where
    /// the work allowed is too little to learn from, or no photon that was
    /// traced can be seen.
    pub(super) fn teach(&self, epoch: usize, before: &Emitter) -> Option<Emitter> {
        // A guide has cells of many paths; few paths do better evenly spread.
        if self.photons < FEWEST_PHOTONS {
            return None;
        }
        let [paths, samples] = self.size(epoch)?;
        let number = FIRST_SEQUENCE + 3 * epoch as u32;
        let sequence = |k: u32| Sequence::new(self.seed, Purpose::Pilot, number + k, 0);
        let ctx = &self.gather.ctx;
        let rehearsal = Rehearsal::new(ctx, before, sequence(0), paths);
        let map = PhotonMap::new(&rehearsal.photons, rehearsal.paths(), self.shrink);
        let points = self.look(&map, sequence(1), sequence(2), samples);
        drop(map);
        let importance = Importance::new(&points, samples);
        let lessons = rehearsal.lessons(|photon| {
            // All kernels count as equally large: with a camera that sees them
            // equally well, photons then spread evenly over what is seen.
            photon.flux.mean() * importance.of(ctx.scene, photon).sqrt()
        });
        before.taught(&lessons, self.photons)
    }

    /// Photon paths and camera samples of an epoch's pilot; `None` where the
    /// work allowed is too little to learn from.
    pub(super) fn size(&self, epoch: usize) -> Option<[u64; 2]> {
        let pixels = u64::from(self.resolution[0]) * u64::from(self.resolution[1]);
        let part = |n: u64, least: u64, most: u64| {
            let n = (passes(epoch) * n as f64) as u64;
            (n >= least).then_some(n.min(most))
        };
        // Where photons are the work, a few more looks do not count, nor do the
        // fewest photons that teach where looks are: these are shared by both.
        let [fewest, _] = PATHS;
        let is_little = passes(epoch) * pixels as f64 >= fewest as f64;
        let looks = pixels.max(self.photons / PATHS_PER_SAMPLE);
        let looks = part(looks, SAMPLES[0], SAMPLES[1])?;
        match part(self.photons, fewest, self.photons.max(PATHS[1])) {
            Some(paths) => Some([paths, looks]),
            None => is_little.then_some([fewest, looks.min(fewest / PATHS_PER_SAMPLE)]),
        }
    }

    /// Camera paths over the whole picture: the points they reach, weighed by
    /// how errors there are seen.
    fn look(&self, map: &PhotonMap, light: Sequence, ways: Sequence, samples: u64) -> Vec<Photon> {
        let [width, height] = self.resolution.map(f64::from);
        let gather = Gather {
            map: Some(map),
            ..self.gather
        };
        let beam = beam(self.camera, self.resolution, samples);
        let looks: Vec<(DVec2, f64, Reached)> = (0..samples)
            .into_par_iter()
            .map(|i| {
                let stream = light.at(i);
                let [u, v] = coordinates::film(&stream);
                let [u, v] = [u, v].map(|x| x + MARGIN * (2.0 * x - 1.0));
                let film = DVec2::new(u * width, v * height);
                let ray = self.camera.ray(film);
                let found = gather.sample(
                    ray,
                    &stream,
                    &mut gather.vicinity(),
                    &mut CameraTally::default(),
                );
                let reached = reach(&gather.ctx, ray, beam, &mut ways.at(i));
                (film, found.total().mean(), reached)
            })
            .collect();
        let mut blocks = Blocks::new(self.resolution, samples);
        for (film, light, _) in &looks {
            blocks.add(*film, *light);
        }
        let sight = blocks.sight();
        let weigh = |(film, _, reached): &(DVec2, f64, Reached)| {
            let weight = sight(*film);
            reached.map(|point| {
                point.map(|p| Photon {
                    flux: p.flux * weight,
                    ..p
                })
            })
        };
        looks.iter().flat_map(weigh).flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No path is traced twice, whatever their number from epoch to epoch, and
    /// passes stay aligned with their number.
    #[test]
    fn paths_of_stages_follow_each_other() {
        let text = "(camera: (eye: (0, -3, 2), look_at: (0, 0, 0), fov: 40),
          image: (width: 8, height: 8),
          objects: [
            (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
            (shape: Sphere(center: (0, 0, 1), radius: 0.5), material: Dielectric(ior: 1.5)),
          ],
          lights: [Point(position: (0, 1, 4), power: 1)])";
        let scene = crate::scene::load_str(text, "test.ron", std::path::Path::new(""));
        let scene = scene.expect("a scene");
        let settings = &scene.settings;
        let renderer = crate::render::Renderer::new(&scene, settings, [8, 8], [0, 0, 8, 8]);
        let emitter = renderer.emitter().expect("a caster");
        let mut stage = Stage::new(emitter.clone(), 1 << 12, Refinement::none());
        let mut end = 0;
        for (e, photons) in [1 << 14, 1 << 12, 1 << 16, 3000, 3000, 1 << 13]
            .into_iter()
            .enumerate()
        {
            if e > 0 {
                stage = stage.next(e, emitter.clone(), photons, Refinement::none());
            }
            for round in first_round(e)..first_round(e + 1) {
                let first = stage.first_path(round);
                assert!(first >= end, "epoch {e}: {first} before {end}");
                assert!(first.is_multiple_of(stage.photons), "epoch {e}");
                end = first + stage.photons;
            }
        }
    }

    /// An epoch begins with a round that is a power of two, and what was spent
    /// on pilots by then is the allowed part of the passes before (of the first
    /// round, for the first).
    #[test]
    fn pilots_cost_a_part_of_the_passes_before() {
        let mut spent = 0.0;
        for e in 0..EPOCHS {
            spent += passes(e);
            let first = first_round(e);
            assert_eq!(epoch(first), e);
            assert_eq!(epoch((1 << (e + 1)) - 1), e, "until the next power of two");
            let before = f64::from(first.max(1) * REPLICATES);
            assert!((spent - SHARE * before).abs() < 1e-9, "epoch {e}: {spent}");
        }
        assert_eq!(epoch(u32::MAX), EPOCHS - 1);
    }
}

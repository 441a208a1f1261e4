//! What a render learns on the way: where photons are needed, how many of them
//! against how many camera samples, and which lights matter.
//!
//! Everything here is a function of scene, settings, seed and epoch.

use rayon::prelude::*;

use crate::{
    film::Layer,
    photon::{Emitter, PhotonMap, shoot},
    sampling::{Purpose, Sequence},
    scene::Guidance,
};

use super::{
    Renderer,
    camera_walk::Gather,
    memory::{FEWEST_PHOTONS, photon_budget},
    pass::NATURAL_SCALE,
    pilot::{self, Epochs, Pilot, Stage, epoch},
    refine::Refinement,
    share::{Probe, Survey},
    tally::CameraTally,
};

/// Most photon paths that the program chooses, in all and for each pixel: more
/// passes with fewer photons serve as well and see more of the camera's side.
const MOST_PHOTONS: u64 = 1 << 23;
const PHOTONS_PER_PIXEL: u64 = 8;

/// Photon paths of each of the pilot's two sets, and pixels it looks at.
pub(super) const PILOT_PHOTONS: u64 = 1 << 12;
const PILOT_PIXELS: u64 = 1 << 10;

/// What is known of photons and camera samples before an epoch's passes.
pub(super) struct Weighed {
    pub(super) survey: Survey,
    /// One of the pilot's sets of photons.
    pub(super) map: PhotonMap,
}

impl Renderer<'_> {
    /// How the passes of a round spend their work; `None` without photons.
    /// Pilots run when a round that needs them is asked for.
    pub(super) fn stage_of(&self, round: u32) -> Option<&Stage> {
        let epochs = self.epochs.as_ref()?;
        Some(match self.settings.guidance {
            Guidance::Learned => {
                epochs.at(epoch(round), &|epoch, before| self.learn(epoch, before))
            }
            Guidance::Power => epochs.first(),
        })
    }

    /// The epochs of a render that starts with an emitter.
    pub(super) fn untaught(&self, emitter: Emitter) -> Epochs {
        let weighed = self.weigh(&emitter, None);
        let photons = self.photon_paths(&weighed.survey, None);
        let is_taught =
            self.settings.guidance == Guidance::Learned && self.pilot(photons).size(0).is_some();
        // The first epoch finds its own.
        let refinement = if is_taught {
            Refinement::none()
        } else {
            self.find_refinement(Some((&weighed, photons)), None)
        };
        Epochs::new(Stage::new(emitter, photons, refinement))
    }

    /// The stage of an epoch; `None` where its pilots would be too small to
    /// learn from.
    fn learn(&self, epoch: usize, before: &Stage) -> Option<Stage> {
        let pilot = self.pilot(before.photons);
        pilot.size(epoch)?;
        let taught = pilot.teach(epoch, &before.emitter);
        // Where nothing was taught, the first number of photons stands.
        let is_new = taught.is_some() || epoch > 0;
        let emitter = taught.unwrap_or_else(|| before.emitter.clone());
        let weighed = self.weigh(&emitter, Some(epoch));
        let photons = if is_new {
            self.photon_paths(&weighed.survey, Some(before.photons))
        } else {
            before.photons
        };
        let refinement = self.find_refinement(Some((&weighed, photons)), Some(epoch));
        Some(before.next(epoch, emitter, photons, refinement))
    }

    fn pilot(&self, photons: u64) -> Pilot<'_> {
        Pilot {
            gather: self.scout(None, 0),
            camera: &self.camera,
            resolution: self.resolution,
            seed: self.settings.seed,
            photons,
            shrink: self.schedule.scale(0) / NATURAL_SCALE,
        }
    }

    /// Most photon paths of a pass that the program chooses: as many as the
    /// memory budget holds.
    pub(super) fn most_photons(&self) -> u64 {
        let pixels = u64::from(self.resolution[0]) * u64::from(self.resolution[1]);
        let most = (pixels * PHOTONS_PER_PIXEL)
            .next_power_of_two()
            .clamp(FEWEST_PHOTONS, MOST_PHOTONS);
        // A job that was checked has room for a few; one that was not gets them.
        let size = [self.crop[2], self.crop[3]];
        let room = photon_budget(size, self.settings.memory).unwrap_or(FEWEST_PHOTONS);
        self.settings.photons.unwrap_or(most).clamp(1, room)
    }

    /// Photon paths of a pass: what the user says, or the power of two with
    /// the least error for its work by a pilot; never more than the memory
    /// budget holds. `before` is the number that there were before the epoch.
    fn photon_paths(&self, survey: &Survey, before: Option<u64>) -> u64 {
        let most = self.most_photons();
        if self.settings.photons.is_some() {
            return most;
        }
        // Of powers of two: a budget may be any number.
        let last = (most.next_power_of_two()).max(FEWEST_PHOTONS);
        survey.best_paths(FEWEST_PHOTONS, last, before).min(most)
    }

    /// The pilot: two camera samples in each of some pixels of the whole picture,
    /// so that a crop is a window of it, with two independent sets of photons.
    fn weigh(&self, emitter: &Emitter, epoch: Option<usize>) -> Weighed {
        let (round, number) = (pilot::round(epoch), pilot::sequence(epoch));
        let pilot =
            |k: u32, item| Sequence::new(self.settings.seed, Purpose::Pilot, number + k, item);
        let maps = [0, 1].map(|k| {
            let shot = shoot(&self.called_for(), emitter, pilot(k, 0), 0, PILOT_PHOTONS);
            self.map(&shot, round)
        });
        let gathers: [Gather<'_>; 2] = [0, 1].map(|k| self.scout(Some(&maps[k]), round));
        let pixels = pilot(2, 0);
        let [width, height] = self.resolution;
        let probe = |i: u64| {
            let [u, v] = pixels.at(i).next_2d();
            let [px, py] = [f64::from(width) * u, f64::from(height) * v].map(|x| x as u32);
            let mut tally = CameraTally::default();
            let mut look = |sample: u64, set: usize| {
                let stream = pilot(3, i).at(sample);
                let ray = self.ray(px, py, &stream);
                let found =
                    gathers[set].sample(ray, &stream, &mut gathers[set].vicinity(), &mut tally);
                // Where sources shine, neither photons nor shares matter.
                (found.total() - found[Layer::Emission]).mean()
            };
            let probe = Probe {
                first: [look(0, 0), look(0, 1)],
                second: look(1, 1),
            };
            (probe, tally)
        };
        let found: Vec<(Probe, CameraTally)> =
            (0..PILOT_PIXELS).into_par_iter().map(probe).collect();
        let (probes, tallies): (Vec<Probe>, Vec<CameraTally>) = found.into_iter().unzip();
        let mut tally = CameraTally::default();
        for t in tallies {
            tally += t;
        }
        let work = tally.work(3 * PILOT_PIXELS);
        let all = u64::from(width) * u64::from(height);
        let [map, _] = maps;
        Weighed {
            survey: Survey::new(&probes, PILOT_PHOTONS, work, all),
            map,
        }
    }
}

//! One pass: photons, map, camera samples. A pure function of the scene, the
//! settings, the seed and the pass index.

use rayon::prelude::*;

use crate::{
    film::{Layer, PixelSample},
    photon::{Emitter, PhotonMap, Shot, Tally, shoot},
    plan::Plan,
    sampling::{Purpose, Sequence},
    scene::{Choice, Effect, Guidance, Kernel, Sampler, Scene, Settings},
    transport::{Context, LightPicker},
};

use super::{
    camera_walk::Gather,
    memory::{FEWEST_PHOTONS, photon_budget},
    pilot::{Epochs, Pilot, epoch},
    refine::Refinement,
    schedule::{REPLICATES, Schedule},
    share::{Probe, Survey},
    tally::CameraTally,
};

/// Most photon paths that the program chooses, in all and for each pixel: more
/// passes with fewer photons serve as well and see more of the camera's side.
const MOST_PHOTONS: u64 = 1 << 23;
const PHOTONS_PER_PIXEL: u64 = 8;

/// Kernel scale of the first round, in pixel footprints, at which photons have
/// kernels of their own footprint's size.
const NATURAL_SCALE: f64 = 2.0;

/// Photon paths of each of the pilot's two sets, and pixels it looks at.
pub(super) const PILOT_PHOTONS: u64 = 1 << 12;
const PILOT_PIXELS: u64 = 1 << 10;

/// Everything that passes of one render share.
pub struct Renderer<'a> {
    pub(super) scene: &'a Scene,
    pub(super) settings: Settings,
    plan: Plan,
    forced: Option<Forced>,
    picker: LightPicker,
    emitters: Option<Epochs>,
    schedule: Schedule,
    pub(super) resolution: [u32; 2],
    pub(super) camera: crate::camera::Camera,
    pub(super) crop: [u32; 4],
    pub(super) photons: u64,
    /// Per pixel of the window and around it: whether sources may glint there;
    /// nothing where none can.
    pub(super) glinting: Vec<bool>,
    pub(super) refinement: Refinement,
}

/// What runs although it is in vain, because the user says so. What is decided
/// about the work is decided without it, so that it changes no bit.
struct Forced {
    plan: Plan,
    emitter: Option<Emitter>,
}

/// What a pass delivers.
#[derive(Debug)]
pub struct PassOutput {
    /// Samples of the crop, row by row.
    pub samples: Vec<PixelSample>,
    /// Photon paths emitted.
    pub emitted: u64,
    /// Photons stored.
    pub stored: u64,
    /// Photons refused for not being finite.
    pub refused: u64,
    /// Where the photons' flux went.
    pub tally: Tally,
    /// Camera paths ended by the depth limit.
    pub truncated: u64,
    /// Questions asked of the photon map.
    pub queries: u64,
    /// Candidates that trees offered to answer them.
    pub visited: u64,
    /// Kernels evaluated for it.
    pub tested: u64,
    /// Photons whose kernels reached the point asked for.
    pub accepted: u64,
}

impl<'a> Renderer<'a> {
    /// Prepares a render of the window `crop` (x, y, width, height in pixels)
    /// of a picture of the given resolution.
    pub fn new(
        scene: &'a Scene,
        settings: &Settings,
        resolution: [u32; 2],
        crop: [u32; 4],
    ) -> Self {
        let plan = Plan::new(scene, settings);
        let picker = LightPicker::new(scene);
        let ctx = Context {
            scene,
            plan: &plan,
            picker: &picker,
            max_depth: settings.max_depth,
        };
        let emitter = match settings.guidance {
            Guidance::Learned => Emitter::new(&ctx),
            Guidance::Power => Emitter::by_power(&ctx),
        };
        let emitters = emitter.map(Epochs::new);
        let forced = plan.forced(scene, settings).map(|plan| {
            let ctx = Context { plan: &plan, ..ctx };
            let wanted = settings.choice(Effect::Caustics) == Choice::On;
            let emitter = wanted.then(|| Emitter::in_vain(&ctx)).flatten();
            Forced { plan, emitter }
        });
        let mut renderer = Self {
            scene,
            settings: settings.clone(),
            forced,
            picker,
            emitters,
            schedule: Schedule::new(settings.radius),
            resolution,
            camera: scene.camera.with_resolution(resolution),
            crop,
            photons: 0,
            glinting: Vec::new(),
            refinement: Refinement::none(),
            plan,
        };
        renderer.glinting = renderer.find_glints();
        if renderer.emitters.is_some() {
            renderer.photons = renderer.photon_paths();
        }
        renderer.refinement = renderer.find_refinement();
        renderer
    }

    /// What is simulated.
    pub fn plan(&self) -> &Plan {
        self.forced.as_ref().map_or(&self.plan, |f| &f.plan)
    }

    /// How photons are launched before anything is learned about the picture;
    /// `None` where there are none.
    pub fn emitter(&self) -> Option<&Emitter> {
        self.emitters.as_ref().map(Epochs::first)
    }

    /// How the photons of a round are launched. Pilots teach the emitter where
    /// photons are needed; they run when a round that needs them is asked for.
    pub fn emitter_of(&self, round: u32) -> Option<&Emitter> {
        let emitters = self.emitters.as_ref()?;
        if self.settings.guidance == Guidance::Power {
            return Some(emitters.first());
        }
        let pilot = Pilot {
            // Whichever round of an epoch asks first.
            gather: self.scout(None),
            camera: &self.camera,
            resolution: self.resolution,
            seed: self.settings.seed,
            photons: self.photons,
            shrink: self.schedule.scale(0) / NATURAL_SCALE,
        };
        Some(emitters.at(epoch(round), &|e, before| pilot.teach(e, before)))
    }

    /// Photon paths of a pass.
    pub fn photons(&self) -> u64 {
        self.photons
    }

    /// Kernel radius of a round, in pixel footprints.
    pub fn scale(&self, round: u32) -> f64 {
        self.schedule.scale(round)
    }

    /// What paths of this render may look at.
    pub fn context(&self) -> Context<'_> {
        Context {
            plan: self.plan(),
            ..self.called_for()
        }
    }

    /// The same without what is forced: what pilots look at.
    pub(super) fn called_for(&self) -> Context<'_> {
        Context {
            scene: self.scene,
            plan: &self.plan,
            picker: &self.picker,
            max_depth: self.settings.max_depth,
        }
    }

    /// Runs pass `index`.
    pub fn pass(&self, index: u32) -> PassOutput {
        let (round, replicate) = (index / REPLICATES, index % REPLICATES);
        let shot = self.shoot(round, replicate);
        let map = (shot.emitted > 0).then(|| self.map(&shot, round));
        let stored = shot.photons.len() as u64;
        drop(shot.photons);
        let gather = self.gatherer(map.as_ref(), round);
        let (samples, camera) = self.gather(&gather, round, replicate);
        PassOutput {
            samples,
            emitted: shot.emitted,
            stored,
            refused: map.as_ref().map_or(0, PhotonMap::refused),
            tally: shot.tally,
            truncated: camera.truncated,
            queries: camera.queries,
            visited: camera.visited,
            tested: camera.tested,
            accepted: camera.accepted,
        }
    }

    /// The map of a round's photons.
    pub fn map(&self, shot: &Shot, round: u32) -> PhotonMap {
        PhotonMap::new(
            &shot.photons,
            shot.emitted,
            self.schedule.scale(round) / NATURAL_SCALE,
        )
    }

    /// The photon half of a pass.
    pub fn shoot(&self, round: u32, replicate: u32) -> Shot {
        let sequence = |k| self.sequence(Purpose::Photon, replicate, k);
        let ctx = self.context();
        let mut shot = match self.emitter_of(round) {
            Some(emitter) => {
                let first = u64::from(round) * self.photons;
                shoot(&ctx, emitter, sequence(0), first, self.photons)
            }
            None => Shot {
                tally: Tally::new(self.scene.lights.len()),
                ..Shot::default()
            },
        };
        if let Some(emitter) = self.forced.as_ref().and_then(|f| f.emitter.as_ref()) {
            let first = u64::from(round) * FEWEST_PHOTONS;
            let vain = shoot(&ctx, emitter, sequence(1), first, FEWEST_PHOTONS);
            shot.join(&vain);
        }
        if self.settings.kernel == Kernel::Circle {
            for photon in &mut shot.photons {
                photon.footprint = None;
            }
        }
        shot
    }

    /// The points of a purpose, replicate and item by the sampler that is
    /// asked for. Pilots have their own.
    pub(super) fn sequence(&self, purpose: Purpose, replicate: u32, item: u64) -> Sequence {
        let sequence = Sequence::new(self.settings.seed, purpose, replicate, item);
        match self.settings.sampler {
            Sampler::Sobol => sequence,
            Sampler::Independent => sequence.independent(),
        }
    }

    /// Photon paths of a pass: what the user says, or the power of two with
    /// the least error for its work by a pilot; never more than the memory
    /// budget holds. The pilot looks at the whole picture, so that a crop is
    /// a window of it.
    fn photon_paths(&self) -> u64 {
        let wanted = self.settings.photons.unwrap_or_else(|| {
            self.emitter().map_or(FEWEST_PHOTONS, |emitter| {
                let pixels = u64::from(self.resolution[0]) * u64::from(self.resolution[1]);
                let most = (pixels * PHOTONS_PER_PIXEL)
                    .next_power_of_two()
                    .clamp(FEWEST_PHOTONS, MOST_PHOTONS);
                self.survey(emitter).best_paths(FEWEST_PHOTONS, most)
            })
        });
        // A job that was checked has room for a few; one that was not gets them.
        let size = [self.crop[2], self.crop[3]];
        let room = photon_budget(size, self.settings.memory).unwrap_or(FEWEST_PHOTONS);
        wanted.clamp(1, room)
    }

    /// The pilot: two camera samples in each of some pixels, with two
    /// independent sets of photons.
    fn survey(&self, emitter: &Emitter) -> Survey {
        let seed = self.settings.seed;
        let maps = [2, 3].map(|replicate| {
            let photons = Sequence::new(seed, Purpose::Pilot, replicate, 0);
            let shot = shoot(&self.called_for(), emitter, photons, 0, PILOT_PHOTONS);
            self.map(&shot, 0)
        });
        let gathers = [0, 1].map(|k| self.scout(Some(&maps[k])));
        let pixels = Sequence::new(seed, Purpose::Pilot, 4, 0);
        let [width, height] = self.resolution;
        let probe = |i: u64| {
            let [u, v] = pixels.at(i).next_2d();
            let [px, py] = [f64::from(width) * u, f64::from(height) * v].map(|x| x as u32);
            let mut tally = CameraTally::default();
            let mut look = |sample: u64, set: usize| {
                let stream = Sequence::new(seed, Purpose::Pilot, 5, i).at(sample);
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
        Survey::new(&probes, PILOT_PHOTONS, work, all)
    }

    /// What camera samples of a pilot may ask.
    pub(super) fn scout<'b>(&'b self, map: Option<&'b PhotonMap>) -> Gather<'b> {
        Gather {
            ctx: self.called_for(),
            ..self.gatherer(map, 0)
        }
    }

    /// What camera samples of a round may ask.
    pub(super) fn gatherer<'b>(&'b self, map: Option<&'b PhotonMap>, round: u32) -> Gather<'b> {
        Gather {
            ctx: self.context(),
            map,
            scale: self.schedule.scale(round),
            footprint: self.camera.pixel_footprint(),
        }
    }
}

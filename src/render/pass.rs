//! One pass: photons, map, camera samples. A pure function of the scene, the
//! settings, the seed and the pass index.

use std::sync::OnceLock;

use crate::{
    film::{PixelSample, blur_weight},
    photon::{Emitter, PhotonMap, Shot, Tally, shoot_for},
    plan::Plan,
    sampling::{Purpose, Sequence},
    scene::{Choice, Effect, Guidance, Sampler, Scene, Settings},
    transport::{Context, LightPicker},
};

use super::{
    bounce::Bounces,
    camera_walk::Gather,
    glints::Glinting,
    memory::FEWEST_PHOTONS,
    pilot::Epochs,
    refine::Refinement,
    schedule::{REPLICATES, Schedule},
};

/// Kernel scale of the first round, in pixel footprints, at which photons have
/// kernels of their own footprint's size.
pub(super) const NATURAL_SCALE: f64 = 2.0;

/// Everything that passes of one render share.
pub struct Renderer<'a> {
    pub(super) scene: &'a Scene,
    pub(super) settings: Settings,
    plan: Plan,
    forced: Option<Forced>,
    picker: LightPicker,
    pub(super) epochs: Option<Epochs>,
    pub(super) schedule: Schedule,
    pub(super) resolution: [u32; 2],
    pub(super) camera: crate::camera::Camera,
    pub(super) crop: [u32; 4],
    /// Where sources may glint, after a first look and after a closer one.
    pub(super) glinting: [OnceLock<Glinting>; 2],
    /// How camera paths go on from their first diffuse surface.
    bounces: Bounces,
    /// Where further samples pay if there are no photons.
    refinement: Refinement,
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
            epochs: None,
            schedule: Schedule::new(settings.radius),
            resolution,
            camera: scene.camera.with_resolution(resolution),
            crop,
            glinting: Default::default(),
            refinement: Refinement::none(),
            bounces: Bounces::EVEN,
            plan,
        };
        // Whoever asks next may do so from many threads.
        renderer.glinting(0);
        if settings.guidance == Guidance::Learned {
            renderer.picker = renderer.picker_by_need();
        }
        renderer.bounces = renderer.find_bounces(emitter.as_ref());
        match emitter {
            Some(emitter) => renderer.epochs = Some(renderer.untaught(emitter)),
            None => renderer.refinement = renderer.find_refinement(None, None),
        }
        renderer
    }

    /// What is simulated.
    pub fn plan(&self) -> &Plan {
        self.forced.as_ref().map_or(&self.plan, |f| &f.plan)
    }

    /// How photons are launched before anything is learned about the picture;
    /// `None` where there are none.
    pub fn emitter(&self) -> Option<&Emitter> {
        self.epochs.as_ref().map(|epochs| &epochs.first().emitter)
    }

    /// How the photons of a round are launched. Pilots teach the emitter where
    /// photons are needed; they run when a round that needs them is asked for.
    pub fn emitter_of(&self, round: u32) -> Option<&Emitter> {
        self.stage_of(round).map(|stage| &stage.emitter)
    }

    /// Photon paths of a pass of the first round. Later rounds may have others;
    /// see [`photons_of`](Self::photons_of).
    pub fn photons(&self) -> u64 {
        self.photons_of(0)
    }

    /// Photon paths of a pass of a round; 0 where there are none.
    pub fn photons_of(&self, round: u32) -> u64 {
        self.stage_of(round).map_or(0, |stage| stage.photons)
    }

    /// Where further camera samples of a round pay.
    pub(super) fn refinement_of(&self, round: u32) -> &Refinement {
        self.stage_of(round)
            .map_or(&self.refinement, |stage| &stage.refinement)
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
        let gather = Gather {
            draws_in: blur_weight(index) > 0.0,
            ..self.gatherer(map.as_ref(), round)
        };
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
        let (ctx, kernel) = (self.context(), self.settings.kernel);
        let mut shot = match self.stage_of(round) {
            Some(stage) => {
                let first = stage.first_path(round);
                shoot_for(
                    kernel,
                    &ctx,
                    &stage.emitter,
                    sequence(0),
                    first,
                    stage.photons,
                )
            }
            None => Shot {
                tally: Tally::new(self.scene.lights.len()),
                ..Shot::default()
            },
        };
        if let Some(emitter) = self.forced.as_ref().and_then(|f| f.emitter.as_ref()) {
            let first = u64::from(round) * FEWEST_PHOTONS;
            let vain = shoot_for(kernel, &ctx, emitter, sequence(1), first, FEWEST_PHOTONS);
            shot.join(&vain);
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

    /// What camera samples of a pilot may ask, with the kernels of a round.
    pub(super) fn scout<'b>(&'b self, map: Option<&'b PhotonMap>, round: u32) -> Gather<'b> {
        Gather {
            ctx: self.called_for(),
            ..self.gatherer(map, round)
        }
    }

    /// What camera samples of a round may ask.
    pub(super) fn gatherer<'b>(&'b self, map: Option<&'b PhotonMap>, round: u32) -> Gather<'b> {
        Gather {
            ctx: self.context(),
            map,
            scale: self.schedule.scale(round),
            footprint: self.camera.pixel_footprint(),
            draws_in: false,
            bounces: &self.bounces,
        }
    }
}

//! Where the photons of each light end that are sent to each object.

use serde::Serialize;

use crate::{
    geometry::{BoundingSphere, Ray},
    photon::{Story, Trial},
    plan::Plan,
    render::Renderer,
    scene::{Choice, Effect, Scene, Settings},
};

use super::{MOST_FUNNELS, light::quantile, reason, sequence};

/// Photon paths of the trial, and camera samples that say what is seen.
pub(super) const PATHS: u64 = 1 << 16;
const SAMPLES: u64 = 1 << 12;

/// Numbers of the sequences, behind those of the look.
const PHOTONS: u32 = 16;
const EYE: u32 = 17;

/// What became of the photons of a light that were sent to an object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Funnel {
    /// Name of the light.
    pub light: String,
    /// Name of the object.
    pub object: String,
    /// Paths sent towards the sphere around the object.
    pub aimed: u64,
    /// Of these, paths that the object was the first to reflect or bend.
    pub met: u64,
    /// Of these, paths that ended on a diffuse surface.
    pub landed: u64,
    /// Of these, paths that landed where the camera looks.
    pub seen: u64,
    /// Why there is no caustic, at the step where it is lost; `None` if there
    /// is one.
    pub reason: Option<String>,
}

/// What the trial has shown.
#[derive(Clone, Debug, Default)]
pub(super) struct TrialReport {
    pub(super) funnels: Vec<Funnel>,
    /// Pairs that are not told about.
    pub(super) more: usize,
    /// Part of the paths bent that reach the depth limit.
    pub(super) reached: f64,
    /// Part of the flux seen that the depth limit takes.
    pub(super) cut: f64,
    /// The limit that few would reach.
    pub(super) depth_needed: u32,
}

/// What became of a path, in the words of the funnel.
pub(super) struct Tale<'a> {
    pub(super) story: &'a Story,
    /// Whether it landed before the depth limit asked for, and is seen.
    pub(super) landed: bool,
    pub(super) seen: bool,
}

/// Sends photons to all casters of the plan and follows them.
pub(super) fn trial(scene: &Scene, renderer: &Renderer<'_>, asked: &Settings) -> TrialReport {
    let plan = renderer.plan();
    let mut report = TrialReport::default();
    let trial = renderer.emitter().map_or_else(Trial::default, |emitter| {
        let photons = sequence(asked.seed, PHOTONS);
        Trial::new(&renderer.context(), emitter, photons, PATHS)
    });
    let eye = renderer.seen(sequence(asked.seed, EYE), SAMPLES);
    let tales: Vec<Tale<'_>> = trial
        .stories
        .iter()
        .map(|story| {
            let photon = trial.photons[story.photons.clone()]
                .iter()
                .find(|p| !p.bounced);
            Tale {
                story,
                landed: photon.is_some(),
                seen: photon.is_some_and(|p| eye.sees(p)),
            }
        })
        .collect();
    depths(&trial, &tales, asked, &mut report);
    let pairs = scene.lights.len() * plan.casters.len();
    report.more = pairs.saturating_sub(MOST_FUNNELS);
    let pairs = (0..scene.lights.len()).flat_map(|l| plan.casters.iter().map(move |&c| (l, c)));
    let by_light: Vec<Vec<&Tale<'_>>> = {
        let mut by_light = vec![Vec::new(); scene.lights.len()];
        for tale in &tales {
            by_light[tale.story.light as usize].push(tale);
        }
        by_light
    };
    for (light, caster) in pairs.take(MOST_FUNNELS) {
        let funnel = funnel(scene, plan, asked, light, caster, &by_light[light]);
        report.funnels.push(funnel);
    }
    report
}

/// How deep the paths go.
fn depths(trial: &Trial, tales: &[Tale<'_>], asked: &Settings, report: &mut TrialReport) {
    let mut depths: Vec<u32> = Vec::new();
    let (mut all, mut cut) = (0.0, 0.0);
    for tale in tales.iter().filter(|t| t.story.caster.is_some()) {
        // A photon that lands may meet one surface more than it is bent at.
        let steps = tale.story.surfaces.saturating_sub(1);
        depths.push(steps);
        if tale.seen {
            let flux: f64 = trial.photons[tale.story.photons.clone()]
                .iter()
                .map(|p| p.flux.mean())
                .sum();
            all += flux;
            if steps > asked.max_depth {
                cut += flux;
            }
        }
    }
    depths.sort_unstable();
    if all > 0.0 {
        report.cut = cut / all;
    }
    let over = depths.iter().filter(|&&d| d > asked.max_depth).count();
    report.reached = over as f64 / depths.len().max(1) as f64;
    report.depth_needed = quantile(&depths);
}

fn funnel(
    scene: &Scene,
    plan: &Plan,
    asked: &Settings,
    light: usize,
    caster: u32,
    tales: &[&Tale<'_>],
) -> Funnel {
    let sphere = scene.world.instance_sphere(caster);
    let is_aimed = |t: &&&Tale<'_>| {
        let ray = &t.story.ray;
        t.story.ledger.launched > 0.0 && sphere.is_none_or(|s| meets(ray, &s))
    };
    let is_met = |t: &&&Tale<'_>| t.story.caster.is_some_and(|c| c.instance == caster);
    let aimed: Vec<&Tale<'_>> = if plan.lit[light].contains(caster) {
        tales.iter().filter(is_aimed).copied().collect()
    } else {
        Vec::new()
    };
    let met: Vec<&Tale<'_>> = aimed.iter().filter(is_met).copied().collect();
    let within = |t: &Tale<'_>| t.story.surfaces <= asked.max_depth + 1;
    let landed: Vec<&Tale<'_>> = met
        .iter()
        .copied()
        .filter(|t| t.landed && within(t))
        .collect();
    let seen = landed.iter().filter(|t| t.seen).count() as u64;
    let off = asked.choice(Effect::Caustics) == Choice::Off;
    let reason = if off {
        Some("caustics are switched off".to_owned())
    } else if !plan.lit[light].contains(caster) {
        Plan::obstacle(scene, light, caster).map(|o| o.words(scene, light, caster))
    } else if met.is_empty() {
        Some(reason::not_met(scene, light, caster, &aimed))
    } else if landed.is_empty() {
        Some(reason::not_landed(
            scene,
            light,
            caster,
            &met,
            asked.max_depth,
        ))
    } else if seen == 0 {
        Some(reason::not_seen(scene, caster, &landed))
    } else {
        None
    };
    Funnel {
        light: scene.lights[light].name.clone(),
        object: scene.objects[caster as usize].name.clone(),
        aimed: aimed.len() as u64,
        met: met.len() as u64,
        landed: landed.len() as u64,
        seen,
        reason,
    }
}

/// Whether a ray meets a sphere.
fn meets(ray: &Ray, sphere: &BoundingSphere) -> bool {
    let to = sphere.center - ray.origin;
    let along = to.dot(ray.dir).max(0.0);
    (to - ray.dir * along).length_squared() <= sphere.radius * sphere.radius
}

//! The survey: a short look at a scene before it is rendered. What each effect
//! brings and costs, where the photons of each light end, and what is left out.
//!
//! Everything here is measured by samples and deterministic: a function of
//! scene, settings, resolution and seed. It tells, and decides nothing: what is
//! simulated is proved by `plan`. Work is counted in rays cast, by the weights
//! by which a pass shares its work, never by the clock.

mod funnel;
mod light;
mod reason;

use serde::{Serialize, Serializer};

use crate::{
    plan::{By, judge},
    render::Renderer,
    sampling::{Purpose, Sequence},
    scene::{Choice, Choices, Effect, Scene, Settings},
};

pub use funnel::Funnel;

/// Depth limit of the survey, if the scene's is not larger: what lies beyond a
/// small limit is to be seen.
const DEEP: u32 = 256;

/// Most pairs of light and object whose photons are told about.
pub const MOST_FUNNELS: usize = 256;

/// Share of the light from which on a depth limit is worth a word.
const WORTH_A_WORD: f64 = 1e-3;

/// Number of the survey's first sequence among those of pilots.
const FIRST_SEQUENCE: u32 = 256;

/// What is known of an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectReport {
    /// The effect.
    #[serde(serialize_with = "name")]
    pub effect: Effect,
    /// Whether it is simulated.
    pub on: bool,
    /// Whether the scene or the user has decided.
    pub by_user: bool,
    /// Why.
    pub why: String,
    /// Share of the picture's light, nothing left out, of effects that divide
    /// it among them; `None` of those that light only passes by.
    pub light: Option<Measured>,
    /// Share of the picture's light that the eye sees by way of it, of effects
    /// that light passes by.
    pub seen_through: Option<Measured>,
    /// Share of the work of a pass with one sample a pixel.
    pub work: Option<f64>,
    /// What leaving it out changes.
    pub without: String,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a reference"
)]
fn name<S: Serializer>(effect: &Effect, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(effect.name())
}

/// A share and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measured {
    /// The share.
    pub share: f64,
    /// Its standard error, from the spread of eight replicates.
    pub error: f64,
}

/// Something that the user leaves out although there is light in it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Omission {
    /// What, and what to do about it.
    pub what: String,
    /// Share of the picture's light, nothing left out.
    pub light: f64,
}

/// What the survey has found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Survey {
    /// Width and height of the picture in pixels.
    pub resolution: [u32; 2],
    /// Photon paths of a pass.
    pub photons_per_pass: u64,
    /// All effects.
    pub effects: Vec<EffectReport>,
    /// Share of the work that every picture needs: the ways from the eye.
    pub view_work: f64,
    /// Lights and objects that can cast caustics.
    pub funnels: Vec<Funnel>,
    /// Pairs of them that are not told about.
    pub more_funnels: usize,
    /// What is left out.
    pub left_out: Vec<Omission>,
}

impl Survey {
    /// Surveys a scene as it would be rendered with `settings` at a resolution.
    pub fn of(scene: &Scene, settings: &Settings, resolution: [u32; 2]) -> Self {
        // Nothing left out, nothing forced.
        let full = Settings {
            indirect: true,
            effects: Choices::default(),
            max_depth: settings.max_depth.max(DEEP),
            ..settings.clone()
        };
        let renderer = Renderer::new(scene, &full, resolution, [0, 0, 1, 1]);
        let found = light::Look::at(&renderer, settings);
        let trial = funnel::trial(scene, &renderer, settings);
        let left_out = left_out(settings, &found, &trial);
        let work = found.work(settings);
        let effects = judge(scene, settings)
            .into_iter()
            .map(|v| {
                let light = found.light(v.effect);
                let seen_through = found.seen_through(v.effect);
                EffectReport {
                    effect: v.effect,
                    on: v.on,
                    by_user: v.by == By::User,
                    why: v.why,
                    light,
                    seen_through,
                    work: if v.on { work.of(v.effect) } else { None },
                    without: if v.called_for {
                        without(v.effect, light.or(seen_through))
                    } else {
                        "nothing".to_owned()
                    },
                }
            })
            .collect();
        Self {
            resolution,
            photons_per_pass: renderer.photons(),
            effects,
            view_work: work.view,
            funnels: trial.funnels,
            more_funnels: trial.more,
            left_out,
        }
    }

    /// Share of the picture's light that is left out.
    pub fn share_left_out(&self) -> f64 {
        self.left_out.iter().map(|o| o.light).sum()
    }
}

/// A sequence of the survey's.
fn sequence(settings_seed: u64, number: u32) -> Sequence {
    Sequence::new(settings_seed, Purpose::Pilot, FIRST_SEQUENCE + number, 0)
}

/// What the settings leave out, by what was found with nothing left out.
fn left_out(
    settings: &Settings,
    found: &light::Look,
    trial: &funnel::TrialReport,
) -> Vec<Omission> {
    let mut list = Vec::new();
    for effect in Effect::ALL {
        if settings.choice(effect) != Choice::Off {
            continue;
        }
        if let Some(light) = found.light(effect)
            && light.share > 0.0
        {
            list.push(Omission {
                what: format!("{} are switched off", plural(effect)),
                light: light.share,
            });
        }
    }
    let is_in = |e: Effect| settings.choice(e) != Choice::Off;
    let caustic = found.light(Effect::Caustics).map_or(0.0, |m| m.share);
    let beyond = if is_in(Effect::Caustics) {
        caustic * trial.cut
    } else {
        0.0
    } + found.beyond_depth;
    if beyond >= WORTH_A_WORD {
        let limit = settings.max_depth;
        let deepest = trial.depth_needed.max(found.depth_needed);
        list.push(Omission {
            what: format!(
                "the depth limit {limit} is reached by {} of the photons and {} of the ways \
                 from the eye: {}",
                percent(trial.reached),
                percent(found.reached),
                raise(deepest),
            ),
            light: beyond,
        });
    }
    list
}

/// What to do about a depth limit where few paths are longer than `needed`.
fn raise(needed: u32) -> String {
    if needed < DEEP {
        format!("raise it to {needed}")
    } else {
        format!("some are longer than {DEEP}, and no limit would do")
    }
}

/// The subject of a sentence.
fn plural(effect: Effect) -> &'static str {
    match effect {
        Effect::Indirect => "paths of indirect light",
        other => other.title(),
    }
}

/// What leaving an effect out changes.
fn without(effect: Effect, share: Option<Measured>) -> String {
    let part = percent(share.map_or(0.0, |m| m.share));
    match effect {
        Effect::Sources => format!("lights would not be seen: {part} of the light"),
        Effect::HardShadows | Effect::SoftShadows | Effect::Indirect | Effect::Caustics => {
            format!("{part} of the light would be missing")
        }
        Effect::Mirrors | Effect::Refraction | Effect::TotalReflection | Effect::Panes => {
            format!("{part} of the light seen would come another way")
        }
        Effect::Nesting => "media would meet at the wrong index".to_owned(),
        Effect::ShadingNormals => "smooth meshes would show their faces".to_owned(),
        Effect::Glints => "the same light, with more noise".to_owned(),
    }
}

/// A share in words.
pub fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0 %".to_owned(),
        p if p < 0.01 => "less than 0.01 %".to_owned(),
        p if p < 1.0 => format!("{p:.2} %"),
        p if p < 9.95 => format!("{p:.1} %"),
        p => format!("{p:.0} %"),
    }
}

//! What each effect brings and what it costs, by camera samples taken apart.

use crate::{
    film::Layer,
    photon::shoot,
    render::{Effort, REPLICATES, Renderer, Sight},
    scene::{Choice, Effect, Settings},
};

use super::{Measured, sequence};

/// Photon paths and camera samples of each replicate.
const PHOTONS: u64 = 1 << 13;
const SAMPLES: u64 = 1 << 11;

/// Part of the ways that may stay longer than the depth limit that is advised.
const CUT: f64 = 1e-3;

/// Sums over the samples of one replicate, by effect.
type Sums = [f64; Effect::ALL.len()];

/// What was found.
pub(super) struct Look {
    /// Light by replicate and effect.
    light: Vec<Sums>,
    /// All light by replicate.
    total: Vec<f64>,
    effort: Effort,
    /// Photon paths for every camera sample, in rays cast.
    photons: f64,
    /// Share of the light that is seen beyond the depth limit asked for.
    pub(super) beyond_depth: f64,
    /// Part of the ways from the eye that reach it.
    pub(super) reached: f64,
    /// The limit that few ways would reach.
    pub(super) depth_needed: u32,
}

/// Shares of the work.
pub(super) struct Work {
    pub(super) view: f64,
    by_effect: [Option<f64>; Effect::ALL.len()],
}

impl Work {
    /// That of an effect; `None` of those that have no work of their own.
    pub(super) fn of(&self, effect: Effect) -> Option<f64> {
        self.by_effect[effect as usize]
    }
}

impl Look {
    /// Looks at a scene with a renderer that leaves nothing out; `asked` are the
    /// settings that it is to be rendered with.
    pub(super) fn at(renderer: &Renderer<'_>, asked: &Settings) -> Self {
        let seed = asked.seed;
        let mut look = Self {
            light: Vec::new(),
            total: Vec::new(),
            effort: Effort::default(),
            photons: renderer.photon_effort(),
            beyond_depth: 0.0,
            reached: 0.0,
            depth_needed: 0,
        };
        let emitter = renderer.emitter_of(0);
        let mut depths: Vec<u32> = Vec::new();
        let (mut beyond, mut all, mut samples) = (0.0, 0.0, 0u64);
        for r in 0..REPLICATES {
            let map = emitter.map(|emitter| {
                let photons = sequence(seed, 2 * r);
                let shot = shoot(&renderer.context(), emitter, photons, 0, PHOTONS);
                renderer.map(&shot, 0)
            });
            let (mut sums, mut total) = ([0.0; Effect::ALL.len()], 0.0);
            renderer.sights(map.as_ref(), sequence(seed, 2 * r + 1), SAMPLES, |sight| {
                let light = sight.light.total().mean();
                if !light.is_finite() {
                    return;
                }
                total += light;
                for effect in Effect::ALL {
                    sums[effect as usize] += part(sight, effect);
                }
                if sight.depth > asked.max_depth {
                    beyond += light;
                }
                depths.push(sight.depth);
                add(&mut look.effort, &sight.effort);
                samples += 1;
            });
            all += total;
            look.light.push(sums);
            look.total.push(total);
        }
        depths.sort_unstable();
        if !depths.is_empty() && all > 0.0 {
            look.beyond_depth = beyond / all;
            let over = depths.iter().filter(|&&d| d > asked.max_depth).count();
            look.reached = over as f64 / depths.len() as f64;
            look.depth_needed = quantile(&depths);
        }
        scale(&mut look.effort, 1.0 / samples.max(1) as f64);
        look
    }

    /// Mean and standard error of a share over the replicates.
    fn share(&self, effect: Effect) -> Measured {
        let total: f64 = self.total.iter().sum();
        let sum: f64 = self.light.iter().map(|l| l[effect as usize]).sum();
        if total.is_nan() || total <= 0.0 {
            return Measured::default();
        }
        let share = sum / total;
        let n = self.total.len() as f64;
        let mean = total / n;
        // The error of a quotient of means (delta method).
        let squares: f64 = self
            .light
            .iter()
            .zip(&self.total)
            .map(|(l, t)| (l[effect as usize] - share * t).powi(2))
            .sum();
        Measured {
            share,
            error: (squares / (n * (n - 1.0))).sqrt() / mean,
        }
    }

    /// The share of the light that is an effect's own; `None` of effects that
    /// light only passes by.
    pub(super) fn light(&self, effect: Effect) -> Option<Measured> {
        is_origin(effect).then(|| self.share(effect))
    }

    /// The share of the light that the eye sees by way of an effect.
    pub(super) fn seen_through(&self, effect: Effect) -> Option<Measured> {
        let passes = !is_origin(effect) && effect != Effect::Glints;
        passes.then(|| self.share(effect))
    }

    /// The work by effect as far as they are not switched off.
    pub(super) fn work(&self, asked: &Settings) -> Work {
        let e = &self.effort;
        let mut by_effect = [None; Effect::ALL.len()];
        for (effect, work) in [
            (Effect::HardShadows, e.shadows[0]),
            (Effect::SoftShadows, e.shadows[1]),
            (Effect::Caustics, e.caustics + self.photons),
            (Effect::Indirect, e.indirect),
            (Effect::Glints, e.glints),
        ] {
            let on = asked.choice(effect) != Choice::Off;
            by_effect[effect as usize] = Some(if on { work } else { 0.0 });
        }
        let all = e.view + by_effect.iter().flatten().sum::<f64>();
        Work {
            view: e.view / all,
            by_effect: by_effect.map(|w| w.map(|w| w / all)),
        }
    }
}

/// Whether light belongs to the effect, and to no other of this kind.
fn is_origin(effect: Effect) -> bool {
    matches!(
        effect,
        Effect::Sources
            | Effect::HardShadows
            | Effect::SoftShadows
            | Effect::Caustics
            | Effect::Indirect
    )
}

/// The light of a sample that is an effect's, or that came by way of it.
fn part(sight: &Sight, effect: Effect) -> f64 {
    let by_way = |passed: bool| {
        if passed {
            sight.light.total().mean()
        } else {
            0.0
        }
    };
    match effect {
        Effect::Sources => sight.light[Layer::Emission].mean(),
        Effect::HardShadows => sight.direct[0],
        Effect::SoftShadows => sight.direct[1],
        Effect::Caustics => sight.light[Layer::Caustic].mean(),
        Effect::Indirect => sight.light[Layer::Indirect].mean(),
        Effect::Mirrors => by_way(sight.passed.mirror),
        Effect::Refraction => by_way(sight.passed.glass),
        Effect::TotalReflection => by_way(sight.passed.total),
        Effect::Panes => by_way(sight.passed.pane),
        Effect::Nesting => by_way(sight.passed.nested),
        Effect::ShadingNormals => by_way(sight.passed.smooth),
        Effect::Glints => 0.0,
    }
}

fn add(sum: &mut Effort, more: &Effort) {
    sum.view += more.view;
    sum.caustics += more.caustics;
    sum.indirect += more.indirect;
    sum.glints += more.glints;
    for (a, b) in sum.shadows.iter_mut().zip(more.shadows) {
        *a += b;
    }
}

fn scale(effort: &mut Effort, k: f64) {
    effort.view *= k;
    effort.caustics *= k;
    effort.indirect *= k;
    effort.glints *= k;
    effort.shadows = effort.shadows.map(|s| s * k);
}

/// The depth that all but [`CUT`] of sorted depths do not exceed.
pub(super) fn quantile(sorted: &[u32]) -> u32 {
    let kept = ((1.0 - CUT) * sorted.len() as f64).ceil() as usize;
    sorted
        .get(kept.saturating_sub(1))
        .copied()
        .unwrap_or_default()
}

//! Launching photons: which light, and from there towards which caster.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    geometry::Ray,
    plan::Media,
    sampling::{Discrete, Guide, Purpose, Sequence, Stream},
    spectrum::Rgb,
    transport::{Context, Differential},
};

use super::{Aim, Origin};

/// Coordinates of a stream that an emission may use; the bounces come after.
/// Direction first: the first two dimensions of the sequence are its best. Then
/// the point on the light, the choice of the light and that of its target.
pub(super) const DIMENSIONS: u32 = 6;

/// The coordinate that chooses a target.
const TARGET: u32 = 5;

/// Least part of all paths that goes to each target of each light, however
/// little comes of it in a pilot: what is seen seldom must not be seen with a
/// weight of thousands. All these floors together are at most the second number.
const FLOOR: f64 = 0.01;
const FLOORS: f64 = 0.1;

/// The start of a photon path.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// The first ray.
    pub ray: Ray,
    /// Flux in W: the light's emission over all probabilities. Black if the
    /// sampled start emits nothing.
    pub flux: Rgb,
    /// Index of the light.
    pub light: u32,
    /// The bodies of clear media around the start.
    pub media: Media,
    /// Derivatives of the ray by the sample of direction and point, and the
    /// probability of light and target. May not be finite on a rim.
    pub differential: Differential,
}

/// Launches photons from all lights of a scene.
#[derive(Clone, Debug)]
pub struct Emitter {
    aims: Vec<Aim>,
    choice: Discrete,
}

impl Emitter {
    /// Aims every light at the casters of the plan. `None` if no light can
    /// reach one. Lights get photons by the power that they send towards
    /// casters, found by a small pilot that is a function of the scene alone.
    pub fn new(ctx: &Context<'_>) -> Option<Self> {
        if !ctx.plan.caustics() {
            return None;
        }
        let aims = aims(ctx);
        let powers = aims.iter().map(|a| a.powers().to_vec()).collect();
        Self::with_parts(&aims, powers, Vec::new())
    }

    /// The same with shares by power alone: without a floor, what gets little
    /// power gets few photons.
    pub fn by_power(ctx: &Context<'_>) -> Option<Self> {
        if !ctx.plan.caustics() {
            return None;
        }
        let aims = aims(ctx);
        let powers: Vec<f64> = aims.iter().map(Aim::power_estimate).collect();
        Self::of(aims, &powers)
    }

    /// Aims every light at what the plan proves to be in vain, and at nothing
    /// that [`Emitter::new`] aims at: whoever forces caustics on gets these
    /// photons, too. `None` if there is nothing of that kind.
    pub fn in_vain(ctx: &Context<'_>) -> Option<Self> {
        let unlit = ctx.plan.unlit();
        let aims: Vec<Aim> = unlit
            .iter()
            .enumerate()
            .map(|(i, unlit)| {
                let pilot = Sequence::new(0, Purpose::Pilot, 0, i as u64);
                Aim::beside(ctx, i, unlit, pilot)
            })
            .collect();
        let powers: Vec<f64> = aims.iter().map(Aim::power_estimate).collect();
        Self::of(aims, &powers)
    }

    /// Lights with the parts of the paths that go to each of their targets, in
    /// any unit, and what was learned about these. Parts below the floor are
    /// raised to it.
    pub(super) fn with_parts(
        aims: &[Aim],
        mut parts: Vec<Vec<f64>>,
        guides: Vec<Vec<Option<Guide>>>,
    ) -> Option<Self> {
        raise(&mut parts);
        let shares: Vec<f64> = parts.iter().map(|p| p.iter().sum()).collect();
        let mut guides = guides.into_iter();
        let aims = aims
            .iter()
            .zip(&parts)
            .map(|(aim, parts)| aim.taught(parts, guides.next().unwrap_or_default()))
            .collect();
        Self::of(aims, &shares)
    }

    /// Lights with their shares of the paths; `None` if all are zero.
    pub(super) fn of(aims: Vec<Aim>, shares: &[f64]) -> Option<Self> {
        Some(Self {
            choice: Discrete::new(shares)?,
            aims,
        })
    }

    /// The start of the path that the stream stands for.
    pub fn emit(&self, ctx: &Context<'_>, stream: &mut Stream) -> Emission {
        self.emit_from(ctx, stream).0
    }

    /// [`emit`](Self::emit), and where in the emission the start lies.
    pub(super) fn emit_from(&self, ctx: &Context<'_>, stream: &mut Stream) -> (Emission, Origin) {
        let even = stream.first_4d();
        let light = self.choice.choose(|| stream.next_1d());
        stream.seek(TARGET);
        let aim = &self.aims[light];
        let launch = aim.sample(ctx, || stream.next_1d(), even);
        let light_chance = self.choice.probability(light);
        let light = light as u32;
        let Some(mut launch) = launch else {
            return (
                Emission {
                    ray: Ray::new(DVec3::ZERO, DVec3::Z),
                    flux: Rgb::BLACK,
                    light,
                    media: Media::NONE,
                    differential: Differential::new(),
                },
                Origin {
                    light,
                    target: 0,
                    at: even,
                },
            );
        };
        launch.start.differential.chance = launch.chance * light_chance;
        let media = match ctx.plan.nest() {
            Some(nested) => {
                let start = &nested.starts.lights[light as usize];
                start.at(&ctx.scene.world, launch.start.origin)
            }
            None => Media::NONE,
        };
        // Built where they are returned: derivatives are large to copy.
        (
            Emission {
                ray: Ray {
                    origin: launch.start.origin,
                    dir: launch.start.dir,
                    leaving: aim.body(),
                },
                flux: launch.flux / light_chance,
                light,
                media,
                differential: launch.start.differential,
            },
            Origin {
                light,
                target: launch.target,
                at: launch.at,
            },
        )
    }

    /// Part of the paths that start from a light towards one of its targets.
    pub(super) fn share(&self, light: usize, target: usize) -> f64 {
        self.choice.probability(light) * self.aims[light].share(target)
    }

    /// How the lights are aimed, in the order of the scene's lights.
    pub fn aims(&self) -> &[Aim] {
        &self.aims
    }
}

/// Every light of the scene, aimed at the casters of the plan.
fn aims(ctx: &Context<'_>) -> Vec<Aim> {
    let aim = |i| Aim::new(ctx, i, Sequence::new(0, Purpose::Pilot, 0, i as u64));
    (0..ctx.scene.lights.len()).map(aim).collect()
}

/// Raises the parts of a whole that are below the floor to it.
fn raise(parts: &mut [Vec<f64>]) {
    let count = parts.iter().map(Vec::len).sum::<usize>();
    let sum: f64 = parts.iter().flatten().sum();
    if count < 2 || !(sum > 0.0 && sum.is_finite()) {
        return;
    }
    let floor = FLOOR.min(FLOORS / count as f64);
    // All others together are at most the whole, so a raised part is still
    // `floor` of the new sum.
    let least = sum * floor / (1.0 - floor * (count - 1) as f64);
    for part in parts.iter_mut().flatten() {
        *part = part.max(least);
    }
}

/// Area of a disc.
pub(super) fn disc_area(radius: f64) -> f64 {
    PI * radius * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every part is at least the floor, or its share of a tenth where there are
    /// many; single ones and those above the floor keep their proportions.
    #[test]
    fn no_part_falls_below_the_floor() {
        for parts in [
            vec![vec![1e-9, 5.0], vec![], vec![2.0]],
            vec![vec![0.0; 40], vec![1e6; 10]],
            vec![vec![0.0, 0.0, 1.0]],
            vec![vec![3.0]],
            vec![vec![1.0; 200], vec![0.0]],
        ] {
            let mut raised = parts.clone();
            raise(&mut raised);
            let count = parts.iter().map(Vec::len).sum::<usize>();
            let floor = 0.01f64.min(0.1 / count as f64);
            let sum: f64 = raised.iter().flatten().sum();
            let total: f64 = parts.iter().flatten().sum();
            for (was, is) in parts.iter().flatten().zip(raised.iter().flatten()) {
                assert!(
                    *is / sum >= floor * (1.0 - 1e-12),
                    "{parts:?}: {is} of {sum}"
                );
                assert!(was / total <= floor * 1.2 || was == is, "{parts:?}");
            }
            assert!(sum <= total * 1.12, "{parts:?}: {sum}");
        }
    }
}

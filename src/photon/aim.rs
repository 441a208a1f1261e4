//! Aiming a light at the specular objects of a scene.

use crate::{
    geometry::{Ray, SurfaceId},
    light::Light,
    plan::Lit,
    sampling::{Discrete, GUIDE_DIMENSIONS, Guide, Guided, Sequence},
    spectrum::Rgb,
    transport::Context,
};

use super::{
    domain::{self, Start, Target},
    groups::{MAX_TARGETS, grouped, outermost},
};

/// Samples with which the power sent towards each part is estimated.
const PILOT: u64 = 256;

/// One light's emission, restricted to where casters are.
///
/// The light's domain has a part for each caster (or group), and parts may
/// overlap. A start is drawn from one of them and counts only if no earlier
/// part contains it, so every start counts once, with the density of the part
/// from which it came alone: neighbours of a photon are as far apart as the
/// derivatives of its sample say.
#[derive(Clone, Debug)]
pub struct Aim {
    light: Light,
    /// The body from which photons start, for glowing shapes.
    body: Option<u32>,
    targets: Vec<Target>,
    /// Estimated power towards each target, W.
    powers: Vec<f64>,
    /// Which target; `None` if there is none.
    choice: Option<Discrete>,
    /// Where in each target's part starts are wanted, if that is known.
    guides: Vec<Option<Guide>>,
}

/// The start of a photon from one light.
pub(super) struct Launch {
    /// The point of the light's domain, with its derivatives.
    pub(super) start: Start,
    /// Emission over density; black if the start does not count.
    pub(super) flux: Rgb,
    /// Probability of the target.
    pub(super) chance: f64,
    /// Index of the target.
    pub(super) target: u32,
    /// The sample from which the start was drawn.
    pub(super) at: [f64; GUIDE_DIMENSIONS],
}

impl Aim {
    /// Aims light number `index` of the scene at the casters of the plan.
    pub(super) fn new(ctx: &Context<'_>, index: usize, pilot: Sequence) -> Self {
        Self::at(
            ctx,
            index,
            targets(ctx, index, &ctx.plan.lit[index]),
            0,
            pilot,
        )
    }

    /// The same at other casters: starts that could meet those of the plan do
    /// not count.
    pub(super) fn beside(ctx: &Context<'_>, index: usize, other: &Lit, pilot: Sequence) -> Self {
        let mut all = targets(ctx, index, &ctx.plan.lit[index]);
        let first = all.len();
        all.extend(targets(ctx, index, other));
        Self::at(ctx, index, all, first, pilot)
    }

    /// Aims at the targets from number `first` on; those before it only claim
    /// their starts.
    fn at(
        ctx: &Context<'_>,
        index: usize,
        targets: Vec<Target>,
        first: usize,
        pilot: Sequence,
    ) -> Self {
        let named = &ctx.scene.lights[index];
        let powers: Vec<f64> = (0..targets.len())
            .map(|k| {
                if k < first {
                    0.0
                } else {
                    power_towards(&named.light, &targets, k, pilot)
                }
            })
            .collect();
        Self {
            light: named.light.clone(),
            body: named.instance,
            choice: Discrete::new(&powers),
            guides: vec![None; targets.len()],
            powers,
            targets,
        }
    }

    /// The same, with shares and guides of its own for the targets. A target
    /// for which there is no guide keeps the one it has.
    pub(super) fn taught(&self, shares: &[f64], guides: Vec<Option<Guide>>) -> Self {
        let mut aim = self.clone();
        aim.choice = Discrete::new(shares);
        for (old, new) in aim.guides.iter_mut().zip(guides) {
            *old = new.or(old.take());
        }
        aim
    }

    /// Estimated power sent towards casters, in W, on the safe side.
    pub fn power_estimate(&self) -> f64 {
        if self.choice.is_some() {
            self.powers.iter().sum()
        } else {
            0.0
        }
    }

    /// That power for each target.
    pub(super) fn powers(&self) -> &[f64] {
        &self.powers
    }

    /// Part of the light's paths that go towards a target.
    pub(super) fn share(&self, target: usize) -> f64 {
        self.choice.as_ref().map_or(0.0, |c| c.probability(target))
    }

    /// Number of coordinates on which a start depends.
    pub(super) fn dimensions(&self) -> usize {
        if self.light.has_extent() {
            GUIDE_DIMENSIONS
        } else {
            GUIDE_DIMENSIONS / 2
        }
    }

    /// A start with its flux and derivatives. `u` chooses the part; it is asked
    /// for only where there is a choice. `None` if there is no part.
    #[inline]
    pub(super) fn sample(
        &self,
        ctx: &Context<'_>,
        u: impl FnOnce() -> f64,
        even: [f64; GUIDE_DIMENSIONS],
    ) -> Option<Launch> {
        let choice = self.choice.as_ref()?;
        let k = choice.choose(u);
        let chance = choice.probability(k);
        let guided = match &self.guides[k] {
            Some(guide) => guide.warp(even),
            None => Guided::even(even),
        };
        let [a, b, c, d] = guided.at;
        let mut start = domain::draw(&self.light, self.targets[k], [a, b], [c, d]);
        start.stretch(&guided);
        let counts = belongs(&self.light, &self.targets[..k], &start);
        let mut shaded = false;
        if let Light::Sun(_) = self.light {
            if let Some(bounds) = ctx.scene.world.bounds() {
                // Start before everything that is bounded.
                start.move_before(&bounds.bounding_sphere());
            }
            shaded = counts && behind_a_plane(ctx, &start);
        }
        let flux = start.emission / (chance * start.own_density);
        Some(Launch {
            start,
            flux: if counts && !shaded && flux.is_finite() {
                flux
            } else {
                Rgb::BLACK
            },
            chance,
            target: k as u32,
            at: guided.at,
        })
    }

    /// The surface on which photons start, if the light has a body.
    #[inline]
    pub(super) fn body(&self) -> Option<SurfaceId> {
        self.body.map(|instance| SurfaceId { instance, part: 0 })
    }

    /// Power in W that is not aimed at any caster, and the standard error of
    /// that estimate from `samples` starts over the light's whole domain.
    /// `None` for the sun, whose domain has no bounds.
    pub fn not_aimed(&self, sequence: Sequence, samples: u64) -> Option<(f64, f64)> {
        self.light.power()?;
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..samples {
            let mut s = sequence.at(i);
            let start = domain::draw(&self.light, Target::Whole, s.next_2d(), s.next_2d());
            let x = if belongs(&self.light, &self.targets, &start) {
                (start.emission / start.own_density).mean()
            } else {
                0.0
            };
            sum += x;
            squares += x * x;
        }
        let n = samples as f64;
        let mean = sum / n;
        Some((mean, ((squares / n - mean * mean).max(0.0) / n).sqrt()))
    }
}

/// Whether a start lies in none of the parts.
fn belongs(light: &Light, earlier: &[Target], start: &Start) -> bool {
    !earlier.iter().any(|t| domain::contains(light, *t, start))
}

/// Estimated power in W of the starts of part `k` that count.
fn power_towards(light: &Light, targets: &[Target], k: usize, pilot: Sequence) -> f64 {
    let (mut sum, mut measure) = (0.0, 0.0);
    for i in 0..PILOT {
        let mut s = pilot.at(i);
        let start = domain::draw(light, targets[k], s.next_2d(), s.next_2d());
        if belongs(light, &targets[..k], &start) {
            sum += (start.emission / start.own_density).mean();
        }
        measure += 1.0 / start.own_density;
    }
    // As if one more sample had met the light's full strength: a sliver that
    // the pilot missed must not lose its photons.
    let unseen = domain::strength(light) * measure / PILOT as f64;
    (sum + unseen) / (PILOT + 1) as f64
}

/// Whether something unbounded lies between a start and infinity behind it;
/// bounded things never do, since the sun's photons start before them.
fn behind_a_plane(ctx: &Context<'_>, start: &Start) -> bool {
    let back = Ray::new(start.origin, -start.dir);
    ctx.scene.world.occluded(&back, f64::INFINITY, |_| false)
}

/// The parts of a light's domain from which casters can be reached, in the
/// order in which they claim their starts: the small ones, which know best
/// where their caster is, before those around them.
fn targets(ctx: &Context<'_>, index: usize, lit: &Lit) -> Vec<Target> {
    let light = &ctx.scene.lights[index].light;
    let mut spheres = Vec::new();
    let mut unbounded = false;
    for &i in ctx.plan.casters.iter().filter(|&&i| lit.contains(i)) {
        match ctx.scene.world.instance_sphere(i) {
            Some(s) => spheres.push(s),
            None => unbounded = true,
        }
    }
    let mut out: Vec<Target> =
        outermost(grouped(spheres, MAX_TARGETS, |s| domain::extent(light, s)))
            .into_iter()
            .map(Target::Sphere)
            .collect();
    if unbounded && !matches!(light, Light::Sun(_)) {
        out.push(Target::Whole);
    }
    out
}

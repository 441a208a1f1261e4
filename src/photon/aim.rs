//! Aiming a light at the specular objects of a scene.

use glam::DVec3;

use crate::{
    geometry::{BoundingSphere, Ray, SurfaceId},
    light::Light,
    numeric::U,
    sampling::{Discrete, GUIDE_DIMENSIONS, Guide, Guided, Sequence},
    spectrum::Rgb,
    transport::Context,
};

use super::domain::{self, Start, Target};

/// Largest number of parts a light's domain is divided into; more casters are
/// grouped. A start may ask every part whether it lies there, so this bounds
/// the work.
const MAX_TARGETS: usize = 16;

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
        let named = &ctx.scene.lights[index];
        let targets = targets(ctx, &named.light);
        let powers: Vec<f64> = (0..targets.len())
            .map(|k| power_towards(&named.light, &targets, k, pilot))
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
fn targets(ctx: &Context<'_>, light: &Light) -> Vec<Target> {
    let mut spheres = Vec::new();
    let mut unbounded = false;
    for &i in &ctx.plan.casters {
        match ctx.scene.world.instance_sphere(i) {
            Some(s) if domain::reaches(light, &s) => spheres.push(s),
            Some(_) => {}
            None => unbounded = true,
        }
    }
    let mut out: Vec<Target> = outermost(grouped(light, spheres))
        .into_iter()
        .map(Target::Sphere)
        .collect();
    if unbounded && !matches!(light, Light::Sun(_)) {
        out.push(Target::Whole);
    }
    out
}

/// The spheres by size, without those that lie inside another.
fn outermost(mut spheres: Vec<BoundingSphere>) -> Vec<BoundingSphere> {
    spheres.sort_by(|a, b| a.radius.total_cmp(&b.radius));
    let inside = |s: &BoundingSphere, larger: &BoundingSphere| {
        s.center.distance(larger.center) + s.radius <= larger.radius
    };
    (0..spheres.len())
        .filter(|&i| !spheres[i + 1..].iter().any(|l| inside(&spheres[i], l)))
        .map(|i| spheres[i])
        .collect()
}

/// At most [`MAX_TARGETS`] spheres that cover the given ones. While there may
/// be more groups, the one to which most of the light's domain leads is halved
/// by median along its widest axis: near casters get targets of their own,
/// distant ones share.
fn grouped(light: &Light, mut spheres: Vec<BoundingSphere>) -> Vec<BoundingSphere> {
    if spheres.len() <= MAX_TARGETS {
        return spheres;
    }
    let Some(all) = cover(&spheres) else {
        return spheres;
    };
    let mut groups = vec![(all, spheres.as_mut_slice())];
    while groups.len() < MAX_TARGETS {
        let size = |(sphere, members): &(BoundingSphere, &mut [BoundingSphere])| {
            let single = members.len() < 2;
            if single {
                -1.0
            } else {
                domain::extent(light, sphere)
            }
        };
        let widest = (0..groups.len())
            .max_by(|&a, &b| size(&groups[a]).total_cmp(&size(&groups[b])))
            .unwrap_or(0);
        let (sphere, members) = groups.swap_remove(widest);
        let (low, high) = halves(members);
        match (cover(low), cover(high)) {
            (Some(a), Some(b)) => groups.extend([(a, low), (b, high)]),
            // Too few to halve.
            _ => return groups.into_iter().map(|g| g.0).chain([sphere]).collect(),
        }
    }
    groups.into_iter().map(|g| g.0).collect()
}

/// Halves spheres by the median of their centres along the widest axis.
fn halves(group: &mut [BoundingSphere]) -> (&mut [BoundingSphere], &mut [BoundingSphere]) {
    let spread = |axis: usize| {
        let c = group.iter().map(|s| s.center[axis]);
        c.clone().fold(f64::MIN, f64::max) - c.fold(f64::MAX, f64::min)
    };
    let axis = (0..3)
        .max_by(|a, b| spread(*a).total_cmp(&spread(*b)))
        .unwrap_or(0);
    group.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
    group.split_at_mut(group.len() / 2)
}

/// A sphere around spheres, centred at the mean of their centres.
fn cover(group: &[BoundingSphere]) -> Option<BoundingSphere> {
    if group.is_empty() {
        return None;
    }
    let center = group.iter().map(|s| s.center).sum::<DVec3>() / group.len() as f64;
    let radius = group
        .iter()
        .map(|s| s.center.distance(center) + s.radius)
        .fold(0.0, f64::max);
    Some(BoundingSphere {
        center,
        radius: radius * (1.0 + 8.0 * U),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::PointLight;

    /// Sixty balls in a row, a lamp beside one of them: few groups, which
    /// cover all, and those next to the lamp are alone in theirs.
    #[test]
    fn near_casters_are_targets_of_their_own() {
        let ball = |i: u32| BoundingSphere {
            center: DVec3::new(4.0 * f64::from(i), 0.0, 0.0),
            radius: 0.5,
        };
        let spheres: Vec<_> = (0..60).map(ball).collect();
        let lamp = Light::Point(PointLight {
            position: DVec3::new(4.0 * 37.0, 0.0, 2.0),
            intensity: Rgb::WHITE,
        });
        let groups = grouped(&lamp, spheres.clone());
        assert_eq!(groups.len(), MAX_TARGETS);
        for s in &spheres {
            let covered = |g: &BoundingSphere| {
                s.center.distance(g.center) + s.radius <= g.radius * (1.0 + 1e-12)
            };
            assert!(groups.iter().any(covered), "{s:?} is not covered");
        }
        for i in 36..39 {
            let own = |g: &BoundingSphere| g.center == ball(i).center && g.radius < 0.51;
            assert!(groups.iter().any(own), "ball {i} shares its group");
        }
        // Twins cannot be parted, whatever their number.
        let twins = vec![ball(0); 40];
        assert!(grouped(&lamp, twins).len() <= MAX_TARGETS);
    }

    /// Ten balls in a row, each with a smaller one inside it, and a twin: the
    /// large ones remain, once each, the smallest first.
    #[test]
    fn balls_inside_others_are_no_targets() {
        let ball = |x: f64, radius| BoundingSphere {
            center: DVec3::new(x, 0.0, 0.0),
            radius,
        };
        let mut spheres = Vec::new();
        for i in (0..10).rev() {
            let x = f64::from(i);
            let radius = 0.5 + 0.1 * x;
            spheres.extend([
                ball(4.0 * x, radius),
                ball(4.0 * x + 0.2, radius - 0.25),
                ball(4.0 * x, radius),
            ]);
        }
        let left = outermost(spheres);
        let expected: Vec<_> = (0..10)
            .map(f64::from)
            .map(|x| ball(4.0 * x, 0.5 + 0.1 * x))
            .collect();
        assert_eq!(left, expected);
        // One that only reaches out of another stays.
        assert_eq!(outermost(vec![ball(0.0, 1.0), ball(0.8, 0.3)]).len(), 2);
    }
}

//! Aiming a light at the specular objects of a scene.

use glam::DVec3;

use crate::{
    geometry::{BoundingSphere, Ray, SurfaceId},
    light::Light,
    sampling::{Discrete, Sequence},
    spectrum::Rgb,
    transport::Context,
};

use super::domain::{self, Start, Target};

/// Largest number of parts a light's domain is divided into; more casters are
/// grouped. A start asks every part for its density, so this bounds the work.
const MAX_TARGETS: usize = 16;

/// Samples with which the power sent towards each part is estimated.
const PILOT: u64 = 256;

/// One light's emission, restricted to where casters are.
///
/// A mixture of parts of the light's domain, one for each caster (or group):
/// a start is drawn from one of them and weighted by the density of all, so
/// overlapping bounds count once and the result is unbiased.
#[derive(Clone, Debug)]
pub struct Aim {
    light: Light,
    /// The body from which photons start, for glowing shapes.
    body: Option<u32>,
    targets: Vec<Target>,
    choice: Option<Discrete>,
    power: f64,
}

impl Aim {
    /// Aims light number `index` of the scene at the casters of the plan.
    pub(super) fn new(ctx: &Context<'_>, index: usize, pilot: Sequence) -> Self {
        let named = &ctx.scene.lights[index];
        let targets = targets(ctx, &named.light);
        let powers: Vec<f64> = targets
            .iter()
            .map(|t| {
                let (mut sum, mut measure) = (0.0, 0.0);
                for i in 0..PILOT {
                    let mut s = pilot.at(i);
                    let start = domain::draw(&named.light, *t, s.next_2d(), s.next_2d());
                    sum += (start.emission / start.own_density).mean();
                    measure += 1.0 / start.own_density;
                }
                // As if one more sample had met the light's full strength:
                // a sliver that the pilot missed must not lose its photons.
                let unseen = domain::strength(&named.light) * measure / PILOT as f64;
                (sum + unseen) / (PILOT + 1) as f64
            })
            .collect();
        Self {
            light: named.light.clone(),
            body: named.instance,
            choice: Discrete::new(&powers),
            power: powers.iter().sum(),
            targets,
        }
    }

    /// Estimated power sent towards casters, in W, on the safe side; parts
    /// that overlap count twice.
    pub fn power_estimate(&self) -> f64 {
        if self.choice.is_some() {
            self.power
        } else {
            0.0
        }
    }

    /// A start and its flux: emission over the density of the mixture.
    pub(super) fn sample(
        &self,
        ctx: &Context<'_>,
        u: f64,
        dir: [f64; 2],
        point: [f64; 2],
    ) -> (Ray, Rgb) {
        let Some(choice) = &self.choice else {
            return (Ray::new(DVec3::ZERO, DVec3::Z), Rgb::BLACK);
        };
        let (k, _) = choice.sample(u);
        let start = domain::draw(&self.light, self.targets[k], dir, point);
        let mut density = choice.probability(k) * start.own_density;
        for (i, target) in self.targets.iter().enumerate() {
            if i != k {
                density += choice.probability(i) * domain::density(&self.light, *target, &start);
            }
        }
        let flux = start.emission / density;
        let ray = self.ray(ctx, &start);
        let shaded = matches!(self.light, Light::Sun(_)) && behind_a_plane(ctx, &ray);
        if flux.is_finite() && !shaded {
            (ray, flux)
        } else {
            (ray, Rgb::BLACK)
        }
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
            let aimed = self
                .targets
                .iter()
                .any(|t| domain::density(&self.light, *t, &start) > 0.0);
            let x = if aimed {
                0.0
            } else {
                (start.emission / start.own_density).mean()
            };
            sum += x;
            squares += x * x;
        }
        let n = samples as f64;
        let mean = sum / n;
        Some((mean, ((squares / n - mean * mean).max(0.0) / n).sqrt()))
    }

    fn ray(&self, ctx: &Context<'_>, start: &Start) -> Ray {
        let leaving = self.body.map(|instance| SurfaceId { instance, part: 0 });
        let mut ray = Ray {
            origin: start.origin,
            dir: start.dir,
            leaving,
        };
        if let (Light::Sun(_), Some(bounds)) = (&self.light, ctx.scene.world.bounds()) {
            // Start before everything that is bounded.
            let all = bounds.bounding_sphere();
            let along = (start.origin - all.center).dot(start.dir);
            ray.origin = start.origin - start.dir * (along + 2.0 * all.radius);
        }
        ray
    }
}

/// Whether something unbounded lies between a ray's start and infinity behind
/// it; bounded things never do, since the sun's rays start before them.
fn behind_a_plane(ctx: &Context<'_>, ray: &Ray) -> bool {
    let back = Ray::new(ray.origin, -ray.dir);
    ctx.scene.world.occluded(&back, f64::INFINITY, |_| false)
}

/// The parts of a light's domain from which casters can be reached.
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
    let mut out = Vec::new();
    if unbounded && !matches!(light, Light::Sun(_)) {
        out.push(Target::Whole);
    }
    out.extend(grouped(spheres).into_iter().map(Target::Sphere));
    out
}

/// At most [`MAX_TARGETS`] spheres that cover the given ones: halved by
/// median along the widest axis until they are few enough.
fn grouped(spheres: Vec<BoundingSphere>) -> Vec<BoundingSphere> {
    let mut groups = if spheres.len() <= MAX_TARGETS {
        return spheres;
    } else {
        vec![spheres]
    };
    while groups.len() < MAX_TARGETS {
        let mut next = Vec::new();
        for mut g in groups {
            let spread = |axis: usize| {
                let c = g.iter().map(|s| s.center[axis]);
                c.clone().fold(f64::MIN, f64::max) - c.fold(f64::MAX, f64::min)
            };
            let axis = (0..3)
                .max_by(|a, b| spread(*a).total_cmp(&spread(*b)))
                .unwrap_or(0);
            g.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
            let tail = g.split_off(g.len() / 2);
            next.push(g);
            next.push(tail);
        }
        groups = next;
    }
    groups.iter().filter_map(|g| cover(g)).collect()
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
        radius: radius * (1.0 + 8.0 * crate::numeric::U),
    })
}

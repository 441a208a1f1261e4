//! Light that reaches a diffuse point straight from the sources.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use crate::{
    built,
    geometry::SurfacePoint,
    light::Light,
    plan::Media,
    sampling::{Discrete, Stream},
    scene::Scene,
    spectrum::Rgb,
};

use super::{Context, shadow};

/// A point on a diffuse surface, seen from one side.
#[derive(Clone, Copy, Debug)]
pub struct DiffusePoint {
    /// The point.
    pub point: SurfacePoint,
    /// Geometric normal on the viewer's side.
    pub ng: DVec3,
    /// Shading normal on the viewer's side.
    pub ns: DVec3,
    /// Reflectance.
    pub reflectance: Rgb,
    /// The bodies of clear media on the viewer's side.
    pub media: Media,
}

impl DiffusePoint {
    /// The point as seen along direction `d` by a path in `media`.
    pub fn new(point: SurfacePoint, d: DVec3, reflectance: Rgb, media: Media) -> Self {
        let flip = point.ng.dot(d) > 0.0;
        let (ng, ns) = if flip {
            (-point.ng, -point.ns())
        } else {
            (point.ng, point.ns())
        };
        Self {
            point,
            ng,
            ns,
            reflectance,
            media,
        }
    }
}

/// Parts of all picks that go to lights by power and in equal numbers, whatever
/// a pilot says: what it has not seen must not be seen with a weight of
/// thousands.
const BY_POWER: f64 = 0.1;
const EVENLY: f64 = 0.1;

/// How to divide shadow rays among many lights.
#[derive(Clone, Debug)]
pub struct LightPicker {
    table: Option<Discrete>,
}

impl LightPicker {
    /// Lights are picked in proportion to their power; a sun counts with what
    /// falls on the bounded part of the scene.
    pub fn new(scene: &Scene) -> Self {
        let radius = scene
            .world
            .bounds()
            .map_or(1.0, |b| b.bounding_sphere().radius);
        let weights: Vec<f64> = scene
            .lights
            .iter()
            .map(|l| match (&l.light, l.light.power()) {
                (_, Some(power)) => power.mean(),
                (Light::Sun(sun), None) => (sun.irradiance * (PI * radius * radius)).mean(),
                (_, None) => 0.0,
            })
            .collect();
        Self {
            table: Discrete::new(&weights),
        }
    }

    /// The same with what a pilot says of each light, in any unit: lights are
    /// picked in proportion to it, but for a tenth by power and a tenth in
    /// equal numbers. Scores that are all zero, or not finite, change nothing.
    #[must_use]
    pub fn guided(&self, scores: &[f64]) -> Self {
        let total: f64 = scores.iter().sum();
        let Some(power) = self
            .table
            .as_ref()
            .filter(|_| total > 0.0 && total.is_finite())
        else {
            return self.clone();
        };
        let even = 1.0 / scores.len() as f64;
        let weight = |(i, score): (usize, &f64)| {
            let seen = (1.0 - BY_POWER - EVENLY) * score / total;
            // A light without power needs no rays.
            let evenly = if power.probability(i) > 0.0 {
                EVENLY * even
            } else {
                0.0
            };
            seen + BY_POWER * power.probability(i) + evenly
        };
        let weights: Vec<f64> = scores.iter().enumerate().map(weight).collect();
        Self {
            table: Discrete::new(&weights),
        }
    }

    /// The chances of the lights; `None` if none has any power.
    pub fn table(&self) -> Option<&Discrete> {
        self.table.as_ref()
    }
}

/// Reflected radiance of the light that arrives straight from the sources,
/// with about `rays` shadow rays, at least one: they are shared among the
/// lights where there are few, and go to lights that the picker picks where there
/// are many. Lights without extent need only one ray each.
pub fn direct_light(ctx: &Context<'_>, at: &DiffusePoint, stream: &mut Stream, rays: u32) -> Rgb {
    let mut sum = Rgb::BLACK;
    let add = |_, light, _| sum += light;
    if ctx.plan.soft_lights() {
        each_light::<true>(ctx, at, stream, rays, add);
    } else {
        each_light::<false>(ctx, at, stream, rays, add);
    }
    sum
}

/// The same by kind, and the shadow rays of each: first of lights without
/// extent, whose shadows are hard, then of those with.
pub fn direct_by_extent(
    ctx: &Context<'_>,
    at: &DiffusePoint,
    stream: &mut Stream,
    rays: u32,
) -> [(Rgb, u32); 2] {
    let mut sums = [(Rgb::BLACK, 0); 2];
    each_light::<true>(ctx, at, stream, rays, |i, light, rays| {
        let soft = ctx.scene.lights[i].light.has_extent();
        let sum = &mut sums[usize::from(soft)];
        sum.0 += light;
        sum.1 += rays;
    });
    sums
}

/// Calls `add` with a light, what it sends and the shadow rays that it took.
/// Lights may have extent, or none of the scene does (`SOFT`).
#[inline]
fn each_light<const SOFT: bool>(
    ctx: &Context<'_>,
    at: &DiffusePoint,
    stream: &mut Stream,
    rays: u32,
    mut add: impl FnMut(usize, Rgb, u32),
) {
    let lights = ctx.scene.lights.len();
    if lights <= rays as usize {
        let share = rays / lights.max(1) as u32;
        for (i, light) in ctx.scene.lights.iter().enumerate() {
            let count = if is_soft::<SOFT>(&light.light) {
                share
            } else {
                1
            };
            let mut one = Rgb::BLACK;
            for _ in 0..count {
                one += light_of::<SOFT>(ctx, at, i, place_on::<SOFT>(&light.light, stream));
            }
            add(i, one / f64::from(count), count);
        }
    } else if let Some(table) = &ctx.picker.table {
        let u = stream.next_1d();
        for k in 0..rays {
            // One stratum of the table for each ray.
            let (i, _) = table.sample((f64::from(k) + u) / f64::from(rays));
            let weight = 1.0 / (table.probability(i) * f64::from(rays));
            let u = place_on::<SOFT>(&ctx.scene.lights[i].light, stream);
            add(i, light_of::<SOFT>(ctx, at, i, u) * weight, 1);
        }
    }
}

/// Whether samples of a light differ.
#[inline]
fn is_soft<const SOFT: bool>(light: &Light) -> bool {
    SOFT && built::SOFT_SHADOWS && (!built::HARD_SHADOWS || light.has_extent())
}

/// What chooses a point of a light. Those without extent have only one: nothing
/// is drawn, and later numbers keep their meaning.
#[allow(
    clippy::inline_always,
    reason = "a call would cost as much as it saves where nothing is drawn"
)]
#[inline(always)]
fn place_on<const SOFT: bool>(light: &Light, stream: &mut Stream) -> [f64; 2] {
    if is_soft::<SOFT>(light) {
        stream.next_2d()
    } else {
        stream.skip(2);
        [0.0; 2]
    }
}

/// Reflected radiance of one source, by one shadow ray to the point of it that
/// `u` stands for.
pub fn from_light(ctx: &Context<'_>, at: &DiffusePoint, index: usize, u: [f64; 2]) -> Rgb {
    light_of::<true>(ctx, at, index, u)
}

/// The same, where lights may have extent or do not (`SOFT`).
#[inline]
fn light_of<const SOFT: bool>(
    ctx: &Context<'_>,
    at: &DiffusePoint,
    index: usize,
    u: [f64; 2],
) -> Rgb {
    let light = &ctx.scene.lights[index];
    let Some(sample) = light.light.sample_direct_of::<SOFT>(at.point.p, u) else {
        return Rgb::BLACK;
    };
    let cos = sample.wi.dot(at.ns);
    if cos <= 0.0 || sample.wi.dot(at.ng) <= 0.0 {
        return Rgb::BLACK;
    }
    let radiance = at.reflectance * sample.weight * (cos * FRAC_1_PI);
    if radiance.is_black() {
        return Rgb::BLACK;
    }
    radiance * shadow::transmittance(ctx, &at.point, &at.media, &sample, light.instance)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of lights with powers 1, 3, 0: scores 0, 2, 0 leave 0.1 by power and 0.1
    /// evenly, and nothing to the dark one; no scores change nothing.
    #[test]
    fn guided_picks_keep_their_floors() {
        let picker = LightPicker {
            table: Discrete::new(&[1.0, 3.0, 0.0]),
        };
        let chances = |picker: &LightPicker| -> Vec<f64> {
            let table = picker.table().expect("powers");
            (0..3).map(|i| table.probability(i)).collect()
        };
        let found = chances(&picker.guided(&[0.0, 2.0, 0.0]));
        let parts = [0.1 * 0.25 + 0.1 / 3.0, 0.8 + 0.1 * 0.75 + 0.1 / 3.0, 0.0];
        let sum: f64 = parts.iter().sum();
        for (chance, part) in found.iter().zip(parts) {
            assert!((chance - part / sum).abs() < 1e-12, "{found:?}");
        }
        for nothing in [[0.0; 3], [f64::NAN; 3], [f64::INFINITY; 3]] {
            assert_eq!(chances(&picker.guided(&nothing)), [0.25, 0.75, 0.0]);
        }
    }
}

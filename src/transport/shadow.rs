//! Shadow rays.

use crate::{
    geometry::{Ray, SurfacePoint},
    light::{DirectSample, Source},
    material::Material,
    optics,
    plan::Media,
};

use super::{Context, media_beside, meet};

/// Fraction of a light sample that arrives at `from`: 0 behind anything that
/// blocks, 1 in the clear, between them through thin panes. Refracting
/// surfaces block: their light comes as photons. `media` are the bodies of clear
/// media around `from`, on the side of the light; `body` is the instance that
/// shows the light: it does not shade itself.
pub fn transmittance(
    ctx: &Context<'_>,
    from: &SurfacePoint,
    media: &Media,
    sample: &DirectSample,
    body: Option<u32>,
) -> f64 {
    let (ray, distance) = match sample.source {
        Source::Point(target) => match from.spawn_towards(target) {
            Some(found) => found,
            None => return 0.0,
        },
        Source::Direction(wi) => (from.spawn(wi), f64::INFINITY),
    };
    if ctx.plan.nest().is_some() {
        return through_media(ctx, ray, distance, *media, body);
    }
    if ctx.plan.straight_surfaces() {
        return through_panes(ctx, ray, distance, body);
    }
    let blocked = ctx
        .scene
        .world
        .occluded(&ray, distance, |i| Some(i) == body);
    if blocked { 0.0 } else { 1.0 }
}

/// The same where something may let light through: surface by surface.
fn through_panes(ctx: &Context<'_>, mut ray: Ray, mut distance: f64, body: Option<u32>) -> f64 {
    let world = &ctx.scene.world;
    let mut transmittance = 1.0;
    for _ in 0..=ctx.max_depth {
        let Some(hit) = world.closest(&ray, distance) else {
            return transmittance;
        };
        if Some(hit.surface.instance) == body {
            return transmittance;
        }
        let material = &ctx.scene.object(hit.surface).material;
        let Material::Dielectric { ior, thin, .. } = *material else {
            return 0.0;
        };
        if !material.is_straight() {
            return 0.0;
        }
        let point = world.surface(&ray, &hit);
        if thin {
            transmittance *= optics::pane_transmittance(ray.dir.dot(point.ns()).abs(), ior);
        }
        let dir = ray.dir;
        ray = point.spawn(dir);
        distance -= hit.t;
    }
    // More panes than the depth limit allows.
    0.0
}

/// The same where bodies of clear media may overlap: surfaces that separate no
/// media let light through.
fn through_media(
    ctx: &Context<'_>,
    mut ray: Ray,
    mut distance: f64,
    mut media: Media,
    body: Option<u32>,
) -> f64 {
    let mut transmittance = 1.0;
    for _ in 0..=ctx.max_depth {
        let Some(met) = meet(ctx, &ray, distance, &mut media) else {
            return transmittance;
        };
        if Some(met.hit.surface.instance) == body {
            return transmittance;
        }
        let Material::Dielectric { ior, thin, .. } = met.material else {
            return 0.0;
        };
        if !met.material.is_straight() {
            return 0.0;
        }
        if thin {
            transmittance *= optics::pane_transmittance(ray.dir.dot(met.point.ns()).abs(), ior);
        }
        media = media_beside(ctx, media, &met.point, ray.dir);
        ray = met.point.spawn(ray.dir);
        distance -= met.hit.t;
    }
    0.0
}

//! What a path meets next, and between which media.
//!
//! Where bodies of clear media overlap, surfaces inside a body of higher rank
//! are none: a path goes through them as if nothing were there.

use glam::DVec3;

use crate::{
    geometry::{Hit, Ray, SurfacePoint},
    material::Material,
    plan::Media,
};

use super::Context;

/// A surface that a path has met.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    /// The hit; its `t` is the whole way from the ray's origin.
    pub hit: Hit,
    /// The point.
    pub point: SurfacePoint,
    /// The material between the media that are there: of a body's surface,
    /// `ior` is the index inside over that of what surrounds it here.
    pub material: Material,
}

/// The first surface that a ray meets before `t_max` metres. `media` are the
/// bodies in which it starts; they become those before the surface, but for
/// the body that it belongs to.
pub fn meet(ctx: &Context<'_>, ray: &Ray, t_max: f64, media: &mut Media) -> Option<Met> {
    if ctx.plan.nest.is_some() {
        meet_in::<true>(ctx, ray, t_max, media)
    } else {
        meet_in::<false>(ctx, ray, t_max, media)
    }
}

/// [`meet`] for a caller who knows whether bodies may overlap (`NESTED`): a
/// path that asked at every step would pay for it where none do.
#[allow(
    clippy::inline_always,
    reason = "a ray just made is still in registers, see `World::closest`"
)]
#[inline(always)]
pub(crate) fn meet_in<const NESTED: bool>(
    ctx: &Context<'_>,
    ray: &Ray,
    t_max: f64,
    media: &mut Media,
) -> Option<Met> {
    if NESTED {
        return meet_nested(ctx, *ray, t_max, media);
    }
    let hit = ctx.scene.world.closest(ray, t_max)?;
    Some(Met {
        hit,
        point: ctx.scene.world.surface(ray, &hit),
        material: ctx.scene.object(hit.surface).material,
    })
}

/// The bodies around a path in `media` that goes on from a point in direction
/// `dir`.
#[inline]
pub fn media_beside(ctx: &Context<'_>, media: Media, point: &SurfacePoint, dir: DVec3) -> Media {
    match &ctx.plan.nest {
        None => media,
        Some(nested) => {
            let inside = point.ng.dot(dir) < 0.0;
            nested.nest.beside(point.surface.instance, inside, &media)
        }
    }
}

/// A bound for the loop alone: a straight line through more hidden surfaces
/// than this ends as if nothing were met.
const MOST_HIDDEN: u32 = 1 << 20;

/// The same as [`meet`] among bodies that may overlap.
#[inline(never)]
fn meet_nested(ctx: &Context<'_>, mut ray: Ray, t_max: f64, media: &mut Media) -> Option<Met> {
    let world = &ctx.scene.world;
    // Only asked for where there is one.
    let nest = &ctx.plan.nest.as_ref()?.nest;
    let mut way = 0.0;
    for _ in 0..MOST_HIDDEN {
        let hit = world.closest(&ray, t_max - way)?;
        let point = world.surface(&ray, &hit);
        way += hit.t;
        let met = Met {
            hit: Hit { t: way, ..hit },
            point,
            material: ctx.scene.object(hit.surface).material,
        };
        let Some(rank) = nest.rank(hit.surface.instance) else {
            return Some(met);
        };
        if let Some(ior) = nest.ior(rank, media) {
            return Some(Met {
                material: met.material.with_index(ior),
                ..met
            });
        }
        *media = media_beside(ctx, *media, &point, ray.dir);
        ray = point.spawn(ray.dir);
    }
    None
}

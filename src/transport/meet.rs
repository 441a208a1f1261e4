//! What a path meets next, and between which media.
//!
//! Where bodies of clear media overlap, surfaces inside a body of higher rank
//! are none: a path goes through them as if nothing were there.

use glam::DVec3;

use crate::{
    geometry::{Hit, Ray, SurfacePoint},
    material::Material,
    plan::{Media, Nest},
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
#[allow(
    clippy::inline_always,
    reason = "a ray just made is still in registers, see `World::closest`"
)]
#[inline(always)]
pub fn meet(ctx: &Context<'_>, ray: &Ray, t_max: f64, media: &mut Media) -> Option<Met> {
    if let Some(nested) = &ctx.plan.nest {
        // Taken apart, so that the other way stays in registers.
        let (hit, point, material) = meet_nested(ctx, &nested.nest, *ray, t_max, media)?;
        return Some(Met {
            hit,
            point,
            material,
        });
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
fn meet_nested(
    ctx: &Context<'_>,
    nest: &Nest,
    mut ray: Ray,
    t_max: f64,
    media: &mut Media,
) -> Option<(Hit, SurfacePoint, Material)> {
    let world = &ctx.scene.world;
    let mut way = 0.0;
    for _ in 0..MOST_HIDDEN {
        let hit = world.closest(&ray, t_max - way)?;
        let point = world.surface(&ray, &hit);
        way += hit.t;
        let hit = Hit { t: way, ..hit };
        let material = ctx.scene.object(hit.surface).material;
        let Some(rank) = nest.rank(hit.surface.instance) else {
            return Some((hit, point, material));
        };
        if let Some(ior) = nest.ior(rank, media) {
            return Some((hit, point, material.with_index(ior)));
        }
        *media = media_beside(ctx, *media, &point, ray.dir);
        ray = point.spawn(ray.dir);
    }
    None
}

//! What a path meets next, and between which media.
//!
//! Where bodies of clear media overlap, surfaces inside a body of higher rank
//! are none: a path goes through them as if nothing were there.

use crate::{
    geometry::{Hit, Ray, SurfacePoint},
    material::Material,
    plan::{Media, Nest},
};

use super::{Bend, Context, Lobe};

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
    /// The bodies on the near side.
    pub near: Media,
    /// The bodies on the far side.
    pub beyond: Media,
}

impl Met {
    /// The bodies around a path that goes on along a lobe.
    #[inline]
    pub fn media_along(&self, lobe: &Lobe) -> Media {
        match lobe.bend {
            Bend::Mirror { .. } => self.near,
            Bend::Straight | Bend::Refract { .. } => self.beyond,
        }
    }
}

/// The first surface that a ray meets before `t_max` metres; `media` are the
/// bodies in which it starts.
#[allow(
    clippy::inline_always,
    reason = "a ray just made is still in registers, see `World::closest`"
)]
#[inline(always)]
pub fn meet(ctx: &Context<'_>, ray: &Ray, t_max: f64, media: &Media) -> Option<Met> {
    if let Some(nested) = &ctx.plan.nest {
        // Taken apart, so that the other way stays in registers.
        let (hit, point, material, near, beyond) =
            meet_nested(ctx, &nested.nest, *ray, t_max, *media)?;
        return Some(Met {
            hit,
            point,
            material,
            near,
            beyond,
        });
    }
    let hit = ctx.scene.world.closest(ray, t_max)?;
    Some(Met {
        hit,
        point: ctx.scene.world.surface(ray, &hit),
        material: ctx.scene.object(hit.surface).material,
        near: Media::NONE,
        beyond: Media::NONE,
    })
}

/// A bound for the loop alone: a straight line through more hidden surfaces
/// than this ends as if nothing were met.
const MOST_HIDDEN: u32 = 1 << 20;

/// The same among bodies that may overlap.
#[inline(never)]
fn meet_nested(
    ctx: &Context<'_>,
    nest: &Nest,
    mut ray: Ray,
    t_max: f64,
    mut media: Media,
) -> Option<(Hit, SurfacePoint, Material, Media, Media)> {
    let world = &ctx.scene.world;
    let mut way = 0.0;
    for _ in 0..MOST_HIDDEN {
        let hit = world.closest(&ray, t_max - way)?;
        let point = world.surface(&ray, &hit);
        way += hit.t;
        let hit = Hit { t: way, ..hit };
        let material = ctx.scene.object(hit.surface).material;
        let enters = point.ng.dot(ray.dir) < 0.0;
        let Some(crossing) = nest.crossing(hit.surface.instance, enters, &media) else {
            return Some((hit, point, material, media, media));
        };
        if let Some(ior) = crossing.ior {
            let material = material.with_index(ior);
            return Some((hit, point, material, crossing.near, crossing.beyond));
        }
        media = crossing.beyond;
        ray = point.spawn(ray.dir);
    }
    None
}

//! What a path meets next, and between which media.
//!
//! Where bodies of clear media overlap, surfaces inside a body of higher rank
//! are none: a path goes through them as if nothing were there. Surfaces of
//! several bodies in one place are one surface, between the media on its sides,
//! and where one that is opaque is in the same place, that is all there is.

use glam::DVec3;

use crate::{
    geometry::{Hit, Ray, SurfacePoint},
    material::Material,
    numeric::gamma,
    plan::{Media, Nest},
};

use super::Context;

/// A surface that a path has met.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    /// The hit; its `t` is the whole way from the ray's origin.
    pub hit: Hit,
    /// The point; where several surfaces coincide, that of one of them with an
    /// error that holds all.
    pub point: SurfacePoint,
    /// The material between the media that are there: of a body's surface,
    /// `ior` is the index inside over that of what surrounds it here.
    pub material: Material,
}

/// The first surface that a ray meets before `t_max` metres. `media` are the
/// bodies in which it starts; they become those before the surface, but for
/// the body that it belongs to.
pub fn meet(ctx: &Context<'_>, ray: &Ray, t_max: f64, media: &mut Media) -> Option<Met> {
    if ctx.plan.nest().is_some() {
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
    match ctx.plan.nest() {
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

/// The same as [`meet`] among bodies that may overlap, or touch what is opaque.
#[inline(never)]
fn meet_nested(ctx: &Context<'_>, mut ray: Ray, t_max: f64, media: &mut Media) -> Option<Met> {
    let world = &ctx.scene.world;
    // Only asked for where there is one.
    let nest = &ctx.plan.nest()?.nest;
    let mut way = 0.0;
    for _ in 0..MOST_HIDDEN {
        let (hit, crowded) = world.closest_and_crowd(&ray, t_max - way, NEAR)?;
        let point = world.surface(&ray, &hit);
        way += hit.t;
        let met = Met {
            hit: Hit { t: way, ..hit },
            point,
            material: ctx.scene.object(hit.surface).material,
        };
        // Errors are far smaller still, so that only at grazing angles a surface
        // outside of the window may be in the same place.
        let place = if crowded || point.ng.dot(ray.dir).abs() < GRAZING {
            Place::of(ctx, nest, &ray, &hit, point, *media)
        } else {
            let media = *media;
            Place {
                point,
                media,
                wall: None,
            }
        };
        if let Some(wall) = place.wall {
            return Some(Met {
                hit: Hit {
                    t: way - hit.t + wall.t,
                    ..wall
                },
                point: place.point,
                material: ctx.scene.object(wall.surface).material,
            });
        }
        if nest.rank(hit.surface.instance).is_none() {
            return Some(met);
        }
        let [inner, outer] =
            [true, false].map(|inside| nest.beside(hit.surface.instance, inside, &place.media));
        if let Some(ior) = nest.ior(&inner, &outer) {
            *media = place.media;
            return Some(Met {
                point: place.point,
                material: met.material.with_index(ior),
                ..met
            });
        }
        *media = media_beside(ctx, place.media, &place.point, ray.dir);
        ray = place.point.spawn(ray.dir);
    }
    None
}

/// Over the coordinates, how near to a point surfaces are looked at: far more
/// than errors, far less than what is modelled.
const NEAR: f64 = 1.0 / (1u64 << 30) as f64;

/// A cosine below which rays graze.
const GRAZING: f64 = 1.0 / 256.0;

/// Where a path meets a surface, and maybe others.
struct Place {
    point: SurfacePoint,
    /// The bodies around the path before; of those whose surfaces coincide with
    /// this one, on which side of it they are.
    media: Media,
    /// The hit on an opaque surface, if one coincides with a clear one here:
    /// `point` is on it, and what goes on from there starts beyond both.
    wall: Option<Hit>,
}

impl Place {
    /// Surfaces at `t_1 < t_2` with the normals `n_1`, `n_2` and the errors
    /// `e_1`, `e_2` are in one place if `(t_2 - t_1) max |n_i . d|` is at most
    /// `e_1 + e_2` and the rounding of the ray's own numbers, as in solids.
    fn of(
        ctx: &Context<'_>,
        nest: &Nest,
        ray: &Ray,
        hit: &Hit,
        point: SurfacePoint,
        media: Media,
    ) -> Self {
        let world = &ctx.scene.world;
        let far = ray.origin.abs().max_element() + hit.t;
        let near = NEAR * far;
        let this = hit.surface.instance;
        let is_opaque = |i: u32| ctx.scene.objects[i as usize].material.is_opaque();
        let on_wall = is_opaque(this);
        let is_body = |i: u32| nest.rank(i).is_some();
        // Two surfaces that are opaque, or neither opaque nor bodies', are two.
        let counts = |i: u32| i != this && (is_opaque(i) != on_wall || is_body(i) && is_body(this));
        let (others, _) = world.neighbours(point.p, near, counts);
        let mut place = Self {
            point,
            media,
            wall: None,
        };
        let mut error = point.error;
        let rounding = gamma(24) * far;
        let cosine = point.ng.dot(ray.dir);
        for i in others {
            // The first surface of all is the one that was met.
            let Some(next) = world.closest_on(i, ray, hit.t + near / cosine.abs()) else {
                continue;
            };
            let beside = world.surface(ray, &next);
            let errors = point.error + beside.error + rounding;
            let slope = beside.ng.dot(ray.dir);
            if (next.t - hit.t) * slope.abs().max(cosine.abs()) > errors {
                continue;
            }
            // A ray that goes on from here starts beyond them all.
            error = error.max(2.0 * errors);
            if on_wall {
                place.wall = Some(*hit);
            } else if is_opaque(i) {
                place.wall = Some(next);
                place.point = beside;
            } else {
                place.media = nest.shared(place.media, i, (slope < 0.0) == (cosine < 0.0));
            }
        }
        place.point.error = place.point.error.max(error);
        place
    }
}

//! The walk through specular steps to the first surface where light can be
//! gathered or found.

use crate::{
    geometry::{Ray, SurfacePoint},
    material::Material,
    plan::Media,
    sampling::Stream,
    spectrum::Rgb,
};

use super::{Carried, Context, Lobe, Lobes, Met, lobes, media_beside, meet_in};

/// Where a walk ends.
#[derive(Clone, Copy, Debug)]
pub enum End {
    /// Nothing was met.
    Escaped,
    /// A finite lobe or the body of a light.
    Surface {
        /// The point.
        point: SurfacePoint,
        /// Its material: `Diffuse` or `Black`.
        material: Material,
    },
    /// The depth limit was reached.
    Truncated,
}

/// A camera-side path in mid-walk.
#[derive(Clone, Copy, Debug)]
pub struct Walker {
    /// The ray to follow next.
    pub ray: Ray,
    /// Factor on what will be found.
    pub throughput: Rgb,
    /// How much the path matters, from 0 to 1: the largest channel of the
    /// throughput without the index factors, which radiance gains again on
    /// leaving the medium or, seen from within, was brighter by from the
    /// start.
    pub strength: f64,
    /// Length of the path so far, in metres.
    pub length: f64,
    /// Surface interactions so far.
    pub depth: u32,
    /// The bodies of clear media around the ray's origin.
    pub media: Media,
}

impl Walker {
    /// A path that starts with `ray` at the camera.
    pub fn from_camera(ctx: &Context<'_>, ray: Ray) -> Self {
        let media = match ctx.plan.nest() {
            Some(nested) => nested.starts.camera.at(&ctx.scene.world, ray.origin),
            None => Media::NONE,
        };
        Self::new(ray, media)
    }

    /// A path that starts with `ray` in `media`.
    pub fn new(ray: Ray, media: Media) -> Self {
        Self {
            ray,
            throughput: Rgb::WHITE,
            strength: 1.0,
            length: 0.0,
            depth: 0,
            media,
        }
    }

    /// Follows mirrors, glass and panes to an end. Where light divides, the
    /// weaker way is offered to `branch`: if it takes it (returns `true`),
    /// both ways are followed, the stronger one here. If not, a coin from
    /// `stream` decides on one.
    pub fn walk(
        &mut self,
        ctx: &Context<'_>,
        stream: &mut Stream,
        branch: &mut impl FnMut(&Walker) -> bool,
    ) -> End {
        if ctx.plan.nest().is_some() {
            self.walk_in::<true>(ctx, stream, branch)
        } else {
            self.walk_in::<false>(ctx, stream, branch)
        }
    }

    /// The same, where bodies may overlap or not (`NESTED`).
    #[inline]
    fn walk_in<const NESTED: bool>(
        &mut self,
        ctx: &Context<'_>,
        stream: &mut Stream,
        branch: &mut impl FnMut(&Walker) -> bool,
    ) -> End {
        loop {
            let Some(met) = meet_in::<NESTED>(ctx, &self.ray, f64::INFINITY, &mut self.media)
            else {
                return End::Escaped;
            };
            let Met {
                point, material, ..
            } = met;
            self.depth += 1;
            self.length += met.hit.t;
            // Most walks end here, without a look at what glass would do.
            if !material.is_specular() {
                return End::Surface { point, material };
            }
            let Some(lobes) = lobes(&material, &point, self.ray.dir, Carried::Radiance) else {
                return End::Surface { point, material };
            };
            if self.depth >= ctx.max_depth {
                return End::Truncated;
            }
            let before = *self;
            match lobes {
                Lobes::One(lobe) => self.follow::<NESTED>(ctx, &met, &lobe, 1.0),
                Lobes::Two(a, b) => {
                    let (main, side) = if a.share < b.share { (b, a) } else { (a, b) };
                    let mut other = before;
                    other.follow::<NESTED>(ctx, &met, &side, side.share);
                    if side.share > 0.0 && branch(&other) {
                        self.follow::<NESTED>(ctx, &met, &main, main.share);
                    } else {
                        let lobe = lobes.choose(|| stream.next_1d());
                        self.follow::<NESTED>(ctx, &met, &lobe, 1.0);
                    }
                }
            }
            if self.throughput.is_black() {
                return End::Escaped;
            }
        }
    }

    /// Goes on along a lobe, with the given part of what is carried.
    #[inline]
    fn follow<const NESTED: bool>(&mut self, ctx: &Context<'_>, met: &Met, lobe: &Lobe, part: f64) {
        self.throughput *= lobe.weight * part;
        self.strength *= lobe.weight.max() / lobe.index * part;
        self.ray = met.point.spawn(lobe.dir);
        if NESTED {
            self.media = media_beside(ctx, self.media, &met.point, lobe.dir);
        }
    }
}

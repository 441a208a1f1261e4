//! The walk through specular steps to the first surface where light can be
//! gathered or found.

use crate::{
    geometry::{Hit, Ray, SurfacePoint},
    material::Material,
    sampling::Stream,
    spectrum::Rgb,
};

use super::{Carried, Context, Lobes, lobes};

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
    /// Length of the path so far, in metres.
    pub length: f64,
    /// Surface interactions so far.
    pub depth: u32,
}

impl Walker {
    /// A path that starts with `ray`.
    pub fn new(ray: Ray) -> Self {
        Self {
            ray,
            throughput: Rgb::WHITE,
            length: 0.0,
            depth: 0,
        }
    }

    /// Follows mirrors, glass and panes to an end. At the first `splits`
    /// surfaces where light divides, both ways are followed: one here, the
    /// other is handed to `branch` with the number of splits left to it.
    /// Later ones toss a coin from `stream`.
    pub fn walk(
        &mut self,
        ctx: &Context<'_>,
        stream: &mut Stream,
        splits: u32,
        branch: &mut impl FnMut(Walker, u32),
    ) -> End {
        let mut splits = splits;
        loop {
            let Some(hit) = ctx.scene.world.closest(&self.ray, f64::INFINITY) else {
                return End::Escaped;
            };
            let point = self.arrive(ctx, &hit);
            let material = ctx.scene.object(hit.surface).material;
            let Some(lobes) = lobes(&material, &point, self.ray.dir, Carried::Radiance) else {
                return End::Surface { point, material };
            };
            if self.depth >= ctx.max_depth {
                return End::Truncated;
            }
            let lobe = match lobes {
                Lobes::Two(a, b) if splits > 0 && a.share > 0.0 => {
                    splits -= 1;
                    let (main, side) = if a.share < b.share { (b, a) } else { (a, b) };
                    let mut other = *self;
                    other.throughput *= side.weight * side.share;
                    other.ray = point.spawn(side.dir);
                    branch(other, splits);
                    self.throughput *= main.share;
                    main
                }
                lobes => lobes.choose(|| stream.next_1d()),
            };
            self.throughput *= lobe.weight;
            if self.throughput.is_black() {
                return End::Escaped;
            }
            self.ray = point.spawn(lobe.dir);
        }
    }

    fn arrive(&mut self, ctx: &Context<'_>, hit: &Hit) -> SurfacePoint {
        self.depth += 1;
        self.length += hit.t;
        ctx.scene.world.surface(&self.ray, hit)
    }
}

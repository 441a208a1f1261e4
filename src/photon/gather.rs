//! Asking the map at a surface point, with what stands around it.

use std::{
    cell::OnceCell,
    f64::consts::{FRAC_1_SQRT_2, TAU},
};

use glam::DVec3;

use crate::{
    material::Material,
    numeric::{Frame, trig},
    transport::{Context, DiffusePoint},
};

use super::{Ellipse, Gathered, Kernels, Query, Vicinity};

/// Directions in which walls around a gather point are looked for.
const DIRECTIONS: usize = 32;

/// Smallest share of a kernel that is made up for: in a narrow gap the share
/// is not known well enough to divide by it.
const LEAST_SHARE: f64 = 1.0 / 12.0;

/// Irradiance at a diffuse point by the photons whose kernels reach it, those
/// behind walls left out, and the kernels' lost parts made up for. `u` in
/// `[0, 1)` turns the pattern in which walls are looked for.
///
/// Without the first, light would leak through thin walls; without the second,
/// floors would darken along them. Nothing of this is paid where no wall comes
/// near.
pub fn gather(
    ctx: &Context<'_>,
    vicinity: &mut Vicinity<'_>,
    at: &DiffusePoint,
    kernels: &Kernels,
    u: f64,
) -> Gathered {
    let query = Query {
        p: at.point.p,
        n: at.ng,
        kernels: *kernels,
    };
    if vicinity.map().is_empty() {
        return Gathered::default();
    }
    let world = &ctx.scene.world;
    let own = at.point.surface.instance;
    let farthest = kernels.farthest();
    let draws_in = vicinity.draws_in();
    let is_other_wall = |i: u32| i != own && is_wall(&ctx.scene.objects[i as usize].material);
    // Most points have no photon near, and most photons no wall.
    let surroundings = OnceCell::new();
    let horizon = OnceCell::new();
    let walls =
        || surroundings.get_or_init(|| world.neighbours(at.point.p, farthest, is_other_wall));
    let clear = || {
        let (walls, clear) = walls();
        if walls.is_empty() {
            f64::INFINITY
        } else {
            *clear
        }
    };
    vicinity.irradiance(&query, clear, |offset, ellipse| {
        let (walls, clear) = walls();
        // With room for the photon's rounded place.
        let near = 4.0 * offset.length_squared() <= clear * clear;
        let seen = near || {
            let way = at.point.spawn_towards(at.point.p + offset);
            way.is_none_or(|(ray, distance)| !world.occluded_by(walls, &ray, distance))
        };
        if !seen {
            return [0.0; 3];
        }
        let horizon = horizon.get_or_init(|| Horizon::around(ctx, at, walls, farthest, u));
        if draws_in {
            horizon.all_shares(ellipse).map(f64::recip)
        } else {
            let [whole] = horizon.shares(ellipse, [1.0]);
            [whole.recip(), 0.0, 0.0]
        }
    })
}

/// Whether a surface separates what lies on its two sides: light that passes
/// glass is no leak.
pub fn is_wall(material: &Material) -> bool {
    match material {
        Material::Diffuse { .. } | Material::Mirror { .. } | Material::Black => true,
        Material::Dielectric { .. } => false,
    }
}

/// How far the tangent plane around a point is free of walls.
struct Horizon {
    /// Unit directions and the free way along each, in metres.
    free: [(DVec3, f64); DIRECTIONS],
    /// The shortest of these.
    nearest: f64,
}

impl Horizon {
    fn around(ctx: &Context<'_>, at: &DiffusePoint, walls: &[u32], farthest: f64, u: f64) -> Self {
        let frame = Frame::around(at.ng);
        let free: [(DVec3, f64); DIRECTIONS] = std::array::from_fn(|i| {
            let (sin, cos) = trig::sin_cos(TAU * (i as f64 + u) / DIRECTIONS as f64);
            let dir = (frame.s * cos + frame.t * sin).normalize();
            let ray = at.point.spawn(dir);
            let met = ctx.scene.world.closest_of(walls, &ray, farthest);
            (dir, met.unwrap_or(f64::INFINITY))
        });
        let nearest = free.iter().fold(f64::INFINITY, |least, f| least.min(f.1));
        Self { free, nearest }
    }

    /// The shares that walls leave of a kernel around the point and of those of
    /// half and of a quarter of its area. To those that no wall reaches they leave
    /// all.
    fn all_shares(&self, ellipse: &Ellipse) -> [f64; 3] {
        if ellipse.major * FRAC_1_SQRT_2 <= self.nearest {
            let [whole] = self.shares(ellipse, [1.0]);
            [whole, 1.0, 1.0]
        } else {
            self.shares(ellipse, [1.0, 2.0, 4.0])
        }
    }

    /// The shares that walls leave of a kernel around the point, drawn in to
    /// areas smaller by these factors, above 0.
    fn shares<const N: usize>(&self, ellipse: &Ellipse, narrower: [f64; N]) -> [f64; N] {
        if ellipse.major <= self.nearest {
            return [1.0; N];
        }
        let (a2, b2) = (ellipse.major * ellipse.major, ellipse.minor * ellipse.minor);
        let (mut left, mut all) = ([0.0; N], 0.0);
        for &(dir, free) in &self.free {
            let c = dir.dot(ellipse.axis);
            let c2 = c * c;
            // The squared way to the ellipse's rim, and the part of the
            // kernel's mass within a smaller way, 2 x - x^2 for x its square
            // over that of the rim.
            let rim2 = a2 * b2 / (b2 * c2 + a2 * (1.0 - c2).max(0.0));
            let inside = free * free / rim2;
            all += rim2;
            for (left, narrower) in left.iter_mut().zip(narrower) {
                let x = (narrower * inside).min(1.0);
                *left += rim2 * x * (2.0 - x);
            }
        }
        left.map(|left| (left / all).max(LEAST_SHARE))
    }
}

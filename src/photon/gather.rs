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

/// Directions in which walls around a gather point are looked for, four to each
/// of [`TURNS`]. Twice as many leave the same errors in `cornell_glass`, to four
/// digits of relMSE.
const DIRECTIONS: usize = 16;

/// Directions that are worked out side by side.
const LANES: usize = 4;

/// Cosines and sines of the first quarter of the directions.
const TURNS: [[f64; 2]; DIRECTIONS / 4] = [
    [1.0, 0.0],
    [0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.382_683_432_365_089_8, 0.923_879_532_511_286_7],
];

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
    /// Unit vectors that span the plane.
    frame: [DVec3; 2],
    /// Unit directions in it.
    x: [f32; DIRECTIONS],
    y: [f32; DIRECTIONS],
    /// The square of the free way along each, in units of the farthest way that
    /// matters.
    free2: [f32; DIRECTIONS],
    /// That unit in metres.
    unit: f64,
    /// The shortest free way in metres.
    nearest: f64,
}

impl Horizon {
    fn around(ctx: &Context<'_>, at: &DiffusePoint, walls: &[u32], farthest: f64, u: f64) -> Self {
        let Frame { s, t, .. } = Frame::around(at.ng);
        let mut horizon = Self {
            frame: [s, t],
            x: [0.0; DIRECTIONS],
            y: [0.0; DIRECTIONS],
            free2: [f32::INFINITY; DIRECTIONS],
            unit: farthest,
            nearest: f64::INFINITY,
        };
        let (sin, cos) = trig::sin_cos(TAU * u / DIRECTIONS as f64);
        for i in 0..DIRECTIONS {
            let [turn_cos, turn_sin] = TURNS[i / 4];
            let (x, y) = (
                cos * turn_cos - sin * turn_sin,
                cos * turn_sin + sin * turn_cos,
            );
            let (x, y) = [(x, y), (-y, x), (-x, -y), (y, -x)][i % 4];
            (horizon.x[i], horizon.y[i]) = (x as f32, y as f32);
            let ray = at.point.spawn((s * x + t * y).normalize());
            if let Some(free) = ctx.scene.world.closest_of(walls, &ray, farthest) {
                horizon.free2[i] = (free / farthest).powi(2) as f32;
                horizon.nearest = horizon.nearest.min(free);
            }
        }
        horizon
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
    /// areas smaller by these factors, above 0. Like kernels, worked out in single
    /// precision, in lengths of the major axis.
    fn shares<const N: usize>(&self, ellipse: &Ellipse, narrower: [f32; N]) -> [f64; N] {
        if ellipse.major <= self.nearest {
            return [1.0; N];
        }
        let [ax, ay] = self.frame.map(|v| v.dot(ellipse.axis) as f32);
        let flat = (ellipse.minor / ellipse.major).powi(2) as f32;
        let scale = (self.unit / ellipse.major).powi(2) as f32;
        let mut left = [[0.0f32; LANES]; N];
        let mut all = [0.0f32; LANES];
        for first in (0..DIRECTIONS).step_by(LANES) {
            for lane in 0..LANES {
                let i = first + lane;
                let c = self.x[i] * ax + self.y[i] * ay;
                let c2 = c * c;
                // The squared way to the ellipse's rim, and the part of the
                // kernel's mass within a smaller way, 2 x - x^2 for x its square
                // over that of the rim.
                let rim2 = flat / (flat * c2 + (1.0 - c2).max(0.0));
                let inside = self.free2[i] * scale / rim2;
                all[lane] += rim2;
                for (left, narrower) in left.iter_mut().zip(narrower) {
                    let x = (narrower * inside).min(1.0);
                    left[lane] += rim2 * x * (2.0 - x);
                }
            }
        }
        let sum = |s: [f32; LANES]| (s[0] + s[1]) + (s[2] + s[3]);
        let all = sum(all);
        left.map(|left| f64::from(sum(left) / all).max(LEAST_SHARE))
    }
}

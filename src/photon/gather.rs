//! Asking the map at a surface point, with what stands around it.

use glam::DVec3;

use crate::{
    numeric::{Frame, trig},
    transport::{Context, DiffusePoint},
};

use super::{Gathered, PhotonMap};

/// Places at which a kernel that walls cut is probed for what is left of it.
const PROBES: u32 = 24;

/// Irradiance at a diffuse point by the photons within `radius` metres, those
/// behind other surfaces left out, and the kernel's lost part made up for.
/// `u` in `[0, 1)` turns the pattern of probes.
///
/// Without the first, light would leak through thin walls; without the second,
/// floors would darken along them. Nothing of this is paid where no other
/// surface comes near.
pub fn gather(
    ctx: &Context<'_>,
    map: &PhotonMap,
    at: &DiffusePoint,
    radius: f64,
    u: f64,
) -> Gathered {
    let world = &ctx.scene.world;
    let own = at.point.surface.instance;
    let mut walls = world.neighbours(at.point.p, radius, own);
    // What lets light through in a straight line is no wall.
    walls.retain(|&i| !ctx.scene.objects[i as usize].material.is_straight());
    if walls.is_empty() {
        return map.irradiance(at.point.p, at.ng, radius, |_| true);
    }
    let sees = |q: DVec3| {
        let way = at.point.spawn_towards(q);
        way.is_none_or(|(ray, distance)| !world.occluded_by(&walls, &ray, distance))
    };
    let found = map.irradiance(at.point.p, at.ng, radius, sees);
    if found.irradiance.is_black() && found.bounced.is_black() {
        return found;
    }
    let share = seen_share(at, radius, u, sees);
    Gathered {
        irradiance: found.irradiance / share,
        bounced: found.bounced / share,
        ..found
    }
}

/// The share of the kernel's mass over the tangent plane that `sees` accepts,
/// above 0.
fn seen_share(at: &DiffusePoint, radius: f64, u: f64, sees: impl Fn(DVec3) -> bool) -> f64 {
    /// A full turn over the golden ratio squared: the sunflower's angle, which
    /// spreads any number of probes evenly.
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let frame = Frame::around(at.ng);
    let (mut seen, mut all) = (0.0, 0.0);
    for i in 0..PROBES {
        // Equal areas of the disc; the kernel's height is the weight.
        let r2 = (f64::from(i) + 0.5) / f64::from(PROBES);
        let (sin, cos) = trig::sin_cos(std::f64::consts::TAU * u + GOLDEN_ANGLE * f64::from(i));
        let r = radius * r2.sqrt();
        let weight = 1.0 - r2;
        all += weight;
        if sees(at.point.p + frame.s * (r * cos) + frame.t * (r * sin)) {
            seen += weight;
        }
    }
    // The point itself is seen, whatever the probes say: a photon was.
    seen.max(1.0) / all
}

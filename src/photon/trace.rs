//! One photon path, from its launch to its end.

use glam::DVec3;

use crate::{
    geometry::Ray,
    material::Material,
    sampling::Stream,
    spectrum::Rgb,
    transport::{Carried, Context, Lobe, lobes},
};

use super::{Emission, LightTally, emit};

/// Light that landed at a finite lobe after it was reflected or bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Where it landed, metres.
    pub position: DVec3,
    /// Geometric normal of the surface on the side from which it came.
    pub normal: DVec3,
    /// Flux in W, not yet divided by the number of emitted paths.
    pub flux: Rgb,
}

/// Below this fraction of its launched flux a photon plays roulette at
/// absorbing surfaces.
const ROULETTE_BELOW: f64 = 0.25;

/// Follows a photon; what becomes of its flux goes into `tally`.
pub fn trace(
    ctx: &Context<'_>,
    emission: &Emission,
    stream: &mut Stream,
    tally: &mut LightTally,
) -> Option<Photon> {
    let mut flux = emission.flux;
    tally.paths += 1;
    tally.launched += flux.mean();
    if flux.is_black() {
        return None;
    }
    let mut ray: Ray = emission.ray;
    let mut bent = false;
    for depth in 0..=ctx.max_depth {
        let Some(hit) = ctx.scene.world.closest(&ray, f64::INFINITY) else {
            tally.escaped += flux.mean();
            return None;
        };
        let point = ctx.scene.world.surface(&ray, &hit);
        let material = ctx.scene.object(hit.surface).material;
        if depth == 0 {
            tally.landed_paths += 1;
        }
        let Some(lobes) = lobes(&material, &point, ray.dir, Carried::Flux) else {
            return end(&material, &point, ray.dir, flux, bent, tally);
        };
        if depth == ctx.max_depth {
            break;
        }
        stream.seek(emit::DIMENSIONS + 2 * depth);
        let lobe = lobes.choose(|| stream.next_1d());
        flux = scatter(flux, &lobe, tally);
        let q = survival(flux, emission.flux);
        if q < 1.0 && stream.next_1d() >= q {
            tally.roulette_loss += flux.mean();
            return None;
        }
        tally.roulette_gain += flux.mean() * (1.0 / q - 1.0);
        flux = flux / q;
        bent |= lobe.bent;
        ray = point.spawn(lobe.dir);
    }
    tally.truncated += flux.mean();
    tally.truncated_paths += 1;
    None
}

/// The flux after a specular step, with its change booked.
fn scatter(flux: Rgb, lobe: &Lobe, tally: &mut LightTally) -> Rgb {
    let shaded = flux * lobe.shading;
    tally.shading_change += shaded.mean() - flux.mean();
    let out = flux * lobe.weight;
    tally.absorbed += shaded.mean() - out.mean();
    out
}

/// Probability of going on: one while the photon is strong, and such that a
/// weak survivor is back at the threshold. Splitting at glass never weakens a
/// photon (it chooses), so this acts only where mirrors absorb.
fn survival(flux: Rgb, launched: Rgb) -> f64 {
    let floor = ROULETTE_BELOW * launched.max();
    let q = flux.max() / floor;
    if q < 1.0 {
        q.max(f64::MIN_POSITIVE)
    } else {
        1.0
    }
}

/// The photon's end at a surface that is not specular.
fn end(
    material: &Material,
    point: &crate::geometry::SurfacePoint,
    d: DVec3,
    flux: Rgb,
    bent: bool,
    tally: &mut LightTally,
) -> Option<Photon> {
    if !material.is_finite() {
        tally.absorbed += flux.mean();
        return None;
    }
    if !bent {
        tally.direct += flux.mean();
        return None;
    }
    tally.stored += flux.mean();
    tally.photons += 1;
    let normal = if point.ng.dot(d) > 0.0 {
        -point.ng
    } else {
        point.ng
    };
    Some(Photon {
        position: point.p,
        normal,
        flux,
    })
}

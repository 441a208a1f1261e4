//! What the eye sees before its path is scattered, and what a diffuse point
//! gets straight from the lights: the part that all methods do alike that
//! look from the eye and find indirect light in their own way.

use crate::{
    film::{Layer, PixelSample},
    spectrum::Rgb,
    transport::{Carried, Context, DiffusePoint},
};

use super::{
    flight::{Flight, Met, arriving, density},
    random::Random,
    setup::Setup,
    sources::{Connection, Sources},
};

/// Follows a path through mirrors and glass to the first diffuse surface.
pub(super) fn first_diffuse(
    setup: &Setup<'_>,
    flight: &mut Flight,
    random: &mut impl Random,
) -> Option<DiffusePoint> {
    loop {
        match flight.next(&setup.context(), random) {
            Met::Diffuse(at) => return Some(at),
            Met::Bent { .. } => {}
            Met::Sky | Met::End | Met::Light { .. } => return None,
        }
    }
}

/// The same for a path that comes from the eye: if it ends at a light instead,
/// the light goes to the sample. Where `sees_bent` is false, mirrors and glass
/// are black.
pub(super) fn first_seen(
    setup: &Setup<'_>,
    flight: &mut Flight,
    random: &mut impl Random,
    sees_bent: bool,
    sample: &mut PixelSample,
) -> Option<DiffusePoint> {
    let ctx = setup.context();
    let sources = setup.sources();
    let shining = loop {
        match flight.next(&ctx, random) {
            Met::Diffuse(at) => return Some(at),
            Met::Bent { .. } if sees_bent => {}
            Met::Bent { .. } | Met::End => return None,
            Met::Light { point, light } => {
                let cos = -point.ng.dot(flight.ray.dir);
                break sources.light(light).surface_radiance(cos);
            }
            Met::Sky => {
                let suns = ctx.plan.suns.iter();
                break suns.fold(Rgb::BLACK, |sum, &sun| {
                    sum + sources.light(sun as usize).sky_radiance(flight.ray.dir)
                });
            }
        }
    };
    sample[Layer::Emission] += flight.throughput * shining;
    None
}

/// Light of a sampled source that a diffuse point reflects. `weight` gets the
/// connection and the density per solid angle with which the point scatters
/// towards it.
pub(super) fn lit(
    ctx: &Context<'_>,
    sources: &Sources<'_>,
    at: &DiffusePoint,
    random: &mut impl Random,
    weight: impl FnOnce(&Connection, f64) -> f64,
) -> Rgb {
    let choice = random.next_1d();
    let Some(c) = sources.connect(at.point.p, choice, random.next_2d()) else {
        return Rgb::BLACK;
    };
    // Reflectance / pi times the cosine.
    let scattered = density(at, c.wi, Carried::Radiance);
    if scattered <= 0.0 {
        return Rgb::BLACK;
    }
    let arrives = arriving(ctx, at, c.source, c.wi, c.body);
    at.reflectance * c.weight * (scattered * weight(&c, scattered) * arrives)
}

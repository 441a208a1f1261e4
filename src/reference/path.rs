//! Path tracing from the eye (J. Kajiya, *The Rendering Equation*, SIGGRAPH
//! 1986), with light sampling and multiple importance sampling (E. Veach and
//! L. Guibas, *Optimally Combining Sampling Techniques for Monte Carlo
//! Rendering*, SIGGRAPH 1995).
//!
//! Owns all paths, L (S|D)* E, of lights that can be hit. At every diffuse
//! surface a light is sampled, and the direction in which the path goes on may
//! meet one: where both can make a path, the power heuristic weighs them.
//! Light that is bent between a source and a diffuse surface is found by
//! chance alone; if the source is a point, a spot, a beam or an ideal sun, by
//! none.
//!
//! For: pictures without caustics, and the caustics of large lamps.

use crate::{
    film::PixelSample,
    geometry::Ray,
    transport::{Carried, DiffusePoint},
};

use super::{
    eye::lit,
    flight::{Flight, Met, density},
    random::{Layout, Random},
    setup::{Setup, layer_of},
    sources::{Seat, Sources},
};

/// What path tracing sees along a camera ray.
pub(super) fn radiance(setup: &Setup<'_>, ray: Ray, random: &mut impl Random) -> PixelSample {
    let ctx = setup.context();
    let sources = setup.sources();
    let mut sample = PixelSample::default();
    let mut flight = Flight::from_camera(&ctx, ray);
    let mut bent = false;
    // The last diffuse point, unless light was bent since.
    let mut last: Option<DiffusePoint> = None;
    loop {
        match flight.next(&ctx, random) {
            Met::End => return sample,
            Met::Sky => {
                let layer = layer_of(flight.bounces, bent);
                for &sun in &ctx.plan.suns {
                    let seat = Seat::Far {
                        travel: flight.ray.dir,
                    };
                    let sun = sun as usize;
                    let radiance = sources.light(sun).sky_radiance(flight.ray.dir);
                    let weight = found(&sources, sun, &seat, last.as_ref());
                    sample[layer] += flight.throughput * radiance * weight;
                }
                return sample;
            }
            Met::Light { point, light } => {
                let cos = -point.ng.dot(flight.ray.dir);
                let radiance = sources.light(light).surface_radiance(cos);
                if !radiance.is_black() {
                    let seat = sources.seat(light, point.p);
                    let weight = found(&sources, light, &seat, last.as_ref());
                    let layer = layer_of(flight.bounces, bent);
                    sample[layer] += flight.throughput * radiance * weight;
                }
                return sample;
            }
            Met::Bent { .. } => (bent, last) = (true, None),
            Met::Diffuse(at) => {
                if !setup.allows(flight.bounces + 1) {
                    return sample;
                }
                let goes_on = {
                    let throughput = flight.throughput;
                    let depth = flight.depth;
                    let goes_on = flight.bounce(&ctx, &at, random);
                    random.seek(Layout::light(depth));
                    let layer = layer_of(flight.bounces, false);
                    sample[layer] += throughput
                        * lit(&ctx, &sources, &at, random, |c, scattered| {
                            if !sources.light(c.light).has_extent() {
                                return 1.0;
                            }
                            let sampled = sources.direct(c.light, &c.seat, at.point.p);
                            heuristic(sampled, seen_from(&at, &c.seat, scattered))
                        });
                    goes_on
                };
                if !goes_on {
                    return sample;
                }
                (bent, last) = (false, Some(at));
            }
        }
    }
}

/// Weight of a light that was met in a direction sampled at `last`.
fn found(sources: &Sources<'_>, light: usize, seat: &Seat, last: Option<&DiffusePoint>) -> f64 {
    let Some(at) = last else {
        return 1.0;
    };
    let wi = match *seat {
        Seat::At { p, .. } => (p - at.point.p).normalize(),
        Seat::Far { travel } => -travel,
    };
    let scattered = density(at, wi, Carried::Radiance);
    heuristic(
        seen_from(at, seat, scattered),
        sources.direct(light, seat, at.point.p),
    )
}

/// Density of a seat if a direction at `at` is drawn with density `scattered`
/// towards it.
fn seen_from(at: &DiffusePoint, seat: &Seat, scattered: f64) -> f64 {
    match *seat {
        Seat::At { p, ng } => {
            let to = at.point.p - p;
            let d2 = to.length_squared();
            scattered * ng.map_or(0.0, |ng| ng.dot(to).abs()) / (d2 * d2.sqrt())
        }
        Seat::Far { .. } => scattered,
    }
}

/// The power heuristic, exponent 2: weight of the way with density `own`.
fn heuristic(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

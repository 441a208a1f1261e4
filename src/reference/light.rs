//! Light tracing: paths from the lights, connected to the camera at every
//! diffuse surface (J. Arvo, *Backward Ray Tracing*, SIGGRAPH course notes
//! 1986; P. Dutré, E. Lafortune and Y. Willems, *Monte Carlo Light Tracing
//! with Direct Computation of Pixel Intensities*, Compugraphics 1993).
//!
//! Owns L (S|D)* D E: the surface that the eye looks at must be a diffuse one,
//! seen in a straight line. What mirrors and glass show to the eye is black,
//! and so are the sources themselves. A sun lights what lies in the shadow of
//! the sphere around all bounded objects.
//!
//! For: caustics on diffuse surfaces, also of lights without extent.

use crate::{
    light::Source,
    transport::{Carried, DiffusePoint},
};

use super::{
    flight::{Flight, Met, arriving, density, landing},
    random::{Layout, Random},
    setup::{Contribution, Setup, layer_of},
};

/// Follows one of `paths` paths from a light.
pub(super) fn trace(
    setup: &Setup<'_>,
    paths: u64,
    random: &mut impl Random,
    found: &mut Vec<Contribution>,
) {
    let ctx = setup.context();
    let Some(mut flight) = start(setup, random) else {
        return;
    };
    let mut bent = false;
    loop {
        match flight.next(&ctx, random) {
            Met::Bent { .. } => bent = true,
            Met::Diffuse(at) => {
                let diffuse = flight.bounces + 1;
                if !setup.allows(diffuse) {
                    return;
                }
                if let Some(mut seen) = seen(setup, &at, &flight) {
                    seen.layer = layer_of(diffuse, bent && diffuse == 1);
                    seen.value = seen.value / paths as f64;
                    found.push(seen);
                }
                if !flight.bounce(&ctx, &at, random) {
                    return;
                }
            }
            Met::Sky | Met::End | Met::Light { .. } => return,
        }
    }
}

/// A path that has just left a light.
pub(super) fn start(setup: &Setup<'_>, random: &mut impl Random) -> Option<Flight> {
    random.seek(Layout::START);
    let ([a, b], [c, d]) = (random.next_2d(), random.next_2d());
    let start = setup.sources().start(random.next_1d(), [a, b, c, d])?;
    Some(Flight::from_light(&setup.context(), &start))
}

/// What the camera sees of the flux that lands at a diffuse point.
fn seen(setup: &Setup<'_>, at: &DiffusePoint, flight: &Flight) -> Option<Contribution> {
    let p = at.point.p;
    let sight = setup.camera.sight(p)?;
    let to = (sight.eye - p).normalize();
    let cos = density(at, to, Carried::Flux);
    if cos <= 0.0 || at.reflectance.is_black() {
        return None;
    }
    let arrives = arriving(&setup.context(), at, Source::Point(sight.eye), to, None);
    let factor = cos * sight.per_area * arrives * landing(at, flight.ray.dir);
    let value = flight.throughput * at.reflectance * factor;
    (!value.is_black()).then_some(Contribution {
        film: sight.film,
        layer: layer_of(1, false),
        value,
    })
}

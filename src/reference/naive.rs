//! The first algorithm of every course: rays leave the lights in all
//! directions, bounce off what they meet, and those that happen to fall
//! through a hole onto a screen make the picture.
//!
//! Owns all paths, L (S|D)* E, of every light, and needs no connection to the
//! eye: what mirrors show is there, and so are the sources. The price is that
//! almost no ray arrives ([`Forward`](super::Forward)). The hole of a
//! perspective camera has a radius and the screen stands behind it, so the
//! picture is blurred by the hole; an orthographic camera has no hole, its
//! pictures stay black. The hole stops no light: a ray that was counted flies
//! on.
//!
//! For: seeing why rays are traced from the eye.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    camera::{Camera, Projection},
    geometry::Ray,
    spectrum::Rgb,
};

use super::{
    flight::Met,
    light::start,
    random::Random,
    setup::{Contribution, Setup, layer_of},
};

/// A camera with a hole of its own: a pinhole and the screen behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// Radius of the hole in metres.
    pub radius: f64,
    /// Distance from the hole to the screen in metres.
    pub depth: f64,
}

impl Pinhole {
    /// A hole as wide as two pixels of what lies at `distance` metres, and a
    /// screen as far behind it. A point there is seen as a disc of four
    /// pixels' diameter.
    pub fn for_distance(camera: &Camera, distance: f64) -> Self {
        Self {
            radius: camera.pixel_footprint().spread * distance,
            depth: distance,
        }
    }
}

/// Follows one of `paths` paths from a light.
pub(super) fn trace(
    setup: &Setup<'_>,
    pinhole: &Pinhole,
    paths: u64,
    random: &mut impl Random,
    found: &mut Vec<Contribution>,
) {
    let ctx = setup.context();
    let Some(mut flight) = start(setup, random) else {
        return;
    };
    let (mut bent, mut bent_first) = (false, false);
    loop {
        let (ray, carried, diffuse) = (flight.ray, flight.throughput, flight.bounces);
        let met = flight.next(&ctx, random);
        let end = match &met {
            Met::Bent { point, .. } | Met::Light { point, .. } => Some(point.p),
            Met::Diffuse(at) => Some(at.point.p),
            Met::Sky => None,
            // Where the path ends is not known, nor how much of it arrived.
            Met::End => return,
        };
        let reach = end.map_or(f64::INFINITY, |p| (p - ray.origin).length());
        if let Some((film, value)) = seen(&setup.camera, pinhole, &ray, reach, carried) {
            found.push(Contribution {
                film,
                layer: layer_of(diffuse, bent_first),
                value: value / paths as f64,
            });
        }
        match met {
            Met::Bent { .. } => bent = true,
            Met::Diffuse(at) => {
                bent_first |= bent && flight.bounces == 0;
                if !setup.allows(flight.bounces + 1) || !flight.bounce(&ctx, &at, random) {
                    return;
                }
            }
            Met::Sky | Met::End | Met::Light { .. } => return,
        }
    }
}

/// The place on the screen, in pixels, of a ray that falls through the hole,
/// and the radiance that its flux stands for.
fn seen(
    camera: &Camera,
    pinhole: &Pinhole,
    ray: &Ray,
    reach: f64,
    flux: Rgb,
) -> Option<(glam::DVec2, Rgb)> {
    if camera.projection() == Projection::Orthographic {
        return None;
    }
    let (eye, forward) = (camera.eye(), camera.forward());
    let cos = -ray.dir.dot(forward);
    if cos <= 0.0 {
        return None;
    }
    let t = (ray.origin - eye).dot(forward) / cos;
    let off: DVec3 = ray.at(t) - eye;
    if t <= 0.0 || t >= reach || off.length_squared() > pinhole.radius * pinhole.radius {
        return None;
    }
    // On the screen the light lies opposite, turned by half a turn: as if
    // seen from the eye along the line through that place.
    let screen = off + ray.dir * (pinhole.depth / cos);
    let sight = camera.sight(eye - screen)?;
    // Flux through the hole per area of the hole across the ray and solid
    // angle; a square pixel of the screen is seen from a point of the hole
    // under pixel^2 cos^3, whatever the point.
    let pixel = camera.pixel_footprint().spread;
    let hole = PI * pinhole.radius * pinhole.radius;
    let etendue = hole * pixel * pixel * cos * cos * cos * cos;
    Some((sight.film, flux / etendue))
}

//! Recursive ray tracing (T. Whitted, *An Improved Illumination Model for
//! Shaded Display*, Communications of the ACM 23(6), 1980).
//!
//! Owns L S* E, and L D S* E of lights taken as points: at a diffuse surface
//! one shadow ray goes to the middle of each light, which counts with what the
//! whole light would send, so shadows are hard. Mirrors and glass are followed
//! both ways. Sees neither caustics nor light between diffuse surfaces; thin
//! panes let shadow rays through.
//!
//! For: what pictures looked like before path tracing, in the same time.

use std::f64::consts::FRAC_1_PI;

use crate::{
    film::{Layer, PixelSample},
    geometry::Ray,
    material::Material,
    sampling::Stream,
    spectrum::Rgb,
    transport::{DiffusePoint, End, Walker},
};

use super::{flight::arriving, setup::Setup};

/// Ways weaker than this are followed by chance.
const SPLIT_ABOVE: f64 = 1.0 / 256.0;

/// First coordinate of the coins that decide on weak ways.
const COINS: u32 = 2;

/// The middle of a light's sample square is the middle of the light.
const MIDDLE: [f64; 2] = [0.5, 0.5];

/// What Whitted's algorithm sees along a camera ray.
pub(super) fn radiance(setup: &Setup<'_>, ray: Ray, mut stream: Stream) -> PixelSample {
    let ctx = setup.context();
    let mut sample = PixelSample::default();
    stream.seek(COINS);
    let mut pending = vec![Walker::from_camera(&ctx, ray)];
    while let Some(mut walker) = pending.pop() {
        // Strengths sum to at most one, so ways that are split off are few.
        let end = walker.walk(&ctx, &mut stream, &mut |other| {
            let follow = other.strength > SPLIT_ABOVE;
            if follow {
                pending.push(*other);
            }
            follow
        });
        let (layer, found) = match end {
            End::Truncated => continue,
            End::Escaped => {
                let suns = ctx.plan.suns.iter();
                let sky = suns.fold(Rgb::BLACK, |sum, &sun| {
                    sum + setup.scene.lights[sun as usize]
                        .light
                        .sky_radiance(walker.ray.dir)
                });
                (Layer::Emission, sky)
            }
            End::Surface {
                point,
                material: Material::Diffuse { reflectance },
            } => {
                let at = DiffusePoint::new(point, walker.ray.dir, reflectance, walker.media);
                (Layer::Direct, shade(setup, &at))
            }
            End::Surface { point, .. } => {
                let cos = -point.ng.dot(walker.ray.dir);
                let light = setup.scene.object(point.surface).light;
                let shining = light.map_or(Rgb::BLACK, |light| {
                    setup.scene.lights[light as usize]
                        .light
                        .surface_radiance(cos)
                });
                (Layer::Emission, shining)
            }
        };
        sample[layer] += walker.throughput * found;
    }
    sample
}

/// Light of the middles of all sources that a diffuse point reflects.
fn shade(setup: &Setup<'_>, at: &DiffusePoint) -> Rgb {
    let ctx = setup.context();
    let lights = setup.scene.lights.iter();
    lights.fold(Rgb::BLACK, |sum, light| {
        let Some(s) = light.light.sample_direct(at.point.p, MIDDLE) else {
            return sum;
        };
        let cos = s.wi.dot(at.ns);
        if cos <= 0.0 || s.wi.dot(at.ng) <= 0.0 {
            return sum;
        }
        let arrives = arriving(&ctx, at, s.source, s.wi, light.instance);
        sum + at.reflectance * s.weight * (cos * FRAC_1_PI * arrives)
    })
}

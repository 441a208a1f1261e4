//! Stochastic progressive photon mapping (Hachisuka and Jensen 2009): one hit
//! point a pixel, drawn anew for every pass, statistics and radius shared by
//! the pixel, box kernel, random photons.

use std::f64::consts::PI;

use crate::{
    clock::Clock,
    cost::{Row, Series, doublings},
    exact::{Case, Reference},
};

use super::photons::{Photon, Random, photon};

/// Photon paths of a pass.
const PHOTONS: u64 = 1 << 14;

/// Share of the new photons that is kept, as published.
const ALPHA: f64 = 2.0 / 3.0;

/// What a pixel remembers.
#[derive(Clone, Copy, Debug)]
struct Pixel {
    /// This pass's hit point, in pixels.
    hit: [f64; 2],
    /// Square of the radius, in pixels.
    radius_sq: f64,
    /// Photons kept so far.
    kept: f64,
    /// Their light, as it shrank with the disc.
    light: f64,
    /// Photons of this pass.
    new: u32,
    /// Their light.
    new_light: f64,
}

/// Renders until the time is up, from a radius of `first` pixels.
pub(crate) fn sppm(case: &Case, reference: &Reference, first: f64, seconds: f64) -> Series {
    let side = case.window.pixels as usize;
    let fresh = Pixel {
        hit: [0.0; 2],
        radius_sq: first * first,
        kept: 0.0,
        light: 0.0,
        new: 0,
        new_light: 0.0,
    };
    let mut pixels = vec![fresh; side * side];
    let mut random = Random::new(first.to_bits());
    let mut rows = Vec::new();
    let (mut emitted, mut spent) = (0, 0.0);
    for passes in doublings(1) {
        let clock = Clock::start();
        while emitted < passes * PHOTONS {
            pass(case, &mut pixels, &mut random);
            emitted += PHOTONS;
        }
        spent += clock.seconds();
        let irradiance = |p: &Pixel| p.light / (PI * p.radius_sq * emitted as f64);
        let image = case.window.image(pixels.iter().map(irradiance));
        rows.push(Row::of(&image, reference, emitted, spent));
        if 2.0 * spent > seconds {
            break;
        }
    }
    Series::new(format!("SPPM, {first} px"), rows)
}

fn pass(case: &Case, pixels: &mut [Pixel], random: &mut Random) {
    let side = case.window.pixels as usize;
    let mut widest = 0.0f64;
    for (i, pixel) in pixels.iter_mut().enumerate() {
        let corner = [(i % side) as f64, (i / side) as f64];
        pixel.hit = corner.map(|c| c + random.next());
        widest = widest.max(pixel.radius_sq);
    }
    let reach = widest.sqrt();
    for _ in 0..PHOTONS {
        if let Some(photon) = photon(case, random) {
            splat(&photon, pixels, side, reach);
        }
    }
    for pixel in pixels.iter_mut().filter(|p| p.new > 0) {
        let new = f64::from(pixel.new);
        let kept = pixel.kept + ALPHA * new;
        let shrink = kept / (pixel.kept + new);
        pixel.radius_sq *= shrink;
        pixel.light = (pixel.light + pixel.new_light) * shrink;
        pixel.kept = kept;
        pixel.new = 0;
        pixel.new_light = 0.0;
    }
}

/// Gives a photon to the hit points that it is near enough to.
fn splat(photon: &Photon, pixels: &mut [Pixel], side: usize, reach: f64) {
    let [x, y] = photon.at;
    let range = |c: f64| {
        // `as` saturates below at zero; beyond the window nothing is left.
        let end = ((c + reach + 1.0) as usize).min(side);
        ((c - reach) as usize).min(end)..end
    };
    for row in range(y) {
        for pixel in &mut pixels[row * side..][range(x)] {
            let (dx, dy) = (x - pixel.hit[0], y - pixel.hit[1]);
            if dx * dx + dy * dy < pixel.radius_sq {
                pixel.new += 1;
                pixel.new_light += photon.irradiance;
            }
        }
    }
}

//! Stochastic progressive photon mapping (T. Hachisuka and H. Jensen,
//! *Stochastic Progressive Photon Mapping*, ACM TOG 28(5), 2009).
//!
//! Owns all paths, L (S|D)* E. Light that comes straight from a source is found
//! by shadow rays at the first diffuse surface that the eye sees, all other
//! light by photons there. Every pixel has statistics that its camera samples
//! share: a radius r and a count n of photons. A pass finds the M photons within
//! r of what the pixel sees, counts a part of them, and shrinks the circle as if
//! the photons lay evenly:
//!
//! ```text
//! n' = n + a M,   r'^2 = r^2 n' / (n + M),   a = 2/3.
//! ```
//!
//! The radius begins at the settings' number of pixel footprints where the
//! pixel first sees a diffuse surface. The paper's sum of light,
//! tau' = (tau + light of the M) r'^2 / r^2, which gives the radiance
//! tau / (pi r^2 N P) after N passes of P light paths, need not be kept: tau / r^2
//! grows by the light of the M over the r^2 with which they were found, so the
//! radiance is the mean of what the passes find by themselves.
//!
//! A pass depends on those before it by its radii. There are as many independent
//! runs as replicates, each with statistics of its own; pass i is the next one
//! of replicate i modulo 8.
//!
//! For: the error of shared statistics, and of circles that shrink with the
//! photons that they have found; the noise does not show it.

use std::f64::consts::PI;

use crate::{
    film::{Layer, PixelSample},
    geometry::Ray,
};

use super::{
    eye::{first_seen, lit},
    flight::Flight,
    photons::{Landed, shoot},
    random::{Layout, Random},
    setup::Setup,
};

/// The part of the photons found that is counted.
const ALPHA: f64 = 2.0 / 3.0;

/// Bytes of a pixel's statistics.
pub(super) const BYTES_PER_PIXEL: u64 = size_of::<Statistics>() as u64;

/// What the camera samples of a pixel share.
#[derive(Clone, Copy, Debug, Default)]
struct Statistics {
    /// Squared radius in square metres; 0 before a diffuse surface was seen.
    radius_sq: f64,
    /// Photons counted.
    count: f64,
}

impl Statistics {
    /// Takes photons that were found within the radius.
    fn take(&mut self, found: u32) {
        if found > 0 {
            let found = f64::from(found);
            let count = self.count + ALPHA * found;
            self.radius_sq *= count / (self.count + found);
            self.count = count;
        }
    }
}

/// The state of one replicate: the statistics of every pixel of the window.
pub(super) struct Run {
    pixels: Vec<Statistics>,
}

impl Run {
    pub(super) fn new(setup: &Setup<'_>) -> Self {
        Self {
            pixels: vec![Statistics::default(); setup.window_pixels()],
        }
    }

    /// The pass of this replicate in `round`.
    pub(super) fn pass(
        &mut self,
        setup: &Setup<'_>,
        replicate: u32,
        round: u32,
    ) -> Vec<PixelSample> {
        let paths = setup.light_paths();
        let first = u64::from(round) * paths;
        let photons = Landed::new(shoot(setup, replicate, first, paths, |layer| {
            layer != Layer::Direct
        }));
        let eyes = Eyes {
            setup,
            photons,
            paths: paths as f64,
        };
        setup.by_pixel_with(
            replicate,
            round,
            &mut self.pixels,
            |own, film, mut stream| eyes.look(own, setup.camera.ray(film), &mut stream),
        )
    }
}

/// What the camera samples of a pass look at.
struct Eyes<'a> {
    setup: &'a Setup<'a>,
    photons: Landed,
    /// Light paths of the pass.
    paths: f64,
}

impl Eyes<'_> {
    /// What is seen along a camera ray.
    fn look(&self, own: &mut Statistics, ray: Ray, random: &mut impl Random) -> PixelSample {
        let setup = self.setup;
        let ctx = setup.context();
        let mut sample = PixelSample::default();
        let mut flight = Flight::from_camera(&ctx, ray);
        let Some(at) = first_seen(setup, &mut flight, random, true, &mut sample) else {
            return sample;
        };
        if own.radius_sq == 0.0 {
            let footprint = setup.camera.pixel_footprint();
            let width = footprint.width + footprint.spread * flight.way;
            own.radius_sq = (setup.first_radius() * width).powi(2);
        }
        let mut found = Vec::new();
        let index = self.photons.index();
        index.within(at.point.p, own.radius_sq, &mut found);
        let scale = 1.0 / (PI * own.radius_sq * self.paths);
        let mut count = 0;
        for (layer, light) in found
            .iter()
            .filter_map(|near| self.photons.reflected(near, &at))
        {
            count += 1;
            sample[layer] += flight.throughput * light * scale;
        }
        own.take(count);
        random.seek(Layout::light(flight.depth));
        let direct = lit(&ctx, &setup.sources(), &at, random, |_, _| 1.0);
        sample[Layer::Direct] += flight.throughput * direct;
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of what the passes find by themselves is the paper's radiance.
    #[test]
    fn no_sum_of_light_is_needed() {
        let mut own = Statistics {
            radius_sq: 0.3,
            count: 0.0,
        };
        let (mut tau, mut mine) = (0.0, 0.0);
        for (pass, found) in [0, 3, 0, 1, 12, 2, 0, 40, 5].into_iter().enumerate() {
            let light = 0.7 * f64::from(found) + 0.1 * f64::from(found).sqrt();
            let before = own.radius_sq;
            own.take(found);
            tau = (tau + light) * own.radius_sq / before;
            mine += light / before;
            let passes = (pass + 1) as f64;
            let paper = tau / (own.radius_sq * passes);
            assert!((mine / passes - paper).abs() <= 1e-14 * paper);
        }
        // Counted: two thirds of all.
        assert!((own.count - ALPHA * 63.0).abs() < 1e-12);
    }
}

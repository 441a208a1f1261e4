//! Photon mapping as first published (H. Jensen, *Global Illumination using
//! Photon Maps*, Eurographics Workshop on Rendering 1996).
//!
//! Owns all paths, L (S|D)* E. Light that comes straight from a source is
//! found by shadow rays; L S+ D at the surface that is seen, in the caustic
//! map; everything else by a gathering ray, which goes on in a random
//! direction to the next diffuse surface and looks up all light that lands
//! there in the global map. Both maps hold the photons of the same paths, none
//! of them aimed. The estimate is that of the nearest photons, weighed by the
//! paper's cone, the narrowest, which falls to zero at the farthest photon.
//!
//! There is nothing progressive about it: each replicate has one caustic map
//! and one global map, built before its first pass from as many light paths as
//! its passes together have. A pass is one camera sample of each pixel. More
//! passes asked for mean more photons in these maps; waiting for more passes
//! of the same maps takes away the noise of the camera's samples alone. The
//! replicates' spread says how uneven the photons lie; it says nothing of the
//! blur, which is as wide as the circle with the nearest photons and stays.
//!
//! For: what photon mapping was before radii shrank.

use std::{f64::consts::PI, num::NonZero};

use crate::{
    film::{Layer, PixelSample},
    geometry::{Ray, points::Near},
    spectrum::Rgb,
    transport::DiffusePoint,
};

use super::{
    eye::{first_diffuse, first_seen, lit},
    flight::Flight,
    photons::{Landed, shoot},
    random::{Layout, Random},
    setup::Setup,
};

/// The maps of one replicate.
pub(super) struct Maps {
    caustic: Landed,
    global: Landed,
    /// Light paths from which they were made.
    paths: f64,
    /// Photons of an estimate.
    nearest: NonZero<usize>,
}

impl Maps {
    /// Traces `paths` paths of a replicate.
    pub(super) fn new(
        setup: &Setup<'_>,
        replicate: u32,
        paths: u64,
        nearest: NonZero<u32>,
    ) -> Self {
        let all = shoot(setup, replicate, 0, paths, |_| true);
        let of_caustics = all.iter().filter(|photon| photon.layer == Layer::Caustic);
        Self {
            caustic: Landed::new(of_caustics.copied().collect()),
            // Nobody asks for it without light between diffuse surfaces.
            global: Landed::new(if setup.allows(2) { all } else { Vec::new() }),
            paths: paths as f64,
            nearest: nearest.try_into().unwrap_or(NonZero::<usize>::MIN),
        }
    }

    /// What is seen along a camera ray.
    pub(super) fn radiance(
        &self,
        setup: &Setup<'_>,
        ray: Ray,
        random: &mut impl Random,
    ) -> PixelSample {
        let ctx = setup.context();
        let mut sample = PixelSample::default();
        let mut flight = Flight::from_camera(&ctx, ray);
        let Some(at) = first_seen(setup, &mut flight, random, true, &mut sample) else {
            return sample;
        };
        let (seen, depth) = (flight.throughput, flight.depth);
        let mut found = Vec::new();
        sample[Layer::Caustic] += seen * self.reflected(&self.caustic, &at, &mut found);
        if setup.allows(2)
            && flight.bounce(&ctx, &at, random)
            && let Some(next) = first_diffuse(setup, &mut flight, random)
        {
            let reflected = self.reflected(&self.global, &next, &mut found);
            sample[Layer::Indirect] += flight.throughput * reflected;
        }
        random.seek(Layout::light(depth));
        sample[Layer::Direct] += seen * lit(&ctx, &setup.sources(), &at, random, |_, _| 1.0);
        sample
    }

    /// Radiance that a diffuse point reflects of a map's light.
    fn reflected(&self, map: &Landed, at: &DiffusePoint, found: &mut Vec<Near>) -> Rgb {
        map.index().nearest(at.point.p, self.nearest, found);
        let radius_sq = found.last().map_or(0.0, |farthest| farthest.distance_sq);
        if radius_sq <= 0.0 {
            // No photons, or all in one place: no area to spread them over.
            return Rgb::BLACK;
        }
        let sum = found.iter().fold(Rgb::BLACK, |sum, near| {
            let weight = 1.0 - (near.distance_sq / radius_sq).sqrt();
            match map.reflected(near, at) {
                Some((_, light)) => sum + light * weight,
                None => sum,
            }
        });
        // The cone's mean over the circle is a third.
        sum * (3.0 / (PI * radius_sq * self.paths))
    }
}

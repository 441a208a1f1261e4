//! Photons for the methods that keep them: where paths from the lights land on
//! diffuse surfaces, and what lands near a point.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;
use rayon::prelude::*;

use crate::{
    film::Layer,
    geometry::{
        PointIndex,
        points::{BYTES_PER_POINT, Near},
    },
    spectrum::Rgb,
    transport::DiffusePoint,
};

use super::{
    flight::{Met, landing},
    light,
    setup::{Setup, layer_of},
};

/// Bytes that a photon takes, its places in lists that are joined and its
/// point in the index included.
pub(super) const BYTES_PER_PHOTON: u64 = 2 * size_of::<Photon>() as u64 + BYTES_PER_POINT;

/// Paths on which one thread works at a time. The photons do not depend on it.
const CHUNK: u64 = 1024;

/// Light that has landed on a diffuse surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Photon {
    pub(super) p: DVec3,
    /// Unit direction in which it came.
    dir: DVec3,
    /// Flux in W over all probabilities, for one path: to be divided by their
    /// number. On a smooth surface it counts about the shading normal.
    flux: Rgb,
    /// The layer of this light where the eye sees it here.
    pub(super) layer: Layer,
}

/// The photons of paths `first..first + count` of a replicate's sequence, in
/// the order of the paths; of these, those that `keep` wants.
pub(super) fn shoot(
    setup: &Setup<'_>,
    replicate: u32,
    first: u64,
    count: u64,
    keep: impl Fn(Layer) -> bool + Sync,
) -> Vec<Photon> {
    let sequence = setup.light_sequence(replicate);
    let chunks: Vec<Vec<Photon>> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut photons = Vec::new();
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                // An order of their own: pixels are looked at round by round.
                let mut stream = sequence.at_own_order(first + i);
                trace(setup, &mut stream, &mut |photon| {
                    if keep(photon.layer) {
                        photons.push(photon);
                    }
                });
            }
            photons
        })
        .collect();
    chunks.concat()
}

/// Follows a path from a light.
fn trace(setup: &Setup<'_>, stream: &mut crate::sampling::Stream, store: &mut dyn FnMut(Photon)) {
    let ctx = setup.context();
    let Some(mut flight) = light::start(setup, stream) else {
        return;
    };
    let mut bent = false;
    loop {
        match flight.next(&ctx, stream) {
            Met::Bent { .. } => bent = true,
            Met::Diffuse(at) => {
                let diffuse = flight.bounces + 1;
                if !setup.allows(diffuse) {
                    return;
                }
                store(Photon {
                    p: at.point.p,
                    dir: flight.ray.dir,
                    flux: flight.throughput * landing(&at, flight.ray.dir),
                    layer: layer_of(diffuse, bent && diffuse == 1),
                });
                if !flight.bounce(&ctx, &at, stream) {
                    return;
                }
            }
            Met::Sky | Met::End | Met::Light { .. } => return,
        }
    }
}

/// Photons and where they lie.
pub(super) struct Landed {
    photons: Vec<Photon>,
    index: PointIndex,
}

impl Landed {
    pub(super) fn new(photons: Vec<Photon>) -> Self {
        Self {
            index: PointIndex::new(photons.iter().map(|photon| photon.p)),
            photons,
        }
    }

    /// Where they lie.
    pub(super) fn index(&self) -> &PointIndex {
        &self.index
    }

    /// A photon that was found, if it fell on the side of the surface that is
    /// seen; its layer, and its flux times the diffuse surface's BSDF.
    pub(super) fn reflected(&self, near: &Near, at: &DiffusePoint) -> Option<(Layer, Rgb)> {
        let photon = &self.photons[near.number as usize];
        (photon.dir.dot(at.ng) < 0.0)
            .then(|| (photon.layer, at.reflectance * photon.flux * FRAC_1_PI))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{
        reference::{Method, flight::mean_bounces},
        scene::load_str,
    };

    /// In a closed body every path lands until the roulette ends it: as often
    /// as the budget counts with.
    #[test]
    fn no_more_photons_than_the_budget_counts_with() {
        for albedo in [0.1, 0.5, 0.9] {
            let text = format!(
                "(camera: (eye: (0, 0, 0), look_at: (1, 0, 0), fov: 40), image: (width: 8, height: 8),
                  objects: [(shape: Sphere(center: (0, 0, 0), radius: 2),
                             material: Diffuse(reflectance: {albedo}))],
                  lights: [Point(position: (0, 0, 1), power: 1)], render: (max_depth: 500))"
            );
            let scene =
                load_str(&text, "test.ron", Path::new("")).unwrap_or_else(|e| panic!("{e}"));
            let window = [0, 0, 8, 8];
            let setup = Setup::new(&scene, &scene.settings, Method::Sppm, [8, 8], window, 1);
            let paths = 1 << 14;
            let photons = shoot(&setup, 0, 0, paths, |_| true);
            let mean = photons.len() as f64 / paths as f64;
            let most = mean_bounces(albedo);
            assert!((0.98..1.02).contains(&(mean / most)), "{mean} {most}");
            // All light lands at first: the flux of direct photons is the power.
            let direct = photons.iter().filter(|p| p.layer == Layer::Direct);
            let power: f64 = direct.map(|p| p.flux[1] / paths as f64).sum();
            assert!((power - 1.0).abs() < 1e-9, "{power}");
        }
    }
}

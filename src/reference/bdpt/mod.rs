//! Bidirectional path tracing (E. Lafortune and Y. Willems, *Bi-directional
//! Path Tracing*, Compugraphics 1993; E. Veach and L. Guibas, *Bidirectional
//! Estimators for Light Transport*, EGRW 1994; Veach 1997, chapter 10).
//!
//! Owns all paths, L (S|D)* E, that have two neighbouring places at which
//! light is not bent, or a light that can be hit. A path from the eye and one
//! from a light are joined at every pair of diffuse places, the light's with
//! the eye, the eye's with a light sampled for it, and where the eye's path
//! hits a light. The power heuristic weighs all ways in which a path can be
//! made; mirrors and glass are joined to nothing. Cannot see S D S paths of
//! lights that can't be hit: the caustic of a point light, seen in glass.
//!
//! For: a reference that shares no estimator with the photon map and sees
//! nearly all that it sees.

mod join;
mod subpath;
mod weight;

pub(super) use join::sample;

use glam::DVec2;

use crate::film::PixelSample;

use super::setup::{Setup, Shares};

/// One pass: for each pixel of the film a path from the eye and one from the
/// lights.
pub(super) fn pass(setup: &Setup<'_>, replicate: u32, round: u32) -> Vec<PixelSample> {
    let (corner, [width, _]) = setup.film();
    let paths = setup.film_pixels();
    setup.by_sample(paths, Shares::PATHS, |i, found| {
        let stream = |item| setup.sequence(replicate, item).at(u64::from(round));
        let (mut camera, mut light) = (stream(2 * i), stream(2 * i + 1));
        let [column, row] = [i % u64::from(width), i / u64::from(width)].map(|k| k as f64);
        let within = DVec2::from_array([camera.next_1d(), camera.next_1d()]);
        let film = corner + DVec2::new(column, row) + within;
        sample(setup, film, paths, &mut camera, &mut light, found);
    })
}

#[cfg(test)]
mod tests;

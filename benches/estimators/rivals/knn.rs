//! Photon mapping as first published (Jensen 1996): one pass of random
//! photons, one query at the centre of each pixel, the `k` nearest photons, a
//! cone filter.

use std::{f64::consts::PI, num::NonZero};

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;

use crate::{
    clock::Clock,
    cost::{Row, Series, doublings},
    exact::{Case, Reference},
};

use super::photons::{Photon, Random, photon};

/// Photons further out of the window than its own width are of no use.
const MARGIN: f64 = 1.0;

/// One picture for every budget until the time is up.
pub(crate) fn knn(case: &Case, reference: &Reference, k: usize, seconds: f64) -> Series {
    let mut rows = Vec::new();
    for emitted in doublings(1 << 14) {
        let clock = Clock::start();
        let irradiance = estimate(case, k, emitted);
        let spent = clock.seconds();
        let image = case.window.image(irradiance.into_iter());
        rows.push(Row::of(&image, reference, emitted, spent));
        if 2.0 * spent > seconds {
            break;
        }
    }
    Series::new(format!("k-NN, k = {k}"), rows)
}

fn estimate(case: &Case, k: usize, emitted: u64) -> Vec<f64> {
    let side = case.window.pixels as usize;
    let limits = -MARGIN * side as f64..(1.0 + MARGIN) * side as f64;
    let mut random = Random::new(emitted);
    let photons: Vec<Photon> = (0..emitted)
        .filter_map(|_| photon(case, &mut random))
        .filter(|p| p.at.iter().all(|c| limits.contains(c)))
        .collect();
    let positions: Vec<[f64; 2]> = photons.iter().map(|p| p.at).collect();
    let tree = ImmutableKdTree::new_from_slice(&positions)
        .unwrap_or_else(|e| panic!("a tree of finite points: {e:?}"));
    let count = NonZero::new(k).unwrap_or(NonZero::<usize>::MIN);
    let at = |query: [f64; 2]| {
        let nearest = tree
            .query(&query)
            .nearest_n::<SquaredEuclidean<f64>>(count)
            .execute();
        let radius_sq = nearest.last().map_or(f64::INFINITY, |n| n.distance);
        // A cone that falls to zero at the farthest photon; its mean over the
        // disc is a third.
        let light: f64 = nearest
            .iter()
            .map(|n| {
                let weight = 1.0 - (n.distance / radius_sq).sqrt();
                weight * photons[n.item as usize].irradiance
            })
            .sum();
        3.0 * light / (PI * radius_sq * emitted as f64)
    };
    (0..side * side)
        .into_par_iter()
        .map(|pixel| at([pixel % side, pixel / side].map(|corner| corner as f64 + 0.5)))
        .collect()
}

//! Where a map's photons lie: their middle, and an order in which neighbours
//! in space are neighbours in memory.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Photon;

/// The median of the photons' positions along each axis; of a sample where
/// there are many.
pub(super) fn median(photons: &[&Photon]) -> DVec3 {
    const SAMPLE: usize = 4096;
    let step = (photons.len() / SAMPLE).max(1);
    let along = |axis: usize| {
        let mut xs: Vec<f64> = photons
            .iter()
            .step_by(step)
            .map(|p| p.position[axis])
            .collect();
        if xs.is_empty() {
            return 0.0;
        }
        let middle = xs.len() / 2;
        *xs.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    DVec3::new(along(0), along(1), along(2))
}

/// Photons whose distances are added up in sequence.
const PART: usize = 4096;

/// Sorts photons along a Morton curve; their old order decides between those
/// in one cell.
pub(super) fn sort_along_curve(photons: &mut [&Photon], center: DVec3) {
    // The curve's cube spans eight times the mean distance from the median
    // either way, cut into 1024 cells a side; what lies outside counts to the
    // outermost cells. A sum of sums of fixed parts: it must not depend on threads.
    let taxicab = |p: &&Photon| {
        let o = (p.position - center).abs();
        o.x + o.y + o.z
    };
    let parts: Vec<f64> = photons
        .par_chunks(PART)
        .map(|part| part.iter().map(taxicab).sum())
        .collect();
    let mean = parts.iter().sum::<f64>() / photons.len().max(1) as f64;
    let scale = 64.0 / mean.max(f64::MIN_POSITIVE);
    photons.par_sort_by_cached_key(|p| {
        morton(((p.position - center) * scale + DVec3::splat(512.0)).as_vec3())
    });
}

/// Interleaves the lowest ten bits of three coordinates, clamped to 0..1024.
fn morton(cell: Vec3) -> u32 {
    let spread = |x: f32| {
        // `as` clamps below at zero.
        let mut v = (x as u32).min(1023);
        v = (v | v << 16) & 0x0300_00ff;
        v = (v | v << 8) & 0x0300_f00f;
        v = (v | v << 4) & 0x030c_30c3;
        (v | v << 2) & 0x0924_9249
    };
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

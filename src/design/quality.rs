//! What a lens really does: light is traced through its face, and where it
//! lands is compared with the picture.

use glam::DVec3;
use rayon::prelude::*;

use super::Task;
use crate::{
    numeric::SplineSurface,
    optics::{Interface, fresnel, refract},
};

/// Rays along each axis for each height.
const RAYS: usize = 4;

/// How the light that passes a lens compares with its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Correlation (Pearson's) of the light's density with the picture's.
    pub correlation: f64,
    /// Root mean square of the difference of both densities, whose mean is 1.
    pub rms: f64,
    /// The part of the light that lands outside the picture.
    pub outside: f64,
    /// The part of the light that the face reflects, by Fresnel's law.
    pub reflected: f64,
}

/// Where the light of a place on the face lands, and the part that passes;
/// `None` if it is reflected totally. Lens and screen are centred on the axis.
fn land(task: &Task, face: &SplineSurface, u: [f64; 2]) -> Option<([f64; 2], f64)> {
    let spacing = task.spacing();
    let jet = face.at(u[0], u[1]);
    let slope = [jet.gradient[0] / spacing[0], jet.gradient[1] / spacing[1]];
    let normal = DVec3::new(slope[0], slope[1], -1.0).normalize();
    let eta = 1.0 / task.ior;
    let Interface::Partial {
        cos_t,
        transmittance,
        ..
    } = fresnel(-normal.z, eta)
    else {
        return None;
    };
    let d = refract(DVec3::Z, normal, eta, cos_t);
    let t = (task.distance - jet.value) / d.z;
    let from = [0, 1].map(|k| u[k] * spacing[k] - 0.5 * task.lens[k]);
    Some(([from[0] + t * d.x, from[1] + t * d.y], transmittance))
}

/// Traces light through the face, `RAYS` by `RAYS` rays for each height, and
/// compares
/// where it lands with `density` on `size` cells.
pub(super) fn measure(task: &Task, heights: &[f64], size: [usize; 2], density: &[f64]) -> Quality {
    let [nx, ny] = task.resolution;
    let face = SplineSurface::new(task.resolution, heights);
    let picture = task.picture();
    let rays = [RAYS * nx, RAYS * ny];
    let landed: Vec<(Option<usize>, f64)> = (0..rays[0] * rays[1])
        .into_par_iter()
        .map(|k| {
            let ray = [k % rays[0], k / rays[0]];
            let u = [0, 1]
                .map(|a| (ray[a] as f64 + 0.5) / rays[a] as f64 * (task.resolution[a] - 1) as f64);
            let Some((p, passed)) = land(task, &face, u) else {
                return (None, 0.0);
            };
            let cell = [0, 1].map(|a| (p[a] / picture[a] + 0.5) * size[a] as f64);
            let inside = cell[0] >= 0.0 && cell[1] >= 0.0;
            let [i, j] = cell.map(|c| c as usize);
            let inside = inside && i < size[0] && j < size[1];
            (inside.then_some(j * size[0] + i), passed)
        })
        .collect();
    let mut found = vec![0.0; density.len()];
    let (mut outside, mut passed) = (0usize, 0.0);
    for (cell, part) in &landed {
        passed += part;
        match cell {
            Some(cell) => found[*cell] += density.len() as f64 / landed.len() as f64,
            None => outside += 1,
        }
    }
    let (correlation, rms) = compare(&found, density);
    Quality {
        correlation,
        rms,
        outside: outside as f64 / landed.len() as f64,
        reflected: 1.0 - passed / landed.len() as f64,
    }
}

/// Correlation and root mean square difference. Without contrast there is
/// nothing to correlate: 1.
fn compare(found: &[f64], known: &[f64]) -> (f64, f64) {
    let n = known.len() as f64;
    let [mean_f, mean_k] = [found, known].map(|list| list.iter().sum::<f64>() / n);
    let (mut ff, mut fk, mut kk, mut square) = (0.0, 0.0, 0.0, 0.0);
    for (f, k) in found.iter().zip(known) {
        ff += (f - mean_f) * (f - mean_f);
        fk += (f - mean_f) * (k - mean_k);
        kk += (k - mean_k) * (k - mean_k);
        square += (f - k) * (f - k);
    }
    let scale = (ff * kk).sqrt();
    let correlation = if scale > 0.0 { fk / scale } else { 1.0 };
    (correlation, (square / n).sqrt())
}

//! A hash grid of photons with ellipses, as fast as it is simple: the limit
//! that a map without walls, classes and bounds could reach.

use glam::DVec3;
use nephroid::photon::Photon;

/// A photon of the grid.
#[derive(Clone, Copy, Default)]
struct Entry {
    at: [f32; 3],
    axis: [f32; 3],
    per_major: f32,
    per_minor: f32,
    flux: [f32; 3],
}

/// Photons by cells as wide as the longest kernel, in the order of a hash.
pub(crate) struct Grid {
    width: f64,
    /// Where the photons of each hash begin.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

impl Grid {
    /// The photons that have a footprint.
    pub(crate) fn new(photons: &[Photon]) -> Self {
        let sized = || photons.iter().filter_map(|p| Some((p, p.footprint?)));
        let width = sized().fold(f64::MIN_POSITIVE, |w, (_, f)| w.max(f.major.length()));
        let size = photons.len().next_power_of_two();
        let mut grid = Self {
            width,
            starts: vec![0; size + 1],
            entries: vec![Entry::default(); sized().count()],
        };
        let slots: Vec<usize> = sized()
            .map(|(p, _)| grid.slot(grid.cell(p.position)))
            .collect();
        for &slot in &slots {
            grid.starts[slot + 1] += 1;
        }
        for i in 0..size {
            grid.starts[i + 1] += grid.starts[i];
        }
        let mut next = grid.starts.clone();
        for ((p, f), slot) in sized().zip(slots) {
            let major = f.major.length();
            grid.entries[next[slot] as usize] = Entry {
                at: p.position.as_vec3().to_array(),
                axis: (f.major / major).as_vec3().to_array(),
                per_major: (1.0 / major) as f32,
                per_minor: (1.0 / f.minor) as f32,
                flux: p.flux.0.map(|c| c as f32),
            };
            next[slot] += 1;
        }
        grid
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        (p / self.width).floor().to_array().map(|c| c as i64)
    }

    fn slot(&self, [x, y, z]: [i64; 3]) -> usize {
        let hash =
            x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ z.wrapping_mul(83_492_791);
        hash as usize & (self.starts.len() - 2)
    }

    /// Flux per m2 at a point, all photons that reach it on one plane.
    pub(crate) fn irradiance(&self, p: DVec3) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let [x, y, z] = self.cell(p);
        let query = p.as_vec3().to_array();
        // Photons of one plane lie in one layer of cells.
        for (i, j) in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (i, j))) {
            let slot = self.slot([x + i, y + j, z]);
            let [first, last] = [slot, slot + 1].map(|s| self.starts[s] as usize);
            for entry in &self.entries[first..last] {
                let d = [0, 1, 2].map(|k| entry.at[k] - query[k]);
                let dot = |v: [f32; 3]| d[0] * v[0] + d[1] * v[1] + d[2] * v[2];
                let along = dot(entry.axis);
                let across = (dot(d) - along * along).max(0.0);
                let q = along * along * entry.per_major * entry.per_major
                    + across * entry.per_minor * entry.per_minor;
                if q < 1.0 {
                    let k = f64::from((1.0 - q) * entry.per_major * entry.per_minor);
                    for (s, f) in sum.iter_mut().zip(entry.flux) {
                        *s += k * f64::from(f);
                    }
                }
            }
        }
        sum
    }
}

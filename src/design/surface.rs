//! The face of the lens: from where the light is to go to heights.
//!
//! Parallel light travels along +z inside the glass and leaves through the
//! face `z = h(x, y)`. The refracted unit direction `d` asks for a normal along
//! `n (0, 0, 1) - d` (Snell's law for vectors), that is for the slopes
//!
//! `dh/dx = d_x / (n - d_z)`, `dh/dy = d_y / (n - d_z)`.
//!
//! They depend on the height from which the light starts, so slopes and
//! heights are found in turns. Slopes of the optimal transport are those of a
//! surface for small angles only: heights follow in least squares.

use rayon::prelude::*;

use super::{Task, poisson::Poisson, transport::Transport};

/// Turns of slopes and heights, at most.
const MAX_TURNS: usize = 40;
/// Heights are found when they change by less than this, in distances of the
/// screen.
const SETTLED: f64 = 1e-10;

/// Where the light of the grid's points and of the middles between neighbours
/// is to land, as places on the screen.
pub(super) struct Targets {
    points: Vec<[f64; 2]>,
    /// Right of each point.
    along_x: Vec<[f64; 2]>,
    /// Above each point.
    along_y: Vec<[f64; 2]>,
}

impl Targets {
    pub(super) fn new(task: &Task, transport: &Transport) -> Self {
        let [nx, ny] = task.resolution;
        let [wide, high] = transport.extent();
        let picture = task.picture();
        let find = |shift: [f64; 2]| {
            let row = |j: usize| {
                let y = (j as f64 + shift[1]) / (ny - 1) as f64 * high;
                let mut guess = [0.0, y];
                let mut line = Vec::with_capacity(nx);
                for i in 0..nx {
                    let x = (i as f64 + shift[0]) / (nx - 1) as f64 * wide;
                    guess = transport.target([x.min(wide), y.min(high)], guess);
                    let [u, v] = [guess[0] / wide - 0.5, guess[1] / high - 0.5];
                    line.push([u * picture[0], v * picture[1]]);
                }
                line
            };
            (0..ny).into_par_iter().flat_map_iter(row).collect()
        };
        Self {
            points: find([0.0, 0.0]),
            along_x: find([0.5, 0.0]),
            along_y: find([0.0, 0.5]),
        }
    }
}

/// The slopes of a face that sends light from `(x, y, z)` to `target` on the
/// screen; `None` if no face can.
fn slopes(task: &Task, from: [f64; 3], target: [f64; 2]) -> Option<[f64; 2]> {
    let way = [
        target[0] - from[0],
        target[1] - from[1],
        task.distance - from[2],
    ];
    let length = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
    let d = way.map(|c| c / length);
    // Beyond this the face would have to be seen from behind.
    (task.ior * d[2] > 1.0).then(|| {
        let up = task.ior - d[2];
        [d[0] / up, d[1] / up]
    })
}

/// Heights at the grid's points, rows along y, the least one zero; `None` if
/// no face sends the light so far aside.
pub(super) fn heights(task: &Task, targets: &Targets) -> Option<Vec<f64>> {
    let [nx, ny] = task.resolution;
    let spacing = task.spacing();
    let poisson = Poisson::new(task.resolution, spacing);
    let mut h = vec![0.0; nx * ny];
    for _ in 0..MAX_TURNS {
        let steps = steps(task, targets, &h)?;
        let mut next = divergence(task.resolution, spacing, &steps);
        poisson.solve(&mut next);
        let least = next.iter().copied().fold(f64::INFINITY, f64::min);
        for z in &mut next {
            *z -= least;
        }
        let change = next.iter().zip(&h).map(|(a, b)| (a - b).abs());
        let change = change.fold(0.0, f64::max);
        h = next;
        if change <= SETTLED * task.distance {
            return Some(h);
        }
    }
    None
}

/// The differences of height from each point to its neighbours right and
/// above: the slopes between, integrated by Simpson's rule. The height in the
/// middle is that of the cubic through heights and slopes at both ends.
fn steps(task: &Task, targets: &Targets, h: &[f64]) -> Option<Vec<[f64; 2]>> {
    let [nx, ny] = task.resolution;
    let [hx, hy] = task.spacing();
    let slope = |i: f64, j: f64, z: f64, target: [f64; 2]| {
        let x = i * hx - 0.5 * task.lens[0];
        let y = j * hy - 0.5 * task.lens[1];
        slopes(task, [x, y, z], target)
    };
    let at_points: Option<Vec<[f64; 2]>> = (0..nx * ny)
        .into_par_iter()
        .map(|k| slope((k % nx) as f64, (k / nx) as f64, h[k], targets.points[k]))
        .collect();
    let at_points = at_points?;
    (0..nx * ny)
        .into_par_iter()
        .map(|k| {
            let (i, j) = (k % nx, k / nx);
            let (x, y) = (i as f64, j as f64);
            let step = |axis: usize, next: usize, at: [f64; 2], target: [f64; 2]| {
                let size = [hx, hy][axis];
                let ends = [at_points[k][axis], at_points[next][axis]];
                let z = 0.5 * (h[k] + h[next]) + 0.125 * size * (ends[0] - ends[1]);
                let middle = slope(at[0], at[1], z, target)?[axis];
                Some(size / 6.0 * (ends[0] + 4.0 * middle + ends[1]))
            };
            let mut steps = [0.0; 2];
            if i + 1 < nx {
                steps[0] = step(0, k + 1, [x + 0.5, y], targets.along_x[k])?;
            }
            if j + 1 < ny {
                steps[1] = step(1, k + nx, [x, y + 0.5], targets.along_y[k])?;
            }
            Some(steps)
        })
        .collect()
}

/// The right side of the normal equations: what flows out of each point.
fn divergence(size: [usize; 2], spacing: [f64; 2], steps: &[[f64; 2]]) -> Vec<f64> {
    let [nx, _] = size;
    let [xx, yy] = spacing.map(|h| h * h);
    (0..steps.len())
        .map(|k| {
            let left = if k % nx > 0 { steps[k - 1][0] } else { 0.0 };
            let below = if k >= nx { steps[k - nx][1] } else { 0.0 };
            (steps[k][0] - left) / xx + (steps[k][1] - below) / yy
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences of a given surface lead back to it.
    #[test]
    fn least_squares_find_a_surface_from_its_steps() {
        let (size, spacing) = ([16, 8], [0.5, 0.25]);
        let z: Vec<f64> = (0..128).map(|k| f64::from((k * k * 31) % 97)).collect();
        let steps: Vec<[f64; 2]> = (0..128)
            .map(|k| {
                let x = if k % 16 < 15 { z[k + 1] - z[k] } else { 0.0 };
                let y = if k < 112 { z[k + 16] - z[k] } else { 0.0 };
                [x, y]
            })
            .collect();
        let mut found = divergence(size, spacing, &steps);
        Poisson::new(size, spacing).solve(&mut found);
        let shift = z[0] - found[0];
        for (a, b) in found.iter().zip(&z) {
            assert!((a + shift - b).abs() < 1e-11);
        }
    }
}

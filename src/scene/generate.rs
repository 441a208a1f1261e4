//! Meshes made from a few numbers.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{
    description::{TorusKnot, Waves},
    mesh_file::MeshData,
};
use crate::numeric::trig::sin_cos;

/// Most triangles a generator makes.
pub const MAX_TRIANGLES: u64 = 50_000_000;

/// Triangles of a sheet of waves.
pub(super) fn wave_triangles(waves: &Waves) -> u64 {
    2 * u64::from(waves.cells.0[0]) * u64::from(waves.cells.0[1])
}

/// A height field over a regular grid: `z` is the sum of the waves, normals
/// are those of the exact surface. Vertices run along x first; every cell
/// gives the triangle below its rising diagonal in a first run over the
/// cells, the one above it in a second, both counter-clockwise from above.
pub(super) fn waves(waves: &Waves) -> MeshData {
    let [nx, ny] = waves.cells.0.map(|n| n as usize);
    let mut vertices = Vec::with_capacity((nx + 1) * (ny + 1));
    let mut normals = Vec::with_capacity(vertices.capacity());
    for j in 0..=ny {
        let y = grid_line(waves.y.0, j, ny);
        for i in 0..=nx {
            let x = grid_line(waves.x.0, i, nx);
            let (mut z, mut dx, mut dy) = (0.0, 0.0, 0.0);
            for wave in &waves.waves {
                let [kx, ky] = wave.k.0;
                let (sin, cos) = sin_cos(kx * x + ky * y + wave.phase.0);
                z += wave.amplitude.0 * sin;
                dx += wave.amplitude.0 * kx * cos;
                dy += wave.amplitude.0 * ky * cos;
            }
            vertices.push(DVec3::new(x, y, waves.level.0 + z));
            normals.push(DVec3::new(-dx, -dy, 1.0).normalize());
        }
    }
    MeshData { vertices, normals: Some(normals), triangles: grid_triangles([nx, ny], [false; 2]) }
}

/// Line `i` of `n + 1` evenly spaced ones, both ends exact.
fn grid_line([from, to]: [f64; 2], i: usize, n: usize) -> f64 {
    if i == n { to } else { from + i as f64 * ((to - from) / n as f64) }
}

/// Triangles of a torus knot.
pub(super) fn knot_triangles(knot: &TorusKnot) -> u64 {
    2 * u64::from(knot.segments) * u64::from(knot.sides)
}

/// A tube around the curve
/// `scale * ((ring + cos qt) cos pt, (ring + cos qt) sin pt, height * sin qt)`,
/// `t` in `[0, 2 pi)`. The cross-section starts on the torus' own outward
/// normal, made orthogonal to the curve, so that the seam closes. Normals are
/// exact: radial. Vertices run around the tube first.
pub(super) fn torus_knot(knot: &TorusKnot) -> MeshData {
    let [nt, nu] = [knot.segments, knot.sides].map(|n| n as usize);
    let around: Vec<(f64, f64)> = (0..nu).map(|k| sin_cos(k as f64 / nu as f64 * TAU)).collect();
    let mut vertices = Vec::with_capacity(nt * nu);
    let mut normals = Vec::with_capacity(nt * nu);
    for k in 0..nt {
        let (center, a, b) = knot_frame(knot, k as f64 / nt as f64 * TAU);
        for &(sin, cos) in &around {
            let out = cos * a + sin * b;
            vertices.push(center + knot.tube.0 * out);
            normals.push(out);
        }
    }
    let mut triangles = grid_triangles([nu, nt], [true; 2]);
    if points_inward(&vertices, &normals, &triangles) {
        for t in &mut triangles {
            t.reverse();
        }
    }
    MeshData { vertices, normals: Some(normals), triangles }
}

/// A point of the curve and two directions that span its normal plane.
fn knot_frame(knot: &TorusKnot, t: f64) -> (DVec3, DVec3, DVec3) {
    let (p, q) = (f64::from(knot.p), f64::from(knot.q));
    let (sin_p, cos_p) = sin_cos(p * t);
    let (sin_q, cos_q) = sin_cos(q * t);
    let radial = DVec3::new(cos_p, sin_p, 0.0);
    let along = DVec3::new(-sin_p, cos_p, 0.0);
    let r = knot.ring.0 + cos_q;
    let center = knot.scale.0 * (r * radial + knot.height.0 * sin_q * DVec3::Z);
    let tangent =
        (-q * sin_q * radial + r * p * along + knot.height.0 * q * cos_q * DVec3::Z).normalize();
    let minor = cos_q * radial + sin_q * DVec3::Z;
    let a = (minor - minor.dot(tangent) * tangent).normalize();
    (DVec3::from(knot.center) + center, a, tangent.cross(a))
}

/// Whether most of the surface is wound against its normals.
fn points_inward(vertices: &[DVec3], normals: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    let facing = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| vertices[i as usize]);
        (b - a).cross(c - a).dot(normals[t[0] as usize])
    };
    triangles.iter().map(facing).sum::<f64>() < 0.0
}

/// Two triangles per cell of a grid of `cells`, whose first direction varies
/// fastest; a direction may close on itself.
fn grid_triangles(cells: [usize; 2], wrap: [bool; 2]) -> Vec<[u32; 3]> {
    let [nu, nv] = cells;
    let width = if wrap[0] { nu } else { nu + 1 };
    let height = if wrap[1] { nv } else { nv + 1 };
    let corner = |i: usize, j: usize| ((j % height) * width + i % width) as u32;
    let mut triangles = Vec::with_capacity(2 * nu * nv);
    for upper in [false, true] {
        for j in 0..nv {
            for i in 0..nu {
                let (a, c) = (corner(i, j), corner(i + 1, j + 1));
                triangles.push(if upper {
                    [a, c, corner(i, j + 1)]
                } else {
                    [a, corner(i + 1, j), c]
                });
            }
        }
    }
    triangles
}

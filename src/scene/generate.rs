//! Meshes made from a few numbers.

mod height_field;

use std::f64::consts::TAU;

use glam::DVec3;

use super::{
    description::{TorusKnot, Waves},
    mesh_file::{MeshData, Names},
};
use crate::numeric::trig::sin_cos;

pub use height_field::{Grid, Height, height_field};

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
    MeshData {
        vertices,
        normals: Some(normals),
        triangles: grid_triangles([nx, ny], [false; 2]),
        names: Names::default(),
    }
}

/// Line `i` of `n + 1` evenly spaced ones, both ends exact.
fn grid_line([from, to]: [f64; 2], i: usize, n: usize) -> f64 {
    if i == n {
        to
    } else {
        from + i as f64 * ((to - from) / n as f64)
    }
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
    let around: Vec<(f64, f64)> = (0..nu)
        .map(|k| sin_cos(k as f64 / nu as f64 * TAU))
        .collect();
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
    MeshData {
        vertices,
        normals: Some(normals),
        triangles,
        names: Names::default(),
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{Cells, Number, Pair, Triple, Wave};

    /// What an independent program computed for the same definition.
    struct Truth {
        /// Vertex index, position, normal.
        samples: [(usize, [f64; 3], [f64; 3]); 3],
        /// Triangle index and corners.
        corners: [(usize, [u32; 3]); 4],
        /// Sums over all vertices, each weighted by `7 i mod 11`.
        position_sum: [f64; 3],
        normal_sum: [f64; 3],
        /// Sum of `(i mod 1009 + 1) (a + 3 b + 7 c)` over triangles.
        corner_sum: u64,
    }

    fn check(mesh: &MeshData, truth: &Truth, tolerance: f64) {
        let normals = mesh.normals.as_ref().unwrap();
        for (i, p, n) in truth.samples {
            assert!(
                (mesh.vertices[i] - DVec3::from(p)).length() < tolerance,
                "vertex {i}"
            );
            assert!(
                (normals[i] - DVec3::from(n)).length() < tolerance,
                "normal {i}"
            );
        }
        for (i, corners) in truth.corners {
            assert_eq!(mesh.triangles[i], corners, "triangle {i}");
        }
        let weighted = |list: &[DVec3]| -> DVec3 {
            list.iter()
                .enumerate()
                .map(|(i, v)| *v * ((7 * i % 11) as f64))
                .sum()
        };
        let slack = tolerance * 5.0 * mesh.vertices.len() as f64;
        let off = weighted(&mesh.vertices) - DVec3::from(truth.position_sum);
        assert!(off.length() < slack, "positions {off}");
        let off = weighted(normals) - DVec3::from(truth.normal_sum);
        assert!(off.length() < slack, "normals {off}");
        let corners = mesh.triangles.iter().enumerate().map(|(i, t)| {
            let [a, b, c] = t.map(u64::from);
            (i as u64 % 1009 + 1) * (a + 3 * b + 7 * c)
        });
        assert_eq!(corners.sum::<u64>(), truth.corner_sum);
    }

    fn pool(cells: u32) -> Waves {
        let list = [
            (0.0280, 5.2, 2.1, 0.0),
            (0.0220, -3.1, 6.3, 1.3),
            (0.0140, 8.9, -4.7, 2.1),
            (0.0100, 2.3, 11.8, 4.0),
            (0.0060, -12.5, -7.4, 5.2),
        ];
        let waves = list.map(|(amplitude, kx, ky, phase)| Wave {
            amplitude: Number(amplitude),
            k: Pair([kx, ky]),
            phase: Number(phase),
        });
        Waves {
            x: Pair([-1.5, 1.5]),
            y: Pair([-1.5, 1.5]),
            level: Number(0.0),
            cells: Cells([cells; 2]),
            waves: waves.to_vec(),
        }
    }

    #[test]
    fn the_pool_equals_its_definition() {
        let truth = Truth {
            samples: [
                (
                    1,
                    [-1.48828125, -1.5, 0.0555671335775754],
                    [-0.04225511136728286, 0.0724133843242404, 0.9964792056706695],
                ),
                (
                    777,
                    [-1.4296875, -1.46484375, 0.05152434758934231],
                    [0.06122167748048243, 0.14231107653252983, 0.9879268513926669],
                ),
                (
                    66048,
                    [1.5, 1.5, -0.017056284687984816],
                    [0.17385822185639946, -0.23562571043954128, 0.956166221570702],
                ),
            ],
            corners: [
                (0, [0, 1, 258]),
                (12345, [12393, 12394, 12651]),
                (65536, [0, 258, 257]),
                (131_071, [65790, 66048, 66047]),
            ],
            position_sum: [4.60546875, 4.5, 20.42261245380926],
            normal_sum: [399.8632437761304, 14.433192925613609, 323104.46039486653],
            corner_sum: 24_169_480_370_725,
        };
        check(&waves(&pool(256)), &truth, 1e-13);
    }

    #[test]
    fn the_knot_equals_its_definition() {
        let knot = TorusKnot {
            center: Triple([0.0, 0.0, 0.55]),
            ..TorusKnot::default()
        };
        let truth = Truth {
            samples: [
                (
                    1,
                    [0.9592777090008295, 0.007564410435885916, 0.5373926493575725],
                    [
                        0.9951847266721969,
                        0.050429402905906105,
                        -0.08404900428285016,
                    ],
                ),
                (
                    777,
                    [0.8997813674441567, 0.1922595316138468, 0.5439427611737442],
                    [0.7002520837924132, 0.49580307707788757, -0.5136402709138777],
                ),
                (
                    65535,
                    [
                        0.9592781889652453,
                        -0.019135655587760703,
                        0.5540149115061318,
                    ],
                    [
                        0.9958994663087232,
                        -0.06130847274841232,
                        0.06652461330408123,
                    ],
                ),
            ],
            corners: [
                (0, [0, 1, 65]),
                (12345, [12345, 12346, 12410]),
                (65536, [0, 65, 64]),
                (131_071, [65535, 0, 63]),
            ],
            position_sum: [
                -1.9083852892293116,
                0.034201700183593135,
                180222.87069689366,
            ],
            normal_sum: [-1.923278808726956, 0.16178127469176518, -0.2350990935124882],
            corner_sum: 23_903_266_158_955,
        };
        // The definition takes the tangent by central differences of step
        // 1e-4: it is off by 1e-8 |c'''| / (6 |c'|), about 1e-8.
        check(&torus_knot(&knot), &truth, 3e-8);
    }

    #[test]
    fn knots_are_wound_outward_for_all_turns() {
        for (p, q) in [(2, 3), (3, 2), (1, 5), (5, 4)] {
            let knot = TorusKnot {
                p,
                q,
                segments: 64,
                sides: 8,
                ..TorusKnot::default()
            };
            let mesh = torus_knot(&knot);
            assert_eq!(mesh.triangles.len() as u64, knot_triangles(&knot));
            let normals = mesh.normals.as_ref().unwrap();
            assert!(
                !points_inward(&mesh.vertices, normals, &mesh.triangles),
                "({p}, {q})"
            );
        }
    }

    #[test]
    fn grids_may_be_oblong() {
        let mesh = waves(&Waves {
            cells: Cells([2, 1]),
            ..pool(1)
        });
        assert_eq!(mesh.vertices.len(), 6);
        assert_eq!(mesh.triangles, [[0, 1, 4], [1, 2, 5], [0, 4, 3], [1, 5, 4]]);
        assert_eq!(mesh.vertices[5].truncate(), glam::DVec2::new(1.5, 1.5));
    }
}

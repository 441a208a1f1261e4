//! A surface `z = f(x, y)` over a rectangle, as a sheet or a solid body.

use glam::DVec3;
use rayon::prelude::*;

use super::{grid_line, grid_triangles};
use crate::scene::mesh_file::{MeshData, Names};

/// Where the grid of a height field stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Extent along x in metres.
    pub x: [f64; 2],
    /// Extent along y in metres.
    pub y: [f64; 2],
    /// Cells along x and y, at least 1.
    pub cells: [usize; 2],
}

impl Grid {
    /// Triangles of the sheet, or of the body if it has a base.
    pub fn triangles(&self, has_base: bool) -> u64 {
        let [nx, ny] = self.cells.map(|n| n as u64);
        let closing = if has_base { 6 * (nx + ny) } else { 0 };
        2 * nx * ny + closing
    }

    /// The place of grid point `(i, j)`.
    fn place(&self, i: usize, j: usize) -> [f64; 2] {
        [
            grid_line(self.x, i, self.cells[0]),
            grid_line(self.y, j, self.cells[1]),
        ]
    }

    /// The grid points around the edge, counter-clockwise from above, as four
    /// sides with both their ends, and the outward normals of the sides.
    fn sides(&self) -> [(Vec<[usize; 2]>, DVec3); 4] {
        let [nx, ny] = self.cells;
        [
            ((0..=nx).map(|i| [i, 0]).collect(), DVec3::NEG_Y),
            ((0..=ny).map(|j| [nx, j]).collect(), DVec3::X),
            ((0..=nx).rev().map(|i| [i, ny]).collect(), DVec3::Y),
            ((0..=ny).rev().map(|j| [0, j]).collect(), DVec3::NEG_X),
        ]
    }
}

/// A point of a height field: `[f, df/dx, df/dy]`.
pub type Height = [f64; 3];

/// The sheet `z = f(x, y)`, its normals those of the exact surface. With a
/// `base`, a z below the surface, walls and a flat bottom make it a closed
/// body; their normals are their own, so the rim stays sharp. `f` gets the
/// numbers of a grid point and its place. Where a gradient is not finite the
/// normal is zero: shading uses the facet's there.
pub fn height_field(
    grid: &Grid,
    base: Option<f64>,
    smooth: bool,
    f: impl Fn([usize; 2], [f64; 2]) -> Height + Sync,
) -> MeshData {
    let [nx, ny] = grid.cells;
    let (mut vertices, mut normals): (Vec<DVec3>, Vec<DVec3>) = (0..(nx + 1) * (ny + 1))
        .into_par_iter()
        .map(|k| {
            let at = [k % (nx + 1), k / (nx + 1)];
            let [x, y] = grid.place(at[0], at[1]);
            let [z, dx, dy] = f(at, [x, y]);
            let normal = DVec3::new(-dx, -dy, 1.0).normalize_or_zero();
            (DVec3::new(x, y, z), normal)
        })
        .unzip();
    let mut triangles = grid_triangles(grid.cells, [false; 2]);
    if let Some(base) = base {
        let body = Body {
            vertices: &mut vertices,
            normals: &mut normals,
            triangles: &mut triangles,
        };
        body.close(grid, base);
    }
    MeshData {
        vertices,
        normals: smooth.then_some(normals),
        triangles,
        names: Names::default(),
    }
}

/// The sheet that is being closed.
struct Body<'a> {
    vertices: &'a mut Vec<DVec3>,
    normals: &'a mut Vec<DVec3>,
    triangles: &'a mut Vec<[u32; 3]>,
}

impl Body<'_> {
    fn push(&mut self, p: DVec3, n: DVec3) -> u32 {
        self.vertices.push(p);
        self.normals.push(n);
        self.vertices.len() as u32 - 1
    }

    /// Adds walls and bottom. The wall repeats the rim's points to the bit;
    /// the bottom is a fan around its middle, which sees all of the rim.
    fn close(mut self, grid: &Grid, base: f64) {
        let [x, y] = [grid.x, grid.y].map(|[from, to]| from + 0.5 * (to - from));
        let middle = self.push(DVec3::new(x, y, base), DVec3::NEG_Z);
        for (side, out) in grid.sides() {
            let mut last: Option<[u32; 3]> = None;
            for [i, j] in side {
                let top = self.vertices[j * (grid.cells[0] + 1) + i];
                let foot = DVec3::new(top.x, top.y, base);
                let now = [
                    self.push(top, out),
                    self.push(foot, out),
                    self.push(foot, DVec3::NEG_Z),
                ];
                if let Some([top_before, foot_before, floor_before]) = last {
                    let [top, foot, floor] = now;
                    self.triangles.push([foot_before, foot, top]);
                    self.triangles.push([foot_before, top, top_before]);
                    self.triangles.push([middle, floor, floor_before]);
                }
                last = Some(now);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Surface, TriangleMesh};

    const GRID: Grid = Grid {
        x: [-1.0, 2.0],
        y: [0.5, 1.5],
        cells: [7, 5],
    };

    fn plane(_: [usize; 2], [x, y]: [f64; 2]) -> Height {
        [1.0 + 0.25 * x - 0.5 * y, 0.25, -0.5]
    }

    fn mesh(data: MeshData) -> TriangleMesh {
        TriangleMesh::new(data.vertices, data.normals, data.triangles).unwrap()
    }

    #[test]
    fn a_body_is_closed_and_has_its_volume() {
        for grid in [
            GRID,
            Grid {
                cells: [1, 1],
                ..GRID
            },
        ] {
            let data = height_field(&grid, Some(-0.75), true, plane);
            assert_eq!(data.triangles.len() as u64, grid.triangles(true));
            let mesh = mesh(data);
            assert!(mesh.is_closed());
            assert_eq!(
                (mesh.dropped_triangles(), mesh.disagreeing_normals()),
                (0, 0)
            );
            // The plane's mean height over the rectangle, above the base.
            let known = 3.0 * (1.0 + 0.25 * 0.5 - 0.5 * 1.0 + 0.75);
            assert!((mesh.signed_volume() - known).abs() < 1e-14);
        }
        let sheet = height_field(&GRID, None, true, plane);
        assert_eq!(sheet.triangles.len() as u64, GRID.triangles(false));
        assert!(!mesh(sheet).is_closed());
    }

    #[test]
    fn walls_and_bottom_are_flat_and_the_top_is_smooth() {
        let bowl = |_: [usize; 2], [x, y]: [f64; 2]| [x * x + y, 2.0 * x, 1.0];
        let data = height_field(&GRID, Some(-1.0), true, bowl);
        let normals = data.normals.as_ref().unwrap();
        let mut counts = [0; 3];
        for t in &data.triangles {
            let [a, b, c] = t.map(|i| data.vertices[i as usize]);
            let facet = (b - a).cross(c - a).normalize();
            for i in t {
                let (p, n) = (data.vertices[*i as usize], normals[*i as usize]);
                if facet.z > 0.0 {
                    let known = DVec3::new(-2.0 * p.x, -1.0, 1.0).normalize();
                    assert!((n - known).length() < 1e-15);
                    counts[0] += 1;
                } else {
                    assert!((n - facet).length() < 1e-15, "{n} on {facet}");
                    counts[if facet.z < 0.0 { 1 } else { 2 }] += 1;
                }
            }
        }
        assert_eq!(counts, [3 * 70, 3 * 24, 3 * 48]);
    }

    #[test]
    fn facets_and_wild_gradients() {
        assert!(height_field(&GRID, None, false, plane).normals.is_none());
        let kink = |_: [usize; 2], _: [f64; 2]| [0.0, f64::NAN, f64::INFINITY];
        let data = height_field(&GRID, None, true, kink);
        assert!(data.normals.unwrap().iter().all(|n| *n == DVec3::ZERO));
    }
}

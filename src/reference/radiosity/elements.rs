//! The finite elements: cells of the diffuse surfaces' charts.

use glam::DVec3;

use crate::{
    geometry::{Instance, SurfaceId, SurfacePoint, Transform},
    numeric::Frame,
    scene::Scene,
};

use super::chart::{Chart, parts};

/// Most cells along a side of a chart.
const MOST: u32 = 1024;

/// Where the stretch of a transformed cell is looked at, along each side.
const LOOKS: u32 = 4;

/// Bytes of an element: its own, its sides' light of a pass, and the power
/// that they have yet to send on.
pub(in super::super) const BYTES_PER_ELEMENT: u64 =
    (size_of::<Element>() + 2 * 4 * size_of::<crate::spectrum::Rgb>()) as u64;

/// A cell of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element {
    instance: u32,
    part: u32,
    /// Its number among the cells of its part.
    cell: u32,
    /// In square metres.
    pub(super) area: f64,
}

/// The cells of a part of an instance.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// Number of its first element.
    first: u32,
    cells: [u32; 2],
}

/// All elements of a scene.
pub(super) struct Elements<'a> {
    scene: &'a Scene,
    cells: Vec<Element>,
    /// For every instance, the grids of its parts; none if it isn't diffuse.
    grids: Vec<Vec<Grid>>,
}

/// The largest edge of an element: the diameter of the sphere around all
/// bounded objects, divided by `patches`.
fn edge(scene: &Scene, patches: u32) -> f64 {
    let bounds = scene.world.bounds();
    let diameter = bounds.map_or(1.0, |b| 2.0 * b.bounding_sphere().radius);
    diameter / f64::from(patches)
}

fn is_element(scene: &Scene, instance: usize) -> bool {
    scene.objects[instance].material.is_finite()
}

/// Name of the first diffuse object that cannot be divided into elements.
pub(in super::super) fn obstacle(scene: &Scene) -> Option<&str> {
    let instances = scene.world.instances().iter().enumerate();
    instances
        .filter(|(i, instance)| is_element(scene, *i) && parts(&instance.shape).is_none())
        .map(|(i, _)| scene.objects[i].name.as_str())
        .next()
}

/// Number of elements of a scene.
pub(in super::super) fn count(scene: &Scene, patches: u32) -> u64 {
    let edge = edge(scene, patches);
    let mut count = 0;
    each_part(scene, |instance, _, chart| {
        let [x, y] = cells(chart, instance, edge);
        count += u64::from(x) * u64::from(y);
    });
    count
}

/// Tells every part of every diffuse instance.
fn each_part(scene: &Scene, mut tell: impl FnMut(&Instance, [u32; 2], &Chart)) {
    for (i, instance) in scene.world.instances().iter().enumerate() {
        if is_element(scene, i) {
            for part in 0..parts(&instance.shape).unwrap_or(0) {
                if let Some(chart) = Chart::of(&instance.shape, part) {
                    tell(instance, [i as u32, part], &chart);
                }
            }
        }
    }
}

/// Cells along the sides of a chart.
fn cells(chart: &Chart, instance: &Instance, edge: f64) -> [u32; 2] {
    let stretch = instance
        .transform
        .as_ref()
        .map_or(1.0, Transform::max_stretch);
    let (sides, fewest) = chart.sides();
    // `as` saturates.
    let along = |i: usize| ((sides[i] * stretch / edge).ceil() as u32).clamp(fewest[i], MOST);
    [along(0), along(1)]
}

/// The place of the unit square at `u` in a cell.
fn within(cell: u32, [nx, ny]: [u32; 2], u: [f64; 2]) -> [f64; 2] {
    let [column, row] = [cell % nx, cell / nx].map(f64::from);
    [
        (column + u[0]) / f64::from(nx),
        (row + u[1]) / f64::from(ny),
    ]
}

/// Area in the world over area in the shape's own space, where the shape has
/// the unit normal `n`.
fn stretch(transform: Option<&Transform>, n: DVec3) -> f64 {
    transform.map_or(1.0, |m| {
        let frame = Frame::around(n);
        m.vector(frame.s).cross(m.vector(frame.t)).length()
    })
}

impl<'a> Elements<'a> {
    /// Divides the diffuse surfaces of a scene: an element is no longer than
    /// the diameter of the scene divided by `patches`.
    pub(super) fn new(scene: &'a Scene, patches: u32) -> Self {
        let edge = edge(scene, patches);
        let mut grids = vec![Vec::new(); scene.world.instances().len()];
        let mut elements = Vec::new();
        each_part(scene, |placed, [instance, part], chart| {
            let grid = Grid {
                first: elements.len() as u32,
                cells: cells(chart, placed, edge),
            };
            grids[instance as usize].push(grid);
            let [nx, ny] = grid.cells;
            let own = chart.area() / (f64::from(nx) * f64::from(ny));
            for cell in 0..nx * ny {
                let looks = (0..LOOKS * LOOKS).map(|k| {
                    let u = [k % LOOKS, k / LOOKS].map(|j| (f64::from(j) + 0.5) / f64::from(LOOKS));
                    stretch(
                        placed.transform.as_ref(),
                        chart.at(within(cell, grid.cells, u)).ng,
                    )
                });
                let mean = looks.sum::<f64>() / f64::from(LOOKS * LOOKS);
                elements.push(Element {
                    instance,
                    part,
                    cell,
                    area: own * mean,
                });
            }
        });
        Self {
            scene,
            cells: elements,
            grids,
        }
    }

    /// Every element.
    pub(super) fn all(&self) -> &[Element] {
        &self.cells
    }

    /// The instance to which an element belongs.
    #[cfg(test)]
    pub(super) fn instance(&self, element: usize) -> u32 {
        self.cells[element].instance
    }

    /// Reflectance of an element.
    pub(super) fn reflectance(&self, element: usize) -> crate::spectrum::Rgb {
        let instance = self.cells[element].instance as usize;
        match self.scene.objects[instance].material {
            crate::material::Material::Diffuse { reflectance } => reflectance,
            _ => crate::spectrum::Rgb::BLACK,
        }
    }

    /// The element on which a point of a diffuse surface lies.
    pub(super) fn at(&self, point: &SurfacePoint) -> Option<usize> {
        let SurfaceId { instance, part } = point.surface;
        let placed = &self.scene.world.instances()[instance as usize];
        let grid = self.grids[instance as usize].get(part as usize)?;
        let [nx, ny] = grid.cells;
        if nx * ny == 1 {
            return Some(grid.first as usize);
        }
        let own = match &placed.transform {
            None => point.p,
            Some(m) => m.inverse_point(point.p),
        };
        let place = Chart::of(&placed.shape, part)?.place(own);
        // `as` is zero below zero and for what is not a number.
        let cell = |x: f64, n: u32| ((x * f64::from(n)) as u32).min(n - 1);
        let number = cell(place[1], ny) * nx + cell(place[0], nx);
        Some((grid.first + number) as usize)
    }

    /// The point of an element at `u` in the unit square, and the density of
    /// its area there over the mean density: the weight of a point if `u` is
    /// drawn evenly.
    pub(super) fn point(&self, element: usize, u: [f64; 2]) -> Option<(SurfacePoint, f64)> {
        let e = self.cells[element];
        let placed = &self.scene.world.instances()[e.instance as usize];
        let cells = self.grids[e.instance as usize][e.part as usize].cells;
        let chart = Chart::of(&placed.shape, e.part)?;
        let own = chart.at(within(e.cell, cells, u));
        let surface = SurfaceId {
            instance: e.instance,
            part: e.part,
        };
        let transform = placed.transform.as_ref();
        let point = match transform {
            None => SurfacePoint {
                p: own.p,
                error: own.error,
                ng: own.ng,
                ns: own.ns,
                surface,
            },
            Some(m) => SurfacePoint {
                p: m.point(own.p),
                error: m.point_error(own.p, own.error),
                ng: m.normal(own.ng),
                ns: m.normal(own.ns),
                surface,
            },
        };
        let [nx, ny] = cells.map(f64::from);
        let weight = stretch(transform, own.ng) * chart.area() / (nx * ny * e.area);
        Some((point, weight))
    }
}

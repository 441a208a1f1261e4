//! Height fields: an image or a formula becomes a surface.

use glam::DVec3;

use super::Builder;
use crate::{
    formula::Formula,
    numeric::SplineSurface,
    scene::{
        MAX_LENGTH, MIN_LENGTH,
        description::{HeightField, Triple},
        diagnostics::Diagnostic,
        generate::{Grid, height_field},
        image_file::{self, Kind, Samples},
        mesh_file::MeshData,
        outline::NodeId,
    },
};

/// Cells along each side of a formula's field, if none are given.
const FORMULA_CELLS: usize = 256;

/// What gives a field its heights.
enum Heights {
    Image(Samples),
    Formula(Formula),
}

impl Builder<'_> {
    pub(super) fn height_field(&mut self, node: NodeId, field: &HeightField) -> Option<MeshData> {
        let x = self.extent(node, "x", field.x.0);
        let y = self.extent(node, "y", field.y.0);
        let depth = match field.depth {
            Some(depth) => self.report.length(node, "depth", depth).map(Some),
            None => Some(None),
        };
        let heights = self.heights(node, field);
        let (x, y, depth, heights) = (x?, y?, depth?, heights?);
        let cells = match (&field.cells, &heights) {
            (Some(cells), _) => cells.0.map(|n| n as usize),
            (None, Heights::Image(image)) => image.size.map(|n| n - 1),
            (None, Heights::Formula(_)) => [FORMULA_CELLS; 2],
        };
        let grid = Grid { x, y, cells };
        let count = if cells.contains(&0) {
            0
        } else {
            grid.triangles(depth.is_some())
        };
        let key = field.cells.map_or("heights", |_| "cells");
        self.budget(node, key, count)?;
        let bottom = depth.map(|d| -d);
        let data = match heights {
            Heights::Image(image) => image_field(&grid, bottom, field.smooth, &image),
            Heights::Formula(formula) => height_field(&grid, bottom, field.smooth, |_, [x, y]| {
                let (z, slopes) = formula.gradient(DVec3::new(x, y, 0.0));
                [z, slopes.x, slopes.y]
            }),
        };
        let top = &data.vertices[..(cells[0] + 1) * (cells[1] + 1)];
        self.check_heights(node, field, top)?;
        if let Some(depth) = depth {
            let lowest = top.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
            self.check_bottom(node, depth, lowest)?;
        }
        Some(data)
    }

    /// Exactly one of an image and a formula, and nothing that goes with the
    /// other.
    fn heights(&mut self, node: NodeId, field: &HeightField) -> Option<Heights> {
        let forms = [
            ("heights", field.heights.is_some()),
            ("formula", field.formula.is_some()),
        ];
        if self.report.exactly_one(node, &forms)? == 0 {
            let path = field.heights.as_deref()?;
            return self.image_heights(node, field, path).map(Heights::Image);
        }
        let strangers = [
            ("channel", field.channel.is_some()),
            ("range", field.range.is_some()),
        ];
        if let Some((key, _)) = strangers.iter().find(|(_, given)| *given) {
            let place = self.report.field(node, key);
            let diagnostic = self
                .report
                .about_key(place, format!("`{key}` does not go with `formula`"))
                .with_label("belongs to an image")
                .with_help("remove it; a formula gives heights in metres");
            self.report.push(diagnostic);
            return None;
        }
        let place = self.report.field(node, "formula");
        let formula = self.formula(place, field.formula.as_deref()?)?;
        if let Some(span) = formula.first_use(2) {
            let diagnostic = self
                .report
                .about_text(place, span, "the formula of a height field has no z")
                .with_label("z is what it gives")
                .with_help("write z as a formula in x and y; for others there is `Implicit`");
            self.report.push(diagnostic);
            return None;
        }
        Some(Heights::Formula(formula))
    }

    /// The first height that is none, or is out of range.
    fn check_heights(&mut self, node: NodeId, field: &HeightField, top: &[DVec3]) -> Option<()> {
        // NaN is in no range.
        let range = -MAX_LENGTH..=MAX_LENGTH;
        let Some(p) = top.iter().find(|p| !range.contains(&p.z)) else {
            return Some(());
        };
        let (key, help) = match field.formula {
            None => (
                "heights",
                "heights are in metres: scale them by `range: (0, ..)`",
            ),
            Some(_) => (
                "formula",
                "move `x` and `y` away from where the formula is undefined",
            ),
        };
        let place = self.report.field(node, key);
        let message = format!("the height is {} at x = {}, y = {}", p.z, p.x, p.y);
        let label = format!("expected heights up to {MAX_LENGTH:e} metres");
        self.report.reject(place, message, label, help)
    }

    /// A range of x or y that is not empty.
    fn extent(&mut self, node: NodeId, key: &str, [from, to]: [f64; 2]) -> Option<[f64; 2]> {
        let place = self.report.field(node, key);
        self.report.point_here(place, Triple([from, to, 0.0]))?;
        if to - from >= MIN_LENGTH {
            return Some([from, to]);
        }
        let label = "expected `(from, to)` with `to` above `from`";
        let message = format!("the range of {key} is empty");
        self.report.reject(place, message, label, "swap the two")
    }

    /// Heights in metres, the first row at the lower end of y.
    fn image_heights(&mut self, node: NodeId, field: &HeightField, path: &str) -> Option<Samples> {
        let mut image = self.height_image(node, path, field.channel.as_deref())?;
        let [from, to] = match (field.range, image.kind) {
            (Some(range), _) => range.0,
            (None, Kind::Numbers) => [0.0, 1.0],
            (None, Kind::Fractions) => {
                let mut missing = self.report.missing_field(node, "range");
                missing.help = Some(
                    "a PNG does not say how high its white is: write `range: (0, 0.01)`, \
                     the heights of black and white in metres"
                        .to_owned(),
                );
                self.report.push(missing);
                return None;
            }
        };
        let width = image.size[0];
        let rows = image.values.chunks(width).rev().flatten();
        image.values = rows.map(|v| from + v * (to - from)).collect();
        Some(image)
    }

    fn height_image(&mut self, node: NodeId, path: &str, channel: Option<&str>) -> Option<Samples> {
        let place = self.report.field(node, "heights");
        let path = self.base_dir.join(path);
        let fault = match image_file::read(&path, channel, &self.inputs) {
            Ok(image) => return Some(image),
            Err(fault) => fault,
        };
        if !path.is_file() {
            let message = format!("cannot use {}: {}", path.display(), fault.message);
            let help = "paths are relative to the scene file's directory";
            return self
                .report
                .reject(place, message, image_file::EXPECTED, help);
        }
        let span = self.report.outline.span(place);
        let (line, column) = self.report.source.position(span.start);
        let used = format!("used at {}:{line}:{column}", self.report.source.name());
        let mut diagnostic =
            Diagnostic::of_file(path.display().to_string(), fault.message).with_note(used);
        if !fault.help.is_empty() {
            diagnostic = diagnostic.with_help(fault.help);
        }
        self.report.push(diagnostic);
        None
    }

    /// The bottom must lie below all of the surface.
    fn check_bottom(&mut self, node: NodeId, depth: f64, lowest: f64) -> Option<()> {
        if lowest > -depth {
            return Some(());
        }
        let place = self.report.field(node, "depth");
        let label = format!("the surface reaches down to z = {lowest}");
        let help = format!("make the body deeper than {}, or raise the field", -lowest);
        self.report
            .reject(place, "the bottom cuts the surface", label, help)
    }
}

/// The field of an image, whose samples are heights.
fn image_field(grid: &Grid, bottom: Option<f64>, smooth: bool, image: &Samples) -> MeshData {
    let surface = SplineSurface::new(image.size, &image.values);
    // The distance of samples, and samples per cell of the grid.
    let [dx, dy] =
        [(grid.x, 0), (grid.y, 1)].map(|([from, to], k)| (to - from) / (image.size[k] - 1) as f64);
    let steps = [0, 1].map(|k| (image.size[k] - 1) as f64 / grid.cells[k] as f64);
    height_field(grid, bottom, smooth, |[i, j], _| {
        let jet = surface.at(i as f64 * steps[0], j as f64 * steps[1]);
        [jet.value, jet.gradient[0] / dx, jet.gradient[1] / dy]
    })
}

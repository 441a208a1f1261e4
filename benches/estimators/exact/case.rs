//! The scenes, as files for the renderer and as closed forms.

use std::fmt::Write;

use super::{Ball, Reference, Sheet, Source, Window, ball, waves};

/// Pixels along a side of every picture.
pub(crate) const PIXELS: u32 = 200;

/// Cells along a side of the mesh that stands for the waves. Its normals are
/// interpolated; the reference of a surface with such normals differs from
/// that of the waves by a relMSE of 4e-6 (with 256 cells by 3e-5).
const MESH_CELLS: u32 = 512;

/// What bends the light.
#[derive(Clone, Debug)]
pub(crate) enum Optics {
    /// A glass ball.
    Ball(Ball),
    /// A sheet of waves.
    Sheet(Sheet),
}

/// A scene and the square of its floor that is looked at.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// Its name in tables and on the command line.
    pub(crate) name: &'static str,
    /// The light and what bends it.
    pub(crate) optics: Optics,
    /// The part of the floor.
    pub(crate) window: Window,
}

/// Names of all scenes.
pub(crate) const CASES: [&str; 6] = ["before", "focus", "after", "point", "sun", "bumpy"];

impl Case {
    /// The scene of that name.
    ///
    /// The windows hold the bright disc within the outermost fold with a
    /// margin of a third (`before`, `point`, `sun`), or most of the light
    /// where there is no fold (`focus`, `after`). `bumpy` keeps away from the
    /// rim of the sheet by more than light is displaced.
    pub(crate) fn named(name: &str) -> Option<Self> {
        let (name, source, height, width) = match name {
            "before" => ("before", Source::Parallel, 1.2, 0.2),
            "focus" => ("focus", Source::Parallel, 1.5, 0.4),
            "after" => ("after", Source::Parallel, 2.0, 1.2),
            "point" => ("point", Source::Point(4.0), 1.6, 0.32),
            "sun" => ("sun", Source::Cone(0.02), 1.2, 0.28),
            "bumpy" => {
                return Some(Self {
                    name: "bumpy",
                    optics: Optics::Sheet(Sheet::bumpy()),
                    window: Window {
                        width: 1.4,
                        pixels: PIXELS,
                    },
                });
            }
            _ => return None,
        };
        Some(Self {
            name,
            optics: Optics::Ball(Ball { source, height }),
            window: Window {
                width,
                pixels: PIXELS,
            },
        })
    }

    /// The exact picture.
    pub(crate) fn reference(&self) -> Reference {
        match &self.optics {
            Optics::Ball(ball) => ball.reference(self.window),
            Optics::Sheet(sheet) => sheet.reference(self.window),
        }
    }

    /// The scene as a file: an orthographic camera between the caster and a
    /// white floor looks down on the window. Radiance times pi is irradiance.
    /// Light that the floor sends back up is no part of the comparison.
    pub(crate) fn text(&self) -> String {
        let (eye, caster, light) = match &self.optics {
            Optics::Ball(ball) => (
                0.5 * (ball.height - 1.0),
                format!(
                    "(shape: Sphere(center: (0, 0, {}), radius: 1), material: Dielectric(ior: {}))",
                    ball.height,
                    ball::INDEX
                ),
                ball_light(ball),
            ),
            Optics::Sheet(sheet) => (
                0.5 * sheet.height,
                format!(
                    "(shape: {}, material: Dielectric(ior: {}), open: true)",
                    waves_text(sheet),
                    waves::INDEX
                ),
                format!(
                    "Directional(direction: (0, 0, -1), irradiance: 1,
                     beam: (center: (0, 0, {}), radius: {}))",
                    2.0 * sheet.height,
                    2.0 * sheet.half
                ),
            ),
        };
        format!(
            "(camera: (eye: (0, 0, {eye}), look_at: (0, 0, 0), up: (0, 1, 0), height: {width}),
              image: (width: {PIXELS}, height: {PIXELS}),
              objects: [
                (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 1)),
                {caster},
              ],
              lights: [{light}],
              render: (indirect: false))",
            width = self.window.width,
        )
    }
}

fn ball_light(ball: &Ball) -> String {
    match ball.source {
        Source::Parallel => format!(
            "Directional(direction: (0, 0, -1), irradiance: 1,
             beam: (center: (0, 0, {}), radius: 1))",
            ball.height + 2.0
        ),
        Source::Point(up) => format!(
            "Point(position: (0, 0, {}), intensity: 1)",
            ball.height + up
        ),
        Source::Cone(tan) => format!(
            "Directional(direction: (0, 0, -1), irradiance: 1, angular_diameter: {})",
            2.0 * tan.atan().to_degrees()
        ),
    }
}

fn waves_text(sheet: &Sheet) -> String {
    let mut text = format!(
        "Waves(x: (-{half}, {half}), y: (-{half}, {half}), level: {}, cells: {MESH_CELLS}, waves: [",
        sheet.height,
        half = sheet.half,
    );
    for wave in &sheet.waves {
        let _ = write!(
            text,
            "(amplitude: {}, k: ({}, {}), phase: {}),",
            wave.amplitude, wave.k.x, wave.k.y, wave.phase
        );
    }
    text + "])"
}

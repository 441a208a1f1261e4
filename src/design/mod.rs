//! Lenses whose caustic is a picture.
//!
//! Contract of the room: parallel light travels along +z through glass and
//! leaves it by the face `z = h(x, y)` into air. The screen is the plane
//! `z = distance`. Lens and picture are rectangles centred on the z axis, of
//! one aspect ratio; the lens sends all its light into the picture. Rows of
//! heights run along x, from the least y to the greatest; the picture's rows
//! from its top likewise, so that it stands upright for someone who looks from
//! the lens onto the screen with -y up. Lengths are metres, densities have mean 1.
//!
//! Three steps: [`target`] makes a density of the picture, [`transport`] finds
//! which place of the picture gets the light of which place of the lens, and
//! `surface` the heights that send it there. [`quality`] traces light through
//! the result.

pub mod poisson;
pub mod quality;
mod surface;
pub mod target;
#[cfg(test)]
mod tests;
pub mod transport;

pub use quality::Quality;
pub use target::Picture;
pub use transport::Transport;

/// Most heights along a side of the lens.
pub const MAX_RESOLUTION: usize = 1024;
/// Cells of the transport for each height, along both sides.
const FINER: usize = 2;
/// The transport's residual at which it is good: far below what a cell shows.
const TOLERANCE: f64 = 1e-4;

/// What a lens is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Width and height of the lens in metres.
    pub lens: [f64; 2],
    /// Size of the picture on the screen, in sizes of the lens.
    pub magnification: f64,
    /// From `h = 0` to the screen in metres.
    pub distance: f64,
    /// Index of refraction of the glass, above 1.
    pub ior: f64,
    /// Heights along x and y: powers of two up to [`MAX_RESOLUTION`].
    pub resolution: [usize; 2],
    /// Least brightness in the picture, as a part of the greatest: from above
    /// 0 to 1. All the lens's light goes into the picture, and a wholly dark
    /// place would need a crease.
    pub darkest: f64,
}

impl Task {
    /// The distances of neighbouring heights in metres.
    pub fn spacing(&self) -> [f64; 2] {
        [0, 1].map(|k| self.lens[k] / (self.resolution[k] - 1) as f64)
    }

    /// Width and height of the picture in metres.
    pub fn picture(&self) -> [f64; 2] {
        self.lens.map(|side| side * self.magnification)
    }
}

/// A lens and how it was found.
#[derive(Clone, Debug)]
pub struct Lens {
    /// Heights in metres, rows along x from the least y; the least is 0.
    pub heights: Vec<f64>,
    /// Heights in a row.
    pub width: usize,
    /// What light traced through it does.
    pub quality: Quality,
    /// Steps of the transport's iteration.
    pub steps: usize,
    /// The transport's residual, see [`Transport`].
    pub residual: f64,
}

impl Lens {
    /// The heights in the order of an image, whose first row is at the top:
    /// that of the greatest y.
    pub fn rows_from_the_top(&self) -> Vec<f64> {
        let rows = self.heights.chunks(self.width).rev();
        rows.flatten().copied().collect()
    }
}

/// Why there is no such lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DesignError {
    /// The picture has no light.
    #[error("the picture is black: there is nowhere to send the light")]
    Black,
    /// The light would have to turn by more than a face can.
    #[error(
        "the light would have to turn too far: move the screen away, or make the picture's size \
         more like that of the lens"
    )]
    TooSteep,
}

/// The lens that does `task` with the light of `picture`.
///
/// # Errors
/// See [`DesignError`].
pub fn design(task: &Task, picture: &Picture) -> Result<Lens, DesignError> {
    let cells = task.resolution.map(|n| n * FINER);
    let density = picture
        .density(cells, task.darkest)
        .ok_or(DesignError::Black)?;
    // Both rectangles are one to the transport: that of the lens.
    let spacing = [0, 1].map(|k| task.lens[k] / cells[k] as f64);
    let transport = Transport::new(cells, spacing, &density, TOLERANCE);
    let targets = surface::Targets::new(task, &transport);
    let heights = surface::heights(task, &targets).ok_or(DesignError::TooSteep)?;
    let seen = task.resolution.map(|n| n / 2);
    let goal = coarser(&density, cells, 2 * FINER);
    Ok(Lens {
        quality: quality::measure(task, &heights, seen, &goal),
        heights,
        width: task.resolution[0],
        steps: transport.steps,
        residual: transport.residual,
    })
}

/// Means over squares of `factor` cells.
fn coarser(density: &[f64], size: [usize; 2], factor: usize) -> Vec<f64> {
    let [nx, ny] = size.map(|n| n / factor);
    let mut means = vec![0.0; nx * ny];
    for (k, value) in density.iter().enumerate() {
        let (i, j) = (k % size[0] / factor, k / size[0] / factor);
        means[j * nx + i] += value / (factor * factor) as f64;
    }
    means
}

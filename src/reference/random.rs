//! Where a path's random numbers come from, and which coordinate decides
//! what.

use crate::sampling::Stream;

/// A point of the unit cube of any dimension, read coordinate by coordinate.
pub(super) trait Random {
    /// Continues at a coordinate.
    fn seek(&mut self, coordinate: u32);

    /// The next coordinate, in `[0, 1)`.
    fn next_1d(&mut self) -> f64;

    /// The next two coordinates.
    fn next_2d(&mut self) -> [f64; 2] {
        [self.next_1d(), self.next_1d()]
    }
}

impl Random for Stream {
    fn seek(&mut self, coordinate: u32) {
        Stream::seek(self, coordinate);
    }

    fn next_1d(&mut self) -> f64 {
        Stream::next_1d(self)
    }
}

/// Which coordinates belong to which surface on a path, so that what happens
/// at one surface does not shift the meaning of what follows.
///
/// At each surface the first two choose a direction, or the first of them a
/// lobe; the third is the roulette's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    first: u32,
    stride: u32,
}

impl Layout {
    /// Paths from the camera: two coordinates for the place on the film; six
    /// at each surface, the last three for a light.
    pub(super) const CAMERA: Self = Self {
        first: 2,
        stride: 6,
    };

    /// Paths from a light: five for the start ([`Layout::START`]), three at
    /// each surface.
    pub(super) const LIGHT: Self = Self {
        first: 5,
        stride: 3,
    };

    /// Coordinates of a start: which light, direction, point.
    pub(super) const START: u32 = 0;

    /// First coordinate of surface number `depth`, counted from 1.
    pub(super) fn surface(self, depth: u32) -> u32 {
        self.first + self.stride * (depth - 1)
    }

    /// First coordinate of the choice of a light at surface number `depth` of
    /// a camera path.
    pub(super) fn light(depth: u32) -> u32 {
        Self::CAMERA.surface(depth) + 3
    }
}

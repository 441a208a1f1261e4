//! One number per pixel, and rectangles of pixels.

use rayon::prelude::*;

use crate::{film::Image, spectrum::Rgb};

/// A rectangle of pixels inside a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Column and row of the top left pixel.
    pub origin: [u32; 2],
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl Region {
    /// The whole of a picture.
    pub fn whole(image: &Image) -> Self {
        Self {
            origin: [0, 0],
            size: [image.width(), image.height()],
        }
    }

    /// Whether it has pixels and lies inside a picture of this width and
    /// height.
    pub fn lies_inside(self, picture: [u32; 2]) -> bool {
        let fits = |axis: usize| {
            let end = u64::from(self.origin[axis]) + u64::from(self.size[axis]);
            self.size[axis] > 0 && end <= u64::from(picture[axis])
        };
        fits(0) && fits(1)
    }
}

/// A number for every pixel of a picture, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

impl Plane {
    /// A plane of these values.
    ///
    /// # Panics
    /// If there are not `width * height` of them.
    pub fn new(width: usize, height: usize, values: Vec<f64>) -> Self {
        assert_eq!(values.len(), width * height, "{width} x {height}");
        Self {
            width,
            height,
            values,
        }
    }

    /// What `f` makes of each pixel of `image`.
    pub fn of(image: &Image, f: impl Fn(Rgb) -> f64 + Sync) -> Self {
        let values = image.pixels().par_iter().map(|&p| f(p)).collect();
        Self::new(image.width() as usize, image.height() as usize, values)
    }

    /// What `f` makes of the values of two planes of one size, pixel by pixel.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn join(a: &Self, b: &Self, f: impl Fn(f64, f64) -> f64 + Sync) -> Self {
        assert_eq!((a.width, a.height), (b.width, b.height), "planes differ");
        let both = a.values.par_iter().zip(&b.values);
        Self::new(a.width, a.height, both.map(|(&a, &b)| f(a, b)).collect())
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All values, row by row from the top.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// A plane of this size, zero everywhere.
    pub(super) fn zeros(&self) -> Self {
        Self {
            values: vec![0.0; self.values.len()],
            ..*self
        }
    }

    /// All values, to be changed.
    pub(super) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The values of row `y`.
    ///
    /// # Panics
    /// Below the last row.
    pub fn row(&self, y: usize) -> &[f64] {
        &self.values[y * self.width..][..self.width]
    }

    /// The values inside `region`, row by row from the top.
    ///
    /// # Panics
    /// If the region does not lie inside.
    pub fn values_in(&self, region: Region) -> Vec<f64> {
        let [x, y] = region.origin.map(|v| v as usize);
        let [width, height] = region.size.map(|v| v as usize);
        let rows = (y..y + height).map(|row| &self.row(row)[x..x + width]);
        rows.flatten().copied().collect()
    }

    /// The mean of all values; not a number where there are none.
    pub fn mean(&self) -> f64 {
        mean(&self.values)
    }
}

/// The mean, summed in order; not a number where there are no values.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(x: u32, y: u32, width: u32, height: u32) -> Region {
        Region {
            origin: [x, y],
            size: [width, height],
        }
    }

    #[test]
    fn a_region_is_a_window() {
        let plane = Plane::new(4, 3, (0..12).map(f64::from).collect());
        let inner = region(1, 1, 2, 2);
        assert_eq!(plane.values_in(inner), [5.0, 6.0, 9.0, 10.0]);
        assert_eq!(plane.values_in(region(0, 0, 4, 3)), plane.values());
        assert_eq!(plane.mean(), 5.5);
    }

    #[test]
    fn regions_know_whether_they_fit() {
        assert!(region(3, 2, 1, 1).lies_inside([4, 3]));
        for outside in [
            region(4, 0, 1, 1),
            region(0, 0, 5, 1),
            region(0, 0, 0, 1),
            region(0, 2, 1, 2),
            region(u32::MAX, 0, u32::MAX, 1),
        ] {
            assert!(!outside.lies_inside([4, 3]), "{outside:?}");
        }
    }
}

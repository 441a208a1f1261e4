//! A rectangle of linear colour.

use crate::spectrum::Rgb;

/// A picture in memory: linear RGB, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<Rgb>,
}

impl Image {
    /// An image of the given pixels.
    ///
    /// # Panics
    /// If the number of pixels is not `width * height`.
    pub fn new(width: u32, height: u32, pixels: Vec<Rgb>) -> Self {
        assert_eq!(
            pixels.len(),
            width as usize * height as usize,
            "an image of {width} x {height} needs that many pixels"
        );
        Self {
            width,
            height,
            pixels,
        }
    }

    /// An image whose pixel at column `x` and row `y` is `f(x, y)`.
    pub fn from_fn(width: u32, height: u32, mut f: impl FnMut(u32, u32) -> Rgb) -> Self {
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            pixels.extend((0..width).map(|x| f(x, y)));
        }
        Self::new(width, height, pixels)
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// The pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// Outside the image.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The mean over all pixels, channel by channel; black for an image
    /// without pixels.
    pub fn mean(&self) -> Rgb {
        if self.pixels.is_empty() {
            return Rgb::BLACK;
        }
        let mut sum = Rgb::BLACK;
        for &p in &self.pixels {
            sum += p;
        }
        sum / self.pixels.len() as f64
    }
}

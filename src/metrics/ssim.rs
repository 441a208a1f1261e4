//! SSIM: how alike the structure of two pictures is (Z. Wang, A. Bovik, H.
//! Sheikh, E. Simoncelli, *Image Quality Assessment: From Error Visibility to
//! Structural Similarity*, IEEE Transactions on Image Processing 13(4), 2004).

use super::{
    convolve::{convolve, gaussian},
    image_error::{SizeMismatch, check_sizes},
    plane::{Plane, Region},
};
use crate::{film::Image, spectrum::srgb_code};

/// Weight of the constant that steadies the luminance (section III-B).
const K1: f64 = 0.01;
/// Weight of the constant that steadies the contrast.
const K2: f64 = 0.03;
/// Standard deviation of the window in pixels.
const SIGMA: f64 = 1.5;
/// The window has 11 x 11 pixels: five on each side of the middle.
const RADIUS: u32 = 5;

/// Structural similarity of two pictures.
#[derive(Clone, Debug)]
pub struct Ssim {
    map: Plane,
}

impl Ssim {
    /// Of two pictures as a screen shows them: linear values in 0..=1; what
    /// lies outside is clipped. Compared is the luma Y' = 0.2126 R' + 0.7152 G' +
    /// 0.0722 B' (ITU-R BT.709) of their sRGB codes, whose range is one. It is
    /// symmetric.
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn new(image: &Image, reference: &Image) -> Result<Self, SizeMismatch> {
        check_sizes(image, reference)?;
        let luma = |image: &Image| {
            Plane::of(image, |p| {
                let [r, g, b] = p.0.map(srgb_code);
                0.2126 * r + 0.7152 * g + 0.0722 * b
            })
        };
        let (x, y) = (luma(image), luma(reference));
        if x.values().is_empty() {
            return Ok(Self { map: x });
        }
        Ok(Self {
            map: similarity(&x, &y),
        })
    }

    /// The mean over the pixels of `region` whose whole window lies in the
    /// picture: at most one, which equal pictures have, and above minus one.
    /// None if there is no such pixel.
    ///
    /// # Panics
    /// If the region does not lie inside.
    pub fn mean_in(&self, region: Region) -> Option<f64> {
        let [width, height] = [self.map.width(), self.map.height()].map(|v| v as u32);
        let inner = |axis: usize, side: u32| {
            let start = region.origin[axis].max(RADIUS);
            let end = (region.origin[axis] + region.size[axis]).min(side.saturating_sub(RADIUS));
            (end > start).then(|| (start, end - start))
        };
        let (x, columns) = inner(0, width)?;
        let (y, rows) = inner(1, height)?;
        let seen = Region {
            origin: [x, y],
            size: [columns, rows],
        };
        Some(super::plane::mean(&self.map.values_in(seen)))
    }
}

/// The similarity at each pixel; meaningful where the window fits.
fn similarity(x: &Plane, y: &Plane) -> Plane {
    let window = gaussian(RADIUS as usize, SIGMA);
    let mean = |plane: &Plane| convolve(plane, &window, &window);
    let product = |a: &Plane, b: &Plane| mean(&Plane::join(a, b, |a, b| a * b));
    let (mean_x, mean_y) = (mean(x), mean(y));
    let (square_x, square_y) = (product(x, x), product(y, y));
    let mixed = product(x, y);
    let values = (0..mixed.values().len()).map(|i| {
        let (mx, my) = (mean_x.values()[i], mean_y.values()[i]);
        let covariance = mixed.values()[i] - mx * my;
        // Each for itself, so that equal pictures have exactly one.
        let variances = (square_x.values()[i] - mx * mx) + (square_y.values()[i] - my * my);
        let light = (2.0 * mx * my + K1 * K1) / (mx * mx + my * my + K1 * K1);
        light * (2.0 * covariance + K2 * K2) / (variances + K2 * K2)
    });
    Plane::new(x.width(), x.height(), values.collect())
}

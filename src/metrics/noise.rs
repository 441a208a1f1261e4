//! One number for the noise of a picture.

use crate::{film::Image, spectrum::Rgb};

/// Root mean square of noise over value, with the floor of the relative MSE: a
/// tenth of the picture's mean. `noise` is the standard error of `image`.
pub fn relative_noise(image: &Image, noise: &Image) -> f64 {
    relative_deviation(image, noise.pixels().iter().map(|&n| n * n))
}

/// The same from the variances of the pixels.
pub(super) fn relative_deviation(image: &Image, variances: impl Iterator<Item = Rgb>) -> f64 {
    let mean = image.mean().mean();
    let floor = 0.01 * mean * mean;
    let mut sum = 0.0;
    for (x, variance) in image.pixels().iter().zip(variances) {
        for c in 0..3 {
            let denominator = x[c] * x[c] + floor;
            if denominator > 0.0 {
                sum += variance[c] / denominator;
            }
        }
    }
    let channels = 3.0 * image.pixels().len().max(1) as f64;
    (sum / channels).sqrt()
}

//! One number for the noise of a picture.

use crate::film::Image;

/// Root mean square of noise over value, with the floor of the relative MSE: a
/// tenth of the picture's mean. `noise` is the standard error of `image`.
pub fn relative_noise(image: &Image, noise: &Image) -> f64 {
    let mean = image.mean().mean();
    let floor = 0.01 * mean * mean;
    let mut sum = 0.0;
    for (x, n) in image.pixels().iter().zip(noise.pixels()) {
        for c in 0..3 {
            let denominator = x[c] * x[c] + floor;
            if denominator > 0.0 {
                sum += n[c] * n[c] / denominator;
            }
        }
    }
    let channels = 3.0 * image.pixels().len().max(1) as f64;
    (sum / channels).sqrt()
}

//! PNG: a picture for the eye, 8 bits per channel in sRGB.
//!
//! Value = sRGB transfer curve of (radiance times exposure factor), clipped to
//! 0..=1, rounded to the nearest of 256 steps. There is no tone curve: what
//! exceeds the exposure's white clips channel by channel, so that brightness
//! differences below white stay true. The transfer curve is IEC 61966-2-1.

use std::{io::Cursor, path::Path};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rayon::prelude::*;

use super::{
    atomic::{OutputError, write_whole},
    image::Image,
};
use crate::numeric::trig::pow;

/// The linear value that the mean of a picture takes when no exposure is given:
/// the reflectance that photography calls middle grey.
const MIDDLE_GREY: f64 = 0.18;

/// The factor that exposes `image`: 2^`stops`, or, without stops, the factor
/// that takes the mean over all pixels and channels to middle grey (0.18). Pixels
/// that are not finite do not count; a picture without light keeps factor 1.
pub fn exposure_factor(image: &Image, stops: Option<f64>) -> f64 {
    if let Some(stops) = stops {
        return pow(2.0, stops);
    }
    let (mut sum, mut count) = (0.0, 0u64);
    for pixel in image.pixels().iter().filter(|p| p.is_finite()) {
        sum += pixel.mean();
        count += 1;
    }
    let factor = MIDDLE_GREY * count as f64 / sum;
    if factor.is_finite() && factor > 0.0 {
        factor
    } else {
        1.0
    }
}

/// The sRGB code of a linear value: clipped to 0..=1, through the transfer
/// curve, rounded to the nearest of 0..=255. NaN becomes 0.
pub fn srgb_byte(linear: f64) -> u8 {
    let v = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    let coded = if v <= 0.0031308 {
        12.92 * v
    } else {
        1.055 * pow(v, 1.0 / 2.4) - 0.055
    };
    // 0..=255 by construction.
    (coded * 255.0).round() as u8
}

/// The bytes of a PNG of `image`, exposed by `stops` (see
/// [`exposure_factor`]).
///
/// # Errors
/// What the encoder objects to, in words (an image without pixels, say).
pub fn encode_png(image: &Image, stops: Option<f64>) -> Result<Vec<u8>, String> {
    let factor = exposure_factor(image, stops);
    let codes: Vec<u8> = image
        .pixels()
        .par_iter()
        .flat_map_iter(|pixel| pixel.0.map(|c| srgb_byte(c * factor)))
        .collect();
    let mut bytes = Cursor::new(Vec::new());
    PngEncoder::new(&mut bytes)
        .write_image(
            &codes,
            image.width(),
            image.height(),
            ExtendedColorType::Rgb8,
        )
        .map_err(|e| e.to_string())?;
    Ok(bytes.into_inner())
}

/// Writes a PNG of `image`, exposed by `stops` (see [`exposure_factor`]), whole
/// or not at all.
///
/// # Errors
/// See [`OutputError`].
pub fn write_png(path: &Path, image: &Image, stops: Option<f64>) -> Result<(), OutputError> {
    let bytes = encode_png(image, stops).map_err(|reason| OutputError::Encode {
        path: path.to_owned(),
        reason,
    })?;
    write_whole(path, |file| file.write_all(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Rgb;

    /// Codes of the standard: linear values whose codes are tabulated.
    #[test]
    fn codes_of_known_values() {
        for (linear, code) in [
            (0.0, 0),
            (1.0, 255),
            (0.5, 188),
            (0.18, 118),
            (0.214_041_140_482_232_55, 128),
            (0.0031308, 10),
            (0.002, 7),
            (7.0, 255),
            (-1.0, 0),
            (f64::NAN, 0),
            (f64::INFINITY, 255),
        ] {
            assert_eq!(srgb_byte(linear), code, "{linear}");
        }
    }

    #[test]
    fn exposure_is_stops_or_middle_grey() {
        let image = Image::new(2, 1, vec![Rgb::new(1.0, 2.0, 3.0), Rgb::BLACK]);
        assert_eq!(exposure_factor(&image, Some(3.0)), 8.0);
        assert_eq!(exposure_factor(&image, Some(-1.0)), 0.5);
        assert!((exposure_factor(&image, None) - 0.18).abs() < 1e-16);
        let dark = Image::new(1, 1, vec![Rgb::BLACK]);
        assert_eq!(exposure_factor(&dark, None), 1.0);
        let broken = Image::new(2, 1, vec![Rgb::grey(f64::NAN), Rgb::grey(0.36)]);
        assert!((exposure_factor(&broken, None) - 0.5).abs() < 1e-16);
    }
}

//! PNG: a picture for the eye, 8 bits per channel in sRGB.
//!
//! Value = sRGB transfer curve of (radiance times exposure factor), clipped to
//! 0..=1, rounded to the nearest of 256 steps. There is no tone curve: what
//! exceeds the exposure's white clips channel by channel, so that brightness
//! differences below white stay true. The transfer curve is IEC 61966-2-1.

use std::{
    fs::File,
    io::{BufReader, Cursor},
    path::Path,
};

use image::{ExtendedColorType, ImageEncoder, ImageFormat, ImageReader, codecs::png::PngEncoder};
use rayon::prelude::*;

use super::{
    atomic::{OutputError, write_whole},
    exr_read::ReadError,
    image::Image,
};
use crate::{
    numeric::trig::pow,
    spectrum::{Rgb, srgb_code, srgb_linear},
};

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
    // 0..=255 by construction.
    (srgb_code(linear) * 255.0).round() as u8
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

/// Reads a PNG of 8 or 16 bits per channel as linear values in 0..=1. The
/// codes are taken for sRGB, whatever profile the file names; a grey picture
/// has three equal channels.
///
/// # Errors
/// [`ReadError::File`] for a file that is missing, damaged or larger than the
/// decoder's limit (512 MiB), and for a picture with transparent pixels, whose
/// colour depends on what lies behind.
pub fn read_png(path: &Path) -> Result<Image, ReadError> {
    decode_png(path).map_err(|reason| ReadError::File {
        path: path.to_owned(),
        reason,
    })
}

fn decode_png(path: &Path) -> Result<Image, String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let decoder = ImageReader::with_format(BufReader::new(file), ImageFormat::Png);
    // Eight bits become sixteen without loss: the factor is 257.
    let codes = decoder
        .decode()
        .map_err(|e| format!("it is not a PNG that can be read: {e}"))?
        .into_rgba16();
    if codes.pixels().any(|p| p[3] != u16::MAX) {
        return Err("it has transparent pixels; flatten it first".to_owned());
    }
    let linear = |code: u16| srgb_linear(f64::from(code) / f64::from(u16::MAX));
    let pixels = codes
        .pixels()
        .map(|p| Rgb::new(linear(p[0]), linear(p[1]), linear(p[2])));
    Ok(Image::new(codes.width(), codes.height(), pixels.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each of the 256 codes, written and read, is the code it was, and the
    /// curve's ends and its knee are where the standard has them.
    #[test]
    fn what_is_written_is_read() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("codes.png");
        let pixel = |x: u32, y: u32| {
            let code = |k: u32| srgb_linear(f64::from(k % 256) / 255.0);
            Rgb::new(code(x + 16 * y), code(x + 16 * y + 77), code(3 * x + y))
        };
        let image = Image::from_fn(16, 16, pixel);
        write_png(&path, &image, Some(0.0)).unwrap();
        assert_eq!(read_png(&path).unwrap(), image);
        assert_eq!((srgb_linear(0.0), srgb_linear(1.0)), (0.0, 1.0));
        assert!((srgb_linear(0.5) - 0.214_041_140_482_232_55).abs() < 1e-15);
        assert!((srgb_linear(0.04) - 0.04 / 12.92).abs() < 1e-17);
        assert!((srgb_code(0.214_041_140_482_232_55) - 0.5).abs() < 1e-15);
    }

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

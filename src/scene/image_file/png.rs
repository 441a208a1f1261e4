//! 16-bit grey PNG.

use std::io::Cursor;

use image::{ColorType, DynamicImage, ImageDecoder, Limits, codecs::png::PngDecoder};

use super::{Fault, Kind, Samples, check_size};

/// Memory that decoding may take beside the samples.
const MAX_DECODER_BYTES: u64 = 1 << 28;

pub(super) fn parse(bytes: &[u8]) -> Result<Samples, Fault> {
    let broken = |e: image::ImageError| Fault::new(format!("a broken PNG: {e}"), "");
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODER_BYTES);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let size = check_size(u64::from(width), u64::from(height))?;
    check_colour(decoder.color_type())?;
    let DynamicImage::ImageLuma16(grey) = DynamicImage::from_decoder(decoder).map_err(broken)?
    else {
        return Err(Fault::new("a PNG that is not grey after all", ""));
    };
    let fraction = |v: &u16| f64::from(*v) / f64::from(u16::MAX);
    Ok(Samples {
        kind: Kind::Fractions,
        size,
        values: grey.as_raw().iter().map(fraction).collect(),
    })
}

/// Only 16-bit grey says one height per pixel finely enough.
fn check_colour(colour: ColorType) -> Result<(), Fault> {
    let (message, help) = match colour {
        ColorType::L16 => return Ok(()),
        ColorType::L8 => (
            "the PNG has 8 bits a pixel",
            "256 steps of height are facets to light: save it with 16 bits from \
             the original data (raising the bits of this one keeps its steps)",
        ),
        ColorType::La8 | ColorType::La16 => (
            "the PNG has an alpha channel",
            "heights are not transparent: save it as plain 16-bit grey",
        ),
        _ => (
            "the PNG has colours",
            "a height is one number: save it as 16-bit grey",
        ),
    };
    Err(Fault::new(message, help))
}

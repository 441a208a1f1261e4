//! Heights as an EXR image: one channel `Y` in single precision.
//!
//! Half precision or a PNG would store them in steps, which are facets to
//! light. Compressed without loss; the same heights give the same bytes.

use std::{io::Cursor, path::Path};

use exr::prelude as ox;
use exr::prelude::WritableImage as _;

use super::{
    atomic::{OutputError, write_whole},
    exr_file::{Attribute, Window, layer_attributes, sort_header},
};

/// The bytes of an EXR image of `values`, `size[0]` a row from the top; they
/// are rounded to 32-bit floats.
///
/// # Errors
/// In words: an image without pixels, a size that does not fit the values, an
/// attribute whose name is one of the format's own.
pub fn encode_heights(
    size: [usize; 2],
    values: &[f64],
    attributes: &[(String, Attribute)],
) -> Result<Vec<u8>, String> {
    if values.is_empty() {
        return Err("there are no pixels".to_owned());
    }
    if size[0].checked_mul(size[1]) != Some(values.len()) {
        return Err("there is not one value per pixel".to_owned());
    }
    let side = |n| u32::try_from(n).map_err(|_| "the image is too large".to_owned());
    let window = Window::whole(side(size[0])?, side(size[1])?);
    let bound = f64::from(f32::MAX);
    let samples = values.iter().map(|v| v.clamp(-bound, bound) as f32);
    let channel = ox::AnyChannel::new("Y", ox::FlatSamples::F32(samples.collect()));
    let layer = ox::Layer::new(
        (size[0], size[1]),
        layer_attributes(window, attributes)?,
        ox::Encoding::SMALL_LOSSLESS,
        ox::AnyChannels::sort(std::iter::once(channel).collect()),
    );
    let mut bytes = Cursor::new(Vec::new());
    ox::Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| e.to_string())?;
    let mut bytes = bytes.into_inner();
    sort_header(&mut bytes).ok_or("the encoder produced a header that cannot be read back")?;
    Ok(bytes)
}

/// Writes [`encode_heights`] to a file, whole or not at all.
///
/// # Errors
/// See [`OutputError`].
pub fn write_heights(
    path: &Path,
    size: [usize; 2],
    values: &[f64],
    attributes: &[(String, Attribute)],
) -> Result<(), OutputError> {
    let bytes = encode_heights(size, values, attributes).map_err(|reason| OutputError::Encode {
        path: path.to_owned(),
        reason,
    })?;
    write_whole(path, |file| file.write_all(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels as _, ReadLayers as _};

    #[test]
    fn heights_come_back_in_single_precision() {
        let values: Vec<f64> = (0..12).map(|k| 1e-3 / f64::from(k + 1)).collect();
        let attributes = [
            ("distance".to_owned(), Attribute::Number(0.3)),
            ("picture".to_owned(), Attribute::Text("n.png".to_owned())),
            ("index".to_owned(), Attribute::Number(1.5)),
        ];
        let bytes = encode_heights([4, 3], &values, &attributes).unwrap();
        let read = ox::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(&bytes))
            .unwrap()
            .layer_data;
        assert_eq!(read.size, ox::Vec2(4, 3));
        let channel = &read.channel_data.list[0];
        let single: Vec<f32> = values.iter().map(|v| *v as f32).collect();
        assert_eq!(channel.name, *"Y");
        assert_eq!(channel.sample_data, ox::FlatSamples::F32(single));
        for _ in 0..4 {
            assert_eq!(encode_heights([4, 3], &values, &attributes).unwrap(), bytes);
        }
        assert!(encode_heights([4, 4], &values, &attributes).is_err());
        assert!(encode_heights([0, 3], &[], &attributes).is_err());
    }
}

//! One channel of an EXR image.

use std::io::Cursor;

use exr::prelude as ox;
use exr::prelude::{ReadChannels as _, ReadLayers as _};

use super::{Fault, Kind, MAX_IMAGE_BYTES, Samples, check_size};

pub(super) fn parse(bytes: &[u8], channel: Option<&str>) -> Result<Samples, Fault> {
    check_header(bytes)?;
    let picture = ox::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| broken(&e))?;
    let layer = picture.layer_data;
    let size = check_size(layer.size.0 as u64, layer.size.1 as u64)?;
    let chosen = choose(&layer.channel_data.list, channel)?;
    let name = &chosen.name;
    if chosen.sampling != ox::Vec2(1, 1) || chosen.sample_data.len() != size[0] * size[1] {
        let message = format!("the channel {name} is subsampled");
        return Err(Fault::new(message, "save it with all its pixels"));
    }
    let values: Vec<f64> = match &chosen.sample_data {
        ox::FlatSamples::F32(list) => list.iter().map(|&v| f64::from(v)).collect(),
        ox::FlatSamples::U32(list) => list.iter().map(|&v| f64::from(v)).collect(),
        ox::FlatSamples::F16(_) => {
            return Err(Fault::new(
                format!("the channel {name} has half precision"),
                "its 2048 steps are facets to light: save it in single precision (32 bits)",
            ));
        }
    };
    if let Some(k) = values.iter().position(|v| !v.is_finite()) {
        let (column, row) = (k % size[0], k / size[0]);
        return Err(Fault::new(
            format!(
                "the pixel in column {column} of row {row} is {}, not a height",
                values[k]
            ),
            "fill the holes of the image with finite numbers (columns and rows count from 0, \
             from the top left)",
        ));
    }
    Ok(Samples {
        kind: Kind::Numbers,
        size,
        values,
    })
}

fn broken(e: &ox::Error) -> Fault {
    Fault::new(format!("a broken EXR image: {e}"), "")
}

/// Looks at the sizes that the header claims.
fn check_header(bytes: &[u8]) -> Result<(), Fault> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|e| broken(&e))?;
    let mut total = 0u64;
    for header in &meta.headers {
        let [width, height] = [header.layer_size.0, header.layer_size.1].map(|n| n as u64);
        check_size(width, height)?;
        let bytes = (width * height).saturating_mul(header.channels.bytes_per_pixel as u64);
        total = total.saturating_add(bytes);
    }
    if total > MAX_IMAGE_BYTES {
        return Err(Fault::new(
            format!("the channels of the image take {total} bytes in memory"),
            "save the heights alone, as one channel",
        ));
    }
    Ok(())
}

/// The channel of that name; without a name the only one, or `Y`.
fn choose<'a>(
    list: &'a [ox::AnyChannel<ox::FlatSamples>],
    name: Option<&str>,
) -> Result<&'a ox::AnyChannel<ox::FlatSamples>, Fault> {
    if let (None, [only]) = (name, list) {
        return Ok(only);
    }
    let found = list.iter().find(|c| c.name == *name.unwrap_or("Y"));
    found.ok_or_else(|| {
        let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
        let message = match name {
            Some(name) => format!("the image has no channel {name:?}"),
            None => "the image has several channels, none of them called Y".to_owned(),
        };
        let first = names.first().map_or("Y", String::as_str);
        let help = format!(
            "it has {}: write `channel: {first:?}`, for example",
            names.join(", ")
        );
        Fault::new(message, help)
    })
}

//! Reading EXR: any file of flat parts, of which the colour layers are
//! taken.
//!
//! A colour layer is three channels `R`, `G`, `B` with nothing or one prefix
//! before them: `R` belongs to the picture itself, `caustic.R` to the layer
//! `caustic`. What else a file holds (depth, alpha) is left aside.

use std::{
    collections::BTreeSet,
    fs::File,
    io::BufReader,
    path::{Path, PathBuf},
};

use exr::prelude as ox;
use exr::prelude::{ReadChannels as _, ReadLayers as _};
use thiserror::Error;

use super::image::Image;
use crate::spectrum::Rgb;

/// Samples that a file may hold, over all channels: 4 GiB in single precision.
/// A header can claim any size; nothing is allocated for more than this.
const MOST_SAMPLES: usize = 1 << 30;

/// Why a picture could not be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file is missing, damaged, or of a kind that is not supported.
    #[error("cannot read {}: {reason}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The file has no such colour layer.
    #[error("cannot read {}: no channels {prefix}R, {prefix}G, {prefix}B among {}", .path.display(), .found.join(", "))]
    NoSuchLayer {
        /// The file.
        path: PathBuf,
        /// What stands before R, G and B: nothing or `layer.`.
        prefix: String,
        /// The channels there are.
        found: Vec<String>,
    },
}

/// The flat parts of a file with all their channels.
type Parts = ox::Image<ox::Layers<ox::AnyChannels<ox::FlatSamples>>>;

/// Reads the colour layer `layer` of an EXR file (`""` for the picture itself)
/// with half or single precision channels.
///
/// # Errors
/// See [`ReadError`].
pub fn read_exr(path: &Path, layer: &str) -> Result<Image, ReadError> {
    let parts = read_parts(path).map_err(|reason| refuse(path, reason))?;
    if let Some(image) = take_layer(&parts, layer) {
        return image.map_err(|reason| refuse(path, reason));
    }
    let channels = parts.layer_data.iter().flat_map(|p| &p.channel_data.list);
    Err(ReadError::NoSuchLayer {
        path: path.to_owned(),
        prefix: prefix(layer),
        found: channels.map(|channel| channel.name.to_string()).collect(),
    })
}

/// Reads every colour layer of an EXR file with its name: the picture itself
/// (`""`) first if there is one, the others in alphabetical order. There may be
/// none.
///
/// # Errors
/// [`ReadError::File`].
pub fn read_exr_layers(path: &Path) -> Result<Vec<(String, Image)>, ReadError> {
    let parts = read_parts(path).map_err(|reason| refuse(path, reason))?;
    let channels = parts.layer_data.iter().flat_map(|p| &p.channel_data.list);
    let names: BTreeSet<String> = channels
        .filter_map(|channel| layer_of_red(&channel.name.to_string()))
        .collect();
    let mut layers = Vec::new();
    for name in names {
        if let Some(image) = take_layer(&parts, &name) {
            layers.push((name, image.map_err(|reason| refuse(path, reason))?));
        }
    }
    Ok(layers)
}

/// The layer whose red channel has this name, if it is one.
fn layer_of_red(channel: &str) -> Option<String> {
    match channel {
        "R" => Some(String::new()),
        _ => channel.strip_suffix(".R").map(str::to_owned),
    }
}

fn prefix(layer: &str) -> String {
    match layer {
        "" => String::new(),
        _ => format!("{layer}."),
    }
}

fn refuse(path: &Path, reason: String) -> ReadError {
    ReadError::File {
        path: path.to_owned(),
        reason,
    }
}

fn read_parts(path: &Path) -> Result<Parts, String> {
    let open = || File::open(path).map(BufReader::new);
    check_size(open().map_err(|e| e.to_string())?)?;
    ox::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(open().map_err(|e| e.to_string())?)
        .map_err(|e| e.to_string())
}

/// Refuses what the header claims to be too large, before anything is
/// allocated for it.
fn check_size(file: BufReader<File>) -> Result<(), String> {
    let meta = ox::MetaData::read_from_buffered(file, false).map_err(|e| e.to_string())?;
    let samples = meta.headers.iter().try_fold(0usize, |sum, header| {
        let ox::Vec2(width, height) = header.layer_size;
        let samples = width.checked_mul(height)?;
        sum.checked_add(samples.checked_mul(header.channels.list.len())?)
    });
    match samples {
        Some(count) if count <= MOST_SAMPLES => Ok(()),
        _ => Err(format!(
            "its header claims more than {MOST_SAMPLES} samples"
        )),
    }
}

/// The layer's picture from the first part that has its three channels.
fn take_layer(parts: &Parts, layer: &str) -> Option<Result<Image, String>> {
    let prefix = prefix(layer);
    let names = ["R", "G", "B"].map(|c| format!("{prefix}{c}"));
    parts.layer_data.iter().find_map(|part| {
        let find = |name: &String| {
            let mut list = part.channel_data.list.iter();
            list.find(|channel| channel.name.to_string() == *name)
        };
        match names.each_ref().map(find) {
            [Some(r), Some(g), Some(b)] => Some(join(part.size, [r, g, b])),
            _ => None,
        }
    })
}

fn join(
    size: ox::Vec2<usize>,
    planes: [&ox::AnyChannel<ox::FlatSamples>; 3],
) -> Result<Image, String> {
    let too_big = |_| "the picture is too large".to_owned();
    let width = u32::try_from(size.0).map_err(too_big)?;
    let height = u32::try_from(size.1).map_err(too_big)?;
    let mut pixels = vec![Rgb::BLACK; size.0 * size.1];
    for (c, plane) in planes.into_iter().enumerate() {
        if plane.sample_data.len() != pixels.len() {
            return Err(format!("the channel {} is subsampled", plane.name));
        }
        for (pixel, value) in pixels.iter_mut().zip(plane.sample_data.values_as_f32()) {
            pixel.0[c] = f64::from(value);
        }
    }
    Ok(Image::new(width, height, pixels))
}

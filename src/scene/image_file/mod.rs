//! Images that hold numbers rather than colours: heights.
//!
//! 16-bit grey PNG and single precision EXR. Eight bits are refused: their 256
//! steps are facets to light, and so are the 2048 of half precision. The
//! header is asked for size and kind before any pixel is decoded, so that no
//! file takes more memory than its limit.

mod exr;
mod png;

use std::{fs::File, io::Read, path::Path};

use super::Inputs;

/// Most samples of an image.
pub const MAX_SAMPLES: u64 = 1 << 24;
/// Largest image file, in bytes.
pub const MAX_IMAGE_BYTES: u64 = 1 << 30;
/// What the kinds of file are called in messages.
pub(super) const EXPECTED: &str = "expected a 16-bit grey PNG or an EXR image";

/// Which numbers the samples of a file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Fractions of the format's range, from 0 to 1 (PNG).
    Fractions,
    /// Numbers as they are (EXR).
    Numbers,
}

/// Numbers on a grid, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// What the numbers are.
    pub kind: Kind,
    /// Samples in a row, and rows.
    pub size: [usize; 2],
    /// The numbers, all finite.
    pub values: Vec<f64>,
}

/// Why an image is of no use, and what would help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What is wrong.
    pub message: String,
    /// What to do about it; may be empty.
    pub help: String,
}

impl Fault {
    fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: help.into(),
        }
    }
}

/// Reads an image; the name's extension decides the format. `channel` chooses
/// among the channels of an EXR image. `inputs` takes note of the file.
///
/// # Errors
/// What is wrong with the file.
pub fn read(path: &Path, channel: Option<&str>, inputs: &Inputs) -> Result<Samples, Fault> {
    let bytes = read_bytes(path).map_err(|message| Fault::new(message, ""))?;
    inputs.add(path, &bytes);
    parse(path, &bytes, channel)
}

/// Reads an image from the bytes of a file; the name's extension decides the
/// format.
///
/// # Errors
/// What is wrong with the bytes.
pub fn parse(name: &Path, bytes: &[u8], channel: Option<&str>) -> Result<Samples, Fault> {
    let extension = name.extension().and_then(|e| e.to_str());
    match extension.unwrap_or_default().to_ascii_lowercase().as_str() {
        "png" if channel.is_some() => Err(Fault::new(
            "the image has one channel only, without a name",
            "remove `channel`; it chooses among the channels of an EXR image",
        )),
        "png" => png::parse(bytes),
        "exr" => exr::parse(bytes, channel),
        _ => Err(Fault::new(
            "the name of an image of heights ends in .png or .exr",
            "save it as a 16-bit grey PNG, or as EXR in single precision",
        )),
    }
}

/// Refuses a size before anything is decoded.
fn check_size(width: u64, height: u64) -> Result<[usize; 2], Fault> {
    if width < 2 || height < 2 {
        return Err(Fault::new(
            format!("the image has {width} x {height} pixels"),
            "a surface needs at least 2 along each side",
        ));
    }
    if width.saturating_mul(height) > MAX_SAMPLES {
        return Err(Fault::new(
            format!("the image has {width} x {height} pixels, more than {MAX_SAMPLES}"),
            "make it smaller: 4096 x 4096 is the limit",
        ));
    }
    Ok([width as usize, height as usize])
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, String> {
    let unreadable = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => "there is no such image".to_owned(),
        _ => format!("cannot read the image: {e}"),
    };
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        return Err("this is not a regular file".to_owned());
    }
    if metadata.len() > MAX_IMAGE_BYTES {
        let limit = MAX_IMAGE_BYTES >> 30;
        return Err(format!("the image is larger than {limit} GiB"));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(MAX_IMAGE_BYTES)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests;

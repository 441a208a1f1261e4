//! EXR: the linear picture, its layers, and how it came about.
//!
//! One part with 32-bit float channels: `R G B` is the picture, `direct.R` and
//! so on are its layers, compressed without loss (ZIP, 16 lines). The data
//! window is the rendered rectangle, the display window the whole picture.
//! The same picture and attributes give the same bytes. Attributes:
//!
//! | name | type | meaning |
//! |---|---|---|
//! | `software` | string | program and version |
//! | `sceneHash` | string | fingerprint of all files of the scene |
//! | `seed` | string | seed of the random numbers, decimal (64 bits fit no EXR number) |
//! | `passes` | double | passes in the picture |
//! | `photons` | double | photon paths emitted, all passes |
//! | `renderSeconds` | double | wall time of the render |
//!
//! and whatever else the caller adds.

use std::{io::Cursor, path::Path};

use exr::prelude as ox;
use exr::prelude::WritableImage as _;

use super::{
    accumulator::Film,
    atomic::{OutputError, write_whole},
    image::Image,
    layer::Layer,
};

/// Where the rendered rectangle lies in the whole picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Width and height of the whole picture.
    pub full: [u32; 2],
    /// Column and row of the rectangle's top left pixel.
    pub origin: [u32; 2],
}

impl Window {
    /// The window of a picture that is rendered as a whole.
    pub fn whole(width: u32, height: u32) -> Self {
        Self {
            full: [width, height],
            origin: [0, 0],
        }
    }
}

/// A value that hangs on a file under a name.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// A string. EXR stores bytes: characters beyond Latin-1 become `?`.
    Text(String),
    /// A number, stored as a double.
    Number(f64),
}

/// How a picture came about: what its file says beside the pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Fingerprint of the scene.
    pub scene_hash: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Photon paths emitted over all passes.
    pub photons: u64,
    /// Wall time of the render in seconds.
    pub render_seconds: f64,
    /// Further attributes by name.
    pub further: Vec<(String, Attribute)>,
}

impl Provenance {
    /// The attributes of a file with `passes` passes.
    fn attributes(&self, passes: u64) -> Vec<(String, Attribute)> {
        let mut all = vec![
            (
                "sceneHash".to_owned(),
                Attribute::Text(self.scene_hash.clone()),
            ),
            ("seed".to_owned(), Attribute::Text(self.seed.to_string())),
            ("passes".to_owned(), Attribute::Number(passes as f64)),
            ("photons".to_owned(), Attribute::Number(self.photons as f64)),
            (
                "renderSeconds".to_owned(),
                Attribute::Number(self.render_seconds),
            ),
        ];
        all.extend(self.further.iter().cloned());
        all
    }
}

/// Writes the picture and the four layers of `film` to `path`, whole or not at
/// all.
///
/// # Errors
/// See [`OutputError`].
pub fn write_film(
    path: &Path,
    film: &Film,
    window: Window,
    provenance: &Provenance,
) -> Result<(), OutputError> {
    write_film_with(path, film, &[], window, provenance)
}

/// As [`write_film`], with `further` images of the film's size as layers of
/// these names.
///
/// # Errors
/// See [`OutputError`].
pub fn write_film_with(
    path: &Path,
    film: &Film,
    further: &[(&str, &Image)],
    window: Window,
    provenance: &Provenance,
) -> Result<(), OutputError> {
    let mut images = vec![("", film.image())];
    images.extend(Layer::ALL.map(|layer| (layer.name(), film.layer_image(layer))));
    let mut layers: Vec<(&str, &Image)> =
        images.iter().map(|(name, image)| (*name, image)).collect();
    layers.extend(further);
    write_exr(path, &layers, window, &provenance.attributes(film.passes()))
}

/// Writes images of one size as the layers of one file, whole or not at all;
/// the layer named `""` is the picture itself.
///
/// # Errors
/// See [`OutputError`]; [`OutputError::Encode`] for what [`encode_exr`] refuses.
pub fn write_exr(
    path: &Path,
    layers: &[(&str, &Image)],
    window: Window,
    attributes: &[(String, Attribute)],
) -> Result<(), OutputError> {
    let bytes = encode_exr(layers, window, attributes).map_err(|reason| OutputError::Encode {
        path: path.to_owned(),
        reason,
    })?;
    write_whole(path, |file| file.write_all(&bytes))
}

/// The bytes of an EXR file; see [`write_exr`]. Values beyond the range of a
/// 32-bit float become its largest.
///
/// # Errors
/// In words: no layer, layers of different sizes, an image without pixels, a
/// window outside the format's range, an attribute whose name is one of the
/// format's own.
pub fn encode_exr(
    layers: &[(&str, &Image)],
    window: Window,
    attributes: &[(String, Attribute)],
) -> Result<Vec<u8>, String> {
    let Some((_, first)) = layers.first() else {
        return Err("there is no layer".to_owned());
    };
    let (width, height) = (first.width(), first.height());
    if layers
        .iter()
        .any(|(_, image)| (image.width(), image.height()) != (width, height))
    {
        return Err("the layers differ in size".to_owned());
    }
    let channels = layers
        .iter()
        .flat_map(|(name, image)| channels(name, image))
        .collect();
    let mut layer = ox::Layer::new(
        (width as usize, height as usize),
        layer_attributes(window, attributes)?,
        ox::Encoding::SMALL_LOSSLESS,
        ox::AnyChannels::sort(channels),
    );
    // A film is one part, and parts without siblings need no name.
    layer.attributes.layer_name = None;
    let mut image = ox::Image::from_layer(layer);
    image.attributes.display_window =
        ox::IntegerBounds::from_dimensions((window.full[0] as usize, window.full[1] as usize));
    let mut bytes = Cursor::new(Vec::new());
    image
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| e.to_string())?;
    let mut bytes = bytes.into_inner();
    sort_header(&mut bytes).ok_or("the encoder produced a header that cannot be read back")?;
    Ok(bytes)
}

/// The three channels of a layer, as single precision planes.
fn channels(name: &str, image: &Image) -> [ox::AnyChannel<ox::FlatSamples>; 3] {
    ["R", "G", "B"].map(|channel| {
        let plane = match channel {
            "R" => 0,
            "G" => 1,
            _ => 2,
        };
        let full_name = if name.is_empty() {
            channel.to_owned()
        } else {
            format!("{name}.{channel}")
        };
        let bound = f64::from(f32::MAX);
        let samples = image
            .pixels()
            .iter()
            .map(|p| p[plane].clamp(-bound, bound) as f32)
            .collect();
        ox::AnyChannel::new(
            ox::Text::new_or_panic(full_name),
            ox::FlatSamples::F32(samples),
        )
    })
}

pub(super) fn layer_attributes(
    window: Window,
    attributes: &[(String, Attribute)],
) -> Result<ox::LayerAttributes, String> {
    let coordinate = |v| i32::try_from(v).map_err(|_| format!("{v} is too far to the side"));
    let mut all = ox::LayerAttributes {
        layer_position: ox::Vec2(coordinate(window.origin[0])?, coordinate(window.origin[1])?),
        software_name: Some(ox::Text::from(concat!(
            "nephroid ",
            env!("CARGO_PKG_VERSION")
        ))),
        ..ox::LayerAttributes::default()
    };
    for (name, value) in attributes {
        let value = match value {
            Attribute::Text(text) => ox::AttributeValue::Text(latin_1(text)),
            Attribute::Number(number) => ox::AttributeValue::F64(*number),
        };
        all.other.insert(latin_1(name), value);
    }
    Ok(all)
}

fn latin_1(text: &str) -> ox::Text {
    let replaced: String = text
        .chars()
        .map(|c| if (c as u32) < 256 { c } else { '?' })
        .collect();
    ox::Text::new_or_none(&replaced).unwrap_or_else(|| ox::Text::from("?"))
}

/// Puts the attributes of a single-part file's header into alphabetical order,
/// so that equal pictures have equal bytes: the encoder keeps further
/// attributes in a hash map, whose order changes from run to run. The header
/// keeps its length, so no offset moves. `None` if the header makes no sense.
///
/// Layout (file layout of the format's own documentation, section "Header"): magic number and version of 4 bytes each,
/// then per attribute a name and a type, both ended by a zero byte, a 4-byte
/// little-endian size and that many bytes of value; a zero byte ends the list.
pub(super) fn sort_header(file: &mut [u8]) -> Option<()> {
    const START: usize = 8;
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut at = START;
    while *file.get(at)? != 0 {
        let name_end = at + file[at..].iter().position(|&b| b == 0)? + 1;
        let type_end = name_end + file.get(name_end..)?.iter().position(|&b| b == 0)? + 1;
        let size = file.get(type_end..type_end + 4)?;
        let size = u32::from_le_bytes([size[0], size[1], size[2], size[3]]) as usize;
        let end = type_end + 4 + size;
        attributes.push(file.get(at..end)?.to_vec());
        at = end;
    }
    attributes.sort();
    let sorted = attributes.concat();
    file[START..START + sorted.len()].copy_from_slice(&sorted);
    Some(())
}

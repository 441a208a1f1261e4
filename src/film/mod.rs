//! The film: what the passes deliver is summed exactly, averaged into images,
//! and written to files.
//!
//! Conventions: an image is stored row by row, the first row at the top, `x` to
//! the right; values are linear radiance in W/m2/sr per channel, without
//! exposure or transfer curve, until a PNG is made of them. A film covers the
//! rectangle that is rendered (the crop), not the whole picture; [`Window`]
//! says where that rectangle lies. Sums do not depend on the order or the
//! grouping of passes ([`Film`]). Files appear whole or not at all ([`atomic`]).

mod accumulator;
pub mod atomic;
mod exr_file;
mod exr_read;
mod heights_file;
mod image;
mod layer;
mod png_file;
pub mod sheets;
mod state;

pub use accumulator::{Film, MergeError, REPLICATES, blur_weight};
pub use atomic::OutputError;
pub use exr_file::{
    Attribute, Provenance, Window, encode_exr, write_exr, write_film, write_film_with,
};
pub use exr_read::{ReadError, read_exr, read_exr_layers};
pub use heights_file::{encode_heights, write_heights};
pub use image::Image;
pub use layer::{Layer, PixelSample};
pub use png_file::{encode_png, exposure_factor, read_png, srgb_byte, write_png};
pub use state::StateError;

//! From a scene file to a scene that can be rendered.
//!
//! Three steps, each with its own job: the [`outline`] finds where every
//! value of the text stands; [`description`] mirrors what is written, read
//! part by part; `build` checks what it means and makes the immutable
//! [`Scene`]. Every mistake becomes a [`Diagnostic`] with its place, and
//! independent mistakes are reported together. After [`load`] nothing can
//! fail.
//!
//! Limits: lengths lie between 1e-12 and 1e12 metres, scene files have at
//! most 64 MiB and four million values, mesh files at most 8 GiB, images of
//! heights at most 2^24 pixels, generated meshes at most 50 million triangles
//! in a scene, pictures 2^28 pixels.

mod build;
mod decode;
pub mod description;
pub mod diagnostics;
mod effect;
pub mod generate;
pub mod image_file;
mod input;
mod literal;
mod load;
pub mod mesh_file;
mod mesh_words;
pub mod outline;
mod report;
#[allow(
    clippy::module_inception,
    reason = "the scene itself, beside how it is made"
)]
mod scene;
mod settings;
pub mod source;
mod suggest;
mod summary;
mod vocabulary;

pub use diagnostics::{Diagnostic, Diagnostics, Place};
pub use effect::{Choice, Choices, Effect, Switch};
pub use input::{Digest, Input, Inputs, fingerprint};
pub use load::{MAX_SCENE_BYTES, load, load_str, load_watched};
pub use scene::{NamedLight, Object, Scene};
pub use settings::{Guidance, Kernel, Sampler, Settings};
pub use summary::{MeshSummary, Summary};

/// Largest length and coordinate in a scene, in metres: far enough for a sun,
/// near enough that squares and the boxes of the tree don't overflow.
pub const MAX_LENGTH: f64 = 1e12;
/// Smallest length in a scene, in metres.
pub const MIN_LENGTH: f64 = 1e-12;
/// Most triangles that generators make in a scene, and that the nodes of a
/// glTF file put together.
pub const MAX_TRIANGLES: u64 = 50_000_000;

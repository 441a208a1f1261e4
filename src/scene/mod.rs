//! From a scene file to a scene that can be rendered.
//!
//! `load` reads a file into a description (a mirror of the file's text),
//! reports every mistake with its place, and builds the immutable [`Scene`].
//! After that nothing can fail.

mod scene;
mod settings;

pub use scene::{NamedLight, Object, Scene};
pub use settings::Settings;

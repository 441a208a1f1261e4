//! The canonical scenes, for benches.

use std::path::Path;

use nephroid::scene::{self, Scene};

/// Names of the five canonical scenes.
pub(crate) const CANONICAL: [&str; 5] =
    ["glass_sphere", "cornell_glass", "cup", "pool", "mesh_glass"];

/// Loads a scene of the `scenes` folder.
pub(crate) fn load(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(format!("{name}.ron"));
    scene::load(&path).unwrap_or_else(|e| panic!("{e}"))
}

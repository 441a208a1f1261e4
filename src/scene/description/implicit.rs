//! Implicit surfaces as written.

use serde::Deserialize;

use super::{Number, Triple};

/// `Implicit(f: "x^2 + y^2 + z^2 - 1", bounds: ((-1, -1, -1), (1, 1, 1)))`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Implicit")]
pub struct ImplicitShape {
    /// The formula: negative inside.
    pub f: String,
    /// The lowest and the highest corner of the box that counts.
    pub bounds: [Triple; 2],
    /// How rays look for it.
    #[serde(default)]
    pub method: MethodDescription,
}

/// How rays look for an implicit surface.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename = "method")]
pub enum MethodDescription {
    /// By interval subdivision.
    #[default]
    Interval,
    /// In steps of a fixed length.
    March {
        /// Length of a step.
        step: Number,
    },
    /// By steps as long as the gradient allows.
    SphereTracing,
}

//! Settings that single methods have.

use std::num::NonZero;

/// What a user may choose for single methods, beside the settings of the
/// scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Photons of an estimate of [`Method::PhotonMap`](super::Method::PhotonMap).
    /// The more, the smoother and the more blurred.
    pub nearest: NonZero<u32>,
    /// Elements of [`Method::Radiosity`](super::Method::Radiosity) along the
    /// diameter of the sphere around all bounded objects: no element is longer
    /// than the diameter over this number.
    pub patches: NonZero<u32>,
}

impl Options {
    /// Of the numbers in use, 50 to 100: noise of about an eighth.
    const NEAREST: NonZero<u32> = NonZero::new(64).expect("not zero");

    /// A room's walls get some twenty elements a side.
    const PATCHES: NonZero<u32> = NonZero::new(32).expect("not zero");
}

impl Default for Options {
    fn default() -> Self {
        Self {
            nearest: Self::NEAREST,
            patches: Self::PATCHES,
        }
    }
}

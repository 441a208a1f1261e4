//! The glowing parallelogram.

use glam::DVec3;

use crate::spectrum::Rgb;

/// A parallelogram of constant radiance on the side of `u x v`.
#[derive(Clone, Debug)]
pub struct QuadLight {
    /// One corner, metres.
    pub corner: DVec3,
    /// First edge, metres.
    pub u: DVec3,
    /// Second edge, metres.
    pub v: DVec3,
    /// Emitted radiance, W/m2/sr.
    pub radiance: Rgb,
}

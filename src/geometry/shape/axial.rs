//! Coordinates about an axis, for shapes that are round about one.

use glam::{DVec2, DVec3};

use crate::{
    geometry::transform::unit,
    numeric::{Frame, gamma},
};

/// An axis from its base, and two directions across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) base: DVec3,
    across: [DVec3; 2],
    /// Unit direction.
    pub(super) along: DVec3,
}

/// A ray across and along an axis, from the point that it reaches at `slide`.
pub(super) struct AxialRay {
    pub(super) slide: f64,
    pub(super) o: DVec2,
    pub(super) oz: f64,
    pub(super) d: DVec2,
    pub(super) dz: f64,
}

impl Axis {
    /// The axis through `base` in a direction of any length but zero.
    pub(super) fn new(base: DVec3, direction: DVec3) -> Self {
        let frame = Frame::around(unit(direction));
        Self {
            base,
            across: [frame.s, frame.t],
            along: frame.n,
        }
    }

    /// A vector as its part across the axis and its part along it.
    #[inline]
    pub(super) fn split(&self, v: DVec3) -> (DVec2, f64) {
        (
            DVec2::new(self.across[0].dot(v), self.across[1].dot(v)),
            self.along.dot(v),
        )
    }

    /// A vector across the axis.
    #[inline]
    pub(super) fn join_flat(&self, flat: DVec2) -> DVec3 {
        self.across[0] * flat.x + self.across[1] * flat.y
    }

    /// The vector with these parts.
    #[inline]
    pub(super) fn join(&self, flat: DVec2, z: f64) -> DVec3 {
        self.join_flat(flat) + self.along * z
    }

    /// The point of the axis at a height.
    #[inline]
    pub(super) fn at(&self, z: f64) -> DVec3 {
        self.base + self.along * z
    }

    /// The ray in the axis' coordinates. One from afar first slides to where
    /// it passes the height `middle`: the coefficients are then as small as
    /// the shape. From the surface itself it starts where it is, since one root
    /// is known there.
    #[inline]
    pub(super) fn slid(&self, origin: DVec3, dir: DVec3, middle: f64, leaving: bool) -> AxialRay {
        let from = origin - self.base;
        let slide = if leaving {
            0.0
        } else {
            (self.along * middle - from).dot(dir) / dir.length_squared()
        };
        let (d, dz) = self.split(dir);
        let (o, oz) = self.split(from + dir * slide);
        AxialRay {
            slide,
            o,
            oz,
            d,
            dz,
        }
    }

    /// Error of a point formed from coordinates whose absolute sum is `reach`:
    /// the frame is about eight roundings from orthonormal and from the given
    /// axis, the length of a shape four, products and sums take four; adding
    /// the base rounds once more.
    pub(super) fn error_of(&self, reach: f64, p: DVec3) -> f64 {
        gamma(16) * reach + gamma(1) * (self.base.abs().max(p.abs())).max_element()
    }
}

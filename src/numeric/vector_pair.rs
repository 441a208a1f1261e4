//! Two vectors side by side.

use std::ops::{Add, Mul, Sub};

use glam::{DMat3, DVec2, DVec3};

/// Two vectors, kept coordinate by coordinate: what is done to both is done by
/// the same instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VectorPair {
    /// First coordinates.
    pub x: DVec2,
    /// Second coordinates.
    pub y: DVec2,
    /// Third coordinates.
    pub z: DVec2,
}

impl VectorPair {
    /// Two null vectors.
    pub const ZERO: Self = Self {
        x: DVec2::ZERO,
        y: DVec2::ZERO,
        z: DVec2::ZERO,
    };

    /// The vectors one by one.
    #[inline]
    pub fn to_array(self) -> [DVec3; 2] {
        [
            DVec3::new(self.x.x, self.y.x, self.z.x),
            DVec3::new(self.x.y, self.y.y, self.z.y),
        ]
    }

    /// A vector times either number.
    #[inline]
    pub fn along(v: DVec3, by: DVec2) -> Self {
        Self {
            x: by * v.x,
            y: by * v.y,
            z: by * v.z,
        }
    }

    /// The scalar products with a vector.
    #[inline]
    pub fn dot(self, v: DVec3) -> DVec2 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// The squared lengths.
    #[inline]
    pub fn length_squared(self) -> DVec2 {
        self.x * self.x + self.y * self.y + self.z * self.z
    }

    /// The images under a linear map.
    #[inline]
    #[must_use]
    pub fn under(self, map: &DMat3) -> Self {
        Self {
            x: self.dot(map.row(0)),
            y: self.dot(map.row(1)),
            z: self.dot(map.row(2)),
        }
    }
}

impl From<[DVec3; 2]> for VectorPair {
    #[inline]
    fn from([a, b]: [DVec3; 2]) -> Self {
        Self {
            x: DVec2::new(a.x, b.x),
            y: DVec2::new(a.y, b.y),
            z: DVec2::new(a.z, b.z),
        }
    }
}

impl Add for VectorPair {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self {
            x: self.x + o.x,
            y: self.y + o.y,
            z: self.z + o.z,
        }
    }
}

impl Sub for VectorPair {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self {
            x: self.x - o.x,
            y: self.y - o.y,
            z: self.z - o.z,
        }
    }
}

impl Mul<f64> for VectorPair {
    type Output = Self;
    #[inline]
    fn mul(self, by: f64) -> Self {
        self * DVec2::splat(by)
    }
}

/// Each vector times a number of its own.
impl Mul<DVec2> for VectorPair {
    type Output = Self;
    #[inline]
    fn mul(self, by: DVec2) -> Self {
        Self {
            x: self.x * by,
            y: self.y * by,
            z: self.z * by,
        }
    }
}

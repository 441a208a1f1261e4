//! The linear RGB triple.

use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

/// Three linear sRGB coefficients.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb(pub [f64; 3]);

impl Rgb {
    /// Black.
    pub const BLACK: Self = Self([0.0; 3]);
    /// One in each channel.
    pub const WHITE: Self = Self([1.0; 3]);

    /// The three coefficients.
    #[inline]
    pub const fn new(r: f64, g: f64, b: f64) -> Self {
        Self([r, g, b])
    }

    /// The same value in each channel.
    #[inline]
    pub const fn grey(v: f64) -> Self {
        Self([v; 3])
    }

    /// Largest channel.
    #[inline]
    pub fn max(self) -> f64 {
        self.0[0].max(self.0[1]).max(self.0[2])
    }

    /// Mean of the channels: the weight used by tallies and roulettes.
    #[inline]
    pub fn mean(self) -> f64 {
        (self.0[0] + self.0[1] + self.0[2]) / 3.0
    }

    /// Brightness to the eye, by the weights of ITU-R BT.709.
    #[inline]
    pub fn luminance(self) -> f64 {
        0.2126 * self.0[0] + 0.7152 * self.0[1] + 0.0722 * self.0[2]
    }

    /// Whether every channel is zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.0 == [0.0; 3]
    }

    /// Whether every channel is finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }

    /// Channel by channel.
    #[inline]
    #[must_use]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }
}

impl Index<usize> for Rgb {
    type Output = f64;
    #[inline]
    fn index(&self, i: usize) -> &f64 {
        &self.0[i]
    }
}

impl Add for Rgb {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self([self.0[0] + o.0[0], self.0[1] + o.0[1], self.0[2] + o.0[2]])
    }
}

impl Sub for Rgb {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self([self.0[0] - o.0[0], self.0[1] - o.0[1], self.0[2] - o.0[2]])
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Mul for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self([self.0[0] * o.0[0], self.0[1] * o.0[1], self.0[2] * o.0[2]])
    }
}

impl Mul<f64> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, k: f64) -> Self {
        self.map(|c| c * k)
    }
}

impl MulAssign<f64> for Rgb {
    #[inline]
    fn mul_assign(&mut self, k: f64) {
        *self = *self * k;
    }
}

impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl Div<f64> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, k: f64) -> Self {
        self.map(|c| c / k)
    }
}

//! Double-double arithmetic, about 32 digits: the oracle for stated errors.

use std::ops::{Add, Div, Mul, Sub};

use glam::DVec3;
use nephroid::numeric::{two_product, two_sum};

/// The unevaluated sum of two floats.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dd(f64, f64);

impl Dd {
    pub(crate) fn of(x: f64) -> Self {
        Self(x, 0.0)
    }

    pub(crate) fn round(self) -> f64 {
        self.0 + self.1
    }

    pub(crate) fn sqrt(self) -> Self {
        let s = Self::of(self.0.sqrt());
        if s.0 == 0.0 {
            return s;
        }
        // One Newton step doubles the digits.
        s + (self - s * s) / (s + s)
    }
}

impl Add for Dd {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let (s, e) = two_sum(self.0, o.0);
        let (t, f) = two_sum(self.1, o.1);
        let (s, e) = two_sum(s, e + t);
        let (s, e) = two_sum(s, e + f);
        Self(s, e)
    }
}

impl Sub for Dd {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + Self(-o.0, -o.1)
    }
}

impl Mul for Dd {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let (p, e) = two_product(self.0, o.0);
        let (p, e) = two_sum(p, e + (self.0 * o.1 + self.1 * o.0));
        Self(p, e)
    }
}

impl Div for Dd {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let q = Self::of(self.0 / o.0);
        let rest = self - q * o;
        let q = q + Self::of(rest.0 / o.0);
        let rest = self - q * o;
        q + Self::of(rest.0 / o.0)
    }
}

pub(crate) type Vec3Dd = [Dd; 3];

pub(crate) fn vec(v: DVec3) -> Vec3Dd {
    v.to_array().map(Dd::of)
}

pub(crate) fn add(a: Vec3Dd, b: Vec3Dd) -> Vec3Dd {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(crate) fn sub(a: Vec3Dd, b: Vec3Dd) -> Vec3Dd {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn dot(a: Vec3Dd, b: Vec3Dd) -> Dd {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vec3Dd, b: Vec3Dd) -> Vec3Dd {
    let c = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [c(1, 2), c(2, 0), c(0, 1)]
}

pub(crate) fn length(a: Vec3Dd) -> Dd {
    dot(a, a).sqrt()
}

#[test]
fn thirty_digits() {
    let third = Dd::of(1.0) / Dd::of(3.0);
    let one = third + third + third;
    assert!((one - Dd::of(1.0)).round().abs() < 1e-31);
    let two = Dd::of(2.0).sqrt() * Dd::of(2.0).sqrt();
    assert!((two - Dd::of(2.0)).round().abs() < 1e-31);
}

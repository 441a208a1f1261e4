//! Intervals that contain the truth: arithmetic on closed intervals of real
//! numbers, rounded outward.
//!
//! After IEEE 1788-2015 (set-based intervals): every operation returns an
//! interval that contains the exact result for all real operands inside its
//! arguments *for which it is defined*; where there are none, it returns
//! [`Interval::EMPTY`]. Whether a function is defined and continuous all over
//! its argument is another question, which the caller asks (see
//! [`Interval::is_within`]).
//!
//! +, -, *, / and the square root are rounded to nearest by the processor, so
//! that the neighbouring floats enclose the exact result; results known to be
//! exact (sums with zero, products with zero) stay as they are. The library's
//! functions are widened by [`LIBM_ULPS`].

mod functions;

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use functions::LIBM_ULPS;

/// A closed interval of real numbers; an infinite bound stands for all real
/// numbers on that side. `lo <= hi` unless the interval is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// The interval that contains nothing.
    pub const EMPTY: Self = Self {
        lo: f64::INFINITY,
        hi: f64::NEG_INFINITY,
    };
    /// All real numbers.
    pub const ENTIRE: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };
    /// Zero alone.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// All numbers from `lo` to `hi`; empty if there are none or if a bound
    /// is not a number.
    #[inline]
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY {
            Self { lo, hi }
        } else {
            Self::EMPTY
        }
    }

    /// One number; empty if it is infinite or NaN.
    #[inline]
    pub fn point(x: f64) -> Self {
        Self::new(x, x)
    }

    /// Lower bound; plus infinity if the interval is empty.
    #[inline]
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// Upper bound; minus infinity if the interval is empty.
    #[inline]
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// True if no number lies inside.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    /// True if `x` lies inside or on a bound.
    #[inline]
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// True if the interval is not empty and wholly inside `[lo, hi]`.
    #[inline]
    pub fn is_within(self, lo: f64, hi: f64) -> bool {
        lo <= self.lo && self.hi <= hi && !self.is_empty()
    }

    /// True if both bounds are finite.
    #[inline]
    pub fn is_bounded(self) -> bool {
        self.lo > f64::NEG_INFINITY && self.hi < f64::INFINITY
    }

    /// 1 if all numbers inside are positive, -1 if all are negative, 0 if
    /// neither is so.
    #[inline]
    pub fn sign(self) -> i8 {
        if self.is_empty() {
            0
        } else {
            i8::from(self.lo > 0.0) - i8::from(self.hi < 0.0)
        }
    }

    /// Distance between the bounds, rounded to nearest; zero if empty.
    #[inline]
    pub fn width(self) -> f64 {
        if self.is_empty() {
            0.0
        } else {
            self.hi - self.lo
        }
    }

    /// A number near the middle, inside the interval if its bounds are
    /// finite.
    #[inline]
    pub fn middle(self) -> f64 {
        // Halved first, so that the sum cannot overflow.
        (0.5 * self.lo + 0.5 * self.hi).clamp(self.lo.min(self.hi), self.hi.max(self.lo))
    }

    /// The largest magnitude inside; zero if empty.
    #[inline]
    pub fn magnitude(self) -> f64 {
        if self.is_empty() {
            0.0
        } else {
            self.lo.abs().max(self.hi.abs())
        }
    }

    /// The smallest magnitude inside; zero if empty.
    #[inline]
    pub fn mignitude(self) -> f64 {
        match self.sign() {
            0 => 0.0,
            _ => self.lo.abs().min(self.hi.abs()),
        }
    }

    /// The smallest interval around both.
    #[inline]
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        // The bounds of the empty one are neutral.
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// What lies inside both.
    #[inline]
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.min(other.hi))
    }
}

/// `x`, the rounded sum of `a` and `b`, moved down unless it is exact.
#[inline]
fn sum_down(a: f64, b: f64) -> f64 {
    let s = a + b;
    // A sum that rounds to zero is zero.
    if a == 0.0 || b == 0.0 || s == 0.0 {
        s
    } else {
        s.next_down()
    }
}

#[inline]
fn sum_up(a: f64, b: f64) -> f64 {
    -sum_down(-a, -b)
}

impl Add for Interval {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self {
            lo: sum_down(self.lo, other.lo),
            hi: sum_up(self.hi, other.hi),
        }
    }
}

impl Neg for Interval {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

impl Sub for Interval {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// The product of bounds: an infinite bound is no number but stands for all
/// that are large, and zero times these is zero.
#[inline]
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

/// The quotient of bounds, likewise: an infinite divisor gives zero.
#[inline]
fn quotient(a: f64, b: f64) -> f64 {
    if a == 0.0 || b.is_infinite() {
        0.0
    } else {
        a / b
    }
}

/// A rounded result moved outward by `step`; one that is zero because
/// `exact` says so stays.
#[inline]
fn outward(x: f64, exact: bool, step: impl Fn(f64) -> f64) -> f64 {
    if exact { x } else { step(x) }
}

/// The interval of the four combinations of bounds of `a` and `b`; `combine`
/// rounds to nearest and is exact if `is_exact` says so.
#[inline]
fn of_corners(
    a: Interval,
    b: Interval,
    combine: impl Fn(f64, f64) -> f64,
    is_exact: impl Fn(f64, f64) -> bool,
) -> Interval {
    let pairs = [(a.lo, b.lo), (a.lo, b.hi), (a.hi, b.lo), (a.hi, b.hi)];
    let [p, q, r, s] = pairs.map(|(a, b)| combine(a, b));
    let (lo, hi) = (p.min(q).min(r.min(s)), p.max(q).max(r.max(s)));
    if lo != 0.0 && hi != 0.0 {
        return Interval {
            lo: lo.next_down(),
            hi: hi.next_up(),
        };
    }
    // A zero is exact or has underflowed: each is looked at by itself.
    let bound =
        |step: fn(f64) -> f64| pairs.map(|(a, b)| outward(combine(a, b), is_exact(a, b), step));
    Interval {
        lo: bound(f64::next_down)
            .into_iter()
            .fold(f64::INFINITY, f64::min),
        hi: bound(f64::next_up)
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max),
    }
}

impl Mul for Interval {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        of_corners(self, other, product, |a, b| a == 0.0 || b == 0.0)
    }
}

impl Div for Interval {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() || other == Self::ZERO {
            return Self::EMPTY;
        }
        if !other.contains(0.0) {
            return of_corners(self, other, quotient, |a, b| a == 0.0 || b.is_infinite());
        }
        self.over_zero(other)
    }
}

impl Interval {
    /// A quotient whose divisor has zero inside or as one bound.
    fn over_zero(self, divisor: Self) -> Self {
        if self == Self::ZERO {
            return Self::ZERO;
        }
        let one_sided = divisor.lo == 0.0 || divisor.hi == 0.0;
        if !one_sided || (self.lo < 0.0 && self.hi > 0.0) {
            return Self::ENTIRE;
        }
        // From the quotient of least magnitude to infinity.
        let numerator = self.lo.abs().min(self.hi.abs());
        let largest = divisor.lo.abs().max(divisor.hi.abs());
        let exact = numerator == 0.0 || largest.is_infinite();
        let least = outward(quotient(numerator, largest), exact, f64::next_down);
        let positive = Self {
            lo: least.max(0.0),
            hi: f64::INFINITY,
        };
        if (self.hi > 0.0) == (divisor.hi > 0.0) {
            positive
        } else {
            -positive
        }
    }
}

#[cfg(test)]
mod tests;

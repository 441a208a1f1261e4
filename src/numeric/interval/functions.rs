//! Functions of intervals.

use std::f64::consts::FRAC_1_PI;

use super::Interval;
use crate::numeric::{gamma, trig};

/// Units in the last place by which results of the `libm` crate are widened
/// on each side. Its sources state errors below one unit for all functions
/// used here (they are those of FreeBSD's msun and of musl); a second one is
/// kept in reserve. The tests compare with double-double arithmetic.
pub const LIBM_ULPS: u32 = 2;

/// A value of a library function, moved down to be a lower bound.
fn library_down(x: f64) -> f64 {
    (0..LIBM_ULPS).fold(x, |x, _| x.next_down())
}

fn library_up(x: f64) -> f64 {
    (0..LIBM_ULPS).fold(x, |x, _| x.next_up())
}

/// `x` to the power `n` for `x >= 0`, each product moved by `step`, which
/// keeps the result a bound on its side.
fn power_of(x: f64, n: u32, step: impl Fn(f64) -> f64) -> f64 {
    let times = |a: f64, b: f64| {
        if a == 0.0 || b == 0.0 {
            0.0
        } else if a == 1.0 {
            b
        } else if b == 1.0 {
            a
        } else {
            step(a * b).max(0.0)
        }
    };
    let (mut result, mut square, mut left) = (1.0, x, n);
    while left > 0 {
        if left & 1 == 1 {
            result = times(result, square);
        }
        left >>= 1;
        if left > 0 {
            square = times(square, square);
        }
    }
    result
}

impl Interval {
    /// Magnitudes.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.is_empty() {
            return self;
        }
        Self {
            lo: self.mignitude(),
            hi: self.magnitude(),
        }
    }

    /// The smaller of two.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.min(other.hi),
        }
    }

    /// The larger of two.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        -(-self).min(-other)
    }

    /// A whole power. `x^0` is 1; zero has no negative powers.
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        if self.is_empty() {
            return self;
        }
        let magnitude = n.unsigned_abs();
        let up = |x: f64| power_of(x, magnitude, f64::next_up);
        let down = |x: f64| power_of(x, magnitude, f64::next_down);
        let power = if magnitude.is_multiple_of(2) {
            Self {
                lo: down(self.mignitude()),
                hi: up(self.magnitude()),
            }
        } else {
            let low = |x: f64| if x < 0.0 { -up(-x) } else { down(x) };
            Self {
                lo: low(self.lo),
                hi: -low(-self.hi),
            }
        };
        if n < 0 {
            Self { lo: 1.0, hi: 1.0 } / power
        } else {
            power
        }
    }

    /// The power `c` of the numbers from zero up; `c` is finite. Zero has
    /// positive powers only.
    #[must_use]
    pub fn powf(self, c: f64) -> Self {
        let x = self.intersection(Self::new(0.0, f64::INFINITY));
        if x.is_empty() || (x.hi == 0.0 && c <= 0.0) {
            return Self::EMPTY;
        }
        let (from, to) = if c >= 0.0 { (x.lo, x.hi) } else { (x.hi, x.lo) };
        Self {
            lo: library_down(trig::pow(from, c)).max(0.0),
            hi: library_up(trig::pow(to, c)),
        }
    }

    /// Square roots of the numbers from zero up.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.is_empty() || self.hi < 0.0 {
            return Self::EMPTY;
        }
        let root = |x: f64, step: fn(f64) -> f64| if x == 0.0 { 0.0 } else { step(x.sqrt()) };
        Self {
            lo: root(self.lo.max(0.0), f64::next_down),
            hi: root(self.hi, f64::next_up),
        }
    }

    /// A library function that grows all over the interval.
    fn growing(self, f: fn(f64) -> f64) -> Self {
        if self.is_empty() {
            return self;
        }
        Self {
            lo: library_down(f(self.lo)),
            hi: library_up(f(self.hi)),
        }
    }

    /// e to these powers.
    #[must_use]
    pub fn exp(self) -> Self {
        self.growing(trig::exp)
            .intersection(Self::new(0.0, f64::INFINITY))
    }

    /// Natural logarithms of the positive numbers.
    #[must_use]
    pub fn log(self) -> Self {
        if self.is_empty() || self.hi <= 0.0 {
            return Self::EMPTY;
        }
        let positive = Self {
            lo: self.lo.max(0.0),
            hi: self.hi,
        };
        positive.growing(trig::log)
    }

    /// Arc sines, in radians, of the numbers from -1 to 1.
    #[must_use]
    pub fn asin(self) -> Self {
        self.intersection(Self::new(-1.0, 1.0)).growing(trig::asin)
    }

    /// Arc cosines, in radians, of the numbers from -1 to 1.
    #[must_use]
    pub fn acos(self) -> Self {
        let x = self.intersection(Self::new(-1.0, 1.0));
        if x.is_empty() {
            return x;
        }
        Self {
            lo: library_down(trig::acos(x.hi)).max(0.0),
            hi: library_up(trig::acos(x.lo)),
        }
    }

    /// Arc tangents in radians.
    #[must_use]
    pub fn atan(self) -> Self {
        self.growing(trig::atan)
    }

    /// Sines of angles in radians.
    #[must_use]
    pub fn sin(self) -> Self {
        self.wave(0.5, |x| trig::sin_cos(x).0)
    }

    /// Cosines of angles in radians.
    #[must_use]
    pub fn cos(self) -> Self {
        self.wave(0.0, |x| trig::sin_cos(x).1)
    }

    /// Tangents of angles in radians; all numbers if there may be a pole.
    #[must_use]
    pub fn tan(self) -> Self {
        if self.is_empty() {
            return self;
        }
        match self.half_turns(0.5) {
            Some((first, last)) if first > last => self.growing(trig::tan),
            _ => Self::ENTIRE,
        }
    }

    /// True if a tangent may have a pole inside.
    pub fn may_hold_a_pole_of_tan(self) -> bool {
        self.half_turns(0.5)
            .is_none_or(|(first, last)| first <= last)
    }

    /// The first and the last whole number `n` for which the angle
    /// `(n + phase) pi` may lie in the interval, the first above the last if
    /// there is none; nothing if the numbers are too large to tell.
    fn half_turns(self, phase: f64) -> Option<(f64, f64)> {
        let turns = |x: f64| x * FRAC_1_PI - phase;
        // The constant, the product, the difference and one in reserve.
        let error = gamma(4) * (self.magnitude() * FRAC_1_PI + 1.0);
        let (first, last) = (
            (turns(self.lo) - error).ceil(),
            (turns(self.hi) + error).floor(),
        );
        (first.is_finite() && last.is_finite() && error < 0.5).then_some((first, last))
    }

    /// A function between -1 and 1 that is monotonic but at `(n + phase) pi`,
    /// where it is 1 for even `n` and -1 for odd ones.
    fn wave(self, phase: f64, f: fn(f64) -> f64) -> Self {
        if self.is_empty() {
            return self;
        }
        let all = Self { lo: -1.0, hi: 1.0 };
        let Some((first, last)) = self.half_turns(phase) else {
            return all;
        };
        if last > first {
            return all;
        }
        let (a, b) = (f(self.lo), f(self.hi));
        let ends = Self {
            lo: library_down(a.min(b)),
            hi: library_up(a.max(b)),
        }
        .intersection(all);
        if first > last {
            return ends;
        }
        let is_even = (first * 0.5).floor() * 2.0 == first;
        Self {
            lo: if is_even { ends.lo } else { -1.0 },
            hi: if is_even { 1.0 } else { ends.hi },
        }
    }
}

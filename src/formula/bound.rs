//! Formulas in intervals.

use super::operation::{Algebra, Binary, Constant, Pick, Scalar, Slope, Unary};
use crate::numeric::{Interval, two_sum};

/// All values that a formula has in a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Contains the value at every place where the formula is defined; empty
    /// if there is none.
    pub range: Interval,
    /// True only if the formula is defined and continuous all over the
    /// region.
    pub continuous: bool,
}

impl Enclosure {
    /// Every number of an interval.
    #[inline]
    pub(super) fn of(range: Interval) -> Self {
        Self {
            range,
            continuous: !range.is_empty(),
        }
    }

    /// The same with what is known from elsewhere.
    pub(super) fn narrowed(self, range: Interval) -> Self {
        let both = self.range.intersection(range);
        Self {
            range: if both.is_empty() { self.range } else { both },
            ..self
        }
    }
}

/// True if `op` is defined and continuous all over `x`.
fn is_smooth_over(op: Unary, x: Interval) -> bool {
    match op {
        Unary::Tan => !x.may_hold_a_pole_of_tan(),
        Unary::Asin | Unary::Acos => x.is_within(-1.0, 1.0),
        Unary::Log => x.lo() > 0.0,
        Unary::Sqrt => x.lo() >= 0.0,
        Unary::Powi(n) => n >= 0 || !x.contains(0.0),
        Unary::Powf(c) => x.lo() > 0.0 || (x.lo() == 0.0 && c.value() > 0.0),
        _ => true,
    }
}

impl Algebra for Enclosure {
    fn constant(c: &Constant) -> Self {
        Self::of(c.bound)
    }

    #[inline]
    fn unary(op: Unary, a: Self) -> Self {
        let x = a.range;
        let range = match op {
            Unary::Neg => -x,
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Tan => x.tan(),
            Unary::Asin => x.asin(),
            Unary::Acos => x.acos(),
            Unary::Atan => x.atan(),
            Unary::Exp => x.exp(),
            Unary::Log => x.log(),
            Unary::Sqrt => x.sqrt(),
            Unary::Abs => x.abs(),
            Unary::Powi(n) => x.powi(n),
            Unary::Powf(c) => x.powf(c.value()),
        };
        Self {
            range,
            continuous: a.continuous && is_smooth_over(op, x),
        }
    }

    #[inline]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        let (x, y) = (a.range, b.range);
        let range = match op {
            Binary::Add => x + y,
            Binary::Sub => x - y,
            Binary::Mul => x * y,
            Binary::Div => x / y,
            Binary::Min => x.min(y),
            Binary::Max => x.max(y),
        };
        let divides = op != Binary::Div || !y.contains(0.0);
        Self {
            range,
            continuous: a.continuous && b.continuous && divides,
        }
    }
}

/// A slope that must cover something: everything if nothing is known.
fn or_entire(x: Interval) -> Interval {
    if x.is_empty() { Interval::ENTIRE } else { x }
}

/// One over the root of `1 - x^2`.
fn arc_slope(x: Interval) -> Interval {
    let one = Interval::point(1.0);
    let x = x.intersection(Interval::new(-1.0, 1.0));
    or_entire(one / ((one - x) * (one + x)).sqrt())
}

/// `c x^(c-1)`, by way of `x^c / x` where `c - 1` would round.
fn power_slope(c: f64, x: Interval, fx: Interval) -> Interval {
    let less = c - 1.0;
    let exact = two_sum(c, -1.0).1 == 0.0;
    let power = if exact { x.powf(less) } else { fx / x };
    or_entire(Interval::point(c) * power)
}

impl Scalar for Enclosure {
    type Slope = Interval;

    #[inline]
    fn as_slope(self) -> Interval {
        self.range
    }

    fn slope(op: Unary, x: Self, fx: Self) -> Interval {
        let (x, fx) = (x.range, fx.range);
        let one = Interval::point(1.0);
        match op {
            Unary::Neg => -one,
            Unary::Sin => x.cos(),
            Unary::Cos => -x.sin(),
            Unary::Tan => one + fx.powi(2),
            Unary::Asin => arc_slope(x),
            Unary::Acos => -arc_slope(x),
            Unary::Atan => one / (one + x.powi(2)),
            Unary::Exp => fx,
            Unary::Log => or_entire(one / x),
            Unary::Sqrt => or_entire(Interval::point(0.5) / fx),
            Unary::Abs => match x.sign() {
                0 => Interval::new(-1.0, 1.0),
                sign => Interval::point(f64::from(sign)),
            },
            Unary::Powi(n) => or_entire(Interval::point(f64::from(n)) * x.powi(n - 1)),
            Unary::Powf(c) => power_slope(c.value(), x, fx),
        }
    }

    #[inline]
    fn pick(op: Binary, a: Self, b: Self) -> Pick {
        let (a, b) = (a.range, b.range);
        let (first_below, second_below) = (a.hi() < b.lo(), b.hi() < a.lo());
        let (first, second) = match op {
            Binary::Min => (first_below, second_below),
            _ => (second_below, first_below),
        };
        match (first, second) {
            (true, _) => Pick::First,
            (_, true) => Pick::Second,
            _ => Pick::Either,
        }
    }
}

impl Slope for Interval {
    const ZERO: Self = Self::ZERO;

    #[inline]
    fn over(self, divisor: Self) -> Self {
        if divisor.contains(0.0) {
            Self::ENTIRE
        } else {
            self / divisor
        }
    }

    #[inline]
    fn hull(self, other: Self) -> Self {
        Self::hull(self, other)
    }
}

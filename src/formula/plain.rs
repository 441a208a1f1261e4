//! Formulas in `f64`.

use super::operation::{Algebra, Binary, Constant, Pick, Scalar, Slope, Unary};
use crate::numeric::trig;

/// A whole power by repeated multiplication.
#[inline]
pub(super) fn powi(x: f64, n: i32) -> f64 {
    let (mut result, mut square, mut left) = (1.0, x, n.unsigned_abs());
    while left > 0 {
        if left & 1 == 1 {
            result *= square;
        }
        left >>= 1;
        if left > 0 {
            square *= square;
        }
    }
    if n < 0 { 1.0 / result } else { result }
}

/// A power of a number from zero up; NaN for negative ones.
#[inline]
pub(super) fn powf(x: f64, c: f64) -> f64 {
    if x < 0.0 { f64::NAN } else { trig::pow(x, c) }
}

impl Algebra for f64 {
    fn constant(c: &Constant) -> Self {
        c.value
    }

    #[inline]
    fn unary(op: Unary, x: Self) -> Self {
        match op {
            Unary::Neg => -x,
            Unary::Sin => trig::sin_cos(x).0,
            Unary::Cos => trig::sin_cos(x).1,
            Unary::Tan => trig::tan(x),
            Unary::Asin => trig::asin(x),
            Unary::Acos => trig::acos(x),
            Unary::Atan => trig::atan(x),
            Unary::Exp => trig::exp(x),
            Unary::Log => trig::log(x),
            Unary::Sqrt => x.sqrt(),
            Unary::Abs => x.abs(),
            Unary::Powi(n) => powi(x, n),
            Unary::Powf(c) => powf(x, c.value()),
        }
    }

    #[inline]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        match op {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            // A minimum with something undefined is undefined.
            Binary::Min if a <= b => a,
            Binary::Max if a >= b => a,
            _ if a.is_nan() => a,
            Binary::Min | Binary::Max => b,
        }
    }
}

impl Scalar for f64 {
    type Slope = Self;

    #[inline]
    fn as_slope(self) -> Self {
        self
    }

    #[inline]
    fn slope(op: Unary, x: Self, fx: Self) -> Self {
        match op {
            Unary::Neg => -1.0,
            Unary::Sin => trig::sin_cos(x).1,
            Unary::Cos => -trig::sin_cos(x).0,
            Unary::Tan => 1.0 + fx * fx,
            Unary::Asin => 1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Unary::Acos => -1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Unary::Atan => 1.0 / (1.0 + x * x),
            Unary::Exp => fx,
            Unary::Log => 1.0 / x,
            Unary::Sqrt => 0.5 / fx,
            Unary::Abs if x == 0.0 => 0.0,
            Unary::Abs => 1.0f64.copysign(x),
            Unary::Powi(n) => f64::from(n) * powi(x, n - 1),
            Unary::Powf(c) => c.value() * powf(x, c.value() - 1.0),
        }
    }

    #[inline]
    fn pick(op: Binary, a: Self, b: Self) -> Pick {
        let first = match op {
            Binary::Min => a <= b,
            _ => a >= b,
        };
        if first || a.is_nan() {
            Pick::First
        } else {
            Pick::Second
        }
    }
}

impl Slope for f64 {
    const ZERO: Self = 0.0;

    #[inline]
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    /// Derivatives in `f64` take a side.
    #[inline]
    fn hull(self, _other: Self) -> Self {
        self
    }
}

/// The second derivative of `op` at `x`, where its value is `fx`.
pub(super) fn second_slope(op: Unary, x: f64, fx: f64) -> f64 {
    match op {
        Unary::Neg | Unary::Abs => 0.0,
        Unary::Sin | Unary::Cos => -fx,
        Unary::Tan => 2.0 * fx * (1.0 + fx * fx),
        Unary::Asin | Unary::Acos => {
            let below = (1.0 - x) * (1.0 + x);
            let asin = x / (below * below.sqrt());
            if op == Unary::Asin { asin } else { -asin }
        }
        Unary::Atan => -2.0 * x / ((1.0 + x * x) * (1.0 + x * x)),
        Unary::Exp => fx,
        Unary::Log => -1.0 / (x * x),
        Unary::Sqrt => -0.25 / (x * fx),
        Unary::Powi(n) => f64::from(n) * (f64::from(n) - 1.0) * powi(x, n - 2),
        Unary::Powf(c) => {
            let c = c.value();
            c * (c - 1.0) * powf(x, c - 2.0)
        }
    }
}

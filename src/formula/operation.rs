//! The operations of formulas, and what an arithmetic must know of them.

use crate::numeric::Interval;

/// A float as its bits, so that expressions can be compared and hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Bits(u64);

impl Bits {
    pub(super) fn of(x: f64) -> Self {
        // Both zeros are one number.
        Self((x + 0.0).to_bits())
    }

    pub(super) fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// An operation on one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Unary {
    Neg,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Exp,
    Log,
    Sqrt,
    Abs,
    /// A whole power other than 0 and 1, by repeated multiplication.
    Powi(i32),
    /// Any other fixed power, of numbers from zero up.
    Powf(Bits),
}

/// An operation on two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
}

/// A part of a formula without variables: its value and what encloses the
/// exact one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constant {
    pub(super) value: f64,
    pub(super) bound: Interval,
}

impl Constant {
    /// A number as written.
    pub(super) fn of(value: f64) -> Self {
        Self {
            value,
            bound: Interval::point(value),
        }
    }
}

/// Which operand a minimum or maximum takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pick {
    First,
    Second,
    Either,
}

/// An arithmetic in which formulas can be worked out.
pub(super) trait Algebra: Copy {
    fn constant(c: &Constant) -> Self;
    fn unary(op: Unary, a: Self) -> Self;
    fn binary(op: Binary, a: Self, b: Self) -> Self;
}

/// The numbers of which an arithmetic with derivatives is made.
pub(super) trait Scalar: Algebra {
    /// What derivatives are.
    type Slope: Slope;
    /// The value as a factor of derivatives.
    fn as_slope(self) -> Self::Slope;
    /// The derivative of `op` at `x`, where its value is `fx`.
    fn slope(op: Unary, x: Self, fx: Self) -> Self::Slope;
    /// Whose derivatives a minimum or maximum has.
    fn pick(op: Binary, a: Self, b: Self) -> Pick;
}

/// What derivatives are made of.
pub(super) trait Slope:
    Copy
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::Neg<Output = Self>
{
    const ZERO: Self;
    /// The quotient; everything where the divisor may be zero.
    fn over(self, divisor: Self) -> Self;
    /// What covers both.
    fn hull(self, other: Self) -> Self;
}

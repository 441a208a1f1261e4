//! First derivatives, carried forward beside the value: the chain rule, one
//! operation at a time.

use super::operation::{Algebra, Binary, Constant, Pick, Scalar, Slope, Unary};

/// A value and its derivatives by `N` variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual<S: Scalar, const N: usize> {
    pub(super) value: S,
    pub(super) slopes: [S::Slope; N],
}

impl<S: Scalar, const N: usize> Dual<S, N> {
    /// A value that depends on nothing.
    #[inline]
    pub(super) fn constant(value: S) -> Self {
        Self {
            value,
            slopes: [S::Slope::ZERO; N],
        }
    }

    /// Slopes made one by one.
    #[inline]
    fn with(value: S, slope: impl Fn(usize) -> S::Slope) -> Self {
        Self {
            value,
            slopes: std::array::from_fn(slope),
        }
    }
}

impl<S: Scalar> Dual<S, 3> {
    /// Three values, each a variable; `ones` are their derivatives by
    /// themselves.
    #[inline]
    pub(super) fn variables(values: [S; 3], ones: [S::Slope; 3]) -> [Self; 3] {
        std::array::from_fn(|i| {
            let mut x = Self::constant(values[i]);
            x.slopes[i] = ones[i];
            x
        })
    }
}

impl<S: Scalar, const N: usize> Algebra for Dual<S, N> {
    #[inline]
    fn constant(c: &Constant) -> Self {
        Self::constant(S::constant(c))
    }

    #[inline]
    fn unary(op: Unary, a: Self) -> Self {
        let value = S::unary(op, a.value);
        if N == 0 {
            return Self::constant(value);
        }
        if op == Unary::Neg {
            return Self::with(value, |i| -a.slopes[i]);
        }
        let slope = S::slope(op, a.value, value);
        Self::with(value, |i| slope * a.slopes[i])
    }

    #[inline]
    fn binary(op: Binary, a: Self, b: Self) -> Self {
        let value = S::binary(op, a.value, b.value);
        if N == 0 {
            return Self::constant(value);
        }
        let (f, g) = (a.value.as_slope(), b.value.as_slope());
        match op {
            Binary::Add => Self::with(value, |i| a.slopes[i] + b.slopes[i]),
            Binary::Sub => Self::with(value, |i| a.slopes[i] - b.slopes[i]),
            Binary::Mul => Self::with(value, |i| f * b.slopes[i] + g * a.slopes[i]),
            Binary::Div => {
                let q = value.as_slope();
                Self::with(value, |i| (a.slopes[i] - q * b.slopes[i]).over(g))
            }
            Binary::Min | Binary::Max => match S::pick(op, a.value, b.value) {
                Pick::First => Self::with(value, |i| a.slopes[i]),
                Pick::Second => Self::with(value, |i| b.slopes[i]),
                Pick::Either => Self::with(value, |i| a.slopes[i].hull(b.slopes[i])),
            },
        }
    }
}

//! Second derivatives by x, y and z, carried forward beside the first.

use super::{
    operation::{Algebra, Binary, Constant, Pick, Scalar, Unary},
    plain::second_slope,
};

/// Rows and columns of the six second derivatives.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// A value with first and second derivatives; the second ones in the order
/// xx, xy, xz, yy, yz, zz.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    pub(super) value: f64,
    pub(super) first: [f64; 3],
    pub(super) second: [f64; 6],
}

impl Jet {
    pub(super) fn variables(values: [f64; 3]) -> [Self; 3] {
        std::array::from_fn(|i| {
            let mut first = [0.0; 3];
            first[i] = 1.0;
            Self {
                value: values[i],
                first,
                second: [0.0; 6],
            }
        })
    }

    /// A value whose derivatives are made one by one.
    fn with(
        value: f64,
        first: impl Fn(usize) -> f64,
        second: impl Fn(usize, (usize, usize)) -> f64,
    ) -> Self {
        Self {
            value,
            first: std::array::from_fn(first),
            second: std::array::from_fn(|k| second(k, PAIRS[k])),
        }
    }

    fn product(a: &Self, b: &Self) -> Self {
        Self::with(
            a.value * b.value,
            |i| a.value * b.first[i] + b.value * a.first[i],
            |k, (i, j)| {
                a.value * b.second[k]
                    + b.value * a.second[k]
                    + (a.first[i] * b.first[j] + a.first[j] * b.first[i])
            },
        )
    }

    /// From `q b = a`, differentiated twice.
    fn quotient(a: &Self, b: &Self) -> Self {
        let q = a.value / b.value;
        let first: [f64; 3] = std::array::from_fn(|i| (a.first[i] - q * b.first[i]) / b.value);
        Self::with(
            q,
            |i| first[i],
            |k, (i, j)| {
                let cross = first[i] * b.first[j] + first[j] * b.first[i];
                (a.second[k] - cross - q * b.second[k]) / b.value
            },
        )
    }
}

impl Algebra for Jet {
    fn constant(c: &Constant) -> Self {
        Self {
            value: c.value,
            first: [0.0; 3],
            second: [0.0; 6],
        }
    }

    fn unary(op: Unary, a: Self) -> Self {
        let value = f64::unary(op, a.value);
        let slope = f64::slope(op, a.value, value);
        let bend = second_slope(op, a.value, value);
        Self::with(
            value,
            |i| slope * a.first[i],
            |k, (i, j)| slope * a.second[k] + bend * (a.first[i] * a.first[j]),
        )
    }

    fn binary(op: Binary, a: Self, b: Self) -> Self {
        let value = f64::binary(op, a.value, b.value);
        match op {
            Binary::Add => Self::with(
                value,
                |i| a.first[i] + b.first[i],
                |k, _| a.second[k] + b.second[k],
            ),
            Binary::Sub => Self::with(
                value,
                |i| a.first[i] - b.first[i],
                |k, _| a.second[k] - b.second[k],
            ),
            Binary::Mul => Self::product(&a, &b),
            Binary::Div => Self::quotient(&a, &b),
            Binary::Min | Binary::Max => match f64::pick(op, a.value, b.value) {
                Pick::Second => b,
                Pick::First | Pick::Either => a,
            },
        }
    }
}

//! Primitive polynomials and initial direction numbers of dimensions 2 to 16.
//!
//! S. Joe and F. Y. Kuo, *Constructing Sobol sequences with better
//! two-dimensional projections*, SIAM J. Sci. Comput. 30, 2008: the first rows
//! of their table `new-joe-kuo-6.21201`. Dimension 1 is the van der Corput
//! sequence and needs no row.

/// Inner coefficients `a` of the primitive polynomial (its degree is the
/// number of `m`), and the initial odd numbers `m`.
pub(super) struct Row {
    pub(super) a: u32,
    pub(super) m: &'static [u32],
}

#[rustfmt::skip]
pub(super) const ROWS: [Row; 15] = [
    Row { a: 0, m: &[1] },
    Row { a: 1, m: &[1, 3] },
    Row { a: 1, m: &[1, 3, 1] },
    Row { a: 2, m: &[1, 1, 1] },
    Row { a: 1, m: &[1, 1, 3, 3] },
    Row { a: 4, m: &[1, 3, 5, 13] },
    Row { a: 2, m: &[1, 1, 5, 5, 17] },
    Row { a: 4, m: &[1, 1, 5, 5, 5] },
    Row { a: 7, m: &[1, 1, 7, 11, 19] },
    Row { a: 11, m: &[1, 1, 5, 1, 1] },
    Row { a: 13, m: &[1, 1, 1, 3, 11] },
    Row { a: 14, m: &[1, 3, 5, 5, 31] },
    Row { a: 1, m: &[1, 3, 3, 9, 7, 49] },
    Row { a: 13, m: &[1, 1, 1, 15, 21, 21] },
    Row { a: 16, m: &[1, 3, 1, 13, 27, 49] },
];

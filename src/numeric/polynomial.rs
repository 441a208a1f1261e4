//! Real roots of polynomials of low degree within an interval.
//!
//! Between two neighbouring roots of its derivative a polynomial is monotone,
//! so that each sign change between them brackets one root, and Newton's
//! method with bisection as its guard finds it (C. Yuksel, *High-Performance
//! Polynomial Root Finding for Graphics*, Proc. ACM Comput. Graph. Interact.
//! Tech. 5(3), 2022). The derivative's roots are found in the same way, down
//! to the quadratic. Only roots at which the sign changes are told, so that
//! their number is odd exactly if the signs at the ends differ.

use super::quadratic::{Roots, quadratic};

/// Highest degree.
const MAX_DEGREE: usize = 4;

/// Up to four roots, ascending.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RootList {
    roots: [f64; MAX_DEGREE],
    count: usize,
}

impl RootList {
    fn push(&mut self, root: f64) {
        self.roots[self.count] = root;
        self.count += 1;
    }

    /// The roots.
    pub fn as_slice(&self) -> &[f64] {
        &self.roots[..self.count]
    }
}

/// The value of `c[0] + c[1] t + ..` and its derivative.
#[inline]
fn value_and_slope(c: &[f64], t: f64) -> (f64, f64) {
    c.iter()
        .rev()
        .fold((0.0, 0.0), |(v, s), &c| (v * t + c, s * t + v))
}

/// The places in `[lo, hi]` at which `c[0] + c[1] t + ..` (at most five
/// coefficients, of magnitudes near 1) changes its sign. `positive` says which
/// sign it has at either end, whatever rounding makes of it there.
///
/// A root is as good as the polynomial's value: where that is wrong by `e` and
/// the slope is `s`, the root is off by `e / s`.
pub fn sign_changes(c: &[f64], lo: f64, hi: f64, positive: [bool; 2]) -> RootList {
    let mut found = RootList::default();
    let mut slope = [0.0; MAX_DEGREE];
    let degree = c.len() - 1;
    for i in 1..=degree {
        slope[i - 1] = i as f64 * c[i];
    }
    let turns = turning_points(&slope[..degree], lo, hi);
    let (mut from, mut was) = (lo, positive[0]);
    for (i, &to) in turns.as_slice().iter().chain([&hi]).enumerate() {
        let is = if i == turns.count {
            positive[1]
        } else {
            value_and_slope(c, to).0 >= 0.0
        };
        if is != was {
            found.push(bracketed(c, from, to, was));
        }
        (from, was) = (to, is);
    }
    found
}

/// The sign changes of a derivative within `(lo, hi)`.
fn turning_points(c: &[f64], lo: f64, hi: f64) -> RootList {
    if c.len() <= 3 {
        return closed_form(c, lo, hi);
    }
    let positive = |t| value_and_slope(c, t).0 >= 0.0;
    sign_changes(c, lo, hi, [positive(lo), positive(hi)])
}

/// The roots of a polynomial of degree two or less.
fn closed_form(c: &[f64], lo: f64, hi: f64) -> RootList {
    let at = |i: usize| c.get(i).copied().unwrap_or(0.0);
    let mut found = RootList::default();
    let mut keep = |t: f64| {
        if t > lo && t < hi {
            found.push(t);
        }
    };
    // The sign of a zero chooses how roots are rounded: there is but one.
    match quadratic(at(2), 0.5 * at(1) + 0.0, at(0)) {
        Roots::None => {}
        Roots::One(t) => keep(t),
        Roots::Two(a, b) => {
            keep(a);
            keep(b);
        }
    }
    found
}

/// The root between `from` and `to`, where the polynomial is monotone;
/// `falling` if it is positive at `from`.
fn bracketed(c: &[f64], from: f64, to: f64, falling: bool) -> f64 {
    let (mut low, mut high) = (from, to);
    let mut t = 0.5 * (low + high);
    let mut last_step = high - low;
    // Bisection alone would halve the bracket in each round; a hundred rounds
    // leave nothing of it.
    for _ in 0..100 {
        let (value, slope) = value_and_slope(c, t);
        if value == 0.0 {
            return t;
        }
        if (value > 0.0) == falling {
            low = t;
        } else {
            high = t;
        }
        let newton = t - value / slope;
        // Newton's steps must at least halve; else the bracket is halved.
        let step = newton - t;
        let inside = newton > low && newton < high;
        let next = if inside && step.abs() <= 0.5 * last_step {
            newton
        } else {
            low + 0.5 * (high - low)
        };
        last_step = (next - t).abs();
        if next == t {
            return t;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The polynomial with these roots and leading coefficient 1.
    fn with_roots(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |c, &r| {
            let mut next = vec![0.0; c.len() + 1];
            for (i, &c) in c.iter().enumerate() {
                next[i + 1] += c;
                next[i] -= r * c;
            }
            next
        })
    }

    proptest! {
        #[test]
        fn planted_roots_are_found(
            mut roots in prop::collection::vec(-1.0..1.0f64, 1..5),
            pair in prop::option::of((-1.0..1.0f64, 0.1..1.0f64)),
        ) {
            // Two of the roots may be complex: then they are not found.
            let complex = pair.filter(|_| roots.len() <= 2);
            roots.sort_by(f64::total_cmp);
            let mut c = with_roots(&roots);
            if let Some((re, im)) = complex {
                let square = [re * re + im * im, -2.0 * re, 1.0];
                let mut next = vec![0.0; c.len() + 2];
                for (i, a) in c.iter().enumerate() {
                    for (j, b) in square.iter().enumerate() {
                        next[i + j] += a * b;
                    }
                }
                c = next;
            }
            let positive = |t| value_and_slope(&c, t).0 >= 0.0;
            let found = sign_changes(&c, -2.0, 2.0, [positive(-2.0), positive(2.0)]);
            // Roots that nearly coincide may be taken for none.
            let apart = roots.windows(2).map(|w| w[1] - w[0]).fold(1.0, f64::min);
            if apart > 1e-4 {
                prop_assert_eq!(found.as_slice().len(), roots.len());
                for (f, r) in found.as_slice().iter().zip(&roots) {
                    // The coefficients' rounding over the slope there.
                    let slope = value_and_slope(&c, *r).1.abs();
                    prop_assert!((f - r).abs() <= 1e-14 / slope, "{} for {}", f, r);
                }
            }
            prop_assert_eq!(found.as_slice().len() % 2, roots.len() % 2);
            prop_assert!(found.as_slice().is_sorted());
        }

        /// As many sign changes as on a dense grid, or more.
        #[test]
        fn no_sign_change_is_missed(c in prop::array::uniform5(-1.0..1.0f64), lo in -2.0..0.0f64, hi in 0.0..2.0f64) {
            let positive = |t| value_and_slope(&c, t).0 >= 0.0;
            let found = sign_changes(&c, lo, hi, [positive(lo), positive(hi)]);
            let mut seen = 0;
            let mut was = positive(lo);
            for i in 1..=1000 {
                let t = lo + (hi - lo) * f64::from(i) / 1000.0;
                let t = if i == 1000 { hi } else { t };
                seen += usize::from(positive(t) != was);
                was = positive(t);
            }
            prop_assert!(found.as_slice().len() >= seen);
            prop_assert_eq!(found.as_slice().len() % 2, seen % 2);
            for &t in found.as_slice() {
                prop_assert!(value_and_slope(&c, t).0.abs() <= 1e-13 && t >= lo && t <= hi);
            }
        }
    }

    #[test]
    fn double_roots_come_in_pairs_or_not_at_all() {
        for roots in [[0.5, 0.5, -0.5, -0.5], [0.25, 0.25, 0.25, 0.25]] {
            let found = sign_changes(&with_roots(&roots), -1.0, 1.0, [true, true]);
            assert_eq!(found.as_slice().len() % 2, 0, "{found:?}");
        }
        let through = sign_changes(&with_roots(&[0.3, 0.3, 0.3]), -1.0, 1.0, [false, true]);
        assert_eq!(through.as_slice().len(), 1);
        assert!((through.as_slice()[0] - 0.3).abs() < 1e-4, "a triple root");
    }

    /// What the ends are said to be decides, also against rounding.
    #[test]
    fn signs_at_the_ends_are_believed() {
        let c = with_roots(&[0.5]);
        assert_eq!(sign_changes(&c, -1.0, 1.0, [false, true]).as_slice(), [0.5]);
        assert_eq!(
            sign_changes(&c, 0.6, 1.0, [false, true]).as_slice().len(),
            1
        );
        assert!(
            sign_changes(&c, 0.6, 1.0, [true, true])
                .as_slice()
                .is_empty()
        );
    }
}

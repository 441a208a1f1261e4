//! Sums whose bits depend neither on the order nor on the grouping of the
//! addends.
//!
//! A sum is a 128-bit integer count of a power-of-two *quantum*: integer
//! addition is associative, floating-point addition is not. The quantum is
//! chosen once by the owner of the sums (the film derives it from the scene),
//! so that any two partial sums can be added later.

/// The power of two in which a family of sums is counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantum {
    per_unit: f64,
    unit: f64,
}

impl Quantum {
    /// A quantum 2^64 times smaller than the power of two nearest to
    /// `typical` (a typical magnitude of the addends). Sums then keep at
    /// least 19 digits below `typical` and hold values up to 2^62 times it.
    /// A `typical` that is zero or not finite counts as 1.
    pub fn for_typical(typical: f64) -> Self {
        let typical = if typical.is_finite() && typical > 0.0 {
            typical
        } else {
            1.0
        };
        // Clamped so that both the quantum and its inverse are normal floats.
        let exponent = libm::ilogb(typical).clamp(-900, 900) - 64;
        Self {
            per_unit: libm::ldexp(1.0, -exponent),
            unit: libm::ldexp(1.0, exponent),
        }
    }

    /// The quantum whose one count is worth `unit`; `None` unless that is what
    /// [`Quantum::unit`] said of one.
    pub fn of_unit(unit: f64) -> Option<Self> {
        if !unit.is_normal() || unit < 0.0 {
            return None;
        }
        // Inside the range the quantum of 2^64 units has just this unit.
        let quantum = Self::for_typical(libm::ldexp(unit, 64));
        (quantum.unit == unit).then_some(quantum)
    }

    /// The value of one count.
    pub fn unit(self) -> f64 {
        self.unit
    }
}

/// An exact running sum; see the module's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSum(i128);

impl ExactSum {
    /// Adds `x`, rounded to the quantum. Values beyond 2^62 times the typical
    /// magnitude saturate; NaN adds nothing (the film counts and refuses
    /// both before they come here).
    #[inline]
    pub fn add(&mut self, x: f64, quantum: Quantum) {
        // `as` saturates and sends NaN to 0; the shift keeps headroom for the
        // number of addends.
        const LIMIT: i128 = i128::MAX >> 1;
        let counts = ((x * quantum.per_unit).round_ties_even() as i128).clamp(-LIMIT, LIMIT);
        self.0 = self.0.saturating_add(counts);
    }

    /// Adds another sum of the same quantum.
    #[inline]
    pub fn merge(&mut self, other: Self) {
        self.0 = self.0.saturating_add(other.0);
    }

    /// The number of quanta.
    #[inline]
    pub fn counts(self) -> i128 {
        self.0
    }

    /// The sum of so many quanta.
    #[inline]
    pub fn of_counts(counts: i128) -> Self {
        Self(counts)
    }

    /// The sum, rounded once.
    #[inline]
    pub fn value(self, quantum: Quantum) -> f64 {
        rounded(self.0) * quantum.unit
    }
}

/// What `as f64` makes of it, with fewer instructions: no processor converts 128
/// bits by itself.
#[inline]
fn rounded(counts: i128) -> f64 {
    if let Ok(few) = i64::try_from(counts) {
        return few as f64;
    }
    let size = counts.unsigned_abs();
    // The first 63 bits, and whether there is more: ten bits beyond those that a
    // float keeps, so that ties are told from what is above them.
    let shift = 65 - size.leading_zeros();
    let first = (size >> shift) as i64;
    let more = size & ((1 << shift) - 1) != 0;
    let scale = f64::from_bits(u64::from(1023 + shift) << 52);
    let value = (first | i64::from(more)) as f64 * scale;
    if counts < 0 { -value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn keeps_what_floats_lose() {
        let q = Quantum::for_typical(1.0);
        let mut s = ExactSum::default();
        for x in [1e15, 1.0, -1e15] {
            s.add(x, q);
        }
        assert_eq!(s.value(q), 1.0);
    }

    #[test]
    fn a_quantum_comes_back_from_its_unit() {
        for typical in [1e-300, 5e-324, 0.3, 1.0, 7e200, f64::MAX, f64::NAN] {
            let q = Quantum::for_typical(typical);
            assert_eq!(Quantum::of_unit(q.unit()), Some(q), "{typical}");
        }
        for unit in [0.0, -1.0, 3.0, f64::NAN, f64::INFINITY, 1e-320] {
            assert_eq!(Quantum::of_unit(unit), None, "{unit}");
        }
    }

    #[test]
    fn extremes_do_not_wrap() {
        let q = Quantum::for_typical(1e-300);
        let mut s = ExactSum::default();
        for x in [f64::MAX, f64::MAX, f64::INFINITY, f64::NAN] {
            s.add(x, q);
        }
        assert!(s.value(q) > 0.0 && s.value(q).is_finite());
    }

    /// Ties, their neighbours, and both ends of the range.
    #[test]
    fn halves_are_rounded_to_even() {
        for bits in 60..127 {
            for odd in [0, 1, 2, 3] {
                let tie = (1i128 << bits) + (odd << (bits - 53));
                for counts in [tie - 1, tie, tie + 1, -tie, 1 - tie] {
                    assert_eq!(rounded(counts), counts as f64, "{counts}");
                }
            }
        }
        for counts in [0, 1, -1, i128::MAX, i128::MIN, i128::MIN + 1] {
            assert_eq!(rounded(counts), counts as f64, "{counts}");
        }
    }

    proptest! {
        #[test]
        fn counts_are_rounded_as_the_language_has_it(counts: i128, down in 0..127) {
            let counts = counts >> down;
            prop_assert_eq!(rounded(counts), counts as f64);
        }

        #[test]
        fn order_and_grouping_do_not_matter(mut xs in prop::collection::vec(-1e6..1e6f64, 1..40), cut in 0usize..40) {
            let q = Quantum::for_typical(3.0);
            let sum = |v: &[f64]| v.iter().fold(ExactSum::default(), |mut s, &x| { s.add(x, q); s });
            let whole = sum(&xs);
            let cut = cut.min(xs.len());
            let mut parts = sum(&xs[cut..]);
            parts.merge(sum(&xs[..cut]));
            prop_assert_eq!(whole, parts);
            xs.reverse();
            prop_assert_eq!(whole, sum(&xs));
            let naive: f64 = xs.iter().sum();
            prop_assert!((whole.value(q) - naive).abs() <= 1e-9 * 40.0);
        }
    }
}

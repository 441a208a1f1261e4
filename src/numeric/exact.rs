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
        self.0 = self.0.saturating_add(counted(x * quantum.per_unit));
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

/// The whole number nearest to `x`, of two the even one; NaN makes 0, and what is
/// beyond half the range its end, which keeps headroom for the number of addends.
/// With fewer instructions than by rounding and `as`, both of which are calls
/// where processors need not have them.
#[inline]
fn counted(x: f64) -> i128 {
    const LIMIT: i128 = i128::MAX >> 1;
    /// From here on floats are whole numbers.
    const WHOLE: f64 = (1u64 << 52) as f64;
    if x.abs() < WHOLE {
        // The sum has no room for a fraction.
        let shift = WHOLE.copysign(x);
        return i128::from(((x + shift) - shift) as i64);
    }
    let exponent = (x.to_bits() >> 52) as u32 & 0x7ff;
    let places = exponent.wrapping_sub(1023 + 52);
    if places > 126 - 53 {
        return if x.is_nan() {
            0
        } else if x > 0.0 {
            LIMIT
        } else {
            -LIMIT
        };
    }
    let size = i128::from((x.to_bits() & ((1 << 52) - 1)) | (1 << 52)) << places;
    if x < 0.0 { -size } else { size }
}

/// What `as f64` makes of it, with fewer instructions: no processor converts 128
/// bits by itself.
#[inline]
fn rounded(counts: i128) -> f64 {
    /// Below so many times 2^64 all sums but the last are exact.
    const MOST: i64 = 1 << 40;
    const TWO_TO_32: f64 = (1u64 << 32) as f64;
    let (high, low) = ((counts >> 64) as i64, counts as u64);
    if !(-MOST..MOST).contains(&high) {
        return counts as f64;
    }
    let high = high as f64 * (TWO_TO_32 * TWO_TO_32);
    let middle = f64::from((low >> 32) as u32) * TWO_TO_32;
    // What the sum of these two loses (T. Dekker, Numer. Math. 18, 1971, section 4)
    // is a multiple of 2^32 and below 2^52, so with the last 32 bits it is a float.
    let sum = high + middle;
    let lost = middle - (sum - high);
    sum + (lost + f64::from(low as u32))
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

    #[test]
    fn numbers_are_counted_as_the_language_has_it() {
        let limit = i128::MAX >> 1;
        let by_calls = |x: f64| (x.round_ties_even() as i128).clamp(-limit, limit);
        let edges = (-60..130).flat_map(|e| {
            let at = libm::ldexp(1.0, e);
            [
                at,
                at.next_down(),
                at.next_up(),
                1.5 * at,
                at + 0.5,
                at - 0.5,
            ]
        });
        let special = [0.0, f64::MAX, f64::INFINITY, f64::NAN, 5e-324];
        for x in edges.chain(special) {
            assert_eq!(counted(x), by_calls(x), "{x:e}");
            assert_eq!(counted(-x), by_calls(-x), "-{x:e}");
        }
    }

    proptest! {
        #[test]
        fn any_number_is_counted_as_the_language_has_it(mantissa in -1.0..1.0f64, e in -5..130) {
            let x = libm::ldexp(mantissa, e);
            let limit = i128::MAX >> 1;
            prop_assert_eq!(counted(x), (x.round_ties_even() as i128).clamp(-limit, limit));
        }

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

//! Error-free transformations and products that do not cancel.

/// `a + b` as a rounded sum and its exact error (Knuth's two-sum).
#[inline]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

/// Splits `a` into two halves of at most 26 bits (Veltkamp 1968).
#[inline]
fn split(a: f64) -> (f64, f64) {
    // 2^27 + 1
    let c = 134_217_729.0 * a;
    let hi = c - (c - a);
    (hi, a - hi)
}

/// `a * b` as a rounded product and its exact error (Dekker 1971). Exact
/// while no partial product over- or underflows; needs no fused multiply-add,
/// so it costs the same on every machine.
#[inline]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let (ah, al) = split(a);
    let (bh, bl) = split(b);
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

/// `a b - c d` to about two roundings of the true value, also where the two
/// products nearly cancel (Ogita, Rump, Oishi 2005, compensated dot product).
///
/// ```
/// let x = 1.0 + f64::EPSILON;
/// let y = 1.0 - f64::EPSILON;
/// // x y - 1 = -eps^2 exactly; the naive formula gives 0.
/// assert_eq!(nephroid::numeric::difference_of_products(x, y, 1.0, 1.0), -f64::EPSILON * f64::EPSILON);
/// ```
#[inline]
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, pe) = two_product(a, b);
    let (q, qe) = two_product(c, d);
    let (s, se) = two_sum(p, -q);
    let r = s + (se + (pe - qe));
    // Splitting overflows for magnitudes beyond 2^996; the plain formula is
    // then as good as anything.
    if r.is_finite() { r } else { a * b - c * d }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn two_sum_is_exact(a in -1e10..1e10f64, b in -1e-10..1e-10f64) {
            let (s, e) = two_sum(a, b);
            prop_assert_eq!(s, a + b);
            // The error term restores the smaller operand's lost bits.
            prop_assert_eq!((s - a) + e - b + (s - (s - a) - a), 0.0);
        }

        #[test]
        fn cancelling_products_keep_their_value(m in 1i64..(1 << 25), n in 1i64..(1 << 25), k in 1i64..1000) {
            // Integers below 2^53: the truth is exact in i128.
            let (a, b) = ((m * 7 + k) as f64, (n * 5 + 1) as f64);
            let (c, d) = ((m * 7) as f64, (n * 5 + 3) as f64);
            let truth = i128::from(m * 7 + k) * i128::from(n * 5 + 1) - i128::from(m * 7) * i128::from(n * 5 + 3);
            let got = difference_of_products(a, b, c, d);
            prop_assert!((got - truth as f64).abs() <= truth.unsigned_abs() as f64 * 4.0 * crate::numeric::U);
        }
    }
}

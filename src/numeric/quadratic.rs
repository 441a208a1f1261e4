//! Roots of a quadratic without cancellation.
//!
//! Half-b form and the pair `q / a`, `k / q` after *Numerical Recipes*,
//! section 5.6: the second root never subtracts nearly equal numbers.

use super::difference_of_products;

/// The real roots of a quadratic, ascending.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roots {
    /// No real root.
    None,
    /// One root: the equation is linear, or the other root overflows.
    One(f64),
    /// Two roots in ascending order; equal at a tangency.
    Two(f64, f64),
}

/// Solves `a t^2 + 2 h t + k = 0`.
///
/// Roots that are not finite are left out. With `a = h = 0` there is no root,
/// also when `k = 0`.
#[inline]
pub fn quadratic(a: f64, h: f64, k: f64) -> Roots {
    quadratic_with_discriminant(a, h, k, difference_of_products(h, h, a, k))
}

/// The same with the reduced discriminant `h^2 - a k` given by the caller,
/// who may know a better formula for it.
#[inline]
pub fn quadratic_with_discriminant(a: f64, h: f64, k: f64, discriminant: f64) -> Roots {
    if a == 0.0 {
        let t = -k / (2.0 * h);
        return if t.is_finite() {
            Roots::One(t)
        } else {
            Roots::None
        };
    }
    if !discriminant.is_finite() && a.is_finite() && h.is_finite() && k.is_finite() {
        // Overflow: the roots do not change when all coefficients are scaled
        // by the same exact power of two.
        let s = f64::from_bits((1023 - 600) << 52);
        return quadratic(a * s, h * s, k * s);
    }
    if discriminant.is_nan() || discriminant < 0.0 {
        return Roots::None;
    }
    let q = -(h + discriminant.sqrt().copysign(h));
    if q == 0.0 {
        return Roots::Two(0.0, 0.0);
    }
    let (t0, t1) = (q / a, k / q);
    match (t0.is_finite(), t1.is_finite()) {
        (true, true) => Roots::Two(t0.min(t1), t0.max(t1)),
        (true, false) => Roots::One(t0),
        (false, true) => Roots::One(t1),
        (false, false) => Roots::None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn hard_cases() {
        assert_eq!(
            quadratic(1.0, 0.0, 0.0),
            Roots::Two(0.0, 0.0),
            "double root at zero is not NaN"
        );
        assert_eq!(quadratic(0.0, 1.0, -4.0), Roots::One(2.0), "linear");
        assert_eq!(quadratic(0.0, 0.0, 1.0), Roots::None, "constant");
        assert_eq!(quadratic(1.0, 0.0, 1.0), Roots::None, "no real root");
        assert_eq!(
            quadratic(1e200, -1.5e200, 2e200),
            Roots::Two(1.0, 2.0),
            "overflowing discriminant"
        );
        // Textbook cancellation: t^2 - 1e9 t + 1 has a root near 1e-9.
        let Roots::Two(small, _) = quadratic(1.0, -5e8, 1.0) else {
            panic!("two roots expected")
        };
        assert!((small - 1e-9).abs() < 1e-24, "small root {small:e}");
    }

    proptest! {
        #[test]
        fn planted_roots_are_found(r in -1e3..1e3f64, gap in 1e-6..1e3f64, a in 1e-3..1e3f64) {
            let s = r + gap;
            let Roots::Two(t0, t1) = quadratic(a, -a * (r + s) / 2.0, a * r * s) else {
                return Err(TestCaseError::fail("two roots expected"));
            };
            // Coefficients are rounded, so roots move by their condition number.
            let tol = 1e-12 * (1.0 + r.abs() + s.abs()).powi(2) / gap;
            prop_assert!((t0 - r).abs() <= tol && (t1 - s).abs() <= tol, "{t0} {t1} vs {r} {s}");
        }
    }
}

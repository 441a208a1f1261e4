//! Transcendental functions with the same bits on every platform.
//!
//! The platform's `sin`, `cos` and friends may differ in the last bit from
//! machine to machine; everything that can reach a pixel calls these instead
//! (the `libm` crate, a port of the musl functions, pinned by the lock file).

/// Sine and cosine of `x` in radians.
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Sine and cosine of `x` radians, `|x| <= pi/4`, to less than one unit in the
/// last place.
///
/// Taylor series up to `x^17` and `x^16`. What is left out is less than the
/// next term: `8e-20 |x|` and `2e-18`, a hundredth of a rounding. The leading
/// terms are added last, so that only theirs counts in full. No reduction, no
/// branch: half the work of [`sin_cos`], and that of two angles overlaps.
#[inline]
pub fn sin_cos_octant(x: f64) -> (f64, f64) {
    // (-1)^k / (2 k + 1)! from k = 1, and (-1)^k / (2 k)! from k = 2; both
    // rows by pairs of terms, which shortens the chain of operations.
    const S: [f64; 8] = reciprocal_factorials(3);
    const C: [f64; 7] = reciprocal_factorials(4);
    let z = x * x;
    let w = z * z;
    let sin = ((S[6] + z * S[7]) * w + (S[4] + z * S[5])) * w + (S[2] + z * S[3]);
    let sin = sin * w + (S[0] + z * S[1]);
    let cos = (C[6] * w + (C[4] + z * C[5])) * w + (C[2] + z * C[3]);
    let cos = cos * w + (C[0] + z * C[1]);
    // 1 - z / 2 rounds; what it lost is found again.
    let half = 0.5 * z;
    let top = 1.0 - half;
    let lost = (1.0 - top) - half;
    (x + x * (z * sin), top + (lost + w * cos))
}

/// `1 / first!`, `1 / (first + 2)!` and so on, the sign alternating from that
/// of the term `first` in the series of sine or cosine.
const fn reciprocal_factorials<const N: usize>(first: u64) -> [f64; N] {
    let mut terms = [0.0; N];
    let mut k = 0;
    while k < N {
        let n = first + 2 * k as u64;
        let (mut factorial, mut i) = (1, 2);
        while i <= n {
            factorial *= i;
            i += 1;
        }
        let sign = if (n / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
        // Exact up to 18!, as products with many factors of two.
        terms[k] = sign / factorial as f64;
        k += 1;
    }
    terms
}

/// Tangent of `x` in radians.
#[inline]
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Arc cosine in radians.
#[inline]
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Arc sine in radians.
#[inline]
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Arc tangent in radians.
#[inline]
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// e to the power `x`.
#[inline]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Natural logarithm of `x`.
#[inline]
pub fn log(x: f64) -> f64 {
    libm::log(x)
}

/// `x` to the power `y`.
#[inline]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Two to the power `x`.
#[inline]
pub fn exp2(x: f64) -> f64 {
    libm::exp2(x)
}

/// Logarithm of `x` to base two.
#[inline]
pub fn log2(x: f64) -> f64 {
    libm::log2(x)
}

/// Cube root of `x`.
#[inline]
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    /// Units in the last place between two numbers of one sign.
    fn ulps(a: f64, b: f64) -> u64 {
        a.to_bits().abs_diff(b.to_bits())
    }

    /// Both have less than one unit of error: they differ by one at most.
    #[test]
    fn the_octant_agrees_with_libm() {
        let (mut sines, mut cosines) = (0, 0);
        let n = 2_000_003u32;
        for k in 1..=n {
            let x = FRAC_PI_4 * (f64::from(k) / f64::from(n));
            for x in [x, -x, x * 1e-3, x * 1e-160] {
                let (sin, cos) = sin_cos_octant(x);
                let truth = sin_cos(x);
                assert!(ulps(sin, truth.0) <= 1, "sin {x:e}: {sin:e}");
                assert!(ulps(cos, truth.1) <= 1, "cos {x:e}: {cos:e}");
                sines += u64::from(sin != truth.0);
                cosines += u64::from(cos != truth.1);
            }
        }
        // Nearly always both are rounded as the true value is.
        let all = 4 * u64::from(n);
        assert!(10 * sines < all && 10 * cosines < all, "{sines} {cosines}");
    }

    #[test]
    fn the_octant_has_the_symmetries() {
        assert_eq!(sin_cos_octant(0.0), (0.0, 1.0));
        for k in 1..1000 {
            let x = FRAC_PI_4 * f64::from(k) / 1000.0;
            let (sin, cos) = sin_cos_octant(x);
            assert_eq!(sin_cos_octant(-x), (-sin, cos));
        }
    }
}

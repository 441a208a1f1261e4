//! Rounding error counted in the style of Higham, *Accuracy and Stability of
//! Numerical Algorithms* (2002), Lemma 3.1.

/// Unit roundoff of `f64`: half the distance from 1 to the next float.
pub const U: f64 = f64::EPSILON / 2.0;

/// Relative error bound of a product of `n` factors `(1 + d)`, `|d| <= U`:
/// `n U / (1 - n U)`.
///
/// ```
/// assert!(nephroid::numeric::gamma(5) < 6e-16);
/// ```
#[inline]
pub const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * U;
    nu / (1.0 - nu)
}

/// The `f32` not below `x`.
#[inline]
pub fn round_up_f32(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_up() } else { y }
}

/// The `f32` not above `x`.
#[inline]
pub fn round_down_f32(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) > x { y.next_down() } else { y }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outward_rounding_encloses() {
        for x in [
            0.1,
            -0.1,
            1.0,
            1e-50,
            -1e-50,
            1e38,
            16_777_217.0,
            -16_777_217.0,
        ] {
            assert!(f64::from(round_up_f32(x)) >= x, "up {x}");
            assert!(f64::from(round_down_f32(x)) <= x, "down {x}");
        }
        assert_eq!(round_up_f32(0.5), 0.5, "exact values stay");
    }
}

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

/// `x` to the power `y`.
#[inline]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

//! The transfer curve of sRGB, IEC 61966-2-1.

use crate::numeric::trig::pow;

/// The code of a linear value, from 0 to 1: clipped to that first. NaN
/// becomes 0.
pub fn srgb_code(linear: f64) -> f64 {
    let v = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    if v <= 0.0031308 {
        12.92 * v
    } else {
        1.055 * pow(v, 1.0 / 2.4) - 0.055
    }
}

/// The linear value of a code; both run from 0 to 1.
pub fn srgb_linear(code: f64) -> f64 {
    if code <= 0.04045 {
        code / 12.92
    } else {
        pow((code + 0.055) / 1.055, 2.4)
    }
}

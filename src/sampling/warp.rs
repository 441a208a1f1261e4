//! Maps from the unit square to directions and points, with their pdfs.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

use glam::{DVec2, DVec3};

use crate::numeric::trig;

/// A point of the unit disc, uniform; the concentric map keeps strata
/// together (Shirley and Chiu, JGT 2(3), 1997). Pdf per area: 1/pi.
#[inline]
pub fn disc(u: [f64; 2]) -> DVec2 {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    // The angle from the nearer axis, at most an eighth of a turn: sine and
    // cosine need no reduction there.
    if a.abs() > b.abs() {
        let (sin, cos) = trig::sin_cos_octant(FRAC_PI_4 * (b / a));
        DVec2::new(a * cos, a * sin)
    } else {
        let (sin, cos) = trig::sin_cos_octant(FRAC_PI_4 * (a / b));
        DVec2::new(b * sin, b * cos)
    }
}

/// A direction around +z with density proportional to its cosine. Pdf per
/// solid angle: [`cosine_hemisphere_pdf`].
#[inline]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let p = disc(u);
    let r2 = p.length_squared();
    // 1 - r^2 may round below zero at the rim.
    DVec3::new(p.x, p.y, (1.0 - r2).max(0.0).sqrt())
}

/// Pdf per solid angle of [`cosine_hemisphere`] at the given cosine.
#[inline]
pub fn cosine_hemisphere_pdf(cos: f64) -> f64 {
    cos.max(0.0) * FRAC_1_PI
}

/// A direction, uniform over the sphere. Pdf per solid angle: 1/(4 pi).
#[inline]
pub fn sphere(u: [f64; 2]) -> DVec3 {
    cone(u, 2.0)
}

/// `1 - cos` of the half-angle whose sine is `sin`, without cancellation and
/// for any size (half-angles up to 90 degrees).
#[inline]
pub fn one_minus_cos(sin: f64) -> f64 {
    let s2 = sin * sin;
    s2 / (1.0 + (1.0 - s2).max(0.0).sqrt())
}

/// A direction around +z, uniform within the cone whose half-angle has
/// `1 - cos = q`, `0 <= q <= 2`. Pdf per solid angle: [`cone_pdf`].
#[inline]
pub fn cone(u: [f64; 2], q: f64) -> DVec3 {
    // The concentric disc keeps strata; r^2 is uniform, so w = q r^2 is the
    // uniform height below the pole.
    let p = disc(u);
    let r2 = p.length_squared();
    let w = q * r2;
    let cos = 1.0 - w;
    // sin^2 = w (2 - w); scaled so that (x, y) = p sin / r without a division.
    let k = (q * (2.0 - w).max(0.0)).sqrt();
    DVec3::new(p.x * k, p.y * k, cos)
}

/// Pdf per solid angle of [`cone`]; infinite for `q = 0`.
#[inline]
pub fn cone_pdf(q: f64) -> f64 {
    1.0 / (TAU * q)
}

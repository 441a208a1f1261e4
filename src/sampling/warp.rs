//! Maps from the unit square to directions and points, with their pdfs and
//! their derivatives.
//!
//! The derivatives are those of the maps as they are computed. They jump where
//! the concentric map folds, on the diagonals of the square, and they may be
//! infinite at its border, where a rim is reached at a right angle.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

use glam::{DVec2, DVec3};

use crate::numeric::{VectorPair, trig};

/// A mapped point and its derivatives by the two coordinates of the square.
#[derive(Clone, Copy, Debug)]
pub struct Mapped<T> {
    /// The point.
    pub at: T,
    /// Its derivatives; their third coordinates are zero in the plane.
    pub by: VectorPair,
}

/// A point of the unit disc, uniform; the concentric map keeps strata
/// together (Shirley and Chiu, JGT 2(3), 1997). Pdf per area: 1/pi.
#[inline]
pub fn disc(u: [f64; 2]) -> DVec2 {
    disc_mapped(u).at
}

/// [`disc`] with its derivatives.
#[inline]
pub fn disc_mapped(u: [f64; 2]) -> Mapped<DVec2> {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    // The radius is the coordinate of larger magnitude, the angle from its
    // axis is the ratio of the two. Which one it is cannot be foreseen: each
    // number is selected by itself, so that no branch guesses.
    let wide = a.abs() > b.abs();
    let pick = |if_wide: f64, otherwise: f64| if wide { if_wide } else { otherwise };
    let (long, short) = (pick(a, b), pick(b, a));
    // At the centre the derivatives are those of one of the sectors.
    let ratio = short / if long == 0.0 { 1.0 } else { long };
    let turn = FRAC_PI_4 * ratio;
    // At most an eighth of a turn: sine and cosine need no reduction there.
    let (sin, cos) = trig::sin_cos_octant(turn);
    // Derivatives by the long and the short coordinate of what lies along
    // (first) and across the long axis: of r cos and r sin, where
    // r d(turn) = pi/4 (d(short) - ratio d(long)). The factor 2 is that of a
    // and b.
    let along = DVec2::new(2.0 * (cos + sin * turn), -2.0 * FRAC_PI_4 * sin);
    let across = DVec2::new(2.0 * (sin - cos * turn), 2.0 * FRAC_PI_4 * cos);
    let (x, y) = (long * cos, long * sin);
    Mapped {
        at: DVec2::new(pick(x, y), pick(y, x)),
        by: VectorPair {
            x: DVec2::new(pick(along.x, across.y), pick(along.y, across.x)),
            y: DVec2::new(pick(across.x, along.y), pick(across.y, along.x)),
            z: DVec2::ZERO,
        },
    }
}

/// A direction around +z with density proportional to its cosine. Pdf per
/// solid angle: [`cosine_hemisphere_pdf`].
#[inline]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    cosine_hemisphere_mapped(u).at
}

/// [`cosine_hemisphere`] with its derivatives.
#[inline]
pub fn cosine_hemisphere_mapped(u: [f64; 2]) -> Mapped<DVec3> {
    let p = disc_mapped(u);
    // 1 - r^2 may round below zero at the rim.
    let z = (1.0 - p.at.length_squared()).max(0.0).sqrt();
    Mapped {
        at: p.at.extend(z),
        by: VectorPair {
            z: (p.by.x * p.at.x + p.by.y * p.at.y) * (-1.0 / z),
            ..p.by
        },
    }
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
    cone_mapped(u, q).0.at
}

/// [`cone`] with its derivatives by `u`, and its derivative by `q`.
#[inline]
pub fn cone_mapped(u: [f64; 2], q: f64) -> (Mapped<DVec3>, DVec3) {
    // The concentric disc keeps strata; r^2 is uniform, so w = q r^2 is the
    // uniform height below the pole.
    let p = disc_mapped(u);
    let r2 = p.at.length_squared();
    let w = q * r2;
    let rest = (2.0 - w).max(0.0);
    // sin^2 = w (2 - w); scaled so that (x, y) = p sin / r without a division.
    let k = (q * rest).sqrt();
    // k^2 = q (2 - q r^2), so 2 k dk = (rest - w) dq - q^2 d(r^2).
    let half = 0.5 / k;
    let dr2 = (p.by.x * p.at.x + p.by.y * p.at.y) * 2.0;
    let dk = dr2 * (-q * q * half);
    let by = VectorPair {
        x: p.by.x * k + dk * p.at.x,
        y: p.by.y * k + dk * p.at.y,
        z: dr2 * -q,
    };
    let by_q = (p.at * ((rest - w) * half)).extend(-r2);
    let at = (p.at * k).extend(1.0 - w);
    (Mapped { at, by }, by_q)
}

/// Pdf per solid angle of [`cone`]; infinite for `q = 0`.
#[inline]
pub fn cone_pdf(q: f64) -> f64 {
    1.0 / (TAU * q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Sequence};

    /// Squares away from the folds of the concentric map and from the border.
    fn points() -> impl Iterator<Item = [f64; 2]> {
        let sequence = Sequence::new(1, Purpose::Pilot, 0, 0);
        (0..400).filter_map(move |i| {
            let u = sequence.at(i).next_2d();
            let [a, b] = u.map(|x| 2.0 * x - 1.0);
            let smooth = (a.abs() - b.abs()).abs() > 1e-3 && a.abs().max(b.abs()) < 0.97;
            smooth.then_some(u)
        })
    }

    /// Central differences of `f`, of step 1e-5: their error is the third
    /// derivative over 6e10, below 1e-6 away from the border.
    fn assert_derivatives(f: impl Fn([f64; 2]) -> Mapped<DVec3>, what: &str) {
        const H: f64 = 1e-5;
        for u in points() {
            let by = f(u).by.to_array();
            for j in 0..2 {
                let moved = |h: f64| {
                    let mut v = u;
                    v[j] += h;
                    f(v).at
                };
                let expected = (moved(H) - moved(-H)) / (2.0 * H);
                let off = (by[j] - expected).length();
                assert!(off < 1e-5, "{what} at {u:?}: {} off by {off:e}", by[j]);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_maps() {
        let flat = |u| {
            let d = disc_mapped(u);
            Mapped {
                at: d.at.extend(0.0),
                by: d.by,
            }
        };
        assert_derivatives(flat, "disc");
        assert_derivatives(cosine_hemisphere_mapped, "hemisphere");
        for q in [1e-6, 0.1, 1.0, 1.9, 2.0] {
            assert_derivatives(|u| cone_mapped(u, q).0, "cone");
            let size = |u: [f64; 2]| {
                let (m, by_q) = cone_mapped(u, q);
                let h = 1e-5 * q;
                let low = (q - h, cone_mapped(u, q - h).0.at);
                let high = (q, m.at);
                let expected = (high.1 - low.1) / (high.0 - low.0);
                (by_q - expected).length() / (1.0 + by_q.length())
            };
            // A one-sided difference, for 2 is the largest cone.
            for u in points() {
                assert!(size(u) < 1e-3, "cone by its size at {u:?}: {}", size(u));
            }
        }
    }

    /// Of the parallelogram with these sides.
    fn area_of(by: VectorPair) -> f64 {
        let [a, b] = by.to_array();
        a.cross(b).length()
    }

    /// The area of the image of a cell is one over the pdf.
    #[test]
    fn areas_are_inverse_densities() {
        for u in points() {
            let area = area_of(disc_mapped(u).by);
            assert!((area / std::f64::consts::PI - 1.0).abs() < 1e-12, "disc");
            for q in [1e-9, 0.1, 1.9] {
                let area = area_of(cone_mapped(u, q).0.by) * cone_pdf(q);
                assert!((area - 1.0).abs() < 1e-10, "cone {q}: {area}");
            }
            let h = cosine_hemisphere_mapped(u);
            let area = area_of(h.by) * cosine_hemisphere_pdf(h.at.z);
            assert!((area - 1.0).abs() < 1e-10, "hemisphere: {area}");
        }
        let centre = area_of(disc_mapped([0.5; 2]).by);
        assert_eq!(centre, std::f64::consts::PI, "centre");
    }
}

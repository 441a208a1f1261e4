//! Maps from the unit square to directions and points, with their pdfs and
//! with the patch that a small cell of the square covers.
//!
//! A patch has the area of the cell's image, but not its shape: the concentric
//! map stretches cells and folds them on the diagonals of the square, and light
//! that is spread by such cells shows lines where their shape changes at once.
//! What the maps cover is round, so a patch is a square of two sides of equal
//! length, one towards the rim and one along it.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, PI, TAU};

use glam::{DVec2, DVec3};

use crate::numeric::{VectorPair, trig};

/// A mapped point and the patch around it that a cell of the unit square
/// covers.
#[derive(Clone, Copy, Debug)]
pub struct Mapped<T> {
    /// The point.
    pub at: T,
    /// The sides of the patch, for a cell as large as the whole square; their
    /// third coordinates are zero in the plane. Both have the same length, the
    /// root of one over the pdf, and are perpendicular to each other.
    pub by: VectorPair,
    /// How far the patch could be moved along either side without leaving what
    /// is covered, at least, in units of that side.
    pub room: DVec2,
}

impl<T> Mapped<T> {
    /// What the whole square is mapped to.
    pub fn fixed(at: T) -> Self {
        Self {
            at,
            by: VectorPair::ZERO,
            room: DVec2::INFINITY,
        }
    }
}

/// A point of the unit disc, uniform; the concentric map keeps strata
/// together (Shirley and Chiu, JGT 2(3), 1997). Pdf per area: 1/pi.
#[inline]
pub fn disc(u: [f64; 2]) -> DVec2 {
    disc_mapped(u).at
}

/// [`disc`] with its patch.
#[inline]
pub fn disc_mapped(u: [f64; 2]) -> Mapped<DVec2> {
    Polar::of(u).on_disc()
}

/// Where the concentric map sends a point of the square.
#[derive(Clone, Copy)]
struct Polar {
    /// Unit vector from the centre to the point or from the point to the centre.
    axis: DVec2,
    /// Coordinate along it; its magnitude, at most 1, is the radius.
    along: f64,
}

impl Polar {
    #[inline]
    fn of(u: [f64; 2]) -> Self {
        let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
        // The radius is the coordinate of larger magnitude, the angle from its
        // axis is the ratio of the two. Which one it is cannot be foreseen: each
        // number is selected by itself, so that no branch guesses.
        let wide = a.abs() > b.abs();
        let pick = |if_wide: f64, otherwise: f64| if wide { if_wide } else { otherwise };
        let (long, short) = (pick(a, b), pick(b, a));
        // At the centre any direction serves.
        let ratio = short / if long == 0.0 { 1.0 } else { long };
        // At most an eighth of a turn: sine and cosine need no reduction there.
        let (sin, cos) = trig::sin_cos_octant(FRAC_PI_4 * ratio);
        Self {
            axis: DVec2::new(pick(cos, sin), pick(sin, cos)),
            along: long,
        }
    }

    #[inline]
    fn at(&self) -> DVec2 {
        self.axis * self.along
    }

    #[inline]
    fn on_disc(&self) -> Mapped<DVec2> {
        let edge = PI.sqrt();
        let (e, f) = (self.axis * edge, self.axis.perp() * edge);
        Mapped {
            at: self.at(),
            by: VectorPair::from([e.extend(0.0), f.extend(0.0)]),
            room: self.room(),
        }
    }

    /// The way to the rim and half the chord across it, in units of a patch's
    /// side. On a cap of a sphere, which the disc covers evenly, the ways are
    /// longer than on the disc and the sides are not.
    #[inline]
    fn room(&self) -> DVec2 {
        let r = self.along.abs();
        DVec2::new(1.0 - r, ((1.0 - r) * (1.0 + r)).sqrt()) * (1.0 / PI.sqrt())
    }
}

/// A direction around +z with density proportional to its cosine. Pdf per
/// solid angle: [`cosine_hemisphere_pdf`].
#[inline]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    cosine_hemisphere_mapped(u).at
}

/// [`cosine_hemisphere`] with its patch, which is as large as the cosine is
/// small; at the rim it is not finite.
#[inline]
pub fn cosine_hemisphere_mapped(u: [f64; 2]) -> Mapped<DVec3> {
    let p = Polar::of(u);
    let z = ((1.0 - p.along) * (1.0 + p.along)).sqrt();
    let edge = (PI / z).sqrt();
    Mapped {
        at: p.at().extend(z),
        by: VectorPair::from([
            (p.axis * z).extend(-p.along) * edge,
            p.axis.perp().extend(0.0) * edge,
        ]),
        // The horizon is further off than the sine of its height.
        room: DVec2::new(z, 1.0) / edge,
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

/// [`cone`] with its patch, and its derivative by `q`.
#[inline]
pub fn cone_mapped(u: [f64; 2], q: f64) -> (Mapped<DVec3>, DVec3) {
    // The concentric disc keeps strata; r^2 is uniform, so w = q r^2 is the
    // uniform height below the pole.
    let p = Polar::of(u);
    let r2 = p.along * p.along;
    let w = q * r2;
    let rest = (2.0 - w).max(0.0);
    // sin^2 = w (2 - w); scaled so that (x, y) = p sin / r without a division.
    let k = (q * rest).sqrt();
    // k^2 = q (2 - q r^2), so 2 k dk = (rest - w) dq.
    let by_q = (p.at() * ((rest - w) * (0.5 / k))).extend(-r2);
    let edge = (TAU * q).sqrt();
    let mapped = Mapped {
        at: (p.at() * k).extend(1.0 - w),
        by: VectorPair::from([
            (p.axis * (1.0 - w)).extend(-p.along * k) * edge,
            p.axis.perp().extend(0.0) * edge,
        ]),
        room: p.room(),
    };
    (mapped, by_q)
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

    /// The patch lies in the plane of the derivatives and has their area; its
    /// sides are equal and perpendicular, the second one leads along the rim:
    /// neither nearer to the centre nor further away.
    ///
    /// Central differences of `f`, of step 1e-5: their error is the third
    /// derivative over 6e10, below 1e-6 away from the border.
    fn assert_patches(f: impl Fn([f64; 2]) -> Mapped<DVec3>, what: &str) {
        const H: f64 = 1e-5;
        for u in points() {
            let Mapped { at, by, .. } = f(u);
            let [s, t] = by.to_array();
            let [a, b] = [[H, 0.0], [0.0, H]].map(|[h, k]| {
                let [high, low] = [1.0, -1.0].map(|x| f([u[0] + x * h, u[1] + x * k]).at);
                (high - low) / (2.0 * H)
            });
            let (patch, cell) = (s.cross(t), a.cross(b));
            // The concentric map turns the other way where one coordinate leads.
            let off = (patch - cell).length().min((patch + cell).length());
            assert!(
                off < 1e-5 * (1.0 + cell.length()),
                "{what} at {u:?}: {patch}, {cell}"
            );
            let skew = s.dot(t).abs() + (s.length_squared() - t.length_squared()).abs();
            assert!(
                skew < 1e-12 * s.length_squared(),
                "{what} at {u:?}: {s}, {t}"
            );
            let outwards = t.dot(DVec3::new(at.x, at.y, 0.0)).abs() + t.z.abs();
            assert!(outwards < 1e-12 * t.length(), "{what} at {u:?}: {t}");
        }
    }

    #[test]
    fn patches_are_even_cells_of_the_maps() {
        let flat = |u| {
            let d = disc_mapped(u);
            Mapped {
                at: d.at.extend(0.0),
                by: d.by,
                room: d.room,
            }
        };
        assert_patches(flat, "disc");
        assert_patches(cosine_hemisphere_mapped, "hemisphere");
        for q in [1e-6, 0.1, 1.0, 1.9, 2.0] {
            assert_patches(|u| cone_mapped(u, q).0, "cone");
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
            assert!((area / PI - 1.0).abs() < 1e-12, "disc");
            for q in [1e-9, 0.1, 1.9] {
                let area = area_of(cone_mapped(u, q).0.by) * cone_pdf(q);
                assert!((area - 1.0).abs() < 1e-10, "cone {q}: {area}");
            }
            let h = cosine_hemisphere_mapped(u);
            let area = area_of(h.by) * cosine_hemisphere_pdf(h.at.z);
            assert!((area - 1.0).abs() < 1e-10, "hemisphere: {area}");
        }
        let centre = area_of(disc_mapped([0.5; 2]).by);
        assert!((centre / PI - 1.0).abs() < 1e-12, "centre: {centre}");
    }
}

//! Affine maps between a shape's own space and the world.

use glam::{DAffine3, DMat3, DVec3};

use super::{Aabb, BoundingSphere, turning::outer};
use crate::numeric::{U, gamma};

/// An invertible affine map from object space to world space.
///
/// Points go back to object space as `L^-1 (p - translation)`: the difference
/// is formed first, so that an object far from the origin loses nothing but
/// what the world coordinates have lost already.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    linear: DMat3,
    inverse: DMat3,
    translation: DVec3,
    flips: bool,
    similarity: Option<f64>,
}

impl Transform {
    /// `None` if the map is not finite, or singular as far as `f64` can
    /// tell: its determinant is not larger than the rounding error of
    /// computing it from the matrix's own terms. Non-uniform scales of any
    /// ratio are therefore fine.
    pub fn new(map: DAffine3) -> Option<Self> {
        let m = map.matrix3;
        if !map.is_finite() {
            return None;
        }
        let products = |a: f64, b: f64, c: f64| (a * b * c, (a * b * c).abs());
        let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
        let terms = [
            products(x.x, y.y, z.z),
            products(y.x, z.y, x.z),
            products(z.x, x.y, y.z),
            products(-z.x, y.y, x.z),
            products(-x.x, z.y, y.z),
            products(-y.x, x.y, z.z),
        ];
        let det: f64 = terms.iter().map(|t| t.0).sum();
        let permanent: f64 = terms.iter().map(|t| t.1).sum();
        // Two roundings per product, five in the sum, and one per matrix
        // entry: an entry that was itself computed is no better than that.
        let singular = det.is_nan() || det.abs() <= gamma(10) * permanent;
        let inverse = m.inverse();
        (!singular && inverse.is_finite()).then_some(Self {
            linear: m,
            inverse,
            translation: map.translation,
            flips: det < 0.0,
            similarity: scale_of_similarity(m),
        })
    }

    /// True if the map mirrors: right-handed becomes left-handed.
    pub fn flips(&self) -> bool {
        self.flips
    }

    /// The factor by which the map stretches all vectors alike, if it does to
    /// rounding.
    #[inline]
    pub fn similarity(&self) -> Option<f64> {
        self.similarity
    }

    /// An object point in the world.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.translation
    }

    /// An object vector in the world; its length changes.
    #[inline]
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.linear * v
    }

    /// An object normal in the world, of unit length. An outward normal stays
    /// outward, also under a mirroring map.
    #[inline]
    pub fn normal(&self, n: DVec3) -> DVec3 {
        unit(self.inverse.transpose() * n)
    }

    /// True if two object normals are on the same side of each other's plane
    /// in the world: the map may open the angle between them.
    pub(super) fn agree(&self, a: DVec3, b: DVec3) -> bool {
        self.normal(a).dot(self.normal(b)) > 0.0
    }

    /// The derivative of a unit normal by the place on a surface, from object
    /// space to the world, where the normal is `n`.
    pub(super) fn turning(&self, own: DMat3, n: DVec3) -> DMat3 {
        // The object normal comes back as M^T n, and has unit length after
        // division by the factor by which M^-T has stretched it.
        let shrunk = (self.linear.transpose() * n).length();
        let turned = self.inverse.transpose() * own * self.inverse * shrunk;
        // Normalising takes away what is along the normal.
        turned - outer(n, turned.transpose() * n)
    }

    /// A world point in object space.
    #[inline]
    pub fn inverse_point(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.translation)
    }

    /// A world vector in object space; its length changes.
    #[inline]
    pub fn inverse_vector(&self, v: DVec3) -> DVec3 {
        self.inverse * v
    }

    /// A world normal in object space, of unit length.
    #[inline]
    pub fn inverse_normal(&self, n: DVec3) -> DVec3 {
        unit(self.linear.transpose() * n)
    }

    /// Bound on the error along any world axis of `point(p)` if `p` is off
    /// by at most `error` along any axis (pbrt 4th ed., section 6.8). The
    /// bound also covers the way back, so that an origin pushed out by it
    /// arrives in object space on the side to which it was pushed.
    pub fn point_error(&self, p: DVec3, error: f64) -> f64 {
        let forward = absolute(self.linear);
        let size = forward * p.abs();
        let there = gamma(3) * (size + self.translation.abs())
            + (1.0 + gamma(3)) * (forward * DVec3::splat(error));
        // Back: one difference, then a product of three terms whose entries
        // carry the error of the inversion (a cofactor over a determinant).
        let back = forward * (absolute(self.inverse) * (size * (U + gamma(12))));
        (there + back).max_element()
    }

    /// The largest factor by which the map stretches a vector.
    pub fn max_stretch(&self) -> f64 {
        // Eigenvalues of L^T L by Jacobi rotations; scaled to avoid overflow.
        let scale = absolute(self.linear)
            .to_cols_array()
            .into_iter()
            .fold(0.0, f64::max);
        let l = self.linear * (1.0 / scale);
        let gram = l.transpose() * l;
        // The Gram matrix and about nine rotations of six roundings each.
        scale * largest_eigenvalue(gram).sqrt() * (1.0 + gamma(64))
    }

    /// A bound on the factor by which the way back stretches a vector: the
    /// Frobenius norm of the inverse.
    pub fn inverse_stretch(&self) -> f64 {
        let squares: f64 = self.inverse.to_cols_array().iter().map(|x| x * x).sum();
        squares.sqrt() * (1.0 + gamma(12))
    }

    /// The smallest box around the image of a box.
    pub fn bounds(&self, b: &Aabb) -> Aabb {
        if b.is_empty() {
            return Aabb::EMPTY;
        }
        let world = Aabb::around(b.corners().map(|c| self.point(c)));
        world.padded(self.point_error(b.min.abs().max(b.max.abs()), 0.0))
    }

    /// A box around what is sent into a box.
    pub fn inverse_bounds(&self, b: &Aabb) -> Aabb {
        let own = Aabb::around(b.corners().map(|c| self.inverse_point(c)));
        // What `inverse_point` rounds, seen from the world, is a rounding of the
        // world's coordinates and of the shift.
        let far = b.max_abs() + self.point(DVec3::ZERO).abs().max_element();
        own.padded(gamma(16) * (own.max_abs() + far * self.inverse_stretch()))
    }

    /// A sphere around the image of a sphere.
    pub fn sphere(&self, s: &BoundingSphere) -> BoundingSphere {
        BoundingSphere {
            center: self.point(s.center),
            // Three axes, hence at most twice the error along one.
            radius: self.max_stretch() * s.radius + 2.0 * self.point_error(s.center, 0.0),
        }
    }

    /// The box around the image of a sphere: exact, since a linear map sends
    /// the unit sphere to an ellipsoid whose half-widths are the lengths of
    /// the matrix's rows.
    pub fn sphere_bounds(&self, s: &BoundingSphere) -> Aabb {
        let rows = self.linear.transpose();
        let half = DVec3::new(
            rows.x_axis.length(),
            rows.y_axis.length(),
            rows.z_axis.length(),
        ) * s.radius;
        let center = self.point(s.center);
        let margin = self.point_error(s.center.abs() + DVec3::splat(s.radius), 0.0);
        Aabb {
            min: center - half,
            max: center + half,
        }
        .padded(margin)
    }
}

/// A vector's direction; scaled by a power of two first, so that squares
/// neither overflow nor vanish. Zero stays zero.
#[inline]
pub(super) fn unit(v: DVec3) -> DVec3 {
    let scale = power_of_two_near(v.abs().max_element());
    (v * (1.0 / scale)).normalize_or_zero()
}

/// The power of two at or below `x`, within 2^1000 and its inverse; 1 for zero
/// and for what is not finite.
#[inline]
pub(super) fn power_of_two_near(x: f64) -> f64 {
    const LEAST: f64 = f64::from_bits((1023 - 1000) << 52);
    const MOST: f64 = f64::from_bits((1023 + 1000) << 52);
    if x > 0.0 && x.is_finite() {
        // Without its mantissa a float is a power of two, or zero where it
        // lies below the least normal one.
        f64::from_bits(x.to_bits() >> 52 << 52).clamp(LEAST, MOST)
    } else {
        1.0
    }
}

/// The factor by which a matrix stretches all vectors; `None` if it does not
/// treat them alike. A rotation times a scale, multiplied by another one, is
/// about sixteen roundings from exact.
fn scale_of_similarity(m: DMat3) -> Option<f64> {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    let [x, y, z] = columns.map(DVec3::length_squared);
    let off = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| columns[i].dot(columns[j]).abs());
    let uneven = (x - y).abs().max((y - z).abs()).max((z - x).abs());
    let noise = gamma(16) * x;
    let even = uneven <= noise && off.into_iter().all(|d| d <= noise);
    even.then(|| x.sqrt())
}

fn absolute(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// The largest eigenvalue of a symmetric matrix, by cyclic Jacobi sweeps
/// (Golub and Van Loan, *Matrix Computations*, section 8.5).
fn largest_eigenvalue(m: DMat3) -> f64 {
    let mut a = m.to_cols_array_2d();
    // Convergence is quadratic: four sweeps of a 3 x 3 matrix reach rounding.
    for _ in 0..6 {
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            a[p][p] -= t * a[p][q];
            a[q][q] += t * a[p][q];
            a[p][q] = 0.0;
            a[q][p] = 0.0;
            let (rp, rq) = (a[r][p], a[r][q]);
            a[r][p] = c * rp - s * rq;
            a[r][q] = s * rp + c * rq;
            a[p][r] = a[r][p];
            a[q][r] = a[r][q];
        }
    }
    a[0][0].max(a[1][1]).max(a[2][2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use proptest::prelude::*;

    fn any_transform() -> impl Strategy<Value = DAffine3> {
        (
            prop::array::uniform3(-2.0..2.0f64),
            prop::array::uniform3(-3.0..3.0f64),
            prop::array::uniform3(any::<bool>()),
            prop::array::uniform3(-1e3..1e3f64),
        )
            .prop_map(|(scale, turn, mirror, shift)| {
                let s = std::array::from_fn(|i| {
                    libm::exp10(scale[i]) * if mirror[i] { -1.0 } else { 1.0 }
                });
                DAffine3::from_scale_rotation_translation(
                    DVec3::from_array(s),
                    DQuat::from_scaled_axis(DVec3::from_array(turn)),
                    DVec3::from_array(shift),
                )
            })
    }

    #[test]
    fn singular_and_non_finite_maps_are_refused() {
        let turn = DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(1.3);
        for scale in [
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::ZERO,
            DVec3::new(1.0, f64::NAN, 1.0),
            DVec3::new(f64::INFINITY, 1.0, 1.0),
        ] {
            let flat = DAffine3::from_quat(turn) * DAffine3::from_scale(scale);
            assert!(Transform::new(flat).is_none(), "{scale}");
            // A rotation on the other side leaves rounding noise, not zeros.
            let noisy = flat * DAffine3::from_quat(turn);
            assert!(Transform::new(noisy).is_none(), "{scale}, turned");
        }
        let extreme = DAffine3::from_scale(DVec3::new(1e-8, 1.0, 1e8));
        assert!(Transform::new(extreme).is_some(), "extreme but regular");
    }

    #[test]
    fn powers_of_two_are_at_or_below() {
        for k in -1000..1000 {
            let power = libm::exp2(f64::from(k));
            for x in [power, power * 1.3, (power * 2.0).next_down()] {
                assert_eq!(power_of_two_near(x), power, "{x:e}");
            }
        }
        let [least, most] = [-1000.0, 1000.0].map(libm::exp2);
        assert_eq!(power_of_two_near(5e-324), least);
        assert_eq!(power_of_two_near(f64::MAX), most);
        for x in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            assert_eq!(power_of_two_near(x), 1.0, "{x}");
        }
    }

    #[test]
    fn outward_normals_stay_outward_under_mirroring() {
        let mirror = Transform::new(DAffine3::from_scale(DVec3::new(-1.0, 2.0, 1.0))).unwrap();
        assert!(mirror.flips());
        let p = DVec3::new(0.6, 0.0, 0.8);
        assert!(mirror.normal(p).dot(mirror.point(p)) > 0.0);
        assert_eq!(mirror.normal(DVec3::X), DVec3::NEG_X);
    }

    proptest! {
        #[test]
        fn there_and_back_within_the_bound(map in any_transform(), p in prop::array::uniform3(-10.0..10.0f64)) {
            let t = Transform::new(map).unwrap();
            let p = DVec3::from_array(p);
            let w = t.point(p);
            let again = t.point(t.inverse_point(w));
            let off = (again - w).abs().max_element();
            prop_assert!(off <= t.point_error(p, 0.0), "{off:e}");
        }

        #[test]
        fn normals_stay_normal(map in any_transform(), a in prop::array::uniform3(-1.0..1.0f64), b in prop::array::uniform3(-1.0..1.0f64)) {
            let t = Transform::new(map).unwrap();
            let (a, b) = (DVec3::from_array(a), DVec3::from_array(b));
            let n = a.cross(b);
            prop_assume!(n.length() > 1e-3);
            let world = t.normal(n);
            for v in [a, b] {
                let v = t.vector(v);
                prop_assert!(world.dot(v).abs() <= 1e-11 * v.length());
            }
            prop_assert!((world.length() - 1.0).abs() < 1e-14);
            prop_assert!(t.inverse_normal(world).dot(n.normalize()) > 1.0 - 1e-9);
        }

        #[test]
        fn stretch_is_reached_and_never_exceeded(map in any_transform(), v in prop::array::uniform3(-1.0..1.0f64)) {
            let t = Transform::new(map).unwrap();
            let v = DVec3::from_array(v);
            prop_assume!(v.length() > 1e-3);
            let bound = t.max_stretch();
            prop_assert!(t.vector(v).length() <= bound * v.length() * (1.0 + 1e-14));
            // The power method finds the stretch from below.
            let mut w = v;
            for _ in 0..20_000 {
                w = unit(t.linear.transpose() * t.vector(w));
            }
            let reached = t.vector(w).length();
            prop_assert!(reached >= bound * (1.0 - 1e-3), "{reached} of {bound}");
        }

        #[test]
        fn sphere_and_box_bounds_contain_images(map in any_transform(), d in prop::array::uniform3(-1.0..1.0f64)) {
            let t = Transform::new(map).unwrap();
            let d = DVec3::from_array(d);
            prop_assume!(d.length() > 1e-3);
            let s = BoundingSphere { center: DVec3::new(0.3, -2.0, 1.0), radius: 0.7 };
            let image = t.point(s.center + d.normalize() * s.radius);
            prop_assert!(t.sphere(&s).contains(image));
            prop_assert!(t.sphere_bounds(&s).contains(image));
            let b = Aabb { min: s.center - DVec3::splat(0.7), max: s.center + DVec3::splat(0.7) };
            prop_assert!(t.bounds(&b).contains(image));
        }
    }
}

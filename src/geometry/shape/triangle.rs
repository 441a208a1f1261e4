//! The triangle, and the watertight test that meshes share with it.
//!
//! Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1),
//! 2013: vertices are moved into a space in which the ray is the z axis, and
//! the signs of three edge functions decide. Two triangles that share an edge
//! see the same moved vertices, so that they cannot disagree about the side
//! on which the ray passes, provided that the signs are right: where a
//! value is zero, perhaps by rounding, all three are computed again with
//! compensated products.

use glam::DVec3;

use super::{Pieces, Place, ShapeHit, ShapePoint, Surface};
use crate::{
    geometry::{Aabb, BoundingSphere, Turning, transform::power_of_two_near},
    numeric::{U, difference_of_products, gamma},
};

/// One triangle; its normal follows the counter-clockwise winding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    vertices: [DVec3; 3],
    normal: DVec3,
}

impl Triangle {
    /// A triangle whose area is above zero by more than the rounding of its
    /// edges.
    pub fn new(a: DVec3, b: DVec3, c: DVec3) -> Self {
        let vertices = [a, b, c];
        Self {
            vertices,
            normal: triangle_normal(&vertices).unwrap_or(DVec3::Z),
        }
    }

    /// The vertices.
    pub fn vertices(&self) -> [DVec3; 3] {
        self.vertices
    }

    /// Unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }
}

impl Surface for Triangle {
    #[inline]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        if leaving.is_some() {
            return None;
        }
        ShearedRay::new(origin, dir)
            .hit(&self.vertices, t_max)
            .map(|(t, uv)| ShapeHit { t, part: 0, uv })
    }

    #[inline]
    fn surface(&self, _origin: DVec3, _dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let (p, error) = point_at(&self.vertices, hit.uv);
        ShapePoint {
            p,
            error,
            ng: self.normal,
            ns: self.normal,
        }
    }

    fn bounds(&self) -> Option<Aabb> {
        let b = Aabb::around(self.vertices);
        Some(b.padded(gamma(16) * b.max_abs()))
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        let mut sphere = BoundingSphere::around(self.vertices);
        sphere.radius += gamma(16) * Aabb::around(self.vertices).max_abs();
        Some(sphere)
    }

    #[inline]
    fn turning(&self, _part: u32, _uv: [f64; 2], _at: impl Fn() -> Place) -> Turning {
        Turning::Flat
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        (p - self.vertices[0]).dot(self.normal).abs()
    }

    fn pieces(&self) -> Pieces {
        Pieces::FLAT
    }
}

/// The unit normal of a triangle; `None` if it is degenerate: not finite, or
/// of an area within rounding of zero, so that its normal means nothing.
pub(in crate::geometry) fn triangle_normal(v: &[DVec3; 3]) -> Option<DVec3> {
    let (e, f) = scaled_edges(v);
    let n = cross(e, f);
    let length = n.length();
    // Each edge has rounded once, which moves the product by up to
    // 2 U |e| |f|, compensation another 2 U.
    let noise = 4.0 * U * e.length() * f.length();
    (length.is_finite() && length > noise).then(|| n / length)
}

/// [`triangle_normal`] of a triangle that is known to have one.
#[inline]
pub(in crate::geometry) fn sound_normal(v: &[DVec3; 3]) -> DVec3 {
    let (e, f) = scaled_edges(v);
    let n = cross(e, f);
    n / n.length()
}

/// The edges from the first vertex, scaled by powers of two, so that products
/// neither overflow nor vanish.
#[inline]
fn scaled_edges(v: &[DVec3; 3]) -> (DVec3, DVec3) {
    let scaled = |e: DVec3| e * (1.0 / power_of_two_near(e.abs().max_element()));
    (scaled(v[1] - v[0]), scaled(v[2] - v[0]))
}

/// The vector product, compensated.
#[inline]
fn cross(e: DVec3, f: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(e.y, f.z, e.z, f.y),
        difference_of_products(e.z, f.x, e.x, f.z),
        difference_of_products(e.x, f.y, e.y, f.x),
    )
}

/// The point with barycentric weights `uv`, and its error. The weights are
/// never negative, so that the point lies within the triangle whatever their
/// own error; forming it takes an edge, a product and two sums.
#[inline]
pub(in crate::geometry) fn point_at(v: &[DVec3; 3], uv: [f64; 2]) -> (DVec3, f64) {
    let along = (v[1] - v[0]) * uv[0];
    let across = (v[2] - v[0]) * uv[1];
    let p = v[0] + (along + across);
    let spread = along.abs() + across.abs();
    (p, (gamma(3) * spread + U * p.abs()).max_element())
}

/// A ray prepared for the watertight test.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    origin: DVec3,
    /// Direction over its largest component, without that component.
    shear: [f64; 2],
    /// One over the largest component.
    scale: f64,
    /// Index of the largest component.
    axis: usize,
}

impl ShearedRay {
    /// Prepares a ray whose direction is not zero.
    #[inline]
    pub fn new(origin: DVec3, dir: DVec3) -> Self {
        let size = dir.abs();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let d = dir.to_array();
        let scale = 1.0 / d[axis];
        let shear = [d[(axis + 1) % 3] / d[axis], d[(axis + 2) % 3] / d[axis]];
        Self {
            origin,
            shear,
            scale,
            axis,
        }
    }

    /// Where the ray starts.
    #[inline]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Index of the direction's largest component.
    #[inline]
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// The hit with `0 < t < t_max`: its `t` and the weights of the second
    /// and third vertex.
    #[inline]
    pub fn hit(&self, v: &[DVec3; 3], t_max: f64) -> Option<(f64, [f64; 2])> {
        match self.axis {
            0 => self.hit_along::<0>(v, t_max),
            1 => self.hit_along::<1>(v, t_max),
            _ => self.hit_along::<2>(v, t_max),
        }
    }

    /// [`hit`](Self::hit) for a ray whose axis is known to be `AXIS`: for
    /// loops that settle the axis outside.
    #[allow(
        clippy::inline_always,
        reason = "the innermost loop of traversal; measured"
    )]
    #[inline(always)]
    pub fn hit_along<const AXIS: usize>(
        &self,
        v: &[DVec3; 3],
        t_max: f64,
    ) -> Option<(f64, [f64; 2])> {
        let [a, b, c] = [
            self.moved::<AXIS>(v[0]),
            self.moved::<AXIS>(v[1]),
            self.moved::<AXIS>(v[2]),
        ];
        let mut u = c[0] * b[1] - c[1] * b[0];
        let mut v = a[0] * c[1] - a[1] * c[0];
        let mut w = b[0] * a[1] - b[1] * a[0];
        let (mut least, mut most) = extremes(u, v, w);
        if least == 0.0 || most == 0.0 {
            // Rounding keeps order: a computed difference of products can be
            // zero by mistake, but never have the wrong sign.
            [u, v, w] = compensated(a, b, c);
            (least, most) = extremes(u, v, w);
        }
        if least < 0.0 && most > 0.0 {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        let z = (u * a[2] + v * b[2] + w * c[2]) * inverse;
        let t = z * self.scale;
        if !(t > 0.0 && t < t_max) {
            return None;
        }
        let nearest = (a[2] * self.scale)
            .min(b[2] * self.scale)
            .min(c[2] * self.scale);
        if nearest <= 0.0 && z.abs() <= depth_error(a, b, c, inverse) {
            return None;
        }
        Some((t, [v * inverse, w * inverse]))
    }

    /// A vertex relative to the origin, sheared so that the ray is the third
    /// axis (not scaled along it).
    #[allow(
        clippy::inline_always,
        reason = "the innermost loop of traversal; measured"
    )]
    #[inline(always)]
    fn moved<const AXIS: usize>(&self, p: DVec3) -> [f64; 3] {
        let p = (p - self.origin).to_array();
        let z = p[AXIS];
        [
            p[(AXIS + 1) % 3] - self.shear[0] * z,
            p[(AXIS + 2) % 3] - self.shear[1] * z,
            z,
        ]
    }
}

/// The smallest and the largest of three numbers, without branches:
/// `f64::min` takes several instructions to be particular about NaN, which
/// fails the tests that follow in any case.
#[inline]
fn extremes(u: f64, v: f64, w: f64) -> (f64, f64) {
    let min = |a: f64, b: f64| if a < b { a } else { b };
    let max = |a: f64, b: f64| if a > b { a } else { b };
    (min(min(u, v), w), max(max(u, v), w))
}

/// The three edge functions with signs that can be trusted down to
/// underflow.
#[cold]
fn compensated(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    let edge = |p: [f64; 3], q: [f64; 3]| difference_of_products(p[0], q[1], p[1], q[0]);
    [edge(c, b), edge(a, c), edge(b, a)]
}

/// Bound on the error of the depth of a hit on a triangle with these moved
/// vertices (pbrt 4th ed., section 6.8.7). Depth is a mean of
/// the vertices' with weights of one sign: it only matters for triangles that
/// reach behind the origin, where the bound tells in front from behind.
#[cold]
fn depth_error(a: [f64; 3], b: [f64; 3], c: [f64; 3], inverse_det: f64) -> f64 {
    let [x, y, z] = std::array::from_fn(|i| a[i].abs().max(b[i].abs()).max(c[i].abs()));
    let dz = gamma(3) * z;
    let dx = gamma(5) * (x + z);
    let dy = gamma(5) * (y + z);
    let e = 2.0 * x * y;
    let de = 2.0 * (gamma(2) * x * y + dy * x + dx * y);
    3.0 * (gamma(3) * e * z + de * z + dz * e) * inverse_det.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An edge passes the ray at a distance whose square rounds away: the
    /// plain edge function is zero, which would count as inside for the
    /// triangles on both sides. Only one of them may be met.
    #[test]
    fn signs_are_right_below_rounding() {
        let eps = f64::EPSILON;
        let (p, q) = (
            DVec3::new(1.0 + eps, 1.0, 1.0),
            DVec3::new(1.0, 1.0 - eps, 1.0),
        );
        assert_eq!(p.x * q.y - p.y * q.x, 0.0, "the truth is -eps^2");
        // Opposite corners, such that the origin's line would pass the edge
        // `pq`, extended to `-10 q`, on a known side.
        let far = q * DVec3::new(-8.0, -8.0, 1.0);
        let ray = ShearedRay::new(DVec3::ZERO, DVec3::Z);
        let left = ray
            .hit(&[p, far, DVec3::new(-1.0, 1.0, 1.0)], 9.0)
            .is_some();
        let right = ray
            .hit(&[p, far, DVec3::new(1.0, -1.0, 1.0)], 9.0)
            .is_some();
        assert!(left != right, "left {left}, right {right}");
    }

    #[test]
    fn triangles_behind_or_around_the_origin() {
        let hit = |z: [f64; 3], dir: f64| {
            let v = [
                DVec3::new(-1.0, -1.0, z[0]),
                DVec3::new(1.0, -1.0, z[1]),
                DVec3::new(0.0, 1.0, z[2]),
            ];
            ShearedRay::new(DVec3::ZERO, DVec3::Z * dir)
                .hit(&v, 10.0)
                .map(|h| h.0)
        };
        assert_eq!(hit([1.0; 3], 1.0), Some(1.0));
        assert_eq!(hit([1.0; 3], -1.0), None);
        assert_eq!(
            hit([1.0; 3], 0.5),
            Some(2.0),
            "t counts in lengths of the direction"
        );
        assert_eq!(hit([11.0; 3], 1.0), None, "beyond the limit");
        // Through the origin: too close to tell on which side.
        assert_eq!(hit([-1.0, -1.0, 1.0], 1.0), None);
        assert_eq!(
            hit([-1.0, -1.0, 1.0 + 1e-9], 1.0).map(|t| t > 0.0),
            Some(true)
        );
    }

    #[test]
    fn degenerate_means_within_rounding() {
        let normal = |c: DVec3| triangle_normal(&[DVec3::ONE, DVec3::new(2.0, 3.0, 4.0), c]);
        assert_eq!(normal(DVec3::new(3.0, 5.0, 7.0)), None, "collinear");
        assert_eq!(
            normal(DVec3::new(3.0, 5.0, 7.0f64.next_up())),
            None,
            "one rounding off"
        );
        assert!(normal(DVec3::new(3.0, 5.0, 7.0 + 1e-13)).is_some(), "thin");
        assert_eq!(normal(DVec3::new(3.0, f64::NAN, 7.0)), None);
        assert_eq!(normal(DVec3::new(3.0, f64::INFINITY, 7.0)), None);
    }
}

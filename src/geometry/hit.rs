//! What a ray meets, and how rays leave it again.

use glam::DVec3;

use crate::built;

use super::{Ray, SurfaceId};

/// A cheap hit: enough to order hits along a ray and to find the rest later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter: the distance in metres for a world-space ray.
    pub t: f64,
    /// Which surface.
    pub surface: SurfaceId,
    /// Barycentric weights of the triangle's second and third vertex; zero
    /// for other shapes.
    pub uv: [f64; 2],
}

/// A point on a surface, with its error.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position in metres, moved onto the surface where the shape allows it.
    pub p: DVec3,
    /// Bound on the distance between `p` and the true surface along any
    /// axis, in metres: one scalar, since transforms and the watertight
    /// triangle test mix the axes.
    pub error: f64,
    /// Geometric unit normal; see the room's contract for its direction.
    pub ng: DVec3,
    /// Shading unit normal, `ns . ng > 0`.
    pub ns: DVec3,
    /// The surface.
    pub surface: SurfaceId,
}

impl SurfacePoint {
    /// The shading normal; that of the geometry in a build without smooth
    /// normals.
    #[inline]
    pub fn ns(&self) -> DVec3 {
        if built::SHADING_NORMALS {
            self.ns
        } else {
            self.ng
        }
    }

    /// Whether the shading normal is another one than that of the geometry.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        built::SHADING_NORMALS && self.ns != self.ng
    }

    /// A ray leaving the point in unit direction `dir`, started on the side
    /// of the geometric normal towards which `dir` points (pbrt 4th ed.,
    /// section 6.8.6).
    #[inline]
    pub fn spawn(&self, dir: DVec3) -> Ray {
        Ray {
            origin: self.offset(dir),
            dir,
            leaving: Some(self.surface),
        }
    }

    /// A ray from the point to `target`, and the distance to it in metres.
    /// `None` if the target coincides with the point.
    #[inline]
    pub fn spawn_towards(&self, target: DVec3) -> Option<(Ray, f64)> {
        let origin = self.offset(target - self.p);
        let to = target - origin;
        let distance = to.length();
        (distance > 0.0 && distance.is_finite()).then(|| {
            (
                Ray {
                    origin,
                    dir: to / distance,
                    leaving: Some(self.surface),
                },
                distance,
            )
        })
    }

    #[inline]
    fn offset(&self, dir: DVec3) -> DVec3 {
        pushed_out(self.p, self.error, self.ng, dir)
    }
}

/// A point on a surface pushed out of its own error box, towards the side of
/// the normal `ng` on which `dir` points; each coordinate is rounded away from
/// the surface.
#[inline]
pub(super) fn pushed_out(p: DVec3, error: f64, ng: DVec3, dir: DVec3) -> DVec3 {
    let reach = error * (ng.x.abs() + ng.y.abs() + ng.z.abs());
    let side = if ng.dot(dir) < 0.0 { -reach } else { reach };
    let push = |p: f64, n: f64| next_towards(p + side * n, side * n);
    DVec3::new(push(p.x, ng.x), push(p.y, ng.y), push(p.z, ng.z))
}

/// The float after the finite `x` on the side of a positive or negative
/// `side`; `x` itself if `side` is zero. As [`f64::next_up`] and its
/// counterpart, without branches on signs, which a processor cannot foresee.
#[inline]
fn next_towards(x: f64, side: f64) -> f64 {
    // The bits of a float count its magnitude.
    let step = if (x > 0.0) == (side > 0.0) {
        1
    } else {
        u64::MAX
    };
    let moved = f64::from_bits(x.to_bits().wrapping_add(step));
    let moved = if x == 0.0 {
        f64::from_bits(1).copysign(side)
    } else {
        moved
    };
    if side == 0.0 { x } else { moved }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn next_floats_are_those_of_the_standard_library() {
        let least = f64::from_bits(1);
        for x in [0.0, least, f64::MIN_POSITIVE, 0.3, 1.0, 2.0, 1e300] {
            for x in [x, -x, x.next_up(), x.next_down()] {
                for side in [least, 1.0, 1e9] {
                    assert_eq!(next_towards(x, side), x.next_up(), "{x:e}");
                    assert_eq!(next_towards(x, -side), x.next_down(), "{x:e}");
                }
                assert_eq!(next_towards(x, 0.0), x);
                assert_eq!(next_towards(x, -0.0), x);
            }
        }
    }
}

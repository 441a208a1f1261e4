//! The sphere.
//!
//! Intersection after Haines, Guenther and Akenine-Moeller, *Precision
//! Improvements for Ray/Sphere Intersection*, Ray Tracing Gems (2019),
//! chapter 7: the discriminant from the ray's closest approach, the constant
//! term and the discriminant as products of sum and difference.

use glam::DVec3;

use super::{Pieces, Place, ShapeHit, ShapePoint, Surface};
use crate::{
    geometry::{Aabb, BoundingSphere, Transform, Turning},
    numeric::{
        U, gamma,
        quadratic::{Roots, quadratic_with_discriminant},
    },
};

/// A sphere; its normal points outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Sphere {
    /// A sphere with a radius above zero, in metres.
    pub fn new(center: DVec3, radius: f64) -> Self {
        Self { center, radius }
    }

    /// Centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Radius in metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The normal is unit up to a square, two sums, a root and a quotient;
    /// one more rounding scales it and one adds the centre.
    fn error(&self) -> f64 {
        gamma(6) * self.radius + U * (self.center.abs().max_element() + self.radius)
    }
}

impl Surface for Sphere {
    #[allow(clippy::inline_always, reason = "as there")]
    #[inline(always)]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        let from = origin - self.center;
        let a = dir.length_squared();
        let h = from.dot(dir);
        let accept = |t: f64| (t > 0.0 && t < t_max).then(|| ShapeHit::on(0, t));
        if leaving.is_some() {
            // The origin solves the equation, so that the other root is the
            // sum of both.
            return accept(-2.0 * h / a);
        }
        // Most rays miss, which squares can tell. They are compared with more
        // than their rounding, so that what is left out would be left out
        // below: outside and leaving, or passing by.
        let beyond = self.radius * self.radius * (1.0 + gamma(8));
        let start = from.length_squared();
        if h > 0.0 && start > beyond {
            return None;
        }
        let closest = (from - dir * (h / a)).length_squared();
        if closest > beyond {
            return None;
        }
        let (closest, start) = (closest.sqrt(), start.sqrt());
        let discriminant = reduced_discriminant(a, closest, self.radius);
        if discriminant.is_nan() || discriminant < 0.0 {
            return None;
        }
        // Ahead of the centre `k / q` is the nearer root; beyond it, `q / a`
        // is behind the origin. Either way that one is asked first.
        let q = -(h + discriminant.sqrt().copysign(h + 0.0));
        accept(constant_term(start, self.radius) / q).or_else(|| accept(q / a))
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        let from = origin - self.center;
        let (a, h) = (dir.length_squared(), from.dot(dir));
        let (near, far) = if leaving.is_some() {
            (0.0, -2.0 * h / a)
        } else {
            let closest = (from - dir * (h / a)).length();
            let Some(both) = crossings(a, h, closest, from.length(), self.radius) else {
                return;
            };
            both
        };
        [near, far]
            .into_iter()
            .filter(|&t| t > 0.0)
            .for_each(|t| found(ShapeHit::on(0, t)));
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let ng = ((origin - self.center) + dir * hit.t).normalize();
        ShapePoint {
            p: self.center + ng * self.radius,
            error: self.error(),
            ng,
            ns: ng,
        }
    }

    fn bounds(&self) -> Option<Aabb> {
        let b = Aabb {
            min: self.center - DVec3::splat(self.radius),
            max: self.center + DVec3::splat(self.radius),
        };
        Some(b.padded(2.0 * self.error()))
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        Some(BoundingSphere {
            center: self.center,
            radius: self.radius,
        })
    }

    #[inline]
    fn turning(&self, _part: u32, _uv: [f64; 2], _at: impl Fn() -> Place) -> Turning {
        Turning::Round {
            curvature: 1.0 / self.radius,
        }
    }

    fn bounds_under(&self, transform: &Transform) -> Option<Aabb> {
        self.bounding_sphere().map(|s| transform.sphere_bounds(&s))
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        (p.distance(self.center) - self.radius).abs()
    }

    fn pieces(&self) -> Pieces {
        Pieces::CURVED
    }
}

/// `h^2 - a k` of the quadratic of [`crossings`], as a height.
#[inline]
fn reduced_discriminant(a: f64, closest: f64, r: f64) -> f64 {
    a * ((r - closest) * (r + closest))
}

/// The `k` of the quadratic of [`crossings`].
#[inline]
fn constant_term(start: f64, r: f64) -> f64 {
    (start - r) * (start + r)
}

/// Both parameters, ascending, at which a line crosses a circle or sphere of
/// radius `r`: `a` is the squared length of its direction, `h` the product of
/// origin and direction, `closest` and `start` the distances of the point of
/// closest approach and of the origin from the centre.
#[inline]
pub(super) fn crossings(a: f64, h: f64, closest: f64, start: f64, r: f64) -> Option<(f64, f64)> {
    let discriminant = reduced_discriminant(a, closest, r);
    let k = constant_term(start, r);
    // The sign of a zero `h` chooses how the roots are rounded: adding zero
    // makes both signs the same, so that -0 in a direction changes nothing.
    match quadratic_with_discriminant(a, h + 0.0, k, discriminant) {
        Roots::Two(near, far) => Some((near, far)),
        Roots::None | Roots::One(_) => None,
    }
}

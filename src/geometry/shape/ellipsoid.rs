//! The ellipsoid.
//!
//! A unit sphere under an affine map. The map sends a ray to where the sphere
//! is round, so that a flat disc or a long needle is met as exactly as a
//! sphere: the discriminant from the closest approach and the root taken out
//! for rays that leave. A quadric with the inverse squares of the semi-axes
//! would lose digits as the square of their ratio.

use glam::{DMat3, DVec3};

use super::{Pieces, Place, ShapeHit, ShapePoint, Sphere, Surface};
use crate::{
    geometry::{Aabb, BoundingSphere, Transform, Turning},
    numeric::gamma,
};

/// An ellipsoid; its normals point outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// From the unit sphere.
    map: Transform,
    sphere: Sphere,
    longest: f64,
}

impl Ellipsoid {
    /// An ellipsoid around a centre, with semi-axes along x, y and z, all
    /// above zero, turned by a rotation; in metres. `None` if the map is
    /// singular to rounding.
    pub fn new(center: DVec3, semi_axes: DVec3, rotation: DMat3) -> Option<Self> {
        let stretch = rotation * DMat3::from_diagonal(semi_axes);
        let map = Transform::new(glam::DAffine3 {
            matrix3: stretch,
            translation: center,
        })?;
        Some(Self {
            map,
            sphere: Sphere::new(DVec3::ZERO, 1.0),
            longest: map.max_stretch(),
        })
    }

    /// A coordinate on the unit sphere is seven roundings off, the map's
    /// entries four (a rotation times a length), their products and sums
    /// three, over a sum of at most the square root of 3 times the longest
    /// semi-axis; adding the centre rounds once more. What the way back to the
    /// sphere loses does not matter, since the root at the start is taken out.
    fn error(&self) -> f64 {
        let center = self.map.point(DVec3::ZERO).abs().max_element();
        gamma(25) * self.longest + gamma(1) * (center + self.longest)
    }

    #[inline]
    fn own_ray(&self, origin: DVec3, dir: DVec3) -> (DVec3, DVec3) {
        (self.map.inverse_point(origin), self.map.inverse_vector(dir))
    }
}

impl Surface for Ellipsoid {
    #[inline]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        let (origin, dir) = self.own_ray(origin, dir);
        self.sphere.intersect(origin, dir, t_max, leaving)
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        let (origin, dir) = self.own_ray(origin, dir);
        self.sphere.crossings(origin, dir, leaving, found);
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let (origin, dir) = self.own_ray(origin, dir);
        let own = self.sphere.surface(origin, dir, hit);
        let ng = self.map.normal(own.ng);
        ShapePoint {
            p: self.map.point(own.p),
            error: self.error(),
            ng,
            ns: ng,
        }
    }

    #[inline]
    fn turning(&self, part: u32, uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        let place = at();
        self.sphere
            .turning(part, uv, || place)
            .under(&self.map, place.ns)
    }

    fn bounds(&self) -> Option<Aabb> {
        self.sphere.bounds_under(&self.map).map(|b| {
            // A sphere's own radius is exact, its points are not.
            b.padded(2.0 * self.error())
        })
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        let center = self.map.point(DVec3::ZERO);
        Some(BoundingSphere {
            center,
            radius: self.longest + 2.0 * self.error(),
        })
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn distance_bound(&self, p: DVec3, within: f64) -> f64 {
        let stretch = self.map.inverse_stretch();
        let own = self.map.inverse_point(p);
        self.sphere.distance_bound(own, within * stretch) / stretch
    }

    fn pieces(&self) -> Pieces {
        Pieces::CURVED
    }
}

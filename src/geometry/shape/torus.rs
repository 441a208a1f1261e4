//! The torus.
//!
//! A ray meets it where a polynomial of fourth degree is zero. The ray is cut
//! to the slab and the sphere around the torus first, within which the torus
//! is of size one; the signs at both ends are then known, and roots are found
//! between the turning points (`numeric::polynomial`). Each is improved by the
//! distance from the circle in the middle of the tube, which does not cancel
//! for a thin one. For a ray that leaves the surface the constant term is zero
//! and the rest is a cubic.

use glam::{DMat3, DVec2, DVec3};

use super::{Pieces, Place, ShapeHit, ShapePoint, Surface, disc::circle_half_widths, span::Span};
use crate::{
    geometry::{Aabb, BoundingSphere, Turning, transform::unit, turning::outer},
    numeric::{
        Frame, gamma,
        polynomial::{RootList, sign_changes},
    },
};

/// A ring torus; its normals point out of the tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    center: DVec3,
    across: [DVec3; 2],
    axis: DVec3,
    major: f64,
    minor: f64,
}

/// A ray in units of the major radius, across and along the axis, with a
/// direction of unit length, from the point that it reaches at `slide`.
struct Slid {
    slide: f64,
    /// One unit of the ray's own parameter in units of the caller's.
    step: f64,
    o: DVec2,
    oz: f64,
    d: DVec2,
    dz: f64,
}

impl Torus {
    /// A torus around an axis of any length but zero: the distance of the
    /// tube's middle from the centre, and the smaller radius of the tube, both
    /// above zero, in metres.
    pub fn new(center: DVec3, axis: DVec3, major: f64, minor: f64) -> Self {
        let frame = Frame::around(unit(axis));
        Self {
            center,
            across: [frame.s, frame.t],
            axis: frame.n,
            major,
            minor,
        }
    }

    #[inline]
    fn split(&self, v: DVec3) -> (DVec2, f64) {
        (
            DVec2::new(self.across[0].dot(v), self.across[1].dot(v)),
            self.axis.dot(v),
        )
    }

    fn slid(&self, origin: DVec3, dir: DVec3, leaving: bool) -> Slid {
        let from = origin - self.center;
        let slide = if leaving {
            0.0
        } else {
            -from.dot(dir) / dir.length_squared()
        };
        let length = dir.length();
        let (d, dz) = self.split(dir / length);
        let (o, oz) = self.split((from + dir * slide) / self.major);
        Slid {
            slide,
            step: self.major / length,
            o,
            oz,
            d,
            dz,
        }
    }

    /// Radius of the tube in units of the major one.
    #[inline]
    fn tube(&self) -> f64 {
        self.minor / self.major
    }

    /// All hits, in order, with their own parameter.
    fn roots(&self, ray: &Slid, leaving: bool) -> RootList {
        let Some((enter, exit)) = self.clip(ray) else {
            return RootList::default();
        };
        let begin = -ray.slide / ray.step;
        let start = enter.max(begin);
        if start >= exit {
            return RootList::default();
        }
        let tube = self.tube();
        let rho = ray.o.length();
        let (g, e) = (ray.o.dot(ray.d) + ray.oz * ray.dz, ray.o.dot(ray.d));
        let f = ray.d.length_squared();
        if leaving {
            // On the surface |x|^2 + 1 - tube^2 is twice rho; the rest of the
            // linear term is the product of normal and direction.
            let outward = (rho - 1.0) * e + rho * ray.oz * ray.dz;
            let c = [8.0 * outward, 4.0 * (g * g + rho - f), 4.0 * g, 1.0];
            sign_changes(&c, 0.0, exit, [outward > 0.0, true])
        } else {
            let k = rho * rho + ray.oz * ray.oz + (1.0 - tube) * (1.0 + tube);
            let near = (rho - 1.0) * (rho - 1.0) + ray.oz * ray.oz - tube * tube;
            let far = (rho + 1.0) * (rho + 1.0) + ray.oz * ray.oz - tube * tube;
            let c = [
                near * far,
                4.0 * (g * k - 2.0 * e),
                4.0 * g * g + 2.0 * k - 4.0 * f,
                4.0 * g,
                1.0,
            ];
            // Where the ray is cut it is outside, elsewhere it starts.
            let outside = start > begin || self.height(ray, start).0 > 0.0;
            sign_changes(&c, start, exit, [outside, true])
        }
    }

    /// Where the ray is within the slab and the sphere around the torus.
    fn clip(&self, ray: &Slid) -> Option<(f64, f64)> {
        let tube = self.tube();
        let slab = Span::between_planes(ray.oz + tube, ray.dz, 2.0 * tube, [0, 1], None)?;
        let h = ray.o.dot(ray.d) + ray.oz * ray.dz;
        let start = (ray.o.length_squared() + ray.oz * ray.oz).sqrt();
        let closest = (ray.o - ray.d * h).length_squared();
        let along = ray.oz - ray.dz * h;
        let closest = (closest + along * along).sqrt();
        let (near, far) = super::sphere::crossings(1.0, h, closest, start, 1.0 + tube)?;
        let [enter, exit] = Span::of_part(near, far, 0).overlap(slab)?.places();
        Some((enter, exit))
    }

    /// The height above the surface at a ray's own parameter, and how fast it
    /// grows.
    #[inline]
    fn height(&self, ray: &Slid, t: f64) -> (f64, f64) {
        let (flat, z) = (ray.o + ray.d * t, ray.oz + ray.dz * t);
        let rho = flat.length();
        let out = rho - 1.0;
        let away = (out * out + z * z).sqrt();
        let slope = (out * flat.dot(ray.d) / rho + z * ray.dz) / away;
        (away - self.tube(), slope)
    }

    /// The hits with `0 < t`, in order.
    fn hits(&self, origin: DVec3, dir: DVec3, leaving: bool) -> impl Iterator<Item = ShapeHit> {
        let ray = self.slid(origin, dir, leaving);
        let roots = self.roots(&ray, leaving);
        let count = roots.as_slice().len();
        (0..count).filter_map(move |i| {
            let root = roots.as_slice()[i];
            let (height, slope) = self.height(&ray, root);
            let better = root - height / slope;
            let local = if self.height(&ray, better).0.abs() < height.abs() {
                better
            } else {
                root
            };
            let t = local * ray.step + ray.slide;
            (t > 0.0).then(|| ShapeHit::on(0, t))
        })
    }

    /// The middle of the tube nearest to a place given across the axis: its
    /// direction from the centre.
    #[inline]
    fn outward(&self, flat: DVec2) -> DVec3 {
        // In the hole's middle any direction is as near as any other.
        let out = flat.try_normalize().unwrap_or(DVec2::X);
        self.across[0] * out.x + self.across[1] * out.y
    }

    /// The frame is about eight roundings from orthonormal and from the given
    /// axis; the directions to the middle of the tube and from there take five
    /// each, products and sums four; adding the centre rounds once more.
    fn error(&self) -> f64 {
        gamma(32) * (self.major + self.minor)
            + gamma(1) * (self.center.abs().max_element() + self.major + self.minor)
    }
}

impl Surface for Torus {
    #[inline]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        self.hits(origin, dir, leaving.is_some())
            .next()
            .filter(|hit| hit.t < t_max)
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        self.hits(origin, dir, leaving.is_some()).for_each(found);
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let x = (origin - self.center) + dir * hit.t;
        let middle = self.outward(self.split(x).0) * self.major;
        let ng = (x - middle).normalize();
        ShapePoint {
            p: self.center + (middle + ng * self.minor),
            error: self.error(),
            ng,
            ns: ng,
        }
    }

    /// One over the minor radius around the tube; along it the middle moves,
    /// too.
    #[inline]
    fn turning(&self, _part: u32, _uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        let flat = self.split(at().p - self.center).0;
        let along = self.axis.cross(self.outward(flat));
        let follows = outer(along, along) * (self.major / flat.length());
        Turning::General((DMat3::IDENTITY - follows) * (1.0 / self.minor))
    }

    fn bounds(&self) -> Option<Aabb> {
        let half = circle_half_widths(self.axis) * self.major + DVec3::splat(self.minor);
        let b = Aabb {
            min: self.center - half,
            max: self.center + half,
        };
        Some(b.padded(2.0 * self.error()))
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        Some(BoundingSphere {
            center: self.center,
            radius: (self.major + self.minor) * (1.0 + gamma(1)) + 2.0 * self.error(),
        })
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        let (flat, z) = self.split(p - self.center);
        let out = flat.length() - self.major;
        ((out * out + z * z).sqrt() - self.minor).abs()
    }

    fn pieces(&self) -> Pieces {
        Pieces::CURVED
    }
}

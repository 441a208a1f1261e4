//! Cone, paraboloid and hyperboloid of revolution between two planes.
//!
//! All are one surface: around an axis the squared radius is a polynomial of
//! second degree of the height. Heights are counted from where that polynomial
//! is simplest (the tip of a cone, the vertex of a paraboloid, the waist of a
//! hyperboloid), so that it does not cancel there. A ray crosses the side
//! where a quadratic is zero; the capped solid is the overlap of its inside
//! with a slab.

use glam::{DMat3, DVec2, DVec3};

use super::{
    Pieces, Place, ShapeHit, ShapePoint, Surface,
    axial::{AxialRay, Axis},
    disc::circle_half_widths,
    span::{Span, Spans, below_zero, within},
};
use crate::{
    geometry::{Aabb, BoundingSphere, Turning, turning::outer},
    numeric::gamma,
};

/// A surface of revolution; the normal of its side points away from the axis,
/// those of its caps outward. Parts: side 0, base 1, top 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    axis: Axis,
    length: f64,
    /// Radius at the base and at the top.
    radii: [f64; 2],
    profile: Profile,
    capped: bool,
}

const SIDE: u32 = 0;
const BASE: u32 = 1;
const TOP: u32 = 2;

/// The squared radius `c0 + c1 w + c2 w^2` at the height `w = z + shift`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Profile {
    c0: f64,
    c1: f64,
    c2: f64,
    shift: f64,
}

impl Profile {
    /// Half the derivative of the squared radius.
    #[inline]
    fn half_slope(&self, w: f64) -> f64 {
        0.5 * self.c1 + self.c2 * w
    }
}

impl Conic {
    /// A cone between two distinct points on its axis, with a radius at each:
    /// pointed where it is zero, which it may be at one end; in metres.
    pub fn cone(base: DVec3, end: DVec3, radii: [f64; 2], capped: bool) -> Self {
        let length = (end - base).length();
        let [r0, r1] = radii;
        let slope = (r1 - r0) / length;
        let (c0, shift) = if slope == 0.0 {
            (r0 * r0, 0.0)
        } else if r1 == 0.0 {
            (0.0, -length)
        } else {
            (0.0, r0 / slope)
        };
        let profile = Profile {
            c0,
            c1: 0.0,
            c2: slope * slope,
            shift,
        };
        Self::new(base, end, radii, profile, capped)
    }

    /// A paraboloid with its vertex at `apex`, cut at `base` where its radius
    /// is `radius`, in metres. Its focus lies `radius^2 / (4 length)` from the
    /// vertex.
    pub fn paraboloid(base: DVec3, apex: DVec3, radius: f64, capped: bool) -> Self {
        let length = (apex - base).length();
        let profile = Profile {
            c0: 0.0,
            c1: -radius * radius / length,
            c2: 0.0,
            shift: -length,
        };
        Self::new(base, apex, [radius, 0.0], profile, capped)
    }

    /// A hyperboloid of one sheet between two points on its axis, with a
    /// radius at each and a smallest radius `waist` between them, in metres.
    /// The waist is below at least one of the radii and above neither.
    pub fn hyperboloid(base: DVec3, end: DVec3, radii: [f64; 2], waist: f64, capped: bool) -> Self {
        let length = (end - base).length();
        let [a, b] = radii.map(|r| ((r - waist) * (r + waist)).sqrt());
        let slope = (a + b) / length;
        let profile = Profile {
            c0: waist * waist,
            c1: 0.0,
            c2: slope * slope,
            shift: -length * (a / (a + b)),
        };
        Self::new(base, end, radii, profile, capped)
    }

    fn new(base: DVec3, end: DVec3, radii: [f64; 2], profile: Profile, capped: bool) -> Self {
        Self {
            axis: Axis::new(base, end - base),
            length: (end - base).length(),
            radii,
            profile,
            capped,
        }
    }

    /// The ray in the axis' coordinates.
    #[inline]
    fn slid(&self, origin: DVec3, dir: DVec3, leaving: Option<u32>) -> AxialRay {
        let middle = 0.5 * self.length;
        self.axis.slid(origin, dir, middle, leaving.is_some())
    }

    /// The stretches inside the side, prolonged without end.
    #[inline]
    fn inside_side(&self, ray: &AxialRay, leaving: Option<u32>) -> Spans {
        let Profile { c0, c1, c2, shift } = self.profile;
        let w = ray.oz + shift;
        let a = ray.d.length_squared() - c2 * ray.dz * ray.dz;
        let h = ray.o.dot(ray.d) - self.profile.half_slope(w) * ray.dz;
        // On the side itself `h` tells on which side of the tangent plane the
        // ray goes on. Where the error of its start does not tell, there is no
        // chord: one would end on the wrong side of the surface.
        let h = if leaving == Some(SIDE) && h.abs() <= self.unsure(ray) {
            0.0
        } else {
            h
        };
        let k = ray.o.length_squared() - (c0 + (c1 + c2 * w) * w);
        below_zero(a, h, k, leaving == Some(SIDE), SIDE)
    }

    /// A bound on what half the slope along a ray is off at its start: a start
    /// is the root of 3 errors off its point, which is one off the surface, and
    /// rounded to the next float.
    #[inline]
    fn unsure(&self, ray: &AxialRay) -> f64 {
        let reach = ray.o.x.abs() + ray.o.y.abs() + ray.oz.abs();
        let off = 4.0
            * self
                .axis
                .error_of(reach, self.axis.base.abs() + DVec3::splat(reach));
        let slope = ray.d.length() + self.profile.c2 * ray.dz.abs();
        off * slope
            + gamma(8) * self.profile.half_slope(ray.oz + self.profile.shift).abs() * ray.dz.abs()
    }

    /// The stretches inside the capped solid.
    #[inline]
    fn inside(&self, ray: &AxialRay, leaving: Option<u32>) -> Spans {
        match Span::between_planes(ray.oz, ray.dz, self.length, [BASE, TOP], leaving) {
            Some(slab) => within(self.inside_side(ray, leaving), slab),
            None => [None; 2],
        }
    }

    /// Where the open side is crossed, in order.
    #[inline]
    fn side_hits(&self, ray: &AxialRay, leaving: Option<u32>) -> impl Iterator<Item = ShapeHit> {
        let (length, slide, oz, dz) = (self.length, ray.slide, ray.oz, ray.dz);
        self.inside_side(ray, leaving)
            .into_iter()
            .flatten()
            .flat_map(|span| span.places())
            .filter(move |local| (0.0..=length).contains(&(oz + dz * local)))
            .map(move |local| ShapeHit::on(SIDE, local + slide))
            .filter(|hit| hit.t > 0.0)
    }

    /// The gradient of half the squared distance from the axis less half the
    /// squared radius, across and along the axis.
    #[inline]
    fn gradient(&self, flat: DVec2, z: f64) -> (DVec2, f64) {
        (flat, -self.profile.half_slope(z + self.profile.shift))
    }

    /// A point moved onto the side by a step of Newton's method; its error
    /// that comes from the polynomial.
    fn onto_side(&self, flat: DVec2, z: f64) -> (DVec2, f64, f64) {
        let Profile { c0, c1, c2, shift } = self.profile;
        let w = z + shift;
        let shifted = gamma(12) * (z.abs() + shift.abs());
        let (g, gz) = self.gradient(flat, z);
        let length_squared = g.length_squared() + gz * gz;
        if length_squared == 0.0 {
            // The tip of a cone.
            return (flat, z, shifted);
        }
        let length = length_squared.sqrt();
        let level = 0.5 * (flat.length_squared() - (c0 + (c1 + c2 * w) * w));
        let step = level / length_squared;
        // What the polynomial's own rounding leaves, what that of the height
        // does, and the second order of the step.
        let terms = flat.length_squared() + (c0.abs() + (c1.abs() + c2 * w.abs()) * w.abs());
        let rounding = (0.5 * gamma(16) * terms + gz.abs() * shifted) / length;
        let second = 0.5 * step * step * length * c2.max(1.0);
        (flat - g * step, z - gz * step, rounding + second)
    }

    fn reach(&self) -> f64 {
        2.0 * self.radii[0].max(self.radii[1]) + self.length
    }
}

impl Surface for Conic {
    #[inline]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        let ray = self.slid(origin, dir, leaving);
        if self.capped {
            let spans = self.inside(&ray, leaving);
            return spans
                .iter()
                .flatten()
                .find_map(|span| span.first(ray.slide, t_max));
        }
        self.side_hits(&ray, leaving).find(|hit| hit.t < t_max)
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        let ray = self.slid(origin, dir, leaving);
        if self.capped {
            for span in self.inside(&ray, leaving).iter().flatten() {
                span.ends(ray.slide, found);
            }
        } else {
            self.side_hits(&ray, leaving).for_each(found);
        }
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let (flat, z) = self.axis.split((origin - self.axis.base) + dir * hit.t);
        let (flat, z, error, ng) = match hit.part {
            BASE => (flat, 0.0, 0.0, -self.axis.along),
            TOP => (flat, self.length, 0.0, self.axis.along),
            _ => {
                let (flat, z, error) = self.onto_side(flat, z);
                let (g, gz) = self.gradient(flat, z);
                let ng = self.axis.join(g, gz).try_normalize();
                (flat, z, error, ng.unwrap_or(self.axis.along))
            }
        };
        let p = self.axis.base + self.axis.join(flat, z);
        ShapePoint {
            p,
            error: error + self.axis.error_of(flat.x.abs() + flat.y.abs() + z.abs(), p),
            ng,
            ns: ng,
        }
    }

    #[inline]
    fn turning(&self, part: u32, _uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        if part != SIDE {
            return Turning::Flat;
        }
        let (flat, z) = self.axis.split(at().p - self.axis.base);
        let (g, gz) = self.gradient(flat, z);
        // One across the axis, less the profile's second derivative along it.
        let second =
            DMat3::IDENTITY - outer(self.axis.along, self.axis.along) * (1.0 + self.profile.c2);
        Turning::of_level(self.axis.join(g, gz), second)
    }

    /// Along each axis the farthest point is on a rim, or, on a paraboloid,
    /// where the side turns round.
    fn bounds(&self) -> Option<Aabb> {
        let half = circle_half_widths(self.axis.along);
        let top = self.axis.at(self.length);
        let mut b = Aabb::around([
            self.axis.base - half * self.radii[0],
            self.axis.base + half * self.radii[0],
            top - half * self.radii[1],
            top + half * self.radii[1],
        ]);
        if self.profile.c2 == 0.0 {
            let steepness = self.profile.c1.abs();
            for i in 0..3 {
                let depth =
                    half[i] * half[i] * steepness / (4.0 * self.axis.along[i] * self.axis.along[i]);
                if depth < self.length {
                    let radius = (steepness * depth).sqrt();
                    let at = top[i] - self.axis.along[i] * depth;
                    b.min[i] = b.min[i].min(at - half[i] * radius);
                    b.max[i] = b.max[i].max(at + half[i] * radius);
                }
            }
        }
        Some(
            b.padded(
                2.0 * self
                    .axis
                    .error_of(self.reach(), b.min.abs().max(b.max.abs())),
            ),
        )
    }

    /// The sphere through both rims, or around the larger one: the squared
    /// distance from a point of the axis is convex in the height.
    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        let [r0, r1] = self.radii;
        let level = 0.5 * (self.length + (r1 - r0) * (r1 + r0) / self.length);
        let level = level.clamp(0.0, self.length);
        let far = |r: f64, z: f64| (r * r + z * z).sqrt();
        let radius = far(r0, level).max(far(r1, self.length - level));
        let center = self.axis.at(level);
        Some(BoundingSphere {
            center,
            radius: radius * (1.0 + gamma(4)) + 2.0 * self.axis.error_of(self.reach(), center),
        })
    }

    fn is_closed(&self) -> bool {
        self.capped
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        let Profile { c0, c1, c2, shift } = self.profile;
        let (flat, z) = self.axis.split(p - self.axis.base);
        let w = z + shift;
        let (g, gz) = self.gradient(flat, z);
        let slope = (g.length_squared() + gz * gz).sqrt();
        let level = (flat.length_squared() - (c0 + (c1 + c2 * w) * w)).abs();
        let side = level_distance(level, slope, c2.max(1.0));
        if self.capped {
            side.min(z.abs()).min((z - self.length).abs())
        } else {
            side
        }
    }

    fn pieces(&self) -> Pieces {
        Pieces {
            flat: self.capped,
            ..Pieces::ANY
        }
    }
}

/// The least distance over which a polynomial of second degree can fall from
/// `level` to zero if half its gradient has length `slope` and its second
/// derivative stretches by at most `twice`: the root of
/// `twice x^2 + 2 slope x = level`.
pub(super) fn level_distance(level: f64, slope: f64, twice: f64) -> f64 {
    let root = slope + (slope * slope + twice * level).sqrt();
    if root > 0.0 { level / root } else { 0.0 }
}

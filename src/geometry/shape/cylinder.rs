//! The tube, open or capped.
//!
//! The side is a circle seen along the axis, treated like the sphere
//! (Haines et al. 2019). A capped cylinder is the intersection of an infinite
//! one with a slab, and a ray meets it where both of its intervals overlap:
//! no ray can slip through between side and cap.

use glam::{DVec2, DVec3};

use super::{
    Pieces, Place, ShapeHit, ShapePoint, Surface,
    axial::{AxialRay, Axis},
    disc::circle_half_widths,
    span::Span,
    sphere::crossings,
};
use crate::{
    geometry::{Aabb, BoundingSphere, Turning, turning::outer},
    numeric::gamma,
};

/// A circular cylinder; the normal of its side points away from the axis,
/// those of its caps outward. Parts: side 0, base 1, top 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    axis: Axis,
    length: f64,
    radius: f64,
    capped: bool,
}

const SIDE: u32 = 0;
const BASE: u32 = 1;
const TOP: u32 = 2;

impl Cylinder {
    /// A tube of a radius above zero between two distinct points on its
    /// axis, in metres; with `capped` both ends are closed by discs.
    pub fn new(base: DVec3, axis_end: DVec3, radius: f64, capped: bool) -> Self {
        Self {
            axis: Axis::new(base, axis_end - base),
            length: (axis_end - base).length(),
            radius,
            capped,
        }
    }

    /// True if discs close both ends.
    pub fn is_capped(&self) -> bool {
        self.capped
    }

    /// Centre of the base.
    pub fn base(&self) -> DVec3 {
        self.axis.base
    }

    /// Unit direction from the base to the top.
    pub fn axis(&self) -> DVec3 {
        self.axis.along
    }

    /// Distance between the ends in metres.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Radius in metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The parameters between which the line runs inside the infinite
    /// cylinder; unbounded if it runs along the axis.
    #[inline]
    fn side_interval(&self, o: DVec2, d: DVec2, leaving_side: bool) -> Option<(f64, f64)> {
        let a = d.length_squared();
        let h = o.dot(d);
        if leaving_side {
            let other = -2.0 * h / a;
            // Along the axis the line stays on the side: no way to cross it.
            let other = if other.is_finite() { other } else { 0.0 };
            return Some((other.min(0.0), other.max(0.0)));
        }
        let start = o.length();
        if a == 0.0 {
            return (start <= self.radius).then_some((f64::NEG_INFINITY, f64::INFINITY));
        }
        // The distance of the line from the axis, as a height: no difference
        // of nearly equal vectors.
        let closest = (o - d * (h / a)).length();
        crossings(a, h, closest, start, self.radius)
    }

    /// The ray in the axis' coordinates.
    #[inline]
    fn slid(&self, origin: DVec3, dir: DVec3, leaving: Option<u32>) -> AxialRay {
        let middle = 0.5 * self.length;
        self.axis.slid(origin, dir, middle, leaving.is_some())
    }

    /// The stretch inside the capped cylinder, counted from where the ray
    /// slid to.
    #[inline]
    fn span(&self, ray: &AxialRay, leaving: Option<u32>) -> Option<Span> {
        let (near, far) = self.side_interval(ray.o, ray.d, leaving == Some(SIDE))?;
        let caps = Span::between_planes(ray.oz, ray.dz, self.length, [BASE, TOP], leaving)?;
        Span::of_part(near, far, SIDE).overlap(caps)
    }
}

impl Surface for Cylinder {
    #[inline]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        let slid = self.slid(origin, dir, leaving);
        if self.capped {
            return self.span(&slid, leaving)?.first(slid.slide, t_max);
        }
        let (near, far) = self.side_interval(slid.o, slid.d, leaving == Some(SIDE))?;
        let within = |t: f64| (0.0..=self.length).contains(&(slid.oz + slid.dz * t));
        let visible = |local: f64| {
            let t = local + slid.slide;
            (within(local) && t > 0.0 && t < t_max).then(|| ShapeHit::on(SIDE, t))
        };
        visible(near).or_else(|| visible(far))
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        let slid = self.slid(origin, dir, leaving);
        if self.capped {
            if let Some(span) = self.span(&slid, leaving) {
                span.ends(slid.slide, found);
            }
        } else if let Some((near, far)) = self.side_interval(slid.o, slid.d, leaving == Some(SIDE))
        {
            let seen = |local: &f64| (0.0..=self.length).contains(&(slid.oz + slid.dz * local));
            [near, far]
                .into_iter()
                .filter(seen)
                .map(|local| local + slid.slide)
                .filter(|&t| t > 0.0)
                .for_each(|t| found(ShapeHit::on(SIDE, t)));
        }
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let (flat, z) = self.axis.split((origin - self.axis.base) + dir * hit.t);
        let (flat, z, ng) = match hit.part {
            BASE => (flat, 0.0, -self.axis.along),
            TOP => (flat, self.length, self.axis.along),
            _ => {
                let out = flat.normalize();
                let ng = self.axis.join_flat(out);
                (out * self.radius, z, ng.normalize())
            }
        };
        let p = self.axis.base + self.axis.join(flat, z);
        ShapePoint {
            p,
            error: self.axis.error_of(flat.x.abs() + flat.y.abs() + z.abs(), p),
            ng,
            ns: ng,
        }
    }

    #[inline]
    fn turning(&self, part: u32, _uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        if part != SIDE {
            return Turning::Flat;
        }
        // The side turns only around the axis, by one over the radius.
        let around = self.axis.along.cross(at().ns);
        Turning::General(outer(around / self.radius, around))
    }

    fn bounds(&self) -> Option<Aabb> {
        let half = circle_half_widths(self.axis.along) * self.radius;
        let (base, top) = (self.axis.base, self.axis.at(self.length));
        let b = Aabb {
            min: base.min(top) - half,
            max: base.max(top) + half,
        };
        let reach = 2.0 * self.radius + self.length;
        Some(b.padded(2.0 * self.axis.error_of(reach, b.min.abs().max(b.max.abs()))))
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        let half = 0.5 * self.length;
        let center = self.axis.at(half);
        let reach = 2.0 * self.radius + self.length;
        Some(BoundingSphere {
            center,
            // Not by `hypot`, whose last bit depends on the platform.
            radius: (self.radius * self.radius + half * half).sqrt() * (1.0 + gamma(3))
                + 2.0 * self.axis.error_of(reach, center),
        })
    }

    fn is_closed(&self) -> bool {
        self.capped
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        let (across, along) = self.axis.split(p - self.axis.base);
        let side = (across.length() - self.radius).abs();
        if self.capped {
            side.min(along.abs()).min((along - self.length).abs())
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

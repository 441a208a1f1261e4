//! The box with faces across the axes.

use glam::DVec3;

use super::{Pieces, Place, ShapeHit, ShapePoint, Surface, span::Span};
use crate::geometry::{Aabb, Turning};

/// A box; its normals point outward. The face at the smaller coordinate of
/// axis `i` is part `2 i`, the one opposite is part `2 i + 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    bounds: Aabb,
}

impl Cuboid {
    /// A box whose `min` is below its `max` on all axes.
    pub fn new(bounds: Aabb) -> Self {
        Self { bounds }
    }

    /// The stretch inside: the overlap of three slabs.
    #[inline]
    fn span(&self, origin: DVec3, dir: DVec3, leaving: Option<u32>) -> Option<Span> {
        let o = origin - self.bounds.min;
        let size = self.bounds.max - self.bounds.min;
        let slab = |axis: usize| {
            let low = 2 * axis as u32;
            Span::between_planes(o[axis], dir[axis], size[axis], [low, low + 1], leaving)
        };
        slab(0)?.overlap(slab(1)?)?.overlap(slab(2)?)
    }
}

impl Surface for Cuboid {
    #[inline]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        self.span(origin, dir, leaving)?.first(0.0, t_max)
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        if let Some(span) = self.span(origin, dir, leaving) {
            span.ends(0.0, found);
        }
    }

    /// The coordinate across the face is the face's own: there is no error.
    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let Aabb { min, max } = self.bounds;
        let (axis, high) = (hit.part as usize / 2, hit.part % 2 == 1);
        let mut p = (origin + dir * hit.t).clamp(min, max);
        p[axis] = if high { max[axis] } else { min[axis] };
        let ng = DVec3::AXES[axis] * if high { 1.0 } else { -1.0 };
        ShapePoint {
            p,
            error: 0.0,
            ng,
            ns: ng,
        }
    }

    #[inline]
    fn turning(&self, _part: u32, _uv: [f64; 2], _at: impl Fn() -> Place) -> Turning {
        Turning::Flat
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.bounds)
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        let beyond = (self.bounds.min - p).max(p - self.bounds.max);
        if beyond.max_element() > 0.0 {
            beyond.max(DVec3::ZERO).length()
        } else {
            -beyond.max_element()
        }
    }

    fn pieces(&self) -> Pieces {
        Pieces::FLAT
    }
}

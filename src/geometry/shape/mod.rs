//! The shapes, one file each, and the two questions put to all of them:
//! where does a ray meet you, and what are you like there?
//!
//! Everything here happens in the shape's own space. A ray is an origin and
//! a direction of any length but zero; `t` counts in units of that length.
//! Hits have `0 < t < t_max`. `leaving` names the part on which the ray
//! starts: flat parts are then skipped, curved ones drop the root at zero.
//! Constructors take input that has been validated: finite, lengths above
//! zero, directions not zero, edges not parallel.

mod axial;
mod conic;
mod cuboid;
mod cylinder;
mod disc;
mod ellipsoid;
pub mod implicit;
mod plane;
mod quad;
mod quadric;
mod solid;
mod span;
mod sphere;
mod torus;
mod triangle;

use std::sync::Arc;

use glam::DVec3;

pub use conic::Conic;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use implicit::{Implicit, ImplicitError, RootFinder};
pub use plane::Plane;
pub use quad::Quad;
pub use quadric::Quadric;
pub use solid::{Body, Solid, SolidError};
pub use sphere::Sphere;
pub use torus::Torus;
pub use triangle::{ShearedRay, Triangle};
pub(super) use triangle::{point_at, sound_normal, triangle_normal};

use super::{Aabb, BoundingSphere, Transform, TriangleMesh, Turning, hit::pushed_out};
use crate::numeric::gamma;

/// Everything that a ray can meet.
#[derive(Clone, Debug)]
pub enum Shape {
    /// An unbounded plane.
    Plane(Plane),
    /// A parallelogram.
    Quad(Quad),
    /// A flat disc.
    Disc(Disc),
    /// A sphere.
    Sphere(Sphere),
    /// A tube, open or with caps.
    Cylinder(Cylinder),
    /// A cone, paraboloid or hyperboloid of revolution between two planes.
    Conic(Conic),
    /// A squashed and turned sphere.
    Ellipsoid(Arc<Ellipsoid>),
    /// Where a polynomial of second degree is zero.
    Quadric(Arc<Quadric>),
    /// A ring.
    Torus(Torus),
    /// A box.
    Cuboid(Cuboid),
    /// Made of other shapes by union, intersection and difference.
    Solid(Arc<Solid>),
    /// One triangle.
    Triangle(Triangle),
    /// Many triangles, shared between instances.
    Mesh(Arc<TriangleMesh>),
    /// Where a formula is zero, shared between instances.
    Implicit(Arc<Implicit>),
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    /// Ray parameter, in lengths of the direction.
    pub t: f64,
    /// The part that was met: triangle of a mesh, side (0), base (1) or top
    /// (2) of a cylinder or conic, face of a box; in a solid the operand and
    /// its part; otherwise 0.
    pub part: u32,
    /// Barycentric weights of a triangle's second and third vertex; zero for
    /// other shapes.
    pub uv: [f64; 2],
}

impl ShapeHit {
    /// A hit on a shape without barycentric coordinates.
    #[inline]
    pub(crate) fn on(part: u32, t: f64) -> Self {
        Self {
            t,
            part,
            uv: [0.0; 2],
        }
    }
}

/// A point on a shape, in its own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapePoint {
    /// Position, moved onto the surface.
    pub p: DVec3,
    /// Bound on the distance from `p` to the true surface along any axis.
    pub error: f64,
    /// Geometric unit normal.
    pub ng: DVec3,
    /// Shading unit normal, `ns . ng > 0`.
    pub ns: DVec3,
}

/// A place on a shape and its unit normals there, in the shape's own space:
/// what a hit has turned out to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position.
    pub p: DVec3,
    /// Geometric normal.
    pub ng: DVec3,
    /// Shading normal.
    pub ns: DVec3,
}

impl Place {
    /// A place that a map has sent to the world, seen in the shape's own
    /// space.
    #[inline]
    pub(super) fn back(&self, m: &Transform) -> Self {
        Self {
            p: m.inverse_point(self.p),
            ng: m.inverse_normal(self.ng),
            ns: m.inverse_normal(self.ns),
        }
    }
}

/// What every shape answers, in its own space. A new shape is one file that
/// implements this, and one variant of [`Shape`].
pub trait Surface {
    /// The nearest hit with `0 < t < t_max`.
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit>;

    /// True if there is any hit with `0 < t < t_max`.
    #[inline]
    fn occludes(&self, origin: DVec3, dir: DVec3, t_max: f64, leaving: Option<u32>) -> bool {
        self.intersect(origin, dir, t_max, leaving).is_some()
    }

    /// Tells every hit with `0 < t`, in any order. Along a closed shape they
    /// are entries and exits in turn and the last one is an exit, so that the
    /// ray starts inside exactly if their number is odd.
    ///
    /// By default the hits are found one after the other, each from the one
    /// before; shapes that know all at once say so.
    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        let (mut from, mut past, mut leaving) = (origin, 0.0, leaving);
        for _ in 0..MOST_CROSSINGS {
            let Some(hit) = self.intersect(from, dir, f64::INFINITY, leaving) else {
                return;
            };
            let point = self.surface(from, dir, &hit);
            past += hit.t;
            found(ShapeHit { t: past, ..hit });
            from = pushed_out(point.p, point.error, point.ng, dir);
            leaving = Some(hit.part);
        }
    }

    /// True if a ray is inside after all its [`crossings`](Self::crossings):
    /// half of all rays end up behind a plane, none in a bounded shape.
    fn ends_inside(&self, _origin: DVec3, _dir: DVec3, _leaving: Option<u32>) -> bool {
        false
    }

    /// The point at a hit that [`intersect`](Self::intersect) or
    /// [`crossings`](Self::crossings) has returned for the same ray.
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint;

    /// How the shading normal turns at a point of a part; `at` tells what is
    /// known of it.
    fn turning(&self, part: u32, uv: [f64; 2], at: impl Fn() -> Place) -> Turning;

    /// A box around the shape, its rounding error included; `None` if it is
    /// unbounded.
    fn bounds(&self) -> Option<Aabb>;

    /// A sphere around the shape, the smallest one where that is easily had;
    /// `None` if it is unbounded.
    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        self.bounds().map(|b| b.bounding_sphere())
    }

    /// A world box around the transformed shape.
    fn bounds_under(&self, transform: &Transform) -> Option<Aabb> {
        self.bounds().map(|b| transform.bounds(&b))
    }

    /// True if the shape has an inside that no path can enter or leave
    /// unseen.
    fn is_closed(&self) -> bool;

    /// A lower bound of the distance from `p` to the surface; it need be
    /// right only as far as `within`.
    fn distance_bound(&self, p: DVec3, within: f64) -> f64;

    /// Whether the surface may come into a region; errs on the side of yes.
    fn may_meet(&self, region: &Aabb) -> bool {
        let reach = region.half_diagonal().length();
        self.bounds().is_none_or(|b| b.overlaps(region))
            && self.distance_bound(region.center(), reach) <= reach * (1.0 + gamma(8))
    }

    /// Of what kind its pieces are: what is flat everywhere and what is flat
    /// nowhere have no piece in common.
    fn pieces(&self) -> Pieces {
        Pieces::ANY
    }
}

/// Of what kind the pieces of a surface are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pieces {
    /// Some may be flat.
    pub flat: bool,
    /// Some may be curved.
    pub curved: bool,
}

impl Pieces {
    /// Nothing is known.
    pub const ANY: Self = Self {
        flat: true,
        curved: true,
    };

    /// All are flat.
    pub const FLAT: Self = Self {
        flat: true,
        curved: false,
    };

    /// All are curved.
    pub const CURVED: Self = Self {
        flat: false,
        curved: true,
    };

    /// Whether two surfaces may have a piece in common.
    #[must_use]
    pub fn may_coincide(self, other: Self) -> bool {
        self.flat && other.flat || self.curved && other.curved
    }
}

/// Where a search from crossing to crossing ends: far more than any line has,
/// so that a shape that is met without end costs time but no more.
const MOST_CROSSINGS: usize = 1 << 16;

/// Asks the same of whichever shape it is.
macro_rules! each {
    ($self:expr, $s:ident => $call:expr) => {
        match $self {
            Shape::Plane($s) => $call,
            Shape::Quad($s) => $call,
            Shape::Disc($s) => $call,
            Shape::Sphere($s) => $call,
            Shape::Cylinder($s) => $call,
            Shape::Conic($s) => $call,
            Shape::Ellipsoid($s) => $call,
            Shape::Quadric($s) => $call,
            Shape::Torus($s) => $call,
            Shape::Cuboid($s) => $call,
            Shape::Solid($s) => $call,
            Shape::Triangle($s) => $call,
            Shape::Mesh($s) => $call,
            Shape::Implicit($s) => $call,
        }
    };
}

impl Surface for Shape {
    #[allow(
        clippy::inline_always,
        reason = "so that a hit stays in registers, see `World::nearer`"
    )]
    #[inline(always)]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        each!(self, s => s.intersect(origin, dir, t_max, leaving))
    }

    #[inline]
    fn occludes(&self, origin: DVec3, dir: DVec3, t_max: f64, leaving: Option<u32>) -> bool {
        each!(self, s => s.occludes(origin, dir, t_max, leaving))
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        each!(self, s => s.crossings(origin, dir, leaving, found));
    }

    fn ends_inside(&self, origin: DVec3, dir: DVec3, leaving: Option<u32>) -> bool {
        each!(self, s => s.ends_inside(origin, dir, leaving))
    }

    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        each!(self, s => s.surface(origin, dir, hit))
    }

    #[inline]
    fn turning(&self, part: u32, uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        each!(self, s => s.turning(part, uv, at))
    }

    fn bounds(&self) -> Option<Aabb> {
        each!(self, s => s.bounds())
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        each!(self, s => s.bounding_sphere())
    }

    fn bounds_under(&self, transform: &Transform) -> Option<Aabb> {
        each!(self, s => s.bounds_under(transform))
    }

    fn is_closed(&self) -> bool {
        each!(self, s => s.is_closed())
    }

    fn distance_bound(&self, p: DVec3, within: f64) -> f64 {
        each!(self, s => s.distance_bound(p, within))
    }

    fn may_meet(&self, region: &Aabb) -> bool {
        each!(self, s => s.may_meet(region))
    }

    fn pieces(&self) -> Pieces {
        each!(self, s => s.pieces())
    }
}

/// The ray parameter at which a ray crosses the plane through `point`, if it
/// lies in `(0, t_max)`. Parallel rays give an infinity or NaN and miss.
#[inline]
fn plane_crossing(
    point: DVec3,
    normal: DVec3,
    origin: DVec3,
    dir: DVec3,
    t_max: f64,
) -> Option<f64> {
    let t = normal.dot(point - origin) / normal.dot(dir);
    (t > 0.0 && t < t_max).then_some(t)
}

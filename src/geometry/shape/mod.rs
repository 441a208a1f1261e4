//! The shapes, one file each, and the two questions put to all of them:
//! where does a ray meet you, and what are you like there?
//!
//! Everything here happens in the shape's own space. A ray is an origin and
//! a direction of any length but zero; `t` counts in units of that length.
//! Hits have `0 < t < t_max`. `leaving` names the part on which the ray
//! starts: flat parts are then skipped, curved ones drop the root at zero.
//! Constructors take input that has been validated: finite, lengths above
//! zero, directions not zero, edges not parallel.

mod cylinder;
mod disc;
pub mod implicit;
mod plane;
mod quad;
mod sphere;
mod triangle;

use std::sync::Arc;

use glam::DVec3;

pub use cylinder::Cylinder;
pub use disc::Disc;
pub use implicit::{Implicit, ImplicitError, RootFinder};
pub use plane::Plane;
pub use quad::Quad;
pub use sphere::Sphere;
pub use triangle::{ShearedRay, Triangle};
pub(super) use triangle::{point_at, sound_normal, triangle_normal};

use super::{Aabb, BoundingSphere, Transform, TriangleMesh, Turning};

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
    /// (2) of a cylinder; otherwise 0.
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

    /// The point at a hit that [`intersect`](Self::intersect) has returned
    /// for the same ray.
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
}

/// Asks the same of whichever shape it is.
macro_rules! each {
    ($self:expr, $s:ident => $call:expr) => {
        match $self {
            Shape::Plane($s) => $call,
            Shape::Quad($s) => $call,
            Shape::Disc($s) => $call,
            Shape::Sphere($s) => $call,
            Shape::Cylinder($s) => $call,
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

//! Rays, shapes and where they meet.
//!
//! Contract of the room:
//! - Everything is `f64`, in metres. Boxes of the acceleration structure are
//!   `f32`, rounded outward.
//! - A ray's direction need not have unit length inside a shape's own space;
//!   in world space it has. The parameter `t` is the same in both, since
//!   directions are transformed without normalising.
//! - A hit is found in two steps: a cheap [`Hit`] (which surface, how far),
//!   then, once per ray, the full [`SurfacePoint`] with normals and its own
//!   error. Rays leave a surface only through [`SurfacePoint::spawn`] and
//!   [`SurfacePoint::spawn_towards`]: no other place offsets an origin.
//! - `ng` is the geometric normal. On closed shapes it points outward; on
//!   `Plane`, `Quad` and `Disc` it is the stated normal; on triangles it
//!   follows the counter-clockwise winding. It does not depend on the ray.
//!   `ns` is the shading normal, on the same side as `ng`.
//!   [`World::turning`] tells how `ns` changes around a hit.
//! - A ray that leaves a surface carries its [`SurfaceId`]: flat surfaces are
//!   then skipped, curved ones drop the root at zero analytically. There is
//!   no epsilon to tune.

pub mod bounds;
pub mod brute;
pub mod bvh;
pub mod hit;
mod inside;
pub mod mesh;
mod near;
pub mod points;
pub mod ray;
pub mod shape;
pub mod transform;
pub mod turning;
pub mod world;

pub use bounds::{Aabb, BoundingSphere};
pub use hit::{Hit, SurfacePoint};
pub use mesh::TriangleMesh;
pub use points::PointIndex;
pub use ray::{Ray, SurfaceId};
pub use shape::{Shape, Surface};
pub use transform::Transform;
pub use turning::Turning;
pub use world::{Instance, World};

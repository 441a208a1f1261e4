//! The ray and the name of the surface it leaves.

use glam::DVec3;

/// Names one smooth surface of the scene: an instance and a part of its shape
/// (the triangle of a mesh, the side or a cap of a cylinder; otherwise 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SurfaceId {
    /// Index of the instance in its [`World`](super::World).
    pub instance: u32,
    /// Index of the part within the shape.
    pub part: u32,
}

/// A half-line in world space.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start, in metres.
    pub origin: DVec3,
    /// Unit direction.
    pub dir: DVec3,
    /// The surface on which the ray starts, if it starts on one.
    pub leaving: Option<SurfaceId>,
}

impl Ray {
    /// A ray that starts in free space.
    pub fn new(origin: DVec3, dir: DVec3) -> Self {
        Self {
            origin,
            dir,
            leaving: None,
        }
    }

    /// The point at distance `t` metres.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.dir * t
    }
}

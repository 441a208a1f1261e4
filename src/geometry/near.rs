//! Does a shape come near a point? Asked before gathering light around the
//! point: where nothing else is near, nothing can stand between two of its
//! neighbours.
//!
//! The answer errs on the side of yes.

use glam::DVec3;

use super::{Instance, Shape, TriangleMesh, World};

impl World {
    /// Whether the surface of any instance but `except` may come within
    /// `radius` metres of `p`.
    pub fn is_crowded(&self, p: DVec3, radius: f64, except: u32) -> bool {
        (0u32..).zip(self.instances()).any(|(i, instance)| {
            i != except
                && self
                    .instance_bounds(i)
                    .is_none_or(|b| b.padded(radius).contains(p))
                && instance.comes_near(p, radius)
        })
    }
}

impl Instance {
    fn comes_near(&self, p: DVec3, radius: f64) -> bool {
        match &self.transform {
            None => self.shape.comes_near(p, radius),
            Some(m) => self
                .shape
                .comes_near(m.inverse_point(p), radius * m.inverse_stretch()),
        }
    }
}

impl Shape {
    /// Whether the surface may come within `radius` of `p`, in the shape's
    /// own space.
    pub fn comes_near(&self, p: DVec3, radius: f64) -> bool {
        let plane = |point: DVec3, normal: DVec3| (p - point).dot(normal).abs() <= radius;
        match self {
            Self::Plane(s) => plane(s.point(), s.normal()),
            Self::Quad(s) => plane(s.corner(), s.normal()),
            Self::Disc(s) => plane(s.center(), s.normal()),
            Self::Triangle(s) => plane(s.vertices()[0], s.normal()),
            Self::Sphere(s) => (p.distance(s.center()) - s.radius()).abs() <= radius,
            Self::Cylinder(s) => {
                let f = p - s.base();
                let along = f.dot(s.axis());
                let across = (f - s.axis() * along).length();
                let side = (across - s.radius()).abs() <= radius;
                let caps = along.abs() <= radius || (along - s.length()).abs() <= radius;
                side || (s.is_capped() && caps)
            }
            Self::Mesh(m) => m.comes_near(p, radius),
        }
    }
}

impl TriangleMesh {
    /// Whether the box of a few neighbouring triangles comes within `radius`
    /// of `p`.
    fn comes_near(&self, p: DVec3, radius: f64) -> bool {
        self.bvh().overlaps(p, radius)
    }
}

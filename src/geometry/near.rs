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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DQuat};

    use super::*;
    use crate::{
        geometry::{
            Ray, Transform,
            shape::{Cylinder, Disc, Plane, Quad, Sphere, Triangle},
        },
        sampling::{Purpose, Sequence, warp},
    };

    fn shapes() -> Vec<Shape> {
        let grid: Vec<DVec3> = (0..100)
            .map(|i| {
                DVec3::new(
                    f64::from(i % 10) - 4.5,
                    f64::from(i / 10) - 4.5,
                    0.1 * f64::from(i % 3),
                ) / 4.5
            })
            .collect();
        let cells = (0..90u32).filter(|i| i % 10 != 9);
        let triangles = cells
            .flat_map(|i| [[i, i + 1, i + 11], [i, i + 11, i + 10]])
            .collect();
        let mesh = TriangleMesh::new(grid, None, triangles).expect("a sound mesh");
        vec![
            Shape::Plane(Plane::new(DVec3::ZERO, DVec3::new(0.3, 0.2, 1.0))),
            Shape::Quad(Quad::new(
                DVec3::splat(-0.5),
                DVec3::X,
                DVec3::new(0.2, 1.0, 0.5),
            )),
            Shape::Disc(Disc::new(
                DVec3::ZERO,
                DVec3::new(1.0, 1.0, 1.0).normalize(),
                0.8,
            )),
            Shape::Triangle(Triangle::new(DVec3::X, DVec3::Y, DVec3::Z)),
            Shape::Sphere(Sphere::new(DVec3::ZERO, 0.7)),
            Shape::Cylinder(Cylinder::new(
                DVec3::NEG_Z,
                DVec3::new(0.2, 0.0, 1.0),
                0.5,
                true,
            )),
            Shape::Mesh(Arc::new(mesh)),
        ]
    }

    /// Whatever a short ray from the point meets is near.
    #[test]
    fn no_neighbour_is_overlooked_and_far_things_are_not_near() {
        let stretch = DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, 0.5, -1.0),
            DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize(),
            DVec3::new(0.3, -0.2, 0.1),
        );
        for shape in shapes() {
            for transform in [None, Transform::new(stretch)] {
                let world = World::new(vec![Instance {
                    shape: shape.clone(),
                    transform,
                }]);
                let (mut near, mut clear) = (0, 0);
                for i in 0..2000 {
                    let mut s = Sequence::new(3, Purpose::Pilot, 0, i).at(0);
                    let p =
                        DVec3::new(s.next_1d(), s.next_1d(), s.next_1d()) * 4.0 - DVec3::splat(2.0);
                    let radius = 0.3 * s.next_1d();
                    let crowded = world.is_crowded(p, radius, u32::MAX);
                    let ray = Ray::new(p, warp::sphere(s.next_2d()).normalize());
                    if world.closest(&ray, radius).is_some() {
                        assert!(crowded, "{shape:?} is within {radius} of {p}");
                        near += 1;
                    }
                    clear += u32::from(!crowded);
                    assert!(!world.is_crowded(p, radius, 0), "the exception is left out");
                }
                assert!(
                    near > 0 && clear > 500,
                    "{shape:?}: {near} near, {clear} clear"
                );
            }
        }
    }
}

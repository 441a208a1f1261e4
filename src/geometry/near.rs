//! Which surfaces come near a point? Asked before gathering light around the
//! point: where nothing else is near, nothing can stand between two of its
//! neighbours, and where something is, only that can.
//!
//! The answer errs on the side of too many.

use glam::DVec3;

use super::{Aabb, Hit, Instance, Ray, Shape, Surface, SurfaceId, World};

impl World {
    /// The instances that `counts` names whose surface may come within
    /// `radius` metres of `p`, and a lower bound of the distance to all of
    /// them, `radius` if there are none.
    pub fn neighbours(
        &self,
        p: DVec3,
        radius: f64,
        counts: impl Fn(u32) -> bool,
    ) -> (Vec<u32>, f64) {
        let mut found = Vec::new();
        let mut clear = radius;
        let mut ask = |i: u32| {
            if !counts(i) {
                return;
            }
            let bound = self.instances()[i as usize].distance_bound(p, radius);
            if bound <= radius {
                clear = clear.min(bound);
                found.push(i);
            }
        };
        self.apart().iter().copied().for_each(&mut ask);
        self.bvh().near(p, radius, |slots| {
            self.in_slots(slots).iter().copied().for_each(&mut ask);
            false
        });
        (found, clear)
    }

    /// [`World::closest`], and whether another instance is met at most `window`
    /// times the distance and the largest coordinate of the ray's origin farther.
    #[inline(never)]
    pub fn closest_and_crowd(&self, ray: &Ray, t_max: f64, window: f64) -> Option<(Hit, bool)> {
        let far = ray.origin.abs().max_element();
        let mut best: Option<(Hit, bool)> = None;
        let within = |t: f64| (t + window * (far + t)).min(t_max);
        let mut ask = |t: f64, &i: &u32| {
            let Some(hit) = self.closest_on(i, ray, t) else {
                return t;
            };
            best = Some(match best {
                Some((nearest, _)) if nearest.t <= hit.t => (nearest, true),
                Some((other, _)) => (hit, other.t < within(hit.t)),
                None => (hit, false),
            });
            best.map_or(t, |(nearest, _)| within(nearest.t))
        };
        let t = self.apart().iter().fold(t_max, &mut ask);
        self.bvh().closest(ray.origin, ray.dir, t, |slots, t| {
            self.in_slots(slots).iter().fold(t, &mut ask)
        });
        best
    }

    /// Where a ray first meets an instance, if it does before `t_max` metres.
    pub fn closest_on(&self, instance: u32, ray: &Ray, t_max: f64) -> Option<Hit> {
        let leaving = super::world::leaving_part(ray, instance);
        let hit = self.instances()[instance as usize].intersect(ray, t_max, leaving)?;
        Some(Hit {
            t: hit.t,
            surface: SurfaceId {
                instance,
                part: hit.part,
            },
            uv: hit.uv,
        })
    }

    /// The distance at which a ray meets the first of the named instances,
    /// if it does before `t_max` metres.
    pub fn closest_of(&self, instances: &[u32], ray: &Ray, t_max: f64) -> Option<f64> {
        let mut nearest = None;
        for &i in instances {
            let hit = self.closest_on(i, ray, nearest.unwrap_or(t_max));
            nearest = hit.map(|h| h.t).or(nearest);
        }
        nearest
    }

    /// Whether a ray meets any of the named instances at `0 < t < t_max`.
    pub fn occluded_by(&self, instances: &[u32], ray: &Ray, t_max: f64) -> bool {
        instances.iter().any(|&i| {
            let leaving = super::world::leaving_part(ray, i);
            self.instances()[i as usize].occludes(ray, t_max, leaving)
        })
    }
}

impl Instance {
    /// Whether the surface may come into a region of the world; errs on the side
    /// of yes.
    pub fn may_meet(&self, region: &Aabb) -> bool {
        match &self.transform {
            None => self.shape.may_meet(region),
            Some(m) => self.shape.may_meet(&m.inverse_bounds(region)),
        }
    }

    /// Whether a piece of the surface, more than an edge, may lie wholly between
    /// two coordinates of the world; errs on the side of yes.
    pub fn may_lie_between(&self, axis: usize, [low, high]: [f64; 2]) -> bool {
        let Shape::Mesh(mesh) = &self.shape else {
            return true;
        };
        let at = |p: DVec3| self.transform.as_ref().map_or(p, |m| m.point(p))[axis];
        mesh.all_corners()
            .any(|v| v.into_iter().all(|p| (low..=high).contains(&at(p))))
    }

    /// A lower bound of the distance from `p` to the surface, in metres;
    /// exact enough only below `within`.
    pub(super) fn distance_bound(&self, p: DVec3, within: f64) -> f64 {
        match &self.transform {
            None => self.shape.distance_bound(p, within),
            Some(m) => {
                let stretch = m.inverse_stretch();
                self.shape
                    .distance_bound(m.inverse_point(p), within * stretch)
                    / stretch
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DMat3, DQuat};

    use super::*;
    use crate::{
        formula::Formula,
        geometry::{
            Transform, TriangleMesh,
            shape::{
                Body, Conic, Cuboid, Cylinder, Disc, Ellipsoid, Implicit, Plane, Quad, Quadric,
                RootFinder, Solid, Sphere, Torus, Triangle,
            },
        },
        sampling::{Purpose, Sequence, warp},
    };

    fn torus() -> Implicit {
        let f = Formula::parse("(sqrt(x^2 + y^2) - 0.6)^2 + z^2 - 0.04").expect("a formula");
        let bounds = Aabb {
            min: DVec3::NEG_ONE,
            max: DVec3::ONE,
        };
        Implicit::new(f, bounds, RootFinder::Interval).expect("a surface")
    }

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
        let block = Aabb {
            min: DVec3::splat(-0.7),
            max: DVec3::new(0.3, 0.5, 0.7),
        };
        let cuboid = Shape::Cuboid(Cuboid::new(block));
        let parts = [cuboid.clone(), Shape::Sphere(Sphere::new(DVec3::X, 0.9))];
        let parts = parts.map(|shape| Body::of(shape, None));
        let solid = Solid::new(Body::Difference(parts.into())).expect("bounded");
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
            Shape::Implicit(Arc::new(torus())),
            Shape::Conic(Conic::cone(DVec3::NEG_Z, DVec3::Z, [0.9, 0.0], true)),
            Shape::Conic(Conic::paraboloid(DVec3::X, DVec3::NEG_X, 0.9, false)),
            Shape::Conic(Conic::hyperboloid(
                DVec3::NEG_Z,
                DVec3::Z,
                [0.9, 0.7],
                0.4,
                true,
            )),
            Shape::Ellipsoid(Arc::new(
                Ellipsoid::new(DVec3::ZERO, DVec3::new(0.9, 0.6, 0.3), DMat3::IDENTITY)
                    .expect("regular"),
            )),
            Shape::Torus(Torus::new(DVec3::ZERO, DVec3::ONE, 0.8, 0.3)),
            cuboid,
            Shape::Quadric(Arc::new(Quadric::new(
                &[1.0, -0.7, 0.5, 0.3, 0.0, 0.2, 0.1, 0.0, -0.3, -0.2],
                block,
                true,
            ))),
            Shape::Solid(Arc::new(solid)),
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
                    let (found, bound) = world.neighbours(p, radius, |_| true);
                    let crowded = !found.is_empty();
                    let ray = Ray::new(p, warp::sphere(s.next_2d()).normalize());
                    if let Some(hit) = world.closest(&ray, radius) {
                        assert!(crowded, "{shape:?} is within {radius} of {p}");
                        assert!(bound <= hit.t * (1.0 + 1e-12), "{bound} against {}", hit.t);
                        assert_eq!(world.closest_of(&[0], &ray, radius), Some(hit.t));
                        near += 1;
                    }
                    clear += u32::from(!crowded);
                    assert!(
                        world.neighbours(p, radius, |i| i != 0).0.is_empty(),
                        "the exception is left out"
                    );
                }
                assert!(
                    near > 0 && clear > 500,
                    "{shape:?}: {near} near, {clear} clear"
                );
            }
        }
    }
}

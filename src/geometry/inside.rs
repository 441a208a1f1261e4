//! Is a point inside a closed shape?

use glam::DVec3;

use super::{BoundingSphere, Hit, Ray, Shape, Surface, SurfaceId, World};
use crate::numeric::gamma;

/// The direction in which the surface is looked for: askew to whatever people
/// build along axes.
const ASKEW: DVec3 = DVec3::new(
    0.408_730_132_718_341_2,
    0.233_911_094_027_518_7,
    0.882_169_843_016_275_3,
);

impl World {
    /// Whether a point lies inside a closed instance: whether the first
    /// surface that a ray from it meets is seen from behind. On the surface
    /// either answer may come.
    pub fn encloses(&self, instance: u32, p: DVec3) -> bool {
        if let Some(bounds) = self.instance_bounds(instance)
            && !bounds.contains(p)
        {
            return false;
        }
        let ray = Ray::new(p, ASKEW.normalize());
        let Some(hit) = self.instances()[instance as usize].intersect(&ray, f64::INFINITY, None)
        else {
            return false;
        };
        let hit = Hit {
            t: hit.t,
            surface: SurfaceId {
                instance,
                part: hit.part,
            },
            uv: hit.uv,
        };
        self.surface(&ray, &hit).ng.dot(ray.dir) > 0.0
    }

    /// Whether all of a sphere lies inside a closed instance (`Some(true)`) or
    /// all of it outside. Behind a plane is inside. `None` where the surface may
    /// pass through the sphere, and for shapes of which it cannot be proved: open
    /// ones, meshes and formulas, whose faces may turn either way.
    pub fn side(&self, instance: u32, sphere: &BoundingSphere) -> Option<bool> {
        let of = &self.instances()[instance as usize];
        let is_plane = matches!(of.shape, Shape::Plane(_));
        let is_sure = of.shape.is_closed()
            && !matches!(
                of.shape,
                Shape::Mesh(_) | Shape::Implicit(_) | Shape::Quadric(_)
            );
        if !is_plane && !is_sure {
            return None;
        }
        let BoundingSphere { center, radius } = *sphere;
        // Bounds of distances round in a few dozen steps, of lengths as large
        // as the coordinates.
        let far = center.abs().max_element() + radius;
        let around = self.instance_bounds(instance).map_or(0.0, |b| b.max_abs());
        let reach = radius + gamma(64) * (far + around);
        if of.distance_bound(center, 2.0 * reach) <= reach {
            return None;
        }
        if let Shape::Plane(plane) = &of.shape {
            let own = of
                .transform
                .as_ref()
                .map_or(center, |m| m.inverse_point(center));
            return Some((own - plane.point()).dot(plane.normal()) < 0.0);
        }
        Some(self.encloses(instance, center))
    }

    /// The same of what lies infinitely far in all directions within an angle
    /// about the unit vector `dir`, of which the sine is given.
    pub fn side_of_infinity(&self, instance: u32, dir: DVec3, sin_angle: f64) -> Option<bool> {
        let of = &self.instances()[instance as usize];
        let Shape::Plane(plane) = &of.shape else {
            return of.shape.is_closed().then_some(false);
        };
        let own = plane.normal();
        let (normal, ahead) = match &of.transform {
            None => (own, own.dot(dir)),
            Some(m) => (m.normal(own), own.dot(m.inverse_vector(dir))),
        };
        (normal.dot(dir).abs() > sin_angle + gamma(64)).then_some(ahead < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DQuat};

    use super::*;
    use crate::{
        geometry::{
            Instance, Shape, Transform, TriangleMesh,
            shape::{Cylinder, Plane, Sphere},
        },
        sampling::{Purpose, Sequence},
    };

    /// A cube of side 2 about the origin, as a mesh.
    fn cube() -> TriangleMesh {
        let corner = |i: u32, bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let vertices = (0..8u32)
            .map(|i| DVec3::new(corner(i, 0), corner(i, 1), corner(i, 2)))
            .collect();
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        TriangleMesh::new(vertices, None, triangles).expect("a sound mesh")
    }

    /// Spheres that are said to lie on a side have no point on the other one;
    /// many of those that do are told.
    #[test]
    fn a_side_is_a_proof() {
        let shapes = [
            Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.0, 0.2), 0.8)),
            Shape::Cylinder(Cylinder::new(DVec3::NEG_Z, DVec3::Z, 0.7, true)),
            Shape::Plane(Plane::new(
                DVec3::new(0.0, 0.2, 0.1),
                DVec3::new(0.3, 0.1, 1.0),
            )),
        ];
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, 0.5, -1.0),
            DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize(),
            DVec3::new(0.3, -0.2, 0.1),
        );
        for shape in shapes {
            for moved in [false, true] {
                let own = |p: DVec3| {
                    if moved {
                        map.inverse().transform_point3(p)
                    } else {
                        p
                    }
                };
                let inside = |p: DVec3| match &shape {
                    Shape::Plane(s) => (own(p) - s.point()).dot(s.normal()) < 0.0,
                    Shape::Sphere(_) => own(p).distance(DVec3::new(0.1, 0.0, 0.2)) < 0.8,
                    _ => own(p).truncate().length() < 0.7 && own(p).z.abs() < 1.0,
                };
                let world = World::new(vec![Instance {
                    shape: shape.clone(),
                    transform: if moved { Transform::new(map) } else { None },
                }]);
                let (mut told, mut pure) = (0, 0);
                for i in 0..500 {
                    let mut s = Sequence::new(6, Purpose::Pilot, 0, i).at(0);
                    let mut place = |size: f64| {
                        DVec3::new(s.next_1d(), s.next_1d(), s.next_1d()) * size - 0.5 * size
                    };
                    let center = place(4.0);
                    let points: Vec<DVec3> = (0..40)
                        .map(|_| center + place(2.0).normalize() * 0.3)
                        .collect();
                    let sphere = BoundingSphere {
                        center,
                        radius: 0.3,
                    };
                    let within = points.iter().filter(|p| inside(**p)).count();
                    pure += usize::from(within == 0 || within == 40);
                    if let Some(side) = world.side(0, &sphere) {
                        assert_eq!(within, if side { 40 } else { 0 }, "{shape:?} {center}");
                        told += 1;
                    }
                    let dir = (center - DVec3::splat(0.01)).normalize();
                    if let Some(side) = world.side_of_infinity(0, dir, 0.1) {
                        assert_eq!(side, inside(dir * 1e6), "{shape:?} {dir}");
                    }
                }
                // Bounds of distance are not sharp, least of all under a map.
                assert!(told * 8 > pure, "{shape:?}: {told} of {pure}");
            }
        }
        let tube = Shape::Cylinder(Cylinder::new(DVec3::NEG_Z, DVec3::Z, 0.7, false));
        let tube = World::new(vec![Instance {
            shape: tube,
            transform: None,
        }]);
        let far = BoundingSphere {
            center: DVec3::X * 9.0,
            radius: 0.1,
        };
        assert_eq!(tube.side(0, &far), None, "it encloses nothing");
    }

    /// Against the inequalities that define the solids, also under a transform
    /// that mirrors.
    #[test]
    fn inside_is_what_the_inequalities_say() {
        type Inside = fn(DVec3) -> bool;
        let solids: [(Shape, Inside); 3] = [
            (
                Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.0, 0.2), 0.8)),
                |p| p.distance(DVec3::new(0.1, 0.0, 0.2)) < 0.8,
            ),
            (
                Shape::Cylinder(Cylinder::new(DVec3::NEG_Z, DVec3::Z, 0.7, true)),
                |p| p.truncate().length() < 0.7 && p.z.abs() < 1.0,
            ),
            (Shape::Mesh(Arc::new(cube())), |p| {
                p.abs().max_element() < 1.0
            }),
        ];
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, 0.5, -1.0),
            DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize(),
            DVec3::new(0.3, -0.2, 0.1),
        );
        for (shape, is_inside) in solids {
            for moved in [false, true] {
                let world = World::new(vec![Instance {
                    shape: shape.clone(),
                    transform: if moved { Transform::new(map) } else { None },
                }]);
                let mut inside = 0;
                for i in 0..4000 {
                    let mut s = Sequence::new(5, Purpose::Pilot, 0, i).at(0);
                    let own =
                        DVec3::new(s.next_1d(), s.next_1d(), s.next_1d()) * 3.0 - DVec3::splat(1.5);
                    let p = if moved {
                        map.transform_point3(own)
                    } else {
                        own
                    };
                    assert_eq!(world.encloses(0, p), is_inside(own), "{shape:?} at {own}");
                    inside += u32::from(is_inside(own));
                }
                assert!((200..3800).contains(&inside), "{inside} of 4000 inside");
            }
        }
    }
}

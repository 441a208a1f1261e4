//! Is a point inside a closed shape?

use glam::DVec3;

use super::{Hit, Ray, SurfaceId, World};

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
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DQuat};

    use super::*;
    use crate::{
        geometry::{
            Instance, Shape, Transform, TriangleMesh,
            shape::{Cylinder, Sphere},
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

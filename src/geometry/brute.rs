//! The slow twin of [`World`]: the same tests of the same shapes, one after
//! the other, without any tree. It is what the fast one must agree with.

use glam::DVec3;

use super::{
    Hit, Ray, Shape, Surface, SurfaceId, TriangleMesh, World,
    shape::{ShapeHit, ShearedRay},
    world::leaving_part,
};

/// [`World::closest`] by testing everything.
pub fn closest(world: &World, ray: &Ray, t_max: f64) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for (instance, i) in world.instances().iter().zip(0..) {
        let leaving = leaving_part(ray, i);
        let t_max = best.map_or(t_max, |h| h.t);
        let found = match &instance.shape {
            Shape::Mesh(mesh) => {
                let (origin, dir) = instance.own_ray(ray);
                mesh_closest(mesh, origin, dir, t_max, leaving)
            }
            _ => instance.intersect(ray, t_max, leaving),
        };
        if let Some(ShapeHit { t, part, uv }) = found {
            best = Some(Hit {
                t,
                surface: SurfaceId { instance: i, part },
                uv,
            });
        }
    }
    best
}

/// [`World::occluded`] by testing everything.
pub fn occluded(world: &World, ray: &Ray, t_max: f64, ignore: impl Fn(u32) -> bool) -> bool {
    (0..).zip(world.instances()).any(|(i, instance)| {
        let (origin, dir) = instance.own_ray(ray);
        let leaving = leaving_part(ray, i);
        !ignore(i)
            && match &instance.shape {
                Shape::Mesh(mesh) => mesh_closest(mesh, origin, dir, t_max, leaving).is_some(),
                shape => shape.intersect(origin, dir, t_max, leaving).is_some(),
            }
    })
}

/// [`TriangleMesh::intersect`] by testing every triangle.
pub fn mesh_closest(
    mesh: &TriangleMesh,
    origin: DVec3,
    dir: DVec3,
    t_max: f64,
    leaving: Option<u32>,
) -> Option<ShapeHit> {
    let ray = ShearedRay::new(origin, dir);
    let mut best: Option<ShapeHit> = None;
    for part in (0..mesh.triangle_count() as u32).filter(|&i| leaving != Some(i)) {
        let t_max = best.map_or(t_max, |h| h.t);
        if let Some((t, uv)) = ray.hit(&mesh.triangle(part), t_max) {
            best = Some(ShapeHit { t, part, uv });
        }
    }
    best
}

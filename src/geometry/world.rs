//! Everything a ray can meet, in one place.

use glam::DVec3;

use crate::built;

use super::{
    Aabb, BoundingSphere, Hit, Ray, Shape, Surface, SurfaceId, SurfacePoint, Transform,
    bvh::Bvh,
    shape::{ShapeHit, ShapePoint},
};

/// A shape and its place in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The shape, in its own space.
    pub shape: Shape,
    /// From its own space to the world; `None` where they are the same.
    pub transform: Option<Transform>,
}

impl Instance {
    /// The ray's origin and direction in the shape's own space.
    #[inline]
    pub(super) fn own_ray(&self, ray: &Ray) -> (DVec3, DVec3) {
        match &self.transform {
            None => (ray.origin, ray.dir),
            Some(m) => (m.inverse_point(ray.origin), m.inverse_vector(ray.dir)),
        }
    }

    /// The nearest hit of a world-space ray with `0 < t < t_max`; `leaving`
    /// is the part of this instance on which it starts.
    #[allow(
        clippy::inline_always,
        reason = "so that a hit stays in registers, see `World::nearer`"
    )]
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, t_max: f64, leaving: Option<u32>) -> Option<ShapeHit> {
        let (origin, dir) = self.own_ray(ray);
        self.shape.intersect(origin, dir, t_max, leaving)
    }

    /// True if a world-space ray has any hit with `0 < t < t_max`.
    #[inline]
    pub fn occludes(&self, ray: &Ray, t_max: f64, leaving: Option<u32>) -> bool {
        let (origin, dir) = self.own_ray(ray);
        self.shape.occludes(origin, dir, t_max, leaving)
    }

    /// The point at a hit that this instance has returned for the same ray, in
    /// world space.
    #[inline]
    pub(super) fn surface(&self, ray: &Ray, hit: &ShapeHit) -> ShapePoint {
        let (origin, dir) = self.own_ray(ray);
        let own = self.shape.surface(origin, dir, hit);
        let Some(m) = &self.transform else {
            return own;
        };
        // A linear map of normals keeps the sign of ns . ng only when both
        // are the same; otherwise their angle may open.
        let ng = m.normal(own.ng);
        let mut ns = ng;
        if built::SHADING_NORMALS && own.ns != own.ng {
            let smooth = m.normal(own.ns);
            if smooth.dot(ng) > 0.0 {
                ns = smooth;
            }
        }
        ShapePoint {
            p: m.point(own.p),
            error: m.point_error(own.p, own.error),
            ng,
            ns,
        }
    }

    /// The box around the instance; `None` if it is unbounded.
    pub fn bounds(&self) -> Option<Aabb> {
        match &self.transform {
            None => self.shape.bounds(),
            Some(m) => self.shape.bounds_under(m),
        }
    }

    /// A sphere around the instance; `None` if it is unbounded.
    pub fn bounding_sphere(&self) -> Option<BoundingSphere> {
        let sphere = self.shape.bounding_sphere()?;
        Some(match &self.transform {
            None => sphere,
            Some(m) => m.sphere(&sphere),
        })
    }
}

/// Up to this many bounded instances are tested one after the other: entering
/// a tree and walking its root costs about as much as eight tests.
const FEW: usize = 10;

/// All instances, and the tree over those that are bounded.
#[derive(Clone, Debug)]
pub struct World {
    instances: Vec<Instance>,
    bvh: Bvh,
    /// The instance in each slot of the tree.
    slots: Vec<u32>,
    /// The instances that are not in the tree and tested against every ray.
    apart: Vec<u32>,
    boxes: Vec<Option<Aabb>>,
    spheres: Vec<Option<BoundingSphere>>,
}

impl World {
    /// Builds the tree. Instances keep their indices; there may be none.
    pub fn new(instances: Vec<Instance>) -> Self {
        let boxes: Vec<_> = instances.iter().map(Instance::bounds).collect();
        let spheres = instances.iter().map(Instance::bounding_sphere).collect();
        let mut apart = Vec::new();
        let mut bounded: Vec<(u32, Aabb)> = Vec::new();
        let few = boxes.iter().flatten().count() <= FEW;
        for (i, b) in (0..).zip(&boxes) {
            match b {
                Some(b) if !few => bounded.push((i, *b)),
                _ => apart.push(i),
            }
        }
        let (bvh, order) = Bvh::build(bounded.len(), 1, |i| bounded[i].1);
        let slots = order.into_iter().map(|i| bounded[i as usize].0).collect();
        Self {
            instances,
            bvh,
            slots,
            apart,
            boxes,
            spheres,
        }
    }

    /// The nearest hit with `0 < t < t_max` metres.
    #[allow(
        clippy::inline_always,
        reason = "a ray just made is still in registers: from memory it would have to be \
                  read by halves, as it was written"
    )]
    #[inline(always)]
    pub fn closest(&self, ray: &Ray, t_max: f64) -> Option<Hit> {
        let mut best = None;
        let mut t = t_max;
        for &i in &self.apart {
            t = self.nearer(i, ray, t, &mut best);
        }
        if self.slots.is_empty() {
            best
        } else {
            self.closest_in_tree(ray, t, best)
        }
    }

    /// The nearest hit on an instance in the tree with `0 < t < t_max`, or
    /// else `best`.
    #[inline(never)]
    fn closest_in_tree(&self, ray: &Ray, t_max: f64, mut best: Option<Hit>) -> Option<Hit> {
        self.bvh.closest(ray.origin, ray.dir, t_max, |slots, t| {
            let test = |t, &i: &u32| self.nearer(i, ray, t, &mut best);
            self.slots[slots].iter().fold(t, test)
        });
        best
    }

    /// Puts a hit on an instance before `t_max` into `best`; returns the
    /// smaller of its `t` and `t_max`.
    #[allow(
        clippy::inline_always,
        reason = "one call per ray and instance; the hit stays in registers"
    )]
    #[inline(always)]
    fn nearer(&self, instance: u32, ray: &Ray, t_max: f64, best: &mut Option<Hit>) -> f64 {
        let leaving = leaving_part(ray, instance);
        let Some(hit) = self.instance(instance).intersect(ray, t_max, leaving) else {
            return t_max;
        };
        *best = Some(Hit {
            t: hit.t,
            surface: SurfaceId {
                instance,
                part: hit.part,
            },
            uv: hit.uv,
        });
        hit.t
    }

    /// True if there is any hit with `0 < t < t_max` metres on an instance
    /// that `ignore` does not name.
    pub fn occluded(&self, ray: &Ray, t_max: f64, ignore: impl Fn(u32) -> bool) -> bool {
        let blocks =
            |&i: &u32| !ignore(i) && self.instance(i).occludes(ray, t_max, leaving_part(ray, i));
        self.apart.iter().any(blocks)
            || self.bvh.any(ray.origin, ray.dir, t_max, |slots| {
                self.slots[slots].iter().any(blocks)
            })
    }

    /// The point at a hit that this world has returned for the same ray.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let own = ShapeHit {
            t: hit.t,
            part: hit.surface.part,
            uv: hit.uv,
        };
        let point = self.instance(hit.surface.instance).surface(ray, &own);
        SurfacePoint {
            p: point.p,
            error: point.error,
            ng: point.ng,
            ns: point.ns,
            surface: hit.surface,
        }
    }

    /// All instances; hits and surfaces name them by index.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The box around all bounded instances; `None` if there are none.
    pub fn bounds(&self) -> Option<Aabb> {
        self.boxes.iter().flatten().copied().reduce(Aabb::union)
    }

    /// The world box around an instance; `None` if it is unbounded.
    pub fn instance_bounds(&self, instance: u32) -> Option<Aabb> {
        self.boxes[instance as usize]
    }

    /// A world sphere around an instance; `None` if it is unbounded.
    pub fn instance_sphere(&self, instance: u32) -> Option<BoundingSphere> {
        self.spheres[instance as usize]
    }

    /// The tree over bounded instances; empty if they are few.
    pub(super) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The instances in a range of the tree's slots.
    pub(super) fn in_slots(&self, slots: std::ops::Range<usize>) -> &[u32] {
        &self.slots[slots]
    }

    /// The instances that are not in the tree.
    pub(super) fn apart(&self) -> &[u32] {
        &self.apart
    }

    #[inline]
    fn instance(&self, i: u32) -> &Instance {
        &self.instances[i as usize]
    }
}

/// The part of the instance on which the ray starts, if it does.
#[inline]
pub(super) fn leaving_part(ray: &Ray, instance: u32) -> Option<u32> {
    ray.leaving
        .filter(|s| s.instance == instance)
        .map(|s| s.part)
}

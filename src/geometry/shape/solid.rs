//! Solids made of others: union, intersection and difference.
//!
//! A ray is asked for all its crossings of all operands. In order they tell at
//! every place which operands it is inside, and so whether it is inside the
//! whole; where that changes, the whole is met (S. Roth, *Ray Casting for
//! Modeling Solids*, 1982). At the start a ray is inside an operand if the
//! number of crossings ahead is odd, or even for one in which it ends.
//!
//! **Faces that coincide.** Crossings of two operands that lie within the
//! error of both count as one place, where only what holds before and after
//! matters. Hence two boxes that share a face are one body without a wall
//! between them, a hole that ends flush with a face is open there, and nothing
//! thinner than rounding is left. A ray that starts on an operand likewise
//! starts behind all crossings within the error of its start.

mod body;
mod events;

use glam::DVec3;

pub use self::body::Body;
use self::{
    body::{Node, collect, smallest_sphere},
    events::{Event, Events},
};
use super::{Place, Shape, ShapeHit, ShapePoint, Surface};
use crate::{
    geometry::{Aabb, BoundingSphere, Instance, Ray, Transform, Turning},
    numeric::gamma,
};

/// A part number holds the operand above this many bits of its own part.
const PART_BITS: u32 = 26;
/// Most operands: as many as a word has bits.
const MAX_OPERANDS: usize = 64;
/// Most parts of an operand.
const MAX_PARTS: usize = 1 << PART_BITS;

/// Why there is no solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// There are more shapes than a word has bits.
    #[error("{0} shapes are more than the {MAX_OPERANDS} of which a solid may be made")]
    TooMany(usize),
    /// A mesh has more triangles than part numbers can tell apart.
    #[error("a mesh in a solid may have {MAX_PARTS} triangles, not {0}")]
    TooFine(usize),
    /// The whole has no bounds.
    #[error("a solid without end")]
    Unbounded,
    /// The bounds of the operands have nothing in common.
    #[error("the operands have nothing in common")]
    Empty,
}

/// A solid; its normals point outward.
#[derive(Clone, Debug)]
pub struct Solid {
    operands: Vec<Operand>,
    tree: Node,
    bounds: Aabb,
    sphere: BoundingSphere,
}

#[derive(Clone, Debug)]
struct Operand {
    instance: Instance,
    /// True if what is inside it is taken away.
    subtracted: bool,
}

impl Solid {
    /// Puts a solid together; each list has at least one member.
    ///
    /// # Errors
    /// See [`SolidError`].
    pub fn new(body: Body) -> Result<Self, SolidError> {
        let mut operands = Vec::new();
        let (tree, extent) = collect(body, false, &mut operands);
        if operands.len() > MAX_OPERANDS {
            return Err(SolidError::TooMany(operands.len()));
        }
        let parts = |o: &Operand| match &o.instance.shape {
            Shape::Mesh(mesh) => mesh.triangle_count(),
            _ => 0,
        };
        if let Some(count) = operands.iter().map(parts).find(|&n| n > MAX_PARTS) {
            return Err(SolidError::TooFine(count));
        }
        let bounds = extent.ok_or(SolidError::Unbounded)?;
        let size = bounds.max - bounds.min;
        if bounds.is_empty() || size.min_element() <= gamma(16) * bounds.max_abs() {
            return Err(SolidError::Empty);
        }
        let sphere = smallest_sphere(&tree, &operands, bounds);
        // A point on one operand may stick out of the box of another by the
        // error of both.
        let reach = bounds.max_abs() + bounds.half_diagonal().length();
        let bounds = bounds.padded(gamma(64) * reach);
        Ok(Self {
            operands,
            tree,
            bounds,
            sphere,
        })
    }

    /// The shapes that it is made of, in the order of writing.
    pub fn operands(&self) -> impl Iterator<Item = &Instance> {
        self.operands.iter().map(|o| &o.instance)
    }

    #[inline]
    fn operand(&self, part: u32) -> &Operand {
        &self.operands[(part >> PART_BITS) as usize]
    }

    /// The point at a crossing, with the operand's own normal.
    fn own_point(&self, ray: &Ray, hit: &ShapeHit) -> ShapePoint {
        self.operand(hit.part).instance.surface(ray, &own(hit))
    }

    /// All crossings of all operands in order, and the operands that the ray
    /// is inside at its start.
    fn events(&self, ray: &Ray, leaving: Option<u32>) -> (Events, u64) {
        let mut events = Events::new();
        let mut inside = 0;
        for (index, operand) in (0u32..).zip(&self.operands) {
            let instance = &operand.instance;
            let (origin, dir) = instance.own_ray(ray);
            let leaving = leaving
                .filter(|part| part >> PART_BITS == index)
                .map(|part| part & (MAX_PARTS as u32 - 1));
            let mut within = instance.shape.ends_inside(origin, dir, leaving);
            let mut found = |hit: ShapeHit| {
                within = !within;
                events.push(Event {
                    t: hit.t,
                    part: index << PART_BITS | hit.part,
                    uv: hit.uv,
                });
            };
            instance.shape.crossings(origin, dir, leaving, &mut found);
            inside |= u64::from(within) << index;
        }
        events.sort();
        (events, inside)
    }

    /// Tells the places where the inside of the whole begins or ends, in
    /// order, until `found` says that it has seen enough.
    fn walk(&self, ray: &Ray, leaving: Option<u32>, mut found: impl FnMut(ShapeHit) -> bool) {
        let (events, mut inside) = self.events(ray, leaving);
        let mut rest = events.as_slice();
        if let Some(part) = leaving {
            while let Some((event, later)) = rest.split_first()
                && self.starts_beyond(ray, part, event)
            {
                inside ^= bit(event);
                rest = later;
            }
        }
        let mut is = self.tree.holds(inside);
        while let Some((event, later)) = rest.split_first() {
            inside ^= bit(event);
            rest = later;
            if self.tree.holds(inside) == is {
                continue;
            }
            while let Some((next, later)) = rest.split_first()
                && self.same_place(ray, event, next)
            {
                inside ^= bit(next);
                rest = later;
            }
            if self.tree.holds(inside) != is {
                is = !is;
                if !found(event.hit()) {
                    return;
                }
            }
        }
    }

    /// Whether two crossings of different operands lie within the error of
    /// both. How far they are apart counts across the surface that is steeper
    /// to the ray: two that lie in each other are as steep.
    fn same_place(&self, ray: &Ray, a: &Event, b: &Event) -> bool {
        if operand_of(a.part) == operand_of(b.part) {
            return false;
        }
        let [p, q] = [a, b].map(|e| self.own_point(ray, &e.hit()));
        let steepest = p.ng.dot(ray.dir).abs().max(q.ng.dot(ray.dir).abs());
        let apart = (b.t - a.t) * steepest;
        apart <= p.error + q.error + rounding_at(ray, b.t)
    }

    /// Whether a ray that leaves a part also leaves, at its start, the surface
    /// that it crosses in `event`. How far the start is from the part that it
    /// leaves is known: the place from which a crossing is seen cannot be
    /// nearer to any surface that coincides with it.
    fn starts_beyond(&self, ray: &Ray, part: u32, event: &Event) -> bool {
        if operand_of(part) == operand_of(event.part) {
            return false;
        }
        let start = ShapeHit {
            t: 0.0,
            part,
            // Only the plane of a triangle matters, not the place on it.
            uv: [1.0; 2],
        };
        let p = self.own_point(ray, &start);
        let q = self.own_point(ray, &event.hit());
        let off = (ray.origin - p.p).dot(p.ng).abs();
        let steepest = p.ng.dot(ray.dir).abs().max(q.ng.dot(ray.dir).abs());
        event.t * steepest <= off + p.error + q.error + rounding_at(ray, event.t)
    }
}

/// How far a crossing may be off across its surface because of the ray: the
/// origin is taken relative to the operand and sent through its map, the
/// parameter comes from a quadratic, and the place from both.
fn rounding_at(ray: &Ray, t: f64) -> f64 {
    gamma(24) * (ray.origin.abs() + ray.dir.abs() * t).max_element()
}

fn operand_of(part: u32) -> u32 {
    part >> PART_BITS
}

fn bit(event: &Event) -> u64 {
    1 << operand_of(event.part)
}

/// A hit on the whole as one on its operand.
fn own(hit: &ShapeHit) -> ShapeHit {
    ShapeHit {
        part: hit.part & (MAX_PARTS as u32 - 1),
        ..*hit
    }
}

impl Surface for Solid {
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        if passes_by(&self.sphere, origin, dir) {
            return None;
        }
        let mut first = None;
        self.walk(&Ray::new(origin, dir), leaving, |hit| {
            first = Some(hit);
            false
        });
        first.filter(|hit| hit.t < t_max)
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        self.walk(&Ray::new(origin, dir), leaving, |hit| {
            found(hit);
            true
        });
    }

    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let point = self.own_point(&Ray::new(origin, dir), hit);
        if self.operand(hit.part).subtracted {
            ShapePoint {
                ng: -point.ng,
                ns: -point.ns,
                ..point
            }
        } else {
            point
        }
    }

    fn turning(&self, part: u32, uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        let operand = self.operand(part);
        let part = part & (MAX_PARTS as u32 - 1);
        let place = at();
        if !operand.subtracted {
            return operand.instance.turning(part, uv, place);
        }
        let turned = Place {
            p: place.p,
            ng: -place.ng,
            ns: -place.ns,
        };
        operand.instance.turning(part, uv, turned).reversed()
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.bounds)
    }

    fn bounding_sphere(&self) -> Option<BoundingSphere> {
        Some(self.sphere)
    }

    /// The box around the box, or the operands' own where that is smaller.
    fn bounds_under(&self, transform: &Transform) -> Option<Aabb> {
        let by_box = transform.bounds(&self.bounds);
        let by_sphere = transform.sphere_bounds(&self.sphere);
        Some(by_box.intersection(by_sphere))
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn distance_bound(&self, p: DVec3, within: f64) -> f64 {
        self.operands
            .iter()
            .map(|o| o.instance.distance_bound(p, within))
            .fold(f64::INFINITY, f64::min)
    }
}

/// True if a line passes a sphere by more than rounding: most rays do, and
/// need not be asked for crossings.
fn passes_by(sphere: &BoundingSphere, origin: DVec3, dir: DVec3) -> bool {
    let from = origin - sphere.center;
    let closest = from - dir * (from.dot(dir) / dir.length_squared());
    let reach = sphere.radius + gamma(16) * (from.length() + origin.length());
    closest.length_squared() > reach * reach * (1.0 + gamma(8))
}

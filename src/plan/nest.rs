//! Bodies of clear media that overlap: whose medium is where.
//!
//! Bodies are ranked by priority, those of equal priority by their order in
//! the scene, the later ones higher. Where bodies overlap, the medium of the
//! highest rank is there, and nothing is seen of the surfaces of the others
//! (C. Schmidt and B. Budge, *Simple Nested Dielectrics in Ray Traced Images*,
//! Journal of Graphics Tools 7(2), 2002). So the medium is a function of the
//! place alone, and light takes the same ways in both directions.

use glam::DVec3;

use crate::{
    geometry::{Aabb, BoundingSphere, World},
    material::Material,
    numeric::gamma,
    scene::Scene,
};

use super::{Media, media::RANKS};

/// Most bodies that take part; of more, those of the lowest ranks do as if
/// they were alone in air.
const MOST_BODIES: usize = RANKS as usize;

/// A closed object of a clear medium.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Body {
    /// Its instance in the world.
    instance: u32,
    /// Its index of refraction.
    ior: f64,
    /// Its priority.
    priority: i8,
}

/// The bodies of a scene and their ranks.
#[derive(Clone, Debug, PartialEq)]
pub struct Nest {
    /// By rank.
    bodies: Vec<Body>,
    /// The rank of each instance; `None` if it is no body.
    ranks: Vec<Option<u16>>,
}

impl Nest {
    /// All bodies of a scene.
    pub fn of(scene: &Scene) -> Self {
        let mut bodies: Vec<Body> = (0u32..)
            .zip(&scene.objects)
            .filter_map(|(instance, object)| match object.material {
                Material::Dielectric {
                    ior,
                    thin: false,
                    priority: Some(priority),
                } => Some(Body {
                    instance,
                    ior,
                    priority,
                }),
                _ => None,
            })
            .collect();
        // Stable: later objects stay behind earlier ones.
        bodies.sort_by_key(|b| b.priority);
        bodies.drain(..bodies.len().saturating_sub(MOST_BODIES));
        let mut ranks = vec![None; scene.objects.len()];
        for (rank, body) in (0u16..).zip(&bodies) {
            ranks[body.instance as usize] = Some(rank);
        }
        Self { bodies, ranks }
    }

    /// Whether any two bodies may overlap: their boxes do, and their spheres.
    pub fn may_overlap(&self, world: &World) -> bool {
        self.first_overlap(world).is_some()
    }

    /// Two bodies that may overlap, in the order of the scene.
    pub fn first_overlap(&self, world: &World) -> Option<[u32; 2]> {
        let mut found = None;
        self.pairs(world, |a, b| {
            let (a, b) = (a.instance, b.instance);
            found = Some([a.min(b), a.max(b)]);
            false
        });
        found
    }

    /// The rank of an instance; `None` if it is no body.
    #[inline]
    pub fn rank(&self, instance: u32) -> Option<u16> {
        self.ranks[instance as usize]
    }

    /// The instance of the body whose medium is there; `None` outside of all.
    pub fn medium(&self, media: &Media) -> Option<u32> {
        media.top().map(|r| self.bodies[r as usize].instance)
    }

    /// The index of refraction where a path is in `media`.
    #[inline]
    fn index(&self, media: &Media) -> f64 {
        media.top().map_or(1.0, |r| self.bodies[r as usize].ior)
    }

    /// Index on the inner side of a surface over that on its outer side, with
    /// the bodies on either; `None` if one medium fills both sides, and there is
    /// nothing to see.
    #[inline]
    pub fn ior(&self, inner: &Media, outer: &Media) -> Option<f64> {
        (inner.top() != outer.top()).then(|| self.index(inner) / self.index(outer))
    }

    /// What a path knows that has met a surface, with the bodies on its sides:
    /// the `media` that it was in, and of those whose surfaces coincide there on
    /// which side they are.
    pub fn shared(&self, mut media: Media, instance: u32, inner: bool) -> Media {
        if let Some(rank) = self.rank(instance) {
            media = media.without(rank).shared(rank, inner);
        }
        media
    }

    /// The bodies around a path in `media` that goes on from the surface of an
    /// instance, on its inner side or not.
    ///
    /// The side tells whether it is in that body, and in those whose surfaces
    /// coincide there, whatever else `media` says: a surface that was missed by
    /// a rounding is made up for at the next one of the same body.
    #[inline]
    pub fn beside(&self, instance: u32, inside: bool, media: &Media) -> Media {
        let media = &media.on_side(inside);
        match self.rank(instance) {
            Some(rank) if inside => media.with(rank),
            Some(rank) => media.without(rank),
            None => *media,
        }
    }

    /// The bodies in which a point lies.
    pub fn around(&self, world: &World, p: DVec3) -> Media {
        let inside = |(_, body): &(u16, &Body)| world.encloses(body.instance, p);
        let found = (0u16..).zip(&self.bodies).filter(inside);
        found.fold(Media::NONE, |media, (rank, _)| media.with(rank))
    }

    /// Where in a sphere paths start: what is known of all its points.
    pub fn start(&self, world: &World, sphere: &BoundingSphere) -> Start {
        let center = sphere.center;
        let is_body = |i: u32| self.rank(i).is_some();
        let (unsure, _) = world.neighbours(center, sphere.radius, is_body);
        let unsure: Vec<(u16, u32)> = unsure
            .into_iter()
            .filter_map(|i| Some((self.rank(i)?, i)))
            .collect();
        let sure = unsure
            .iter()
            .fold(self.around(world, center), |media, &(rank, _)| {
                media.without(rank)
            });
        Start { sure, unsure }
    }

    /// The same where paths start anywhere on a plane.
    pub fn start_on_plane(&self, world: &World, p: DVec3, normal: DVec3) -> Start {
        let meets = |body: &Body| {
            world.instance_bounds(body.instance).is_none_or(|b| {
                let reach = b.half_diagonal().dot(normal.abs());
                (b.center() - p).dot(normal).abs() <= reach
            })
        };
        let unsure = (0u16..)
            .zip(&self.bodies)
            .filter(|(_, body)| meets(body))
            .map(|(rank, body)| (rank, body.instance))
            .collect();
        Start {
            sure: Media::NONE,
            unsure,
        }
    }

    /// Two bodies of the same priority and different media that overlap, in
    /// the order of the scene: the later one wins, which may not be meant.
    /// Overlaps are looked for at some points of each pair, so small ones may
    /// stay unseen; what is found is one.
    pub fn tie(&self, world: &World) -> Option<[u32; 2]> {
        let mut found = None;
        let mut looked = 0;
        self.pairs(world, |a, b| {
            let differ = a.priority == b.priority && a.ior != b.ior;
            if differ && share_a_point(world, a, b) {
                let (a, b) = (a.instance, b.instance);
                found = Some([a.min(b), a.max(b)]);
            }
            looked += u32::from(differ);
            found.is_none() && looked < MOST_PAIRS
        });
        found
    }

    /// Calls `f` with pairs of bodies that may overlap until it returns
    /// `false`. Boxes are sorted along the axis on which they spread most.
    fn pairs(&self, world: &World, mut f: impl FnMut(&Body, &Body) -> bool) {
        let everywhere = Aabb {
            min: DVec3::NEG_INFINITY,
            max: DVec3::INFINITY,
        };
        let mut boxes: Vec<(&Body, Aabb)> = self
            .bodies
            .iter()
            .map(|b| {
                let bounds = world.instance_bounds(b.instance).unwrap_or(everywhere);
                (b, bounds.padded(gamma(ROUNDINGS) * bounds.max_abs()))
            })
            .collect();
        let axis = widest_axis(&boxes);
        boxes.sort_by(|a, b| a.1.min[axis].total_cmp(&b.1.min[axis]));
        for (i, (a, a_box)) in boxes.iter().enumerate() {
            for (b, b_box) in &boxes[i + 1..] {
                if b_box.min[axis] > a_box.max[axis] {
                    break;
                }
                if a_box.overlaps(b_box) && near(world, a, b) && !f(a, b) {
                    return;
                }
            }
        }
    }
}

/// Where paths start: the bodies around all of the places, and those whose
/// surfaces pass between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    sure: Media,
    /// Rank and instance.
    unsure: Vec<(u16, u32)>,
}

impl Start {
    /// Inside the body of a rank and no other.
    pub fn inside(rank: u16) -> Self {
        Self {
            sure: Media::NONE.with(rank),
            unsure: Vec::new(),
        }
    }

    /// The bodies around one of the places.
    #[inline]
    pub fn at(&self, world: &World, p: DVec3) -> Media {
        self.unsure
            .iter()
            .filter(|&&(_, instance)| world.encloses(instance, p))
            .fold(self.sure, |media, &(rank, _)| media.with(rank))
    }

    /// The bodies around all of the places.
    pub fn sure(&self) -> &Media {
        &self.sure
    }

    /// The instances whose surfaces pass between the places.
    pub fn unsure(&self) -> impl Iterator<Item = u32> + '_ {
        self.unsure.iter().map(|&(_, instance)| instance)
    }
}

/// What touches may be parted by this many roundings of its coordinates, and
/// counts as touching.
pub(super) const ROUNDINGS: u32 = 64;

/// Pairs of bodies, and points of each, that are looked at for a tie.
const MOST_PAIRS: u32 = 1000;
const POINTS: u32 = 64;

/// The axis along which boxes spread most.
fn widest_axis(boxes: &[(&Body, Aabb)]) -> usize {
    let spread = |axis: usize| {
        let ends = boxes.iter().map(|(_, b)| b.min[axis]);
        ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
    };
    (0..3)
        .max_by(|&a, &b| spread(a).total_cmp(&spread(b)))
        .unwrap_or(0)
}

/// Whether two bodies' spheres have a point in common.
fn near(world: &World, a: &Body, b: &Body) -> bool {
    let sphere = |body: &Body| world.instance_sphere(body.instance);
    let (Some(a), Some(b)) = (sphere(a), sphere(b)) else {
        return true;
    };
    let far = a.center.abs().max(b.center.abs()).max_element();
    let off = gamma(ROUNDINGS) * (far + a.radius + b.radius);
    a.center.distance(b.center) <= a.radius + b.radius + off
}

/// Whether one of some points in the boxes of two bodies lies in both. The
/// points are those of a lattice whose steps are powers of a root of
/// `x^4 = x + 1`, which leaves no large gaps.
fn share_a_point(world: &World, a: &Body, b: &Body) -> bool {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let bounds = |body: &Body| world.instance_bounds(body.instance);
    let (Some(p), Some(q)) = (bounds(a), bounds(b)) else {
        return false;
    };
    let (min, max) = (p.min.max(q.min), p.max.min(q.max));
    let step = DVec3::new(1.0, ROOT, ROOT * ROOT) / (ROOT * ROOT * ROOT);
    (0..POINTS).any(|i| {
        let u = (DVec3::splat(0.5) + step * f64::from(i)).fract();
        let at = min + (max - min) * u;
        world.encloses(a.instance, at) && world.encloses(b.instance, at)
    })
}

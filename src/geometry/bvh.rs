//! The bounding volume hierarchy: over the triangles of a mesh, and over the
//! instances of a world.
//!
//! The tree is built by the `obvhs` crate (parallel locally-ordered
//! clustering, then reinsertion) and folded into nodes of [`WIDTH`] children,
//! which are tested together. Boxes are `f32` in *node space*: relative to
//! the centre of the whole and scaled by a power of two, so that the whole
//! fits into `[-1, 1]` whatever its size and place.
//!
//! No hit is lost to `f32`. A ray from outside is first advanced, in `f64`,
//! to where it enters the whole. From there every quantity of the slab test
//! is of order one, and its rounding errors act like a shift of the box's
//! faces (T. Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013): origin 1,
//! difference 2, direction, reciprocal and product 2 each, in units of 2^-24;
//! 12 of them are added to every box, the rest being for the advance. Leaves
//! are tested in `f64` by the caller.

mod build;
mod fold;
mod node;

use std::ops::Range;

use glam::{DVec3, Vec4};
use obvhs::BvhBuildParams;
use rayon::prelude::*;

use self::{
    fold::{fold, stack_need},
    node::{COUNT_SHIFT, FIRST, LEAF, MAX_PER_LEAF, Node, NodeRay, NodeSpace},
};
use super::Aabb;
use crate::numeric::{bounds::round_up_f32, gamma};

pub use self::node::{MAX_PRIMITIVES, WIDTH};

/// Stack entries that fit without allocation; deeper trees, which only
/// pathological scenes give, allocate.
const STACK: usize = 96;

/// So many primitives are looked at by one thread at a time.
const CHUNK: usize = 1 << 12;

/// A tree over primitives that the caller keeps, in the order of their slots.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    space: NodeSpace,
    /// The most stack entries that any ray can need.
    stack_need: usize,
}

#[derive(Clone, Copy, Default)]
struct Entry {
    t: f32,
    child: u32,
}

impl Bvh {
    /// Builds the tree over `count` primitives with the given finite boxes.
    /// Returns it with the primitive of each slot: the caller stores them in
    /// that order, and traversal speaks of slots.
    ///
    /// `per_leaf` is the largest number of primitives tested together, at
    /// most 8: more where their test is cheap.
    ///
    /// # Panics
    ///
    /// If `count` exceeds [`MAX_PRIMITIVES`].
    pub fn build(
        count: usize,
        per_leaf: u32,
        bounds: impl Fn(usize) -> Aabb + Sync,
    ) -> (Self, Vec<u32>) {
        assert!(count <= MAX_PRIMITIVES, "too many primitives for one tree");
        // In chunks of one size: the sign of a zero might depend on the order.
        let wholes: Vec<_> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|i| i * CHUNK..count.min((i + 1) * CHUNK))
            .map(|chunk| chunk.fold(Aabb::EMPTY, |b, i| b.union(bounds(i))))
            .collect();
        let whole = wholes.into_iter().fold(Aabb::EMPTY, Aabb::union);
        let space = NodeSpace::around(&whole);
        if count == 0 {
            return (
                Self {
                    nodes: Vec::new(),
                    space,
                    stack_need: 0,
                },
                Vec::new(),
            );
        }
        let boxes: Vec<_> = (0..count)
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| space.aabb(&bounds(i)))
            .collect();
        let params = BvhBuildParams {
            max_prims_per_leaf: per_leaf.clamp(1, MAX_PER_LEAF),
            ..BvhBuildParams::medium_build()
        };
        let binary = build::build(&boxes, params);
        drop(boxes);
        let (nodes, order) = fold(&binary);
        let stack_need = stack_need(&nodes);
        (
            Self {
                nodes,
                space,
                stack_need,
            },
            order,
        )
    }

    /// Visits leaves in roughly ascending distance. `leaf` gets a range of
    /// slots and the smallest `t` found so far (at first `t_max`), and
    /// returns the smaller of that and what it finds. The result is the last
    /// value returned.
    #[inline]
    pub fn closest(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaf: impl FnMut(Range<usize>, f64) -> f64,
    ) -> f64 {
        if self.nodes.is_empty() {
            return t_max;
        }
        let Some(ray) = self.space.enter(origin, dir, t_max) else {
            return t_max;
        };
        if self.stack_need <= STACK {
            self.walk(&ray, &mut [Entry::default(); STACK], t_max, leaf)
        } else {
            self.walk(
                &ray,
                &mut vec![Entry::default(); self.stack_need],
                t_max,
                leaf,
            )
        }
    }

    /// True if `leaf` says so for any range of slots whose box the ray meets
    /// before `t_max`.
    #[inline]
    pub fn any(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        mut leaf: impl FnMut(Range<usize>) -> bool,
    ) -> bool {
        // A negative `t` ends the walk: no box begins before it.
        let found = self.closest(
            origin,
            dir,
            t_max,
            |slots, t| if leaf(slots) { -1.0 } else { t },
        );
        found < 0.0
    }

    /// Visits the leaves whose boxes come within `radius` of `p`, until
    /// `leaf` says true. Returns whether it did.
    pub fn near(&self, p: DVec3, radius: f64, mut leaf: impl FnMut(Range<usize>) -> bool) -> bool {
        let center = (p - self.space.center) * self.space.scale;
        let radius = radius * self.space.scale * (1.0 + gamma(4));
        // Beyond the whole by more than the radius: also keeps the rounding of
        // what follows of order one.
        let reach = self.space.half + DVec3::splat(radius);
        if self.nodes.is_empty() || !center.abs().cmple(reach).all() {
            return false;
        }
        let (center, limit) = (center.as_vec3().to_array(), round_up_f32(radius * radius));
        let mut todo = Vec::with_capacity(self.stack_need);
        todo.push(0u32);
        while let Some(node) = todo.pop().map(|i| &self.nodes[i as usize]) {
            for lane in 0..WIDTH {
                let gap = (0..3).map(|a| {
                    let face = |side: usize| node.faces[a][side][lane / 4][lane % 4];
                    (face(0) - center[a]).max(center[a] - face(1)).max(0.0)
                });
                if gap.map(|g| g * g).sum::<f32>() > limit {
                    continue;
                }
                let child = node.children[lane];
                if child & LEAF == 0 {
                    todo.push(child);
                } else if leaf(slots(child)) {
                    return true;
                }
            }
        }
        false
    }

    #[inline]
    fn walk(
        &self,
        ray: &NodeRay,
        stack: &mut [Entry],
        mut t_best: f64,
        mut leaf: impl FnMut(Range<usize>, f64) -> f64,
    ) -> f64 {
        let mut limit = ray.limit(t_best);
        let mut len = 0;
        let mut current = 0;
        loop {
            if let Some(node) = self.nodes.get(current as usize) {
                len = push_hits(node, ray, limit, stack, len);
            }
            current = loop {
                if len == 0 {
                    return t_best;
                }
                len -= 1;
                let Entry { t, child } = stack[len];
                if t > limit {
                    continue;
                }
                if child & LEAF == 0 {
                    break child;
                }
                let t = leaf(slots(child), t_best);
                if t < t_best {
                    t_best = t;
                    if t < 0.0 {
                        return t;
                    }
                    limit = ray.limit(t);
                }
            };
        }
    }
}

/// The slots of a leaf's reference.
#[inline]
fn slots(leaf: u32) -> Range<usize> {
    let first = (leaf & FIRST) as usize;
    first..first + (leaf >> COUNT_SHIFT & 7) as usize + 1
}

/// Tests a node's boxes and puts those that are met on the stack, nearest on
/// top. Returns the stack's new length.
#[allow(
    clippy::inline_always,
    reason = "one call per node visited; measured at a tenth of the walk"
)]
#[inline(always)]
fn push_hits(node: &Node, ray: &NodeRay, limit: f32, stack: &mut [Entry], mut len: usize) -> usize {
    let mut near = [Vec4::ZERO; WIDTH / 4];
    let mut far = [Vec4::splat(limit); WIDTH / 4];
    for axis in 0..3 {
        let origin = Vec4::splat(ray.origin[axis]);
        let inverse = Vec4::splat(ray.inverse[axis]);
        let first = &node.faces[axis][usize::from(ray.backward[axis])];
        let last = &node.faces[axis][usize::from(!ray.backward[axis])];
        for half in 0..WIDTH / 4 {
            // Never NaN, see `inverse_f32`: the order of arguments does not
            // matter.
            near[half] = near[half].max((first[half] - origin) * inverse);
            far[half] = far[half].min((last[half] - origin) * inverse);
        }
    }
    let mut hits = near[0].cmple(far[0]).bitmask() | near[1].cmple(far[1]).bitmask() << 4;
    let near = [near[0].to_array(), near[1].to_array()];
    let base = len;
    while hits != 0 {
        let lane = hits.trailing_zeros() as usize % WIDTH;
        hits &= hits - 1;
        let entry = Entry {
            t: near[lane / 4][lane % 4],
            child: node.children[lane],
        };
        let mut at = len;
        while at > base && stack[at - 1].t < entry.t {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = entry;
        len += 1;
    }
    len
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nested boxes that shrink towards a corner make a tree about as deep
    /// as there are boxes: the walk must then allocate its stack, and still
    /// see everything.
    #[test]
    fn very_deep_trees() {
        let side = |i: usize| libm::exp2(-(i as f64) / 2.0);
        let bounds = |i: usize| Aabb {
            min: DVec3::ZERO,
            max: DVec3::splat(side(i)),
        };
        let (bvh, order) = Bvh::build(2000, 1, bounds);
        assert!(bvh.stack_need > STACK, "deep: {}", bvh.stack_need);
        let mut seen = vec![false; 2000];
        let see_all = |slots: Range<usize>, t: f64| {
            slots.for_each(|slot| seen[order[slot] as usize] = true);
            t
        };
        let t = bvh.closest(DVec3::splat(-1.0), DVec3::ONE, f64::INFINITY, see_all);
        assert_eq!(t, f64::INFINITY, "nothing was found");
        assert!(seen.iter().all(|&s| s), "every box lies on the diagonal");
    }

    /// Every slot is in exactly one leaf, and every primitive in one slot.
    #[test]
    fn leaves_partition_the_primitives() {
        let place = |i: usize| {
            let x = i as f64;
            DVec3::new(
                (x * 0.618).fract(),
                (x * 0.414).fract(),
                (x * 0.732).fract(),
            )
        };
        for count in [1, 2, 7, 8, 9, 1000] {
            let (bvh, order) = Bvh::build(count, 4, |i| Aabb::around([place(i), place(i) * 1.01]));
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.iter().copied().eq(0..count as u32), "{count}");
            let mut covered = 0;
            for child in bvh.nodes.iter().flat_map(Node::used) {
                if child & LEAF != 0 {
                    covered += (child >> COUNT_SHIFT & 7) as usize + 1;
                }
            }
            assert_eq!(covered, count);
        }
    }

    /// The limit never falls below the `t` it stands for.
    #[test]
    fn limits_are_rounded_up() {
        let (bvh, _) = Bvh::build(1, 1, |_| {
            Aabb::around([DVec3::splat(0.7), DVec3::splat(1.9)])
        });
        for (origin, dir) in [(-3e5, 0.3), (0.0, 1e-8), (1.0, 7e9)] {
            let origin = DVec3::splat(origin);
            let ray = bvh
                .space
                .enter(origin, DVec3::splat(dir), f64::INFINITY)
                .unwrap();
            for k in 1..50 {
                let t = (f64::from(k) / 37.0 + 0.7 - origin.x) / dir;
                assert!(
                    f64::from(ray.limit(t)) >= t * ray.per_t - ray.advanced,
                    "{t}"
                );
            }
            assert_eq!(ray.limit(f64::INFINITY), f32::INFINITY);
        }
    }
}

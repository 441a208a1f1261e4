//! Wide nodes, and the space in which their boxes live.

use glam::{DVec3, Vec3A, Vec4};

use crate::{
    geometry::{Aabb, transform::power_of_two_near},
    numeric::{
        bounds::{round_down_f32, round_up_f32},
        gamma,
    },
};

/// Children per node.
pub const WIDTH: usize = 8;

/// The largest number of primitives in one tree, 2^28.
pub const MAX_PRIMITIVES: usize = FIRST as usize + 1;

/// By how much boxes grow in node space; derived in the parent's text.
const GROWTH: f64 = 12.0 / 16_777_216.0;

/// A child reference: either the index of a node, or the flag, the number of
/// primitives less one, and the first primitive's slot.
pub(super) const LEAF: u32 = 1 << 31;
pub(super) const COUNT_SHIFT: u32 = 28;
pub(super) const FIRST: u32 = (1 << COUNT_SHIFT) - 1;
pub(super) const MAX_PER_LEAF: u32 = 8;

/// Eight numbers, one per child.
pub(super) type Lanes = [Vec4; WIDTH / 4];

/// Up to [`WIDTH`] boxes; those not used can't be hit.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Node {
    /// Lower and upper faces along each axis.
    pub(super) faces: [[Lanes; 2]; 3],
    pub(super) children: [u32; WIDTH],
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        faces: [[[Vec4::INFINITY; 2], [Vec4::NEG_INFINITY; 2]]; 3],
        children: [0; WIDTH],
    };

    pub(super) fn set(&mut self, lane: usize, aabb: &obvhs::aabb::Aabb, child: u32) {
        for axis in 0..3 {
            self.faces[axis][0][lane / 4][lane % 4] = aabb.min[axis];
            self.faces[axis][1][lane / 4][lane % 4] = aabb.max[axis];
        }
        self.children[lane] = child;
    }

    /// The references in use.
    pub(super) fn used(&self) -> impl Iterator<Item = u32> {
        let [low, high] = &self.faces[0];
        let used = move |lane: &usize| low[lane / 4][lane % 4] <= high[lane / 4][lane % 4];
        (0..WIDTH).filter(used).map(|lane| self.children[lane])
    }
}

/// The map from the caller's coordinates to the boxes'.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeSpace {
    pub(super) center: DVec3,
    /// A power of two, so that scaling is exact.
    pub(super) scale: f64,
    /// Half the size of the whole, grown, in node space.
    pub(super) half: DVec3,
}

/// A ray in node space, at the point where it enters the whole.
pub(super) struct NodeRay {
    pub(super) origin: [f32; 3],
    pub(super) inverse: [f32; 3],
    /// Along which axes it meets the upper face first.
    pub(super) backward: [bool; 3],
    /// Node-space length per unit of the caller's `t`.
    pub(super) per_t: f64,
    /// Node-space length already behind the ray.
    pub(super) advanced: f64,
}

impl NodeRay {
    /// The caller's `t` as a length from the point of entry, not below the
    /// true value.
    #[inline]
    pub(super) fn limit(&self, t: f64) -> f32 {
        round_up_f32(t * self.per_t * (1.0 + gamma(4)) - self.advanced)
    }
}

impl NodeSpace {
    pub(super) fn around(whole: &Aabb) -> Self {
        if whole.is_empty() {
            return Self {
                center: DVec3::ZERO,
                scale: 1.0,
                half: DVec3::ZERO,
            };
        }
        let center = whole.center();
        // The farther faces, since the centre has been rounded.
        let half = (whole.max - center).max(center - whole.min);
        let scale = 0.5 / power_of_two_near(half.max_element());
        let half = half * scale + DVec3::splat(2.0 * GROWTH);
        Self {
            center,
            scale,
            half,
        }
    }

    /// A box in node space, rounded outward and grown.
    pub(super) fn aabb(&self, b: &Aabb) -> obvhs::aabb::Aabb {
        let lo = ((b.min - self.center) * self.scale - DVec3::splat(GROWTH)).to_array();
        let hi = ((b.max - self.center) * self.scale + DVec3::splat(GROWTH)).to_array();
        obvhs::aabb::Aabb::new(
            Vec3A::from_array(lo.map(round_down_f32)),
            Vec3A::from_array(hi.map(round_up_f32)),
        )
    }

    /// The ray in node space from where it enters the whole; `None` if it
    /// passes by, or does not exist (a direction of zero, a NaN).
    #[inline]
    pub(super) fn enter(&self, origin: DVec3, dir: DVec3, t_max: f64) -> Option<NodeRay> {
        let length = dir.abs().max_element();
        let o = (origin - self.center) * self.scale;
        let d = dir / length;
        let (mut near, mut far) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let inverse = 1.0 / d[axis];
            let half = self.half[axis].copysign(d[axis]);
            let (enter, exit) = ((-half - o[axis]) * inverse, (half - o[axis]) * inverse);
            // A NaN (zero times infinity, on a face) leaves both as they are.
            near = if enter > near { enter } else { near };
            far = if exit < far { exit } else { far };
        }
        let per_t = length * self.scale;
        let far = far * (1.0 + 2.0 * gamma(3));
        // Written so that a NaN anywhere fails it.
        let meets = near <= far && near <= t_max * per_t * (1.0 + gamma(4));
        if !(meets && d.is_finite() && o.is_finite()) {
            return None;
        }
        let advanced = near * (1.0 - gamma(4));
        let o = o + d * advanced;
        Some(NodeRay {
            origin: o.to_array().map(|x| x as f32),
            inverse: d.to_array().map(inverse_f32),
            backward: d.to_array().map(f64::is_sign_negative),
            per_t,
            advanced,
        })
    }
}

/// The reciprocal of a direction's component. Components below 2^-60 of the
/// largest count as that: over the size of the whole the ray then moves by
/// far less than the boxes have grown, and no product can become NaN.
#[inline]
fn inverse_f32(d: f64) -> f32 {
    const LARGEST: f32 = (1u64 << 60) as f32;
    (1.0 / d as f32).clamp(-LARGEST, LARGEST)
}

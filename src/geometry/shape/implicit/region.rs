//! What intervals prove of a formula in a box, with a bounded effort.

use std::{cmp::Ordering, collections::BinaryHeap};

use glam::DVec3;

use crate::{
    formula::{Enclosure, Formula},
    geometry::Aabb,
    numeric::{Interval, gamma},
};

/// Boxes that are looked at for one face of the bounds, for one face's sign,
/// and for continuity.
const SHAVINGS: u32 = 1000;
const FACE_PARTS: u32 = 1000;
const VOLUME_PARTS: u32 = 4000;
/// Cells along each axis in which the gradient is bounded.
const CELLS: u32 = 8;
/// Bounds are as tight as this fraction of the box.
const TIGHTNESS: f64 = 1.0 / 256.0;

fn intervals(b: &Aabb) -> [Interval; 3] {
    std::array::from_fn(|i| Interval::new(b.min[i], b.max[i]))
}

/// The halves of a box across its longest side; nothing if floats do not
/// tell them apart.
fn halves(b: &Aabb) -> Option<[Aabb; 2]> {
    let size = b.max - b.min;
    let axis = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j]))?;
    let middle = b.min[axis] + 0.5 * size[axis];
    if middle <= b.min[axis] || middle >= b.max[axis] {
        return None;
    }
    let (mut low, mut high) = (*b, *b);
    low.max[axis] = middle;
    high.min[axis] = middle;
    Some([low, high])
}

/// True if `holds` is proven all over a box, cut into at most `budget` parts.
/// One that says `Some(false)` ends it.
fn proven(
    formula: &Formula,
    whole: Aabb,
    mut budget: u32,
    holds: impl Fn(&Enclosure) -> Option<bool>,
) -> bool {
    let mut open = vec![whole];
    while let Some(b) = open.pop() {
        if budget == 0 {
            return false;
        }
        budget -= 1;
        match holds(&formula.narrow_range(intervals(&b))) {
            Some(true) => {}
            Some(false) => return false,
            None => match halves(&b) {
                Some(parts) => open.extend(parts),
                None => return false,
            },
        }
    }
    true
}

/// True if the box encloses the inside wholly: the formula is positive on
/// all faces, and where it may be zero it is continuous.
pub(super) fn is_closed(formula: &Formula, whole: &Aabb) -> bool {
    let positive = |f: &Enclosure| match f.range.sign() {
        1 if f.continuous => Some(true),
        -1 => Some(false),
        _ if f.range.is_empty() => Some(false),
        _ => None,
    };
    let sound = |f: &Enclosure| {
        if f.continuous || f.range.sign() != 0 {
            Some(true)
        } else if f.range.is_empty() {
            Some(false)
        } else {
            None
        }
    };
    (0..6).all(|side| {
        let (axis, mut face) = (side / 2, *whole);
        if side % 2 == 0 {
            face.max[axis] = face.min[axis];
        } else {
            face.min[axis] = face.max[axis];
        }
        proven(formula, face, FACE_PARTS, positive)
    }) && proven(formula, *whole, VOLUME_PARTS, sound)
}

/// A box whose `key` says how soon it is looked at: the largest first.
struct Open {
    key: f64,
    region: Aabb,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key.total_cmp(&other.key)
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}

/// The tightest box found around all zeros inside a box; nothing if there
/// are provably none. A little is left around them, so that rays enter where
/// signs are known.
pub(super) fn shrunk(formula: &Formula, whole: &Aabb) -> Option<Aabb> {
    let mut tight = *whole;
    for axis in 0..3 {
        tight.min[axis] = -farthest(formula, &tight, axis, -1.0)?;
        tight.max[axis] = farthest(formula, &tight, axis, 1.0)?;
    }
    let margin = TIGHTNESS * (tight.max - tight.min).length();
    let roomy = tight.padded(margin);
    Some(Aabb {
        min: roomy.min.max(whole.min),
        max: roomy.max.min(whole.max),
    })
}

/// A bound on `sign * coordinate` over all zeros: best first, so that the
/// box on top is the one that bounds them all.
fn farthest(formula: &Formula, whole: &Aabb, axis: usize, sign: f64) -> Option<f64> {
    let resolution = TIGHTNESS * (whole.max - whole.min).max_element();
    let open = |region: Aabb| {
        let edge = if sign > 0.0 {
            region.max[axis]
        } else {
            -region.min[axis]
        };
        Open { key: edge, region }
    };
    let mut heap = BinaryHeap::from([open(*whole)]);
    let mut budget = SHAVINGS;
    while let Some(Open { key, region }) = heap.pop() {
        let range = formula.narrow_range(intervals(&region)).range;
        if range.is_empty() || range.sign() != 0 {
            continue;
        }
        budget -= 1;
        let fine = (region.max - region.min).max_element() <= resolution;
        match halves(&region) {
            Some(parts) if !fine && budget > 0 => heap.extend(parts.map(open)),
            _ => return Some(key),
        }
    }
    None
}

/// A bound on the length of the gradient in a box, and whether the formula is
/// continuous all over it. Cell by cell, since intervals of small boxes are
/// narrower.
pub(super) fn steepest(formula: &Formula, whole: &Aabb) -> (f64, bool) {
    let (mut steepest, mut smooth) = (0.0f64, true);
    let cell = (whole.max - whole.min) / f64::from(CELLS);
    for k in 0..CELLS.pow(3) {
        let place = DVec3::new(
            f64::from(k % CELLS),
            f64::from(k / CELLS % CELLS),
            f64::from(k / CELLS / CELLS),
        );
        // Cells overlap by more than their corners round.
        let b = Aabb {
            min: whole.min + cell * place,
            max: whole.min + cell * (place + DVec3::ONE),
        };
        let b = b.padded(gamma(8) * whole.max_abs());
        let (value, slopes) = formula.gradient_range(intervals(&b));
        let sum: f64 = slopes.iter().map(|s| s.magnitude() * s.magnitude()).sum();
        steepest = steepest.max(sum.sqrt() * (1.0 + gamma(5)));
        smooth &= value.continuous;
    }
    (steepest, smooth)
}

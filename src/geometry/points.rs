//! An index over points: the nearest ones, and those within a distance.
//!
//! Points keep the numbers that they were given with. Answers are in an order
//! of their own that depends on nothing else, so whoever adds up what hangs on
//! the points gets the same bits each time.

use std::num::NonZero;

use glam::{DMat3, DVec3};
use kiddo::{Eytzinger, FlatVec, KdTree, SquaredEuclidean};

type Tree = KdTree<f64, u32, Eytzinger, FlatVec<f64, u32, 3, 32>, 3, 32>;

/// Bytes that a point takes while the tree is built, at most: what goes into
/// the tree, and its place there in leaves that may be half empty.
pub const BYTES_PER_POINT: u64 = (ENTRY + 2 * ENTRY) as u64;

/// A point and its number, as it goes into the tree.
const ENTRY: usize = size_of::<([f64; 3], u32)>();

/// A point found: its number, and its squared distance in square metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Place in the list from which the index was made.
    pub number: u32,
    /// Squared distance from the place that was asked for.
    pub distance_sq: f64,
}

/// A kd-tree over points.
pub struct PointIndex {
    rotation: DMat3,
    /// `None` without points.
    tree: Option<Tree>,
    /// Number of points in the tree.
    count: usize,
}

impl PointIndex {
    /// The index over `points`. Those that are not finite are left out.
    ///
    /// # Panics
    /// If there are 2^32 points or more.
    pub fn new(points: impl ExactSizeIterator<Item = DVec3>) -> Self {
        assert!(
            u32::try_from(points.len()).is_ok(),
            "more points than numbers"
        );
        let rotation = off_axis();
        let entries: Vec<([f64; 3], u32)> = points
            .zip(0..)
            .filter(|(p, _)| p.is_finite())
            .map(|(p, number)| ((rotation * p).to_array(), number))
            .collect();
        // The builder refuses nothing that is finite and indexable by u32.
        let tree = (!entries.is_empty())
            .then(|| Tree::new_from_source_parallel(&entries, |e, axis| e.0[axis], |_, e| e.1).ok())
            .flatten();
        let count = entries.len();
        Self {
            rotation,
            tree,
            count,
        }
    }

    /// The `count` points nearest to `p`, or all if there are fewer: nearest
    /// first, those equally far by their numbers.
    pub fn nearest(&self, p: DVec3, count: NonZero<usize>, found: &mut Vec<Near>) {
        found.clear();
        // Room is made for as many as are asked for.
        let count = NonZero::new(self.count).map_or(count, |all| count.min(all));
        if let Some(tree) = &self.tree {
            let nearest = tree
                .query(&(self.rotation * p).to_array())
                .nearest_n::<SquaredEuclidean<f64>>(count)
                .execute();
            found.extend(nearest.iter().map(|n| Near {
                number: n.item,
                distance_sq: n.distance,
            }));
            found.sort_unstable_by(|a, b| {
                let by_distance = a.distance_sq.total_cmp(&b.distance_sq);
                by_distance.then(a.number.cmp(&b.number))
            });
        }
    }

    /// The points nearer to `p` than the square root of `radius_sq`, by their
    /// numbers.
    pub fn within(&self, p: DVec3, radius_sq: f64, found: &mut Vec<Near>) {
        found.clear();
        if let Some(tree) = &self.tree
            && radius_sq > 0.0
        {
            tree.query(&(self.rotation * p).to_array())
                .within::<SquaredEuclidean<f64>>(radius_sq)
                .unsorted()
                .visit(|n| {
                    if n.distance < radius_sq {
                        found.push(Near {
                            number: n.item,
                            distance_sq: n.distance,
                        });
                    }
                });
            found.sort_unstable_by_key(|n| n.number);
        }
    }
}

/// A rotation whose axes are far from each other's and from the coordinate
/// axes, since every third split of a kd-tree over an axis-aligned floor would
/// be wasted: the unit quaternion of (1, 2, 3, 5), exact arithmetic only.
pub(crate) fn off_axis() -> DMat3 {
    DMat3::from_quat(glam::DQuat::from_xyzw(1.0, 2.0, 3.0, 5.0).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Sequence};

    /// Points in the ways in which photons lie: all over, on a floor, on a
    /// line, on a grid, in one place, far away.
    fn clouds() -> Vec<Vec<DVec3>> {
        let random = |i: u64| {
            let mut u = Sequence::new(5, Purpose::Photon, 0, i).at(0);
            DVec3::new(u.next_1d(), u.next_1d(), u.next_1d())
        };
        let cloud = |n: u64, f: fn(DVec3) -> DVec3| (0..n).map(|i| f(random(i))).collect();
        vec![
            Vec::new(),
            vec![DVec3::ONE],
            cloud(2000, |p| p),
            cloud(2000, |p| p * DVec3::new(1.0, 1.0, 0.0)),
            cloud(500, |p| DVec3::X * p.x),
            cloud(500, |p| (p * 4.0).floor()),
            cloud(200, |_| DVec3::splat(0.3)),
            cloud(300, |p| p + DVec3::splat(1e5)),
            cloud(300, |p| {
                if p.x < 0.1 {
                    DVec3::new(f64::NAN, 0.0, f64::INFINITY)
                } else {
                    p
                }
            }),
        ]
    }

    /// Both questions against a look at every point.
    #[test]
    fn answers_are_those_of_a_loop() {
        for (c, points) in clouds().into_iter().enumerate() {
            let index = PointIndex::new(points.iter().copied());
            let mut found = Vec::new();
            for q in [
                DVec3::splat(0.4),
                DVec3::new(0.9, 0.1, 0.0),
                DVec3::splat(-7.0),
                DVec3::splat(1e5 + 0.5),
            ] {
                let mut all: Vec<(f64, u32)> = (0u32..)
                    .zip(&points)
                    .filter(|(_, p)| p.is_finite())
                    .map(|(i, p)| ((*p - q).length_squared(), i))
                    .collect();
                all.sort_by(|a, b| a.0.total_cmp(&b.0));
                // Rotated coordinates round anew.
                let slack = |d2: f64| 1e-9 * (1e-3 + d2);
                for count in [1, 7, 50, 5000] {
                    index.nearest(q, NonZero::new(count).expect("not zero"), &mut found);
                    assert_eq!(found.len(), all.len().min(count), "cloud {c}");
                    for (near, (d2, _)) in found.iter().zip(&all) {
                        let own = (points[near.number as usize] - q).length_squared();
                        assert!((near.distance_sq - d2).abs() <= slack(*d2), "cloud {c}");
                        assert!((near.distance_sq - own).abs() <= slack(own), "cloud {c}");
                    }
                }
                for radius in [0.0f64, 0.05, 0.4, 20.0] {
                    index.within(q, radius * radius, &mut found);
                    assert!(found.is_sorted_by(|a, b| a.number < b.number), "cloud {c}");
                    let own = |sign: f64| {
                        let limit = radius * radius + sign * slack(radius * radius);
                        all.iter().filter(|(d2, _)| *d2 < limit).count()
                    };
                    let count = if radius > 0.0 {
                        own(-1.0)..=own(1.0)
                    } else {
                        0..=0
                    };
                    assert!(count.contains(&found.len()), "cloud {c}, {radius}");
                }
            }
        }
    }
}

//! Sums over runs of indices whose bits do not depend on how the runs were cut
//! or in which order the pieces came.
//!
//! The indices are the leaves of one binary tree, fixed once and for all: two
//! neighbours `2j` and `2j + 1` are added first, then their sums, and so on.
//! What is kept are the sums of the largest subtrees whose leaves are all
//! there, at most 64 for a run. A subtree's sum is made in one way only, and
//! so is the total, from left to right, so ordinary floating-point addition
//! serves. Where the range of the addends is known beforehand,
//! [`ExactSum`](super::ExactSum) is smaller.

use std::{fmt::Debug, ops::Range};

use serde::{Deserialize, Serialize};

/// What can be summed; [`Default`] is the sum of nothing.
pub trait Addend: Clone + Default {
    /// Adds `other`, which has the higher indices.
    fn add(&mut self, other: &Self);
}

/// The sum of a whole subtree: of the indices `start .. start + 2^level`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Node<T> {
    start: u32,
    level: u8,
    sum: T,
}

impl<T> Node<T> {
    fn end(&self) -> u64 {
        u64::from(self.start) + (1 << self.level)
    }

    /// Whether `next` is the right half of the subtree whose left half this is.
    fn pairs_with(&self, next: &Self) -> bool {
        self.level == next.level
            && u64::from(self.start) % (2 << self.level) == 0
            && self.end() == u64::from(next.start)
    }

    /// Whether a subtree starts here, and all its indices are numbers of 32
    /// bits.
    fn is_sound(&self) -> bool {
        self.level <= 32
            && u64::from(self.start) % (1 << self.level) == 0
            && self.end() <= u64::from(u32::MAX) + 1
    }
}

/// A sum over some indices; see the module's text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DyadicSum<T> {
    /// By index, none twice, no two of which pair.
    nodes: Vec<Node<T>>,
}

/// An index that two sums share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overlap(pub u32);

impl<T> Default for DyadicSum<T> {
    fn default() -> Self {
        Self { nodes: Vec::new() }
    }
}

impl<T: Addend> DyadicSum<T> {
    /// Adds the addend of an index.
    ///
    /// # Errors
    /// If it is there already; the sum is then unchanged.
    pub fn push(&mut self, index: u32, addend: T) -> Result<(), Overlap> {
        let nodes = vec![Node {
            start: index,
            level: 0,
            sum: addend,
        }];
        self.merge(&Self { nodes })
    }

    /// Adds all that `other` has.
    ///
    /// # Errors
    /// If an index is in both; the sum is then unchanged.
    pub fn merge(&mut self, other: &Self) -> Result<(), Overlap> {
        let mut all = [&self.nodes[..], &other.nodes].concat();
        all.sort_by_key(|node| node.start);
        for pair in all.windows(2) {
            if pair[0].end() > u64::from(pair[1].start) {
                return Err(Overlap(pair[1].start));
            }
        }
        self.nodes.clear();
        for node in all {
            self.nodes.push(node);
            self.join_last();
        }
        Ok(())
    }

    /// Joins the last subtrees while they pair.
    fn join_last(&mut self) {
        while let [.., left, right] = &mut self.nodes[..]
            && left.pairs_with(right)
        {
            left.sum.add(&right.sum);
            left.level += 1;
            self.nodes.pop();
        }
    }

    /// The sum over all indices.
    pub fn total(&self) -> T {
        self.nodes.iter().fold(T::default(), |mut total, node| {
            total.add(&node.sum);
            total
        })
    }

    /// The indices, as runs without a gap.
    pub fn runs(&self) -> Vec<Range<u64>> {
        let mut runs: Vec<Range<u64>> = Vec::new();
        for node in &self.nodes {
            match runs.last_mut() {
                Some(last) if last.end == u64::from(node.start) => last.end = node.end(),
                _ => runs.push(u64::from(node.start)..node.end()),
            }
        }
        runs
    }

    /// The sums of the subtrees.
    pub fn sums(&self) -> impl Iterator<Item = &T> {
        self.nodes.iter().map(|node| &node.sum)
    }

    /// Whether the subtrees are such as this type makes them; not so, maybe,
    /// for what was read from a file.
    pub fn is_sound(&self) -> bool {
        self.nodes.iter().all(Node::is_sound)
            && self.nodes.windows(2).all(|pair| {
                pair[0].end() <= u64::from(pair[1].start) && !pair[0].pairs_with(&pair[1])
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A sum that shows its brackets.
    #[derive(Clone, Debug, Default, PartialEq)]
    struct Brackets(String);

    impl Addend for Brackets {
        fn add(&mut self, other: &Self) {
            self.0 = match self.0.as_str() {
                "" => other.0.clone(),
                ours => format!("({ours} {})", other.0),
            };
        }
    }

    impl Addend for f64 {
        fn add(&mut self, other: &Self) {
            *self += other;
        }
    }

    fn of(indices: impl IntoIterator<Item = u32>) -> DyadicSum<Brackets> {
        let mut sum = DyadicSum::default();
        for i in indices {
            sum.push(i, Brackets(i.to_string())).unwrap();
        }
        sum
    }

    #[test]
    fn brackets_are_those_of_the_tree() {
        assert_eq!(of(0..4).total().0, "((0 1) (2 3))");
        assert_eq!(of(0..7).total().0, "((((0 1) (2 3)) (4 5)) 6)");
        assert_eq!(of(1..4).total().0, "(1 (2 3))");
        assert_eq!(of([]).total().0, "");
    }

    #[test]
    fn runs_and_overlaps() {
        let mut sum = of([5, 3, 4, 9, 0]);
        assert_eq!(sum.runs(), [0..1, 3..6, 9..10]);
        let before = sum.clone();
        assert_eq!(sum.push(4, Brackets::default()), Err(Overlap(4)));
        assert_eq!(sum.merge(&of(6..12)), Err(Overlap(9)));
        assert_eq!(sum, before);
        let mut last = of([u32::MAX]);
        last.merge(&of([u32::MAX - 1])).unwrap();
        assert_eq!(last.runs()[0], u64::from(u32::MAX) - 1..1 << 32);
        assert!(last.is_sound() && sum.is_sound());
    }

    #[test]
    fn what_is_not_such_a_sum_is_told() {
        let node = |start, level| Node {
            start,
            level,
            sum: 0.0,
        };
        for nodes in [
            vec![node(1, 1)],
            vec![node(0, 33)],
            vec![node(u32::MAX, 1)],
            vec![node(4, 0), node(2, 0)],
            vec![node(0, 1), node(1, 0)],
            vec![node(0, 0), node(1, 0)],
        ] {
            assert!(!DyadicSum { nodes }.is_sound());
        }
        let nodes = vec![node(1, 0), node(2, 0)];
        assert!(DyadicSum { nodes }.is_sound());
    }

    proptest! {
        /// Cut into three pieces in any order, against one run: the same bits,
        /// also where plain sums differ.
        #[test]
        fn pieces_give_the_bits_of_the_whole(
            first in 0u32..40,
            values in prop::collection::vec(-1e9..1e9f64, 1..60),
            cuts in prop::array::uniform2(0usize..60),
            order in Just([0, 1, 2]).prop_shuffle(),
        ) {
            let sum = |range: Range<usize>| {
                let mut sum = DyadicSum::default();
                for i in range {
                    sum.push(first + i as u32, values[i]).unwrap();
                }
                sum
            };
            let whole = sum(0..values.len());
            let [a, b] = cuts.map(|c| c.min(values.len()));
            let pieces = [0..a.min(b), a.min(b)..a.max(b), a.max(b)..values.len()];
            let mut merged = DyadicSum::default();
            for i in order {
                merged.merge(&sum(pieces[i].clone())).unwrap();
            }
            prop_assert_eq!(merged.total().to_bits(), whole.total().to_bits());
            prop_assert_eq!(&merged, &whole);
            prop_assert!(whole.is_sound());
            let naive: f64 = values.iter().sum();
            prop_assert!((whole.total() - naive).abs() <= 1e-3);
        }
    }
}

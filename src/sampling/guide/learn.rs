//! How a guide's tree grows.

use std::{cmp::Ordering, collections::BinaryHeap};

use super::{GUIDE_DIMENSIONS, GUIDE_PAIRS, Node, Weighed};

/// Part of the probability that is spread evenly whatever was learned, so that
/// what was missed still comes.
pub(super) const UNGUIDED: f64 = 0.1;

/// Most halvings of a cell along one coordinate, and along all together.
const MAX_DEPTH: [u8; 2] = [10, 16];

/// A leaf, before its edges are known.
const LEAF: Node = Node::Leaf {
    edge: [1.0; GUIDE_PAIRS],
};

/// Samples of mean weight that each half is credited with beyond those seen.
const PRIOR: f64 = 1.0;

/// Intervals of a cell along a coordinate, compared to decide whether light is
/// uneven along it. Halves would not show a spot in the middle.
const BINS: usize = 8;

/// Unevenness, in units of what chance explains on average, above which a cell
/// is halved. Chance alone exceeds it less than once in a hundred times
/// (chi-square, 7 degrees of freedom).
const SIGNIFICANT: f64 = 3.0;

/// The nodes of a tree of at most so many leaves. `copies` of each sample are
/// given.
pub(super) fn grow(
    samples: &[Weighed],
    dimensions: usize,
    leaves: usize,
    copies: f64,
) -> Vec<Node> {
    let mut order: Vec<&Weighed> = samples.iter().collect();
    let mut tree = Learning {
        nodes: vec![LEAF],
        splits: BinaryHeap::new(),
        dimensions: dimensions.min(GUIDE_DIMENSIONS),
        copies,
    };
    tree.offer(&order, Cell::WHOLE);
    for _ in 1..leaves {
        let Some(split) = tree.splits.pop() else {
            break;
        };
        tree.halve(&mut order, &split);
    }
    tree.nodes
}

/// A cell while the tree grows.
#[derive(Clone, Copy)]
struct Cell {
    node: usize,
    /// Its samples in the common order.
    first: usize,
    count: usize,
    low: [f64; GUIDE_DIMENSIONS],
    depth: [u8; GUIDE_DIMENSIONS],
    /// Probability of the cell by what was learned.
    guided: f64,
}

impl Cell {
    const WHOLE: Self = Self {
        node: 0,
        first: 0,
        count: usize::MAX,
        low: [0.0; GUIDE_DIMENSIONS],
        depth: [0; GUIDE_DIMENSIONS],
        guided: 1.0,
    };

    /// Halvings since the whole cube.
    fn depth(&self) -> u8 {
        self.depth.iter().sum()
    }

    /// Probability of the cell.
    fn probability(&self) -> f64 {
        let volume = 0.5f64.powi(i32::from(self.depth()));
        UNGUIDED * volume + (1.0 - UNGUIDED) * self.guided
    }

    /// The samples in it.
    fn of<'a, 'b>(&self, order: &'b mut [&'a Weighed]) -> &'b mut [&'a Weighed] {
        &mut order[self.first..self.first + self.count]
    }

    /// Width along a coordinate.
    fn width(&self, d: usize) -> f64 {
        0.5f64.powi(i32::from(self.depth[d]))
    }
}

/// A cell worth halving along a coordinate. The more uneven ones come first.
struct Split {
    gain: f64,
    dimension: usize,
    cell: Cell,
}

impl Ord for Split {
    fn cmp(&self, other: &Self) -> Ordering {
        let older = other.cell.node.cmp(&self.cell.node);
        self.gain.total_cmp(&other.gain).then(older)
    }
}

impl PartialOrd for Split {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Split {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Split {}

/// A tree that grows.
struct Learning {
    nodes: Vec<Node>,
    splits: BinaryHeap<Split>,
    dimensions: usize,
    /// Copies of each sample, which are no evidence of their own.
    copies: f64,
}

impl Learning {
    /// Considers halving a cell whose samples are given.
    fn offer(&mut self, samples: &[&Weighed], mut cell: Cell) {
        cell.count = samples.len();
        let [most, most_in_all] = MAX_DEPTH;
        if cell.depth() >= most_in_all {
            return;
        }
        let (sum, squares) = moments(samples);
        // A sum of weights has this variance; its root a quarter of it over
        // the sum, the same for small parts and large ones.
        let chance = self.copies * squares / (4.0 * sum) * (BINS - 1) as f64;
        let best = (0..self.dimensions)
            .filter(|&d| cell.depth[d] < most)
            .map(|d| (unevenness(samples, &cell, d, sum), d))
            // The first of equals.
            .fold((0.0, 0), |best, x| if x.0 > best.0 { x } else { best });
        let gain = best.0 - SIGNIFICANT * chance;
        if gain > 0.0 {
            self.splits.push(Split {
                gain,
                dimension: best.1,
                cell,
            });
        }
    }

    /// Makes two leaves of one.
    fn halve(&mut self, order: &mut [&Weighed], split: &Split) {
        let (cell, d) = (&split.cell, split.dimension);
        let width = 0.5 * cell.width(d);
        let middle = cell.low[d] + width;
        let samples = cell.of(order);
        // Stable: the order of sums must not depend on the sorting.
        samples.sort_by_key(|s| s.at[d] >= middle);
        let count = samples.partition_point(|s| s.at[d] < middle);
        let (sum, squares) = moments(samples);
        let prior = PRIOR * self.copies * squares / sum;
        let below = moments(&samples[..count]).0;
        let share = (below + prior) / (sum + 2.0 * prior);
        let mut halves = [*cell; 2];
        let first = self.nodes.len();
        for (i, half) in halves.iter_mut().enumerate() {
            half.node = first + i;
            half.depth[d] += 1;
        }
        halves[0].count = count;
        halves[0].guided *= share;
        halves[1].first += count;
        halves[1].count -= count;
        halves[1].low[d] = middle;
        halves[1].guided *= 1.0 - share;
        let [low, high] = halves.map(|h| h.probability());
        self.nodes[cell.node] = Node::Inner {
            dimension: d as u8,
            halves: first as u32,
            low: low / (low + high),
            middle,
        };
        self.nodes.extend([LEAF; 2]);
        for half in halves {
            let samples = half.of(order);
            self.offer(samples, half);
        }
    }
}

/// Sum of the weights and of their squares.
fn moments(samples: &[&Weighed]) -> (f64, f64) {
    samples.iter().fold((0.0, 0.0), |(sum, squares), s| {
        (sum + s.weight, squares + s.weight * s.weight)
    })
}

/// How unevenly the weight is spread along a coordinate of a cell: the sum of
/// the squared differences between the roots of its parts and of its mean.
fn unevenness(samples: &[&Weighed], cell: &Cell, d: usize, sum: f64) -> f64 {
    let scale = BINS as f64 / cell.width(d);
    let mut bins = [0.0; BINS];
    for s in samples {
        // `as` saturates at 0.
        let bin = ((s.at[d] - cell.low[d]) * scale) as usize;
        bins[bin.min(BINS - 1)] += s.weight;
    }
    let mean = (sum / BINS as f64).sqrt();
    bins.iter().map(|b| (b.sqrt() - mean).powi(2)).sum()
}

//! A learned distribution over the unit cube.
//!
//! A binary tree halves cells of the cube; each inner node knows the
//! probability of its lower half. A point of the cube walks down the tree, its
//! coordinates stretched on the way like a cumulative distribution: along each
//! coordinate the map is increasing, so points that are spread evenly stay so
//! in every cell. Learning follows T. Müller, M. Gross and J. Novák,
//! *Practical Path Guiding*, CGF 36(4), 2017, in its use of trees; the halves'
//! probabilities are those of a Pólya tree (M. Lavine, *Some Aspects of Polya
//! Tree Distributions*, 1992), mixed with a uniform distribution.

use std::{cmp::Ordering, collections::BinaryHeap};

use super::hash::mix2;

/// Most coordinates of a cube.
pub const GUIDE_DIMENSIONS: usize = 4;

/// Part of the probability that is spread evenly whatever was learned, so that
/// what was missed still comes.
const UNGUIDED: f64 = 0.1;

/// Most cells.
const MAX_LEAVES: usize = 512;

/// Most cells of the tree by which samples are blurred, and the blur in widths
/// of its cells.
const COARSE_LEAVES: usize = 64;
const BLUR: f64 = 1.0;

/// How far around a point stretches are averaged, in widths of its cell.
const AROUND: f64 = 0.4;

/// Where they are taken, each place for a quarter of the way along every
/// coordinate.
const PLACES: [[f64; GUIDE_DIMENSIONS]; 4] = [
    [0.75, 0.25, -0.75, -0.25],
    [-0.25, 0.75, 0.25, -0.75],
    [-0.75, -0.25, 0.75, 0.25],
    [0.25, -0.75, -0.25, 0.75],
];

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// Samples per cell that must have been seen for as many cells.
const SAMPLES_PER_LEAF: usize = 4;

/// Most halvings of a cell along one coordinate, and along all together.
const MAX_DEPTH: [u8; 2] = [10, 16];

/// Samples of mean weight that each half is credited with beyond those seen.
const PRIOR: f64 = 1.0;

/// Intervals of a cell along a coordinate, compared to decide whether light is
/// uneven along it. Halves would not show a spot in the middle.
const BINS: usize = 8;

/// Unevenness, in units of what chance explains on average, above which a cell
/// is halved. Chance alone exceeds it less than once in a hundred times
/// (chi-square, 7 degrees of freedom).
const SIGNIFICANT: f64 = 3.0;

/// A node: a leaf has no halves.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Index of the lower half; the upper half follows. 0 in a leaf.
    halves: u32,
    /// Coordinate along which the cell is halved.
    dimension: u8,
    /// Probability of the lower half, strictly between 0 and 1.
    low: f64,
}

const LEAF: Node = Node {
    halves: 0,
    dimension: 0,
    low: 0.5,
};

/// A distribution over the unit cube of up to four dimensions, constant in
/// each of its cells and nowhere zero.
#[derive(Clone, Debug)]
pub struct Guide {
    nodes: Vec<Node>,
}

/// A point of a guide's distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guided {
    /// The point, each coordinate in `[0, 1)`.
    pub at: [f64; GUIDE_DIMENSIONS],
    /// Its density; the uniform one is 1.
    pub density: f64,
    /// Derivative of each coordinate by that of the even point. Their product
    /// is one over the density.
    pub stretch: [f64; GUIDE_DIMENSIONS],
    /// The stretches averaged around the point, partly at random. Kernels of
    /// this size change from cell to cell by degrees: where they change at
    /// once, there are ripples. All by chance would make light uneven.
    pub blurred: [f64; GUIDE_DIMENSIONS],
    /// How far each coordinate of the point is from the end of the cube, in
    /// coordinates of an even point with these blurred stretches.
    pub room: [f64; GUIDE_DIMENSIONS],
}

impl Guided {
    /// An even point, as it is.
    pub fn even(at: [f64; GUIDE_DIMENSIONS]) -> Self {
        Self {
            at,
            density: 1.0,
            stretch: [1.0; GUIDE_DIMENSIONS],
            blurred: [1.0; GUIDE_DIMENSIONS],
            room: at.map(|u| u.min(1.0 - u)),
        }
    }
}

/// A place in the cube and how much comes from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// The place.
    pub at: [f64; GUIDE_DIMENSIONS],
    /// Its weight, finite and not negative: what was found there over the
    /// density with which the place was drawn.
    pub weight: f64,
}

impl Guide {
    /// A distribution that follows the weights, over the first `dimensions`
    /// coordinates and with at most `cells` cells. `None` if all weights are zero.
    /// The result depends on the samples and their order alone.
    pub fn learn(samples: &[Weighed], dimensions: usize, cells: usize) -> Option<Self> {
        let found: Vec<Weighed> = samples.iter().filter(|s| s.weight > 0.0).copied().collect();
        if found.is_empty() {
            return None;
        }
        let most = cells.min(samples.len() / SAMPLES_PER_LEAF);
        let coarse = Self::grow(&found, dimensions, most.min(COARSE_LEAVES), 1.0);
        // The border of what matters is known as well as the coarse cells are
        // small; light just beyond it must not come as a rare bright photon.
        let blurred: Vec<Weighed> = (0u32..)
            .zip(&found)
            .flat_map(|(i, s)| {
                let weight = 0.5 * s.weight;
                let at = coarse.displaced(s.at, i);
                [Weighed { at, weight }, Weighed { weight, ..*s }]
            })
            .collect();
        Some(Self::grow(&blurred, dimensions, most.min(MAX_LEAVES), 2.0))
    }

    /// A tree of at most so many leaves. `copies` of each sample are given.
    fn grow(samples: &[Weighed], dimensions: usize, leaves: usize, copies: f64) -> Self {
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
        Self { nodes: tree.nodes }
    }

    /// A point moved by up to the width of its cell along each coordinate,
    /// point `i` of an even sequence (R. Kronecker's, with the generalised
    /// golden ratio of M. Roberts, 2018); reflected at the border.
    fn displaced(&self, at: [f64; GUIDE_DIMENSIONS], i: u32) -> [f64; GUIDE_DIMENSIONS] {
        const RATIO: f64 = 1.0 / 1.167_303_978_261_418_7;
        let width = self.widths(at);
        let mut alpha = 1.0;
        std::array::from_fn(|d| {
            alpha *= RATIO;
            let offset = 2.0 * (0.5 + alpha * f64::from(i)).fract() - 1.0;
            reflected(at[d] + BLUR * width[d] * offset)
        })
    }

    /// The widths of the cell in which a point lies.
    fn widths(&self, at: [f64; GUIDE_DIMENSIONS]) -> [f64; GUIDE_DIMENSIONS] {
        self.cell(at).0
    }

    /// The widths of the cell in which a point lies, and its probability by
    /// the coordinates along which it was halved.
    #[inline]
    fn cell(
        &self,
        at: [f64; GUIDE_DIMENSIONS],
    ) -> ([f64; GUIDE_DIMENSIONS], [f64; GUIDE_DIMENSIONS]) {
        let mut low = [0.0; GUIDE_DIMENSIONS];
        let mut width = [1.0; GUIDE_DIMENSIONS];
        let mut chance = [1.0; GUIDE_DIMENSIONS];
        let mut node = &self.nodes[0];
        while node.halves != 0 {
            let d = usize::from(node.dimension);
            width[d] *= 0.5;
            let upper = at[d] >= low[d] + width[d];
            if upper {
                low[d] += width[d];
            }
            chance[d] *= if upper { 1.0 - node.low } else { node.low };
            node = &self.nodes[node.halves as usize + usize::from(upper)];
        }
        (width, chance)
    }

    /// Maps an even point of the cube to a point of the distribution.
    #[inline]
    pub fn warp(&self, even: [f64; GUIDE_DIMENSIONS]) -> Guided {
        let mut u = even;
        let mut low = [0.0; GUIDE_DIMENSIONS];
        let mut width = [1.0; GUIDE_DIMENSIONS];
        let mut chance = [1.0; GUIDE_DIMENSIONS];
        let mut node = &self.nodes[0];
        while node.halves != 0 {
            let d = usize::from(node.dimension);
            width[d] *= 0.5;
            let (rest, p, upper) = if u[d] < node.low {
                (u[d] / node.low, node.low, 0)
            } else {
                low[d] += width[d];
                ((u[d] - node.low) / (1.0 - node.low), 1.0 - node.low, 1)
            };
            u[d] = rest.min(BELOW_ONE);
            chance[d] *= p;
            node = &self.nodes[(node.halves + upper) as usize];
        }
        let mut out = Guided::even(even);
        for d in 0..GUIDE_DIMENSIONS {
            out.at[d] = (low[d] + width[d] * u[d]).min(BELOW_ONE);
            out.stretch[d] = width[d] / chance[d];
            out.density *= chance[d] / width[d];
        }
        // Four numbers of sixteen bits, at random but always the same.
        let hash = even.iter().fold(0, |hash, u| mix2(hash, u.to_bits()));
        let jitter: [f64; GUIDE_DIMENSIONS] =
            std::array::from_fn(|d| f64::from((hash >> (16 * d)) as u16) / 65536.0 - 0.5);
        let mut product = [1.0; GUIDE_DIMENSIONS];
        for offsets in PLACES {
            let near = std::array::from_fn(|d| {
                reflected(out.at[d] + AROUND * width[d] * (offsets[d] + 0.5 * jitter[d]))
            });
            let (width, chance) = self.cell(near);
            for d in 0..GUIDE_DIMENSIONS {
                product[d] *= width[d] / chance[d];
            }
        }
        for d in 0..GUIDE_DIMENSIONS {
            out.blurred[d] = product[d].sqrt().sqrt();
            out.room[d] = out.at[d].min(1.0 - out.at[d]) / out.blurred[d];
        }
        out
    }

    /// Number of cells.
    pub fn leaves(&self) -> usize {
        self.nodes.len().div_ceil(2)
    }
}

/// A coordinate that left the unit interval by less than its length, thrown
/// back at the border.
fn reflected(x: f64) -> f64 {
    let x = x.abs();
    let inside = if x < 1.0 { x } else { 2.0 - x };
    inside.clamp(0.0, BELOW_ONE)
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
        self.nodes[cell.node] = Node {
            halves: first as u32,
            dimension: d as u8,
            low: low / (low + high),
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

#[cfg(test)]
mod tests;

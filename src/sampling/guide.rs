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

mod learn;

use super::hash::mix2;
use learn::grow;

/// Most coordinates of a cube.
pub const GUIDE_DIMENSIONS: usize = 4;

/// Most pairs of coordinates: the first and the second one, the third and the
/// fourth one.
pub const GUIDE_PAIRS: usize = GUIDE_DIMENSIONS / 2;

/// Most cells.
const MAX_LEAVES: usize = 512;

/// Most cells of the tree by which samples are blurred, and the blur in widths
/// of its cells.
const COARSE_LEAVES: usize = 64;
const BLUR: f64 = 1.0;

/// How far around a point edges are averaged, in widths of its cell.
const AROUND: f64 = 0.4;

/// Where they are taken, in units of that: along every coordinate one place in
/// the middle of each quarter of the way.
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

/// A cell of the tree.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// One that is not halved.
    Leaf {
        /// See [`Guided::edge`].
        edge: [f64; GUIDE_PAIRS],
    },
    /// One that is.
    Inner {
        /// Coordinate along which it is halved.
        dimension: u8,
        /// Index of the lower half; the upper half follows.
        halves: u32,
        /// Probability of the lower half, strictly between 0 and 1.
        low: f64,
        /// Where the upper half begins.
        middle: f64,
    },
}

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
    /// For each pair of coordinates, the root of the area of a small square's
    /// image over its own: the edge of an even patch of that area. A patch of
    /// the image's own shape would tell how the tree happened to grow. The
    /// product of the squares is one over the density.
    pub edge: [f64; GUIDE_PAIRS],
    /// The mean edge around the point over that at the point. Kernels that
    /// are larger by this factor change their size from cell to cell by
    /// degrees: where it changes at once, there are ripples. Places around the
    /// point are partly random; wholly random ones would make light uneven.
    pub kernel: [f64; GUIDE_PAIRS],
}

impl Guided {
    /// An even point, as it is.
    pub fn even(at: [f64; GUIDE_DIMENSIONS]) -> Self {
        Self {
            at,
            density: 1.0,
            edge: [1.0; GUIDE_PAIRS],
            kernel: [1.0; GUIDE_PAIRS],
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
        let coarse = Self::of(grow(&found, dimensions, most.min(COARSE_LEAVES), 1.0));
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
        let nodes = grow(&blurred, dimensions, most.min(MAX_LEAVES), 2.0);
        Some(Self::of(nodes))
    }

    /// The guide of a finished tree.
    fn of(mut nodes: Vec<Node>) -> Self {
        let mut open = vec![(0, [1.0; GUIDE_PAIRS])];
        while let Some((i, areas)) = open.pop() {
            match &mut nodes[i] {
                Node::Leaf { edge } => *edge = areas.map(f64::sqrt),
                Node::Inner {
                    dimension,
                    halves,
                    low,
                    ..
                } => {
                    for (half, p) in [(0, *low), (1, 1.0 - *low)] {
                        let mut areas = areas;
                        areas[usize::from(*dimension) / 2] *= 0.5 / p;
                        open.push((*halves as usize + half, areas));
                    }
                }
            }
        }
        Self { nodes }
    }

    /// A point moved by up to the width of its cell along each coordinate,
    /// point `i` of an even sequence (R. Kronecker's, with the generalised
    /// golden ratio of M. Roberts, 2018); reflected at the border.
    fn displaced(&self, at: [f64; GUIDE_DIMENSIONS], i: u32) -> [f64; GUIDE_DIMENSIONS] {
        const RATIO: f64 = 1.0 / 1.167_303_978_261_418_7;
        let mut width = [1.0; GUIDE_DIMENSIONS];
        self.edge(at, |d| width[d] *= 0.5);
        let mut alpha = 1.0;
        std::array::from_fn(|d| {
            alpha *= RATIO;
            let offset = 2.0 * (0.5 + alpha * f64::from(i)).fract() - 1.0;
            reflected(at[d] + BLUR * width[d] * offset)
        })
    }

    /// The edges of the cell in which a point lies. Every coordinate along
    /// which a cell around it is halved is told.
    #[inline]
    fn edge(
        &self,
        at: [f64; GUIDE_DIMENSIONS],
        mut halved: impl FnMut(usize),
    ) -> [f64; GUIDE_PAIRS] {
        let mut node = &self.nodes[0];
        loop {
            match *node {
                Node::Leaf { edge } => return edge,
                Node::Inner {
                    dimension,
                    halves,
                    middle,
                    ..
                } => {
                    let d = usize::from(dimension) % GUIDE_DIMENSIONS;
                    halved(d);
                    node = &self.nodes[halves as usize + usize::from(at[d] >= middle)];
                }
            }
        }
    }

    /// Maps an even point of the cube to a point of the distribution.
    #[inline]
    pub fn warp(&self, even: [f64; GUIDE_DIMENSIONS]) -> Guided {
        let mut u = even;
        let mut low = [0.0; GUIDE_DIMENSIONS];
        let mut width = [1.0; GUIDE_DIMENSIONS];
        let mut node = &self.nodes[0];
        let edge = loop {
            match *node {
                Node::Leaf { edge } => break edge,
                Node::Inner {
                    dimension,
                    halves,
                    low: share,
                    ..
                } => {
                    let d = usize::from(dimension) % GUIDE_DIMENSIONS;
                    width[d] *= 0.5;
                    let (rest, upper) = if u[d] < share {
                        (u[d] / share, 0)
                    } else {
                        low[d] += width[d];
                        ((u[d] - share) / (1.0 - share), 1)
                    };
                    u[d] = rest.min(BELOW_ONE);
                    node = &self.nodes[(halves + upper) as usize];
                }
            }
        };
        let at = std::array::from_fn(|d| (low[d] + width[d] * u[d]).min(BELOW_ONE));
        // Four numbers of sixteen bits, at random but always the same.
        let hash = even.iter().fold(0, |hash, u| mix2(hash, u.to_bits()));
        let jitter: [f64; GUIDE_DIMENSIONS] =
            std::array::from_fn(|d| f64::from((hash >> (16 * d)) as u16) / 65536.0 - 0.5);
        let mut product = [1.0; GUIDE_PAIRS];
        for offsets in PLACES {
            let near = std::array::from_fn(|d| {
                reflected(at[d] + AROUND * width[d] * (offsets[d] + 0.5 * jitter[d]))
            });
            for (product, edge) in product.iter_mut().zip(self.edge(near, |_| {})) {
                *product *= edge;
            }
        }
        Guided {
            at,
            density: 1.0 / edge.iter().map(|e| e * e).product::<f64>(),
            edge,
            kernel: std::array::from_fn(|i| product[i].sqrt().sqrt() / edge[i]),
        }
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

#[cfg(test)]
mod tests;

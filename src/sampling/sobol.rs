//! The Sobol sequence with Owen scrambling, at any index and dimension.
//!
//! 32-bit points: 2^32 indices and 64 dimensions (Joe and Kuo 2008). The
//! scrambling is the hash form of nested uniform scrambling (Laine and Karras
//! 2011; Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020): on
//! bit-reversed numbers, a hash in which a bit influences only higher bits.

use super::joe_kuo::ROWS;

/// Number of dimensions with direction numbers of their own.
pub const DIMENSIONS: usize = 64;

/// Bits of an index that are looked up together.
const GROUP: usize = 4;

/// For each dimension and each group of bits of an index, what every value of
/// the group adds (exclusive or) to the point, with bits reversed. Eight
/// look-ups a point instead of one for each bit that is set; a path's
/// dimensions share a few cache lines.
static GROUPS: [[[u32; 1 << GROUP]; 32 / GROUP]; DIMENSIONS] = groups();

#[allow(
    clippy::large_stack_arrays,
    reason = "evaluated when compiling: it is never on a stack"
)]
const fn groups() -> [[[u32; 1 << GROUP]; 32 / GROUP]; DIMENSIONS] {
    let directions = directions();
    let mut table = [[[0u32; 1 << GROUP]; 32 / GROUP]; DIMENSIONS];
    let mut d = 0;
    while d < DIMENSIONS {
        let mut bit = 0;
        while bit < 32 {
            let mut value = 0;
            while value < 1 << GROUP {
                if value >> (bit % GROUP) & 1 == 1 {
                    table[d][bit / GROUP][value] ^= directions[d][bit].reverse_bits();
                }
                value += 1;
            }
            bit += 1;
        }
        d += 1;
    }
    table
}

/// Direction numbers, one row of 32 a dimension, first bit highest.
const fn directions() -> [[u32; 32]; DIMENSIONS] {
    let mut table = [[0u32; 32]; DIMENSIONS];
    let mut k = 0;
    while k < 32 {
        table[0][k] = 1 << (31 - k);
        k += 1;
    }
    let mut d = 1;
    while d < DIMENSIONS {
        let row = &ROWS[d - 1];
        let s = row.m.len();
        let mut k = 0;
        while k < 32 {
            table[d][k] = if k < s {
                row.m[k] << (31 - k)
            } else {
                let mut v = table[d][k - s] ^ (table[d][k - s] >> s);
                let mut j = 1;
                while j < s {
                    if (row.a >> (s - 1 - j)) & 1 == 1 {
                        v ^= table[d][k - j];
                    }
                    j += 1;
                }
                v
            };
            k += 1;
        }
        d += 1;
    }
    table
}

/// Point `index` of the unscrambled sequence in `dimension < 64`, as a 32-bit
/// fraction.
#[inline]
pub fn sobol(index: u32, dimension: usize) -> u32 {
    reversed(index, dimension).reverse_bits()
}

/// [`sobol`], first bit lowest.
#[inline]
fn reversed(index: u32, dimension: usize) -> u32 {
    let mut x = 0;
    for (k, group) in GROUPS[dimension].iter().enumerate() {
        x ^= group[(index >> (GROUP * k)) as usize % (1 << GROUP)];
    }
    x
}

/// Owen scrambling of a 32-bit fraction: each bit is flipped or not depending
/// on the seed and the bits above it. Takes the fraction with bits reversed,
/// since the hash works from low to high bits.
#[inline]
fn owen_of_reversed(x: u32, seed: u32) -> u32 {
    let mut v = x;
    // Even multipliers: no bit influences itself or lower ones. The constants
    // are those of N. Vegdahl, *Building a Better LK Hash*, 2021.
    v ^= v.wrapping_mul(0x3d20_adea);
    v = v.wrapping_add(seed);
    v = v.wrapping_mul((seed >> 16) | 1);
    v ^= v.wrapping_mul(0x0552_6c56);
    v ^= v.wrapping_mul(0x53a2_2864);
    v.reverse_bits()
}

/// Another order of the indices below 2^16, and of each further block of so
/// many: aligned blocks of a power of two stay together, so that the first
/// 2^m indices still name 2^m points of good quality (Burley 2020, section 5:
/// the scrambling applied to the index).
#[inline]
pub(super) fn shuffled(index: u32, seed: u32) -> u32 {
    let (block, low) = (index & 0xffff_0000, index << 16);
    block | (owen_of_reversed(low.reverse_bits(), seed ^ block) >> 16)
}

/// Owen-scrambled point in `[0, 1)`; equal seeds give equal scramblings.
#[inline]
pub fn sobol_owen(index: u32, dimension: usize, seed: u32) -> f64 {
    f64::from(owen_of_reversed(reversed(index, dimension), seed)) * (1.0 / 4_294_967_296.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first points, known from the published example program.
    #[test]
    fn first_points() {
        let half = 1u32 << 31;
        let q = 1u32 << 30;
        assert_eq!(
            (0..4).map(|i| sobol(i, 0)).collect::<Vec<_>>(),
            [0, half, q, half + q]
        );
        assert_eq!(
            (0..4).map(|i| sobol(i, 1)).collect::<Vec<_>>(),
            [0, half, half + q, q]
        );
    }

    /// Looked up by groups, and added bit by bit as the sequence is defined.
    #[test]
    fn groups_of_bits_add_up() {
        let directions = directions();
        for (d, row) in directions.iter().enumerate() {
            for k in 0..200u64 {
                let index = super::super::mix(k) as u32 >> (k % 32);
                let set = (0..32).filter(|bit| index >> bit & 1 == 1);
                let sum = set.fold(0, |x, bit| x ^ row[bit]);
                assert_eq!(sobol(index, d), sum, "point {index}, dimension {d}");
            }
        }
    }

    /// Every one-dimensional projection of 2^m points has one point in each of
    /// 2^m equal intervals, scrambled or not, at any aligned start.
    #[test]
    fn one_dimensional_strata() {
        for d in 0..DIMENSIONS {
            for start in [0u32, 3 << 8, 0xffff_ff00] {
                let mut seen = [false; 256];
                for i in 0..256 {
                    let x = sobol_owen(start + i, d, 0x1234_5678 ^ d as u32);
                    let cell = (x * 256.0) as usize;
                    assert!(
                        !seen[cell],
                        "dimension {d}, start {start}: cell {cell} twice"
                    );
                    seen[cell] = true;
                }
            }
        }
    }

    /// Dimensions 0 and 1 form a (0, 2)-sequence: all elementary intervals of
    /// area 2^-8 hold one of 256 points.
    #[test]
    fn two_dimensional_elementary_intervals() {
        for seed in [1u32, 99, 0xdead_beef] {
            let pts: Vec<_> = (512..768)
                .map(|i| {
                    (
                        sobol_owen(i, 0, seed),
                        sobol_owen(i, 1, seed.wrapping_mul(0x9e37_79b9)),
                    )
                })
                .collect();
            for a in 0..=8u32 {
                let (nx, ny) = (f64::from(1u32 << a), f64::from(1u32 << (8 - a)));
                let mut seen = vec![false; 256];
                for &(x, y) in &pts {
                    let cell = (x * nx) as usize + ((y * ny) as usize) * nx as usize;
                    assert!(!seen[cell], "shape {a}: cell {cell} twice");
                    seen[cell] = true;
                }
            }
        }
    }

    /// Over seeds, a scrambled point is uniform: chi-square over 64 cells.
    #[test]
    fn scrambling_is_uniform_over_seeds() {
        for index in [0u32, 1, 77] {
            let mut counts = [0.0f64; 64];
            let n = 64 * 400;
            for s in 0..n {
                counts[(sobol_owen(index, 3, super::super::mix(s) as u32) * 64.0) as usize] += 1.0;
            }
            let chi2: f64 = counts.iter().map(|c| (c - 400.0).powi(2) / 400.0).sum();
            // 63 degrees of freedom: the 99.99 % quantile is 113.
            assert!(chi2 < 113.0, "index {index}: chi2 = {chi2}");
        }
    }

    #[test]
    fn shuffling_permutes_aligned_blocks() {
        for seed in [0u32, 1, 0xdead_beef] {
            for (first, size) in [(0u32, 8u32), (0, 64), (96, 32), (1 << 20, 256)] {
                let mut found: Vec<u32> =
                    (first..first + size).map(|i| shuffled(i, seed)).collect();
                found.sort_unstable();
                assert_eq!(found[0] % size, 0, "an aligned block");
                assert!(found.windows(2).all(|w| w[1] == w[0] + 1), "{found:?}");
            }
        }
        assert_ne!(shuffled(5, 1), shuffled(5, 2));
    }

    /// Integrating a smooth function converges clearly faster than 1/sqrt(n).
    #[test]
    fn convergence_beats_random() {
        let rms = |n: u32| {
            let seeds = 32u64;
            let sum: f64 = (0..seeds)
                .map(|s| {
                    let mean = (0..n)
                        .map(|i| {
                            (0..4)
                                .map(|d| {
                                    let seed = super::super::mix2(s, d as u64) as u32;
                                    0.5 + sobol_owen(i, d, seed)
                                })
                                .product::<f64>()
                        })
                        .sum::<f64>()
                        / f64::from(n);
                    (mean - 1.0).powi(2)
                })
                .sum();
            (sum / seeds as f64).sqrt()
        };
        let (coarse, fine) = (rms(64), rms(4096));
        let slope = (coarse / fine).ln() / 64f64.ln();
        assert!(
            slope > 0.9,
            "error falls like n^-{slope:.2}, random gives n^-0.5"
        );
    }
}

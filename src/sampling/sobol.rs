//! The Sobol sequence with Owen scrambling, at any index and dimension.
//!
//! 32-bit points: 2^32 indices and 16 dimensions (Joe and Kuo 2008); farther
//! ones have pairs that leave half of a 16 x 16 grid empty after 4096 points,
//! so streams repeat these 16 in another order instead. The
//! scrambling is the hash form of nested uniform scrambling (Laine and Karras
//! 2011; Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020): on
//! bit-reversed numbers, a hash in which a bit influences only higher bits.

use super::joe_kuo::ROWS;

/// Number of dimensions with direction numbers of their own.
pub const DIMENSIONS: usize = 16;

/// Bits of an index that are looked up together.
const GROUP: usize = 4;

/// What every value of each group of bits of an index adds (exclusive or) to
/// the point, with bits reversed, in all dimensions: eight look-ups instead of
/// one for each bit that is set, each in one cache line for a whole path.
static GROUPS: [[Row; 1 << GROUP]; 32 / GROUP] = groups();

/// One number for each dimension, in a cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Row([u32; DIMENSIONS]);

const fn groups() -> [[Row; 1 << GROUP]; 32 / GROUP] {
    let directions = directions();
    let mut table = [[Row([0; DIMENSIONS]); 1 << GROUP]; 32 / GROUP];
    let mut d = 0;
    while d < DIMENSIONS {
        let mut bit = 0;
        while bit < 32 {
            let mut value = 0;
            while value < 1 << GROUP {
                if value >> (bit % GROUP) & 1 == 1 {
                    table[bit / GROUP][value].0[d] ^= directions[d][bit].reverse_bits();
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

/// Point `index` of the unscrambled sequence in `dimension < 16`, as a 32-bit
/// fraction.
#[inline]
pub fn sobol(index: u32, dimension: usize) -> u32 {
    reversed(index, dimension).reverse_bits()
}

/// [`sobol`], first bit lowest.
#[inline]
fn reversed(index: u32, dimension: usize) -> u32 {
    let mut x = 0;
    for (k, group) in GROUPS.iter().enumerate() {
        x ^= group[(index >> (GROUP * k)) as usize % (1 << GROUP)].0[dimension];
    }
    x
}

/// [`reversed`] in the first four dimensions at once.
#[inline]
fn reversed_4(index: u32) -> [u32; 4] {
    let mut x = [0; 4];
    for (k, group) in GROUPS.iter().enumerate() {
        let row = &group[(index >> (GROUP * k)) as usize % (1 << GROUP)].0;
        for (x, r) in x.iter_mut().zip(row) {
            *x ^= r;
        }
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
    fraction(owen_of_reversed(reversed(index, dimension), seed))
}

/// [`sobol_owen`] in the first four dimensions, with a seed for each.
#[inline]
pub(super) fn sobol_owen_4(index: u32, seeds: [u32; 4]) -> [f64; 4] {
    let x = reversed_4(index);
    [0, 1, 2, 3].map(|d| fraction(owen_of_reversed(x[d], seeds[d])))
}

/// 32 bits as a number in `[0, 1)`.
#[inline]
fn fraction(bits: u32) -> f64 {
    f64::from(bits) * (1.0 / 4_294_967_296.0)
}

#[cfg(test)]
mod tests;

//! Which points stand at the same place.

use std::cmp::Ordering;

use glam::DVec3;
use rayon::prelude::*;

/// For each of `count` points the first one that equals it, by index.
///
/// `hash` must be the same for equal points. Eight bytes a point are sorted;
/// points that share a hash are sorted by `compare`, so that no choice of
/// points makes this slow. The result depends on the points alone.
pub fn first_alike(
    count: usize,
    hash: impl Fn(usize) -> u32 + Sync,
    compare: impl Fn(usize, usize) -> Ordering + Sync,
) -> Vec<u32> {
    const INDEX: u64 = u32::MAX as u64;
    let mut keys: Vec<u64> = (0..count)
        .into_par_iter()
        .map(|i| u64::from(hash(i)) << 32 | i as u64)
        .collect();
    keys.par_sort_unstable();
    let index = |key: &u64| (key & INDEX) as usize;
    keys.par_chunk_by_mut(|a, b| a >> 32 == b >> 32)
        .filter(|alike| alike.len() > 1)
        .for_each(|alike| {
            alike.sort_unstable_by(|a, b| compare(index(a), index(b)).then(a.cmp(b)));
        });
    let mut first: Vec<u32> = vec![0; count];
    let mut before: Option<u64> = None;
    for key in keys {
        let same = before
            .filter(|b| b >> 32 == key >> 32 && compare(index(b), index(&key)) == Ordering::Equal);
        let leader = same.unwrap_or(key);
        first[index(&key)] = index(&leader) as u32;
        before = Some(leader);
    }
    first
}

/// [`first_alike`] for positions, by their bits; the two zeros are one.
pub fn first_at_place(positions: &[DVec3]) -> Vec<u32> {
    let place = |i: usize| place_of(positions[i]);
    first_alike(
        positions.len(),
        |i| hash_of(place(i)),
        |i, j| place(i).cmp(&place(j)),
    )
}

/// The bits of a position; adding zero makes -0 and 0 the same place.
pub fn place_of(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// A hash of a place whose bits depend on all bits of the three numbers:
/// rounds of multiplying and folding, as in the finisher of `MurmurHash3`.
pub fn hash_of(place: [u64; 3]) -> u32 {
    let mut h = 0x9e37_79b9_7f4a_7c15_u64;
    for bits in place {
        h = (h ^ bits).wrapping_mul(0xff51_afd7_ed55_8ccd);
        h ^= h >> 32;
        h = h.wrapping_mul(0xc4ce_b9fe_1a85_ec53);
        h ^= h >> 29;
    }
    (h >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_find_their_first_equal() {
        let p = [
            DVec3::X,
            DVec3::ZERO,
            DVec3::X,
            DVec3::new(-0.0, 0.0, -0.0),
            DVec3::Y,
            DVec3::X,
        ];
        assert_eq!(first_at_place(&p), [0, 1, 0, 1, 4, 0]);
        assert!(first_at_place(&[]).is_empty());
    }

    /// With one hash for all, order alone decides.
    #[test]
    fn collisions_do_not_confuse() {
        let values: Vec<u64> = (0..5000).map(|i| (i * 7919) % 1000).collect();
        for hash in [|_: u64| 7, |v: u64| (v % 3) as u32] {
            let first = first_alike(
                values.len(),
                |i| hash(values[i]),
                |i, j| values[i].cmp(&values[j]),
            );
            for (i, &f) in first.iter().enumerate() {
                let expected = values.iter().position(|v| *v == values[i]);
                assert_eq!(Some(f as usize), expected);
            }
        }
    }
}

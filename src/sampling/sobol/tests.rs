//! What the sequence promises, scrambled or not.

use super::*;
use crate::sampling::{LOW_DISCREPANCY, Purpose, Sequence, mix, mix2};

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

/// Over seeds, a scrambled point is uniform: chi-square over 64 cells.
#[test]
fn scrambling_is_uniform_over_seeds() {
    for index in [0u32, 1, 77] {
        let mut counts = [0.0f64; 64];
        let n = 64 * 400;
        for s in 0..n {
            counts[(sobol_owen(index, 3, mix(s) as u32) * 64.0) as usize] += 1.0;
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
            let mut found: Vec<u32> = (first..first + size).map(|i| shuffled(i, seed)).collect();
            found.sort_unstable();
            assert_eq!(found[0] % size, 0, "an aligned block");
            assert!(found.windows(2).all(|w| w[1] == w[0] + 1), "{found:?}");
        }
    }
    assert_ne!(shuffled(5, 1), shuffled(5, 2));
}

/// A scrambled point of its own seed in every dimension.
fn point<const N: usize>(index: u32, first: usize, seed: u64) -> [f64; N] {
    std::array::from_fn(|k| {
        let d = first + k;
        sobol_owen(index, d, mix2(seed, d as u64) as u32)
    })
}

/// Dimensions 0 and 1 form a (0, 2)-sequence, and scrambling keeps it: for
/// any aligned block of 2^m points, every elementary interval of area 2^-m
/// holds one.
#[test]
fn two_dimensional_elementary_intervals() {
    for seed in 0..8 {
        for (m, start) in [
            (1u32, 6u32),
            (4, 0),
            (8, 512),
            (12, 7 << 12),
            (8, 0xffff_ff00),
        ] {
            let pts: Vec<[f64; 2]> = (0..1 << m).map(|i| point(start + i, 0, seed)).collect();
            for a in 0..=m {
                let (nx, ny) = (f64::from(1u32 << a), f64::from(1u32 << (m - a)));
                let mut seen = vec![false; 1 << m];
                for &[x, y] in &pts {
                    let cell = (x * nx) as usize + ((y * ny) as usize) * nx as usize;
                    assert!(
                        !seen[cell],
                        "seed {seed}, 2^{m}, shape {a}: cell {cell} twice"
                    );
                    seen[cell] = true;
                }
            }
        }
    }
}

/// Root mean square error over seeds of the mean of `f` over the first `n`
/// points.
fn rms<const N: usize>(n: u32, seeds: u64, exact: f64, f: impl Fn([f64; N]) -> f64) -> f64 {
    let sum: f64 = (0..seeds)
        .map(|seed| {
            let sum: f64 = (0..n).map(|i| f(point(i, 0, seed))).sum();
            (sum / f64::from(n) - exact).powi(2)
        })
        .sum();
    (sum / seeds as f64).sqrt()
}

/// Slope of the error between `n` and `64 n` points in doubly logarithmic
/// scale, sign changed; 0.5 for random points.
fn slope<const N: usize>(n: u32, exact: f64, f: impl Fn([f64; N]) -> f64 + Copy) -> f64 {
    (rms(n, 48, exact, f) / rms(64 * n, 48, exact, f)).ln() / 64f64.ln()
}

/// Smooth functions converge as theory says of nested scrambling: like
/// n^-1.5 but for logarithms (A. Owen, *Scrambled Net Variance for Integrals
/// of Smooth Functions*, Annals of Statistics 25(4), 1997).
#[test]
fn smooth_functions_converge_faster_than_random() {
    let two = slope(64, 1.0, |[x, y]| (0.5 + x) * (0.5 + y));
    assert!(two > 1.3, "two dimensions: n^-{two:.2}");
    let four = slope(64, 1.0, |p: [f64; 4]| p.iter().map(|x| 0.5 + x).product());
    assert!(four > 1.0, "four dimensions: n^-{four:.2}");
    // Bounded by the edge, not by smoothness: n^-0.75 in two dimensions.
    let disc = slope(64, std::f64::consts::FRAC_PI_4, |[x, y]| {
        f64::from(u8::from(x * x + y * y < 1.0))
    });
    assert!((0.65..1.0).contains(&disc), "an edge: n^-{disc:.2}");
}

/// No two of a stream's 64 low-discrepancy coordinates shadow each other:
/// 4096 points fill 16 x 16 cells equally in every block of 16 coordinates;
/// coordinates of different blocks are on average as even as random numbers,
/// and none twice as uneven (the shuffling is nested, so they spread more).
#[test]
fn all_pairs_of_coordinates_are_even() {
    const POINTS: u64 = 4096;
    let sequence = Sequence::new(5, Purpose::Photon, 0, 0);
    let mut columns = vec![Vec::new(); LOW_DISCREPANCY as usize];
    for i in 0..POINTS {
        let mut stream = sequence.at(i);
        for column in &mut columns {
            column.push((stream.next_1d() * 16.0) as usize);
        }
    }
    let mut across = Vec::new();
    for (a, first) in columns.iter().enumerate() {
        for (b, second) in columns.iter().enumerate().skip(a + 1) {
            let mut counts = [0.0f64; 256];
            for (x, y) in first.iter().zip(second) {
                counts[16 * x + y] += 1.0;
            }
            let expected = POINTS as f64 / 256.0;
            let squares = counts.iter().map(|c| (c - expected).powi(2));
            let chi2 = squares.sum::<f64>() / expected;
            if a / DIMENSIONS == b / DIMENSIONS {
                assert_eq!(chi2, 0.0, "coordinates {a} and {b}");
            } else {
                // 255 degrees of freedom: the mean for random numbers.
                assert!(chi2 < 2.0 * 255.0, "coordinates {a} and {b}: {chi2:.0}");
                across.push(chi2);
            }
        }
    }
    let mean = across.iter().sum::<f64>() / across.len() as f64;
    // Standard error of the mean: below 22.6 / sqrt(1536) * 2 = 1.2.
    assert!(mean < 260.0, "mean chi2 over blocks: {mean:.0}");
}

/// Indices up to 2^32 and beyond name points of their own.
#[test]
fn the_last_indices() {
    let ends: Vec<u32> = (0..4).map(|i| sobol(u32::MAX - i, 1)).collect();
    for (i, &a) in ends.iter().enumerate() {
        assert!(ends[..i].iter().all(|&b| b != a));
    }
    // All ones: the exclusive or of all direction numbers.
    assert_eq!(sobol(u32::MAX, 0), u32::MAX);
    let sequence = Sequence::new(1, Purpose::Photon, 0, 0);
    let first = |i: u64| sequence.at(i).next_1d();
    assert_ne!(first(1 << 32), first(0), "another scrambling");
    assert_ne!(first((1 << 32) + 1), first(1 << 32));
}

/// What eight sequences of n points lose against one of 8 n, as the ratio of
/// their errors' squares: for smooth functions much, for edges some. The
/// documentation of performance quotes these figures.
#[test]
fn eight_short_sequences_against_one() {
    let ratio = |n: u32, exact: f64, f: &dyn Fn([f64; 2]) -> f64| {
        // Independent means of n points: a mean of eight has an eighth of
        // their variance.
        rms(n, 400, exact, f).powi(2) / 8.0 / rms(8 * n, 400, exact, f).powi(2)
    };
    let edge = |[x, y]: [f64; 2]| f64::from(u8::from(x * x + y * y < 1.0));
    // One photon kernel in a field of uniform light, a hundredth of its area.
    let radius2 = 0.01 * std::f64::consts::FRAC_1_PI;
    let kernel = |[x, y]: [f64; 2]| {
        let d2 = ((x - 0.41).powi(2) + (y - 0.57).powi(2)) / radius2;
        2.0 * (1.0 - d2).max(0.0)
    };
    let smooth = |[x, y]: [f64; 2]| (0.5 + x) * (0.5 + y);
    // Points a sequence; from and to for edge, kernel and smooth function.
    for (n, bounds) in [
        (2, [(2.0, 4.0), (0.6, 1.2), (30.0, 60.0)]),
        (16, [(2.0, 4.0), (2.0, 4.0), (30.0, 70.0)]),
        (128, [(2.0, 4.0), (4.0, 8.0), (30.0, 70.0)]),
        (1024, [(2.0, 4.0), (14.0, 28.0), (40.0, 80.0)]),
    ] {
        let found = [
            ratio(n, std::f64::consts::FRAC_PI_4, &edge),
            ratio(n, 0.01, &kernel),
            ratio(n, 1.0, &smooth),
        ];
        for (found, (least, most)) in found.into_iter().zip(bounds) {
            assert!((least..most).contains(&found), "{n} points: {found:.2}");
        }
    }
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

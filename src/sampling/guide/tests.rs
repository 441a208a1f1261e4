//! Guides learned from densities that are known.

use std::f64::consts::FRAC_2_PI;

use super::{learn::UNGUIDED, *};
use crate::{
    metrics::chi_square,
    sampling::{Purpose, Sequence},
};

/// A bright ridge and a spot in the first two coordinates, a slope in the
/// third; the fourth does not matter.
fn truth(u: [f64; 4]) -> f64 {
    let spot = if (u[0] - 0.5).abs() < 0.03 && (u[1] - 0.5).abs() < 0.03 {
        50.0
    } else {
        0.0
    };
    let ridge = if (0.2..0.26).contains(&u[1]) {
        4.0
    } else {
        0.0
    };
    (0.05 + ridge + spot) * (0.5 + u[2])
}

fn learned(samples: u64) -> Guide {
    let sequence = Sequence::new(5, Purpose::Pilot, 0, 0);
    let samples: Vec<Weighed> = (0..samples)
        .map(|i| {
            let at = point(sequence, i);
            Weighed {
                at,
                weight: truth(at),
            }
        })
        .collect();
    Guide::learn(&samples, 4, 512).expect("light")
}

fn point(sequence: Sequence, i: u64) -> [f64; 4] {
    let mut s = sequence.at(i);
    std::array::from_fn(|_| s.next_1d())
}

/// The leaves: lower corners, widths, probabilities, by walking the tree.
fn cells(guide: &Guide) -> Vec<([f64; 4], [f64; 4], f64)> {
    let mut out = Vec::new();
    let mut pending = vec![(0usize, [0.0; 4], [1.0; 4], 1.0)];
    while let Some((i, low, width, p)) = pending.pop() {
        let Node::Inner {
            dimension,
            halves,
            low: share,
            ..
        } = guide.nodes[i]
        else {
            out.push((low, width, p));
            continue;
        };
        let d = usize::from(dimension);
        let (mut upper, mut half) = (low, width);
        half[d] *= 0.5;
        upper[d] += half[d];
        let first = halves as usize;
        pending.push((first, low, half, p * share));
        pending.push((first + 1, upper, half, p * (1.0 - share)));
    }
    out
}

fn inside(at: [f64; 4], low: [f64; 4], width: [f64; 4]) -> bool {
    (0..4).all(|d| at[d] >= low[d] && at[d] < low[d] + width[d])
}

#[test]
fn cells_fill_the_cube_and_probabilities_add_up() {
    let guide = learned(1 << 14);
    let cells = cells(&guide);
    assert_eq!(cells.len(), guide.leaves());
    assert!(
        cells.len() > 30,
        "{} cells: nothing was learned",
        cells.len()
    );
    let sum: f64 = cells.iter().map(|c| c.2).sum();
    let volume = |w: [f64; 4]| w.iter().product::<f64>();
    let volumes: f64 = cells.iter().map(|c| volume(c.1)).sum();
    assert!((sum - 1.0).abs() < 1e-12, "probabilities add up to {sum}");
    assert_eq!(volumes, 1.0, "powers of two");
    for (low, width, p) in &cells {
        // The evenly spread part, through roundings of the products.
        let least = UNGUIDED * volume(*width) * (1.0 - 1e-12);
        assert!(*p >= least, "cell {low:?} starves: {p}");
        assert_eq!(width[3], 1.0, "the fourth coordinate does not matter");
    }
}

/// Warped points fall into the cells by their probabilities: chi-square of
/// plain hashed points; the density is that of the cell.
#[test]
fn points_follow_the_density() {
    let guide = learned(1 << 14);
    let cells = cells(&guide);
    let mut counts = vec![0u64; cells.len()];
    let draws = 200_000u64;
    for i in 0..draws {
        let u = point(Sequence::new(6, Purpose::Pilot, 0, i), 0);
        let g = guide.warp(u);
        let k = cells
            .iter()
            .position(|c| inside(g.at, c.0, c.1))
            .expect("a cell");
        counts[k] += 1;
        let density = cells[k].2 / cells[k].1.iter().product::<f64>();
        assert!((g.density / density - 1.0).abs() < 1e-12, "density");
    }
    let expected: Vec<f64> = cells.iter().map(|c| c.2 * draws as f64).collect();
    let test = chi_square(&counts, &expected, 5.0).expect("many cells");
    assert!(test.p_value > 1e-3, "{test:?}");
}

/// Of 2^14 points of the sequence, the number in each cell differs from the
/// expected one by far less than chance would have it: evenness survives.
/// Every coordinate grows with its own even coordinate.
#[test]
fn evenness_survives() {
    let guide = learned(1 << 14);
    let cells = cells(&guide);
    let sequence = Sequence::new(7, Purpose::Pilot, 0, 0);
    let n = 1u64 << 14;
    let mut counts = vec![0.0; cells.len()];
    for i in 0..n {
        let u = point(sequence, i);
        let g = guide.warp(u);
        if let Some(k) = cells.iter().position(|c| inside(g.at, c.0, c.1)) {
            counts[k] += 1.0;
        }
        for d in 0..4 {
            let mut v = u;
            v[d] = f64::midpoint(u[d], 1.0);
            assert!(guide.warp(v).at[d] > g.at[d], "{u:?}, coordinate {d}");
        }
    }
    let statistic: f64 = cells
        .iter()
        .zip(&counts)
        .map(|((_, _, p), c)| {
            let e = p * n as f64;
            (c - e) * (c - e) / e
        })
        .sum();
    // Independent points give one for each cell.
    let per_cell = statistic / cells.len() as f64;
    assert!(per_cell < 0.5, "unevenness {per_cell} of chance");
}

/// Edges against differences within a cell, and their squares' product against
/// the density.
#[test]
fn edges_are_roots_of_areas() {
    let guide = learned(1 << 12);
    let mut compared = 0;
    for i in 0..2000 {
        let u = point(Sequence::new(8, Purpose::Pilot, 0, 0), i);
        let g = guide.warp(u);
        let volume: f64 = g.edge.iter().map(|e| e * e).product();
        assert!((volume * g.density - 1.0).abs() < 1e-12, "cell volume");
        for pair in 0..2 {
            let slopes = [2 * pair, 2 * pair + 1].map(|d| {
                let mut v = u;
                v[d] = (u[d] + 1e-7).min(0.999_999_9);
                let moved = guide.warp(v);
                (moved.density == g.density && v[d] > u[d])
                    .then(|| (moved.at[d] - g.at[d]) / (v[d] - u[d]))
            });
            if let [Some(a), Some(b)] = slopes {
                let edge = (a * b).sqrt();
                assert!(
                    (edge / g.edge[pair] - 1.0).abs() < 1e-6,
                    "{u:?}, pair {pair}: {edge}, edge {}",
                    g.edge[pair]
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 3500, "{compared} comparisons");
}

/// Even light stays even where cells of the guide meet: kernels of blurred size
/// leave less than half of the ripples that kernels of their own cell's leave.
#[test]
fn blurred_kernels_leave_few_ripples() {
    let sequence = Sequence::new(9, Purpose::Pilot, 0, 0);
    let samples: Vec<Weighed> = (0..4096)
        .map(|i| {
            let at = point(sequence, i);
            let bright = at[0] > 0.3 && at[0] < 0.6 && at[1] > 0.4;
            Weighed {
                at,
                weight: if bright { 4.0 } else { 0.5 },
            }
        })
        .collect();
    let guide = Guide::learn(&samples, 2, 64).expect("light");
    // Many sequences: the mean shows the ripples without the noise of one.
    let (sequences, length) = (64, 1u64 << 12);
    let half = 2.6 / (length as f64).sqrt();
    let points: Vec<Guided> = (0..sequences)
        .flat_map(|k| (0..length).map(move |i| (k, i)))
        .map(|(k, i)| guide.warp(point(Sequence::new(10, Purpose::Pilot, 0, k), i)))
        .collect();
    let count = points.len();
    let unevenness = |size: fn(&Guided) -> f64| {
        let queries = 200;
        let squares: f64 = (0..queries)
            .map(|i| {
                let q = point(Sequence::new(11, Purpose::Pilot, 0, 0), i);
                let place = [0, 1].map(|d| 0.1 + 0.8 * q[d]);
                let sum: f64 = points
                    .iter()
                    .map(|p| {
                        let radius = half * size(p);
                        let t: f64 = [0, 1]
                            .map(|d| ((p.at[d] - place[d]) / radius).powi(2))
                            .iter()
                            .sum();
                        let kernel = FRAC_2_PI * (1.0 - t).max(0.0) / (radius * radius);
                        kernel / p.density
                    })
                    .sum();
                (sum / count as f64 - 1.0).powi(2)
            })
            .sum();
        (squares / queries as f64).sqrt()
    };
    let (blurred, own) = (
        unevenness(|p| p.edge[0] * p.kernel[0]),
        unevenness(|p| p.edge[0]),
    );
    assert!(blurred < 0.5 * own && blurred < 0.05, "{blurred} of {own}");
}

/// Drawing by the guide makes the variance of an estimate of the truth's
/// integral many times smaller, and leaves its mean.
#[test]
fn learning_pays() {
    let guide = learned(1 << 14);
    let moments = |f: &dyn Fn([f64; 4]) -> f64| {
        let n = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..n {
            let x = f(point(Sequence::new(9, Purpose::Pilot, 0, i), 0));
            sum += x;
            squares += x * x;
        }
        let mean = sum / n as f64;
        (mean, squares / n as f64 - mean * mean, n as f64)
    };
    let (_, plain, _) = moments(&truth);
    let (mean, guided, n) = moments(&|u| {
        let g = guide.warp(u);
        truth(g.at) / g.density
    });
    // The slope has mean 1.
    let expected = 0.05 + 4.0 * 0.06 + 50.0 * 0.06 * 0.06;
    assert!(
        (mean - expected).abs() < 4.0 * (guided / n).sqrt(),
        "{mean}"
    );
    assert!(guided < plain / 10.0, "variance {guided} of {plain}");
}

/// Where nothing was found there is nothing to learn; even light needs one
/// cell; one sample is no evidence.
#[test]
fn nothing_is_made_of_chance() {
    let sequence = Sequence::new(10, Purpose::Pilot, 0, 0);
    let all = |weight: &dyn Fn(u64) -> f64| -> Vec<Weighed> {
        (0..4096)
            .map(|i| Weighed {
                at: point(sequence, i),
                weight: weight(i),
            })
            .collect()
    };
    assert!(Guide::learn(&all(&|_| 0.0), 4, 512).is_none());
    assert!(Guide::learn(&[], 4, 512).is_none());
    let even = Guide::learn(&all(&|_| 1.0), 4, 512).expect("light");
    assert_eq!(even.leaves(), 1);
    assert_eq!(even.warp([0.25; 4]), Guided::even([0.25; 4]));
    let one = Guide::learn(&all(&|i| f64::from(u8::from(i == 7))), 4, 512).expect("light");
    assert_eq!(one.leaves(), 1);
}

/// Coordinates next to 0 and 1 stay in the cube.
#[test]
fn the_border_stays_inside() {
    let guide = learned(1 << 12);
    for u in [[0.0; 4], [1.0f64.next_down(); 4]] {
        let g = guide.warp(u);
        assert!(g.at.iter().all(|x| (0.0..1.0).contains(x)), "{g:?}");
    }
}

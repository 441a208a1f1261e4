//! Whether pictures by different methods show the same.
//!
//! What is compared are means over blocks of pixels and over the whole picture:
//! errors of neighbouring pixels go together. The replicates of several seeds
//! are independent values of each mean; two methods differ if Student's t says
//! so, for unequal variances (B. Welch, *The generalization of Student's problem*,
//! Biometrika 34, 1947). The level is Sidak's for all comparisons of this
//! program, so that the chance of any false alarm is [`FALSE_ALARM`].
//!
//! The blur of methods with kernels is no noise. It is bounded by a second
//! picture, with kernels (or elements) of twice the width: see [`Means::differ`].

use std::sync::atomic::{AtomicUsize, Ordering};

use nephroid::{
    film::{Film, Image},
    metrics::{sidak, student_quantile},
    render::REPLICATES,
    scene::Scene,
};

use super::{By, Width, film};

/// The chance that a difference is seen anywhere though there is none.
const FALSE_ALARM: f64 = 0.01;

/// Sets of pictures that are compared in this program.
const SETS: usize = 19;
static SETS_SO_FAR: AtomicUsize = AtomicUsize::new(0);

/// Seeds of each method: 24 replicates.
const SEEDS: u64 = 3;

/// Pixels along a block.
const BLOCK: u32 = 8;

/// Relative error of sums in another order.
const ROUNDING: f64 = 1e-9;

/// One mean by one method: a value for each replicate.
pub(super) struct Means {
    values: Vec<f64>,
    /// The same with kernels of twice the width, where there are kernels.
    wide: Option<Vec<f64>>,
}

impl Means {
    /// Whether this mean differs from the `truth`, which has no blur, on a
    /// `level`: how far, in standard errors, and how many of these it may be.
    ///
    /// If blur goes like the width of the kernels to the power p, twice the
    /// width has 2^p times the blur, and what it adds is 2^p - 1 times the blur
    /// of the narrow picture. So the truth is expected at n - c (w - n) with a
    /// c = 1 / (2^p - 1), which lies in 0..=1 for every p of one or more:
    /// edges have one, smooth light two. A difference is one that no such c
    /// explains. It is enough to look at both ends of its range: the
    /// distance from the truth is linear in c and its standard error convex, so what
    /// is too far on the same side at both is too far at all between.
    pub(super) fn differ(&self, truth: &[f64], level: f64) -> Option<[f64; 2]> {
        let off = |c: f64| {
            let wide = self.wide.as_ref().unwrap_or(&self.values);
            let pairs = self.values.iter().zip(wide);
            let freed: Vec<f64> = pairs.map(|(n, w)| n - c * (w - n)).collect();
            welch(&freed, truth, level)
        };
        let [near, far] = [off(0.0), off(1.0)];
        let is_off = |[t, most]: [f64; 2]| t.abs() > most;
        let same_side = near[0].signum() == far[0].signum();
        (is_off(near) && is_off(far) && same_side).then_some(near)
    }

    /// Where all light is `factor` times as bright.
    fn times(&self, factor: f64) -> Self {
        let times = |values: &Vec<f64>| values.iter().map(|v| v * factor).collect();
        Self {
            values: times(&self.values),
            wide: self.wide.as_ref().map(times),
        }
    }
}

/// Distance of two means in standard errors, and the largest that counts as
/// chance.
fn welch(a: &[f64], b: &[f64], level: f64) -> [f64; 2] {
    let ([mean_a, variance_a], [mean_b, variance_b]) = (moments(a), moments(b));
    let variance = variance_a + variance_b;
    let rounding = ROUNDING * mean_b.abs();
    let distance = mean_a - mean_b;
    if variance.sqrt() <= rounding {
        return [distance / rounding.max(f64::MIN_POSITIVE), 1.0];
    }
    let part = |v: f64, n: usize| v * v / (n as f64 - 1.0);
    let freedom = variance * variance / (part(variance_a, a.len()) + part(variance_b, b.len()));
    let most = student_quantile(1.0 - level, freedom.floor() as u32);
    [distance / variance.sqrt(), most]
}

/// The mean of independent values and its variance.
fn moments(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    [mean, squares / (n * (n - 1.0))]
}

/// Means of all replicates' pictures by one method, over each block and over
/// the whole picture, which is the last.
fn means(scene: &Scene, by: By, rounds: u32, crop: Option<[u32; 4]>) -> Vec<Means> {
    let replicates = |width: Width| -> Vec<Vec<f64>> {
        let films = (0..SEEDS).map(|seed| film(scene, by, rounds, (seed, width, crop)));
        let of_films = films.flat_map(|film| {
            assert_eq!(film.refused(), 0, "{by:?}");
            (0..REPLICATES as usize).map(move |r| blocks(&film, r))
        });
        of_films.collect()
    };
    let narrow = replicates(Width::Narrow);
    let wide = by.has_blur().then(|| replicates(Width::Wide));
    let column = |rows: &[Vec<f64>], i: usize| rows.iter().map(|row| row[i]).collect();
    (0..narrow[0].len())
        .map(|i| Means {
            values: column(&narrow, i),
            wide: wide.as_ref().map(|wide| column(wide, i)),
        })
        .collect()
}

/// Mean of each block of a replicate's picture and of the whole (green).
fn blocks(film: &Film, replicate: usize) -> Vec<f64> {
    let image: Image = film.replicate_image(replicate);
    let mut found = Vec::new();
    for top in (0..image.height()).step_by(BLOCK as usize) {
        for left in (0..image.width()).step_by(BLOCK as usize) {
            let rows = top..(top + BLOCK).min(image.height());
            let columns = left..(left + BLOCK).min(image.width());
            let pixels = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
            let values: Vec<f64> = pixels.map(|(x, y)| image.pixel(x, y)[1]).collect();
            found.push(values.iter().sum::<f64>() / values.len() as f64);
        }
    }
    found.push(image.mean()[1]);
    found
}

/// Asserts that all pictures show the same as the first, which has no blur,
/// block by block and as a whole, each after so many rounds of each seed; and
/// that they would not if one of them were by the part `shows` too bright or too
/// dark: an agreement of what is noisy or blurred proves nothing.
pub(super) fn assert_agree(scene: &Scene, all: &[(By, u32)], shows: f64, what: &str) {
    assert_part_agrees(scene, all, shows, None, what);
}

/// The same of a part of the picture.
pub(super) fn assert_part_agrees(
    scene: &Scene,
    all: &[(By, u32)],
    shows: f64,
    crop: Option<[u32; 4]>,
    what: &str,
) {
    let sets = SETS_SO_FAR.fetch_add(1, Ordering::Relaxed) + 1;
    assert!(sets <= SETS, "more sets than the level is made for");
    let (first, rounds) = all[0];
    assert!(!first.has_blur(), "the truth is not blurred");
    let truth = means(scene, first, rounds, crop);
    let comparisons = truth.len() * (all.len() - 1);
    let level = sidak(sidak(FALSE_ALARM, SETS), comparisons);
    for &(by, rounds) in &all[1..] {
        let own = means(scene, by, rounds, crop);
        for (i, (own, truth)) in own.iter().zip(&truth).enumerate() {
            if let Some([t, most]) = own.differ(&truth.values, level) {
                panic!(
                    "{what}: {by:?} and {first:?} differ in block {i} by {t:.1} standard errors, \
                     {most:.1} is chance: {:?} {:?}",
                    moments(&own.values),
                    moments(&truth.values)
                );
            }
        }
        let (Some(own), Some(truth)) = (own.last(), truth.last()) else {
            unreachable!("the whole is always there");
        };
        for factor in [1.0 - shows, 1.0 + shows] {
            assert!(
                own.times(factor).differ(&truth.values, level).is_some(),
                "{what}: {by:?} could be {factor} times as bright and would agree with {first:?}: \
                 {:?} {:?}",
                moments(&own.values),
                moments(&truth.values)
            );
        }
    }
}

/// The judge himself: what has the same mean agrees, what has not does not,
/// and only blur that twice the width doubles at least is taken for blur.
#[test]
fn the_judge_can_tell() {
    let level = 1e-4;
    let around = |mean: f64| -> Vec<f64> {
        let steps = (0..24).map(|i| f64::from(i * 7 % 24) - 11.5);
        steps.map(|step| mean + 0.01 * step).collect()
    };
    let truth = around(1.0);
    let sharp = |mean| Means {
        values: around(mean),
        wide: None,
    };
    let blurred = |narrow, wide| Means {
        values: around(narrow),
        wide: Some(around(wide)),
    };
    // A standard error is 0.0144, of the difference 0.0204.
    assert!(sharp(1.05).differ(&truth, level).is_none());
    assert!(sharp(0.95).differ(&truth, level).is_none());
    assert!(sharp(1.2).differ(&truth, level).is_some());
    assert!(sharp(0.8).differ(&truth, level).is_some());
    assert!(blurred(0.8, 0.2).differ(&truth, level).is_none(), "smooth");
    assert!(blurred(0.8, 0.6).differ(&truth, level).is_none(), "edges");
    assert!(blurred(0.8, 0.8).differ(&truth, level).is_some(), "no blur");
    assert!(blurred(0.8, 0.9).differ(&truth, level).is_some(), "sharper");
    assert!(
        blurred(0.6, 0.5).differ(&truth, level).is_some(),
        "too little"
    );
    // Without any noise only equals agree.
    let exact = |mean| Means {
        values: vec![mean; 8],
        wide: None,
    };
    assert!(exact(2.0).differ(&[2.0; 8], level).is_none());
    assert!(exact(2.1).differ(&[2.0; 8], level).is_some());
    assert!(exact(0.0).differ(&[0.0; 8], level).is_none());
}

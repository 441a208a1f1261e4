//! An error taken apart into noise and bias.
//!
//! With pictures x of S seeds, a truth r and the weights of relMSE (the mean
//! over pixels and channels of w (x - r)^2, with 1 / w = r^2 + 0.01
//! mean(r)^2), the variance of one picture is estimated without bias by
//! V = sum (x - mean x)^2 / (S - 1). The squared error of the mean picture
//! holds V / S of it, and the variance of the truth if that is an estimate,
//! too; what is left is the square of the bias.

use crate::film::Image;

use super::record::Split;

/// Share of the truth's mean, squared, in the floor of relMSE.
const FLOOR: f64 = 0.01;

/// The mean of pictures of one size; `None` without any.
pub(super) fn mean(pictures: &[Image]) -> Option<Image> {
    let first = pictures.first()?;
    let mut sums = first.pixels().to_vec();
    for picture in &pictures[1..] {
        for (sum, &pixel) in sums.iter_mut().zip(picture.pixels()) {
            *sum += pixel;
        }
    }
    let n = pictures.len() as f64;
    let pixels = sums.into_iter().map(|sum| sum / n).collect();
    Some(Image::new(first.width(), first.height(), pixels))
}

/// The variance of one of the pictures about what all of them are estimates
/// of, relative to `truth` as in relMSE; `None` with fewer than two.
pub(super) fn variance(pictures: &[Image], truth: &Image) -> Option<f64> {
    if pictures.len() < 2 {
        return None;
    }
    let mean = mean(pictures)?;
    let distances = pictures.iter().map(|p| distance(p, &mean, truth));
    Some(distances.sum::<f64>() / (pictures.len() - 1) as f64)
}

/// The part of the pictures' squared distances from their mean that comes, in
/// each pixel, from the picture farthest off. It is about 0.42 for eight
/// pictures with normal noise, and comes near 7/8 where each pixel owes its
/// noise to one of them alone: to paths so rare that most pictures have none,
/// of which the spread tells little.
pub(super) fn lone_share(pictures: &[Image], truth: &Image) -> Option<f64> {
    let mean = mean(pictures)?;
    let (mut farthest, mut all) = (0.0, 0.0);
    let floor = floor(truth);
    for (i, r) in truth.pixels().iter().enumerate() {
        for c in 0..3 {
            let weight = 1.0 / (r[c] * r[c] + floor);
            let mut most = 0.0f64;
            for picture in pictures {
                let d = picture.pixels()[i][c] - mean.pixels()[i][c];
                let square = if d == 0.0 { 0.0 } else { d * d * weight };
                most = most.max(square);
                all += square;
            }
            farthest += most;
        }
    }
    (all > 0.0).then_some(farthest / all)
}

/// A bound on the mean square of the blur of pictures `sharp`, relative to
/// `truth`, from others whose kernels are twice as wide. Blur that goes like the
/// width to the power p grows by 2^p - 1 times itself, which is at least itself
/// for every p of one or more (edges have one, smooth light two): so the distance
/// of the means, freed of the variances of both, is no less. `None` without
/// two pictures of each.
pub(super) fn blur(sharp: &[Image], wide: &[Image], truth: &Image) -> Option<f64> {
    let noise =
        |pictures: &[Image]| variance(pictures, truth).map(|single| single / pictures.len() as f64);
    let known = noise(sharp)? + noise(wide)?;
    let apart = distance(&mean(sharp)?, &mean(wide)?, truth);
    Some((apart - known).max(0.0))
}

/// What is added to the squares of the truth.
fn floor(truth: &Image) -> f64 {
    let grey = truth.mean().mean();
    FLOOR * grey * grey
}

/// The mean of w (a - b)^2.
fn distance(a: &Image, b: &Image, truth: &Image) -> f64 {
    let floor = floor(truth);
    let mut sum = 0.0;
    for ((a, b), r) in a.pixels().iter().zip(b.pixels()).zip(truth.pixels()) {
        for c in 0..3 {
            let d = a[c] - b[c];
            if d != 0.0 {
                sum += d * d / (r[c] * r[c] + floor);
            }
        }
    }
    sum / (3 * truth.pixels().len().max(1)) as f64
}

/// Noise and bias of pictures of independent seeds, all of the truth's size;
/// `truth_variance` is the relative variance of the truth itself, 0 for an
/// exact one. `None` with fewer than two pictures.
pub fn split(pictures: &[Image], truth: &Image, truth_variance: f64) -> Option<Split> {
    let variance = variance(pictures, truth)?;
    let error = distance(&mean(pictures)?, truth, truth);
    let left = error - variance / pictures.len() as f64 - truth_variance;
    Some(Split {
        noise: variance.sqrt(),
        bias: left.max(0.0).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{metrics::relmse, sampling::mix2, spectrum::Rgb};

    const SIDE: u32 = 64;

    /// A truth with dark and bright parts.
    fn truth() -> Image {
        Image::from_fn(SIDE, SIDE, |x, y| {
            Rgb::new(1.0 + f64::from(x), 0.5 * f64::from(y), 3.0)
        })
    }

    /// A number with mean 0 and variance 1 that belongs to `address`.
    fn normal(address: u64) -> f64 {
        let sum: u64 = (0..12).map(|i| mix2(address, i) >> 11).sum();
        (sum as f64 / (1u64 << 53) as f64) - 6.0
    }

    /// `truth` with noise and bias, both relative to the root of its weight.
    fn picture(truth: &Image, seed: u64, noise: f64, bias: f64) -> Image {
        let grey = truth.mean().mean();
        Image::from_fn(truth.width(), truth.height(), |x, y| {
            let r = truth.pixel(x, y);
            let pixel = u64::from(y) << 32 | u64::from(x);
            Rgb(std::array::from_fn(|c| {
                let unit = (r[c] * r[c] + FLOOR * grey * grey).sqrt();
                let address = mix2(mix2(seed, pixel), c as u64);
                // The bias has both signs, so that it is none of the mean.
                let sign = if (x + y) % 2 == 0 { 1.0 } else { -1.0 };
                r[c] + unit * (noise * normal(address) + sign * bias)
            }))
        })
    }

    /// 12288 numbers: the mean of squares is known to 2 %.
    #[test]
    fn noise_and_bias_are_told_apart() {
        let truth = truth();
        for (noise, bias) in [(0.2, 0.0), (0.2, 0.05), (0.1, 0.1), (0.01, 0.3)] {
            let pictures: Vec<Image> = (0..4).map(|s| picture(&truth, s, noise, bias)).collect();
            let found = split(&pictures, &truth, 0.0).unwrap();
            assert!((found.noise / noise - 1.0).abs() < 0.02, "{found:?}");
            // What noise is left in the square: 2 / 12288 relative to a quarter
            // of its variance, a standard deviation of 0.0056^2 at most.
            let square = found.bias * found.bias;
            assert!((square - bias * bias).abs() < 6e-4, "{found:?}, {bias}");
            let runs = pictures.iter().map(|p| relmse(p, &truth).unwrap());
            let error = runs.sum::<f64>() / 4.0;
            let parts = found.noise * found.noise + found.bias * found.bias;
            assert!((parts / error - 1.0).abs() < 0.02, "{parts}, {error}");
        }
        assert_eq!(split(&[picture(&truth, 0, 0.1, 0.0)], &truth, 0.0), None);
    }

    /// Normal noise shares its squares among the pictures, rare paths do not.
    #[test]
    fn rare_paths_stand_alone() {
        let truth = truth();
        let even: Vec<Image> = (0..8).map(|s| picture(&truth, s, 0.1, 0.0)).collect();
        let share = lone_share(&even, &truth).unwrap();
        assert!((share - 0.42).abs() < 0.02, "{share}");
        let rare = |seed: u64| {
            Image::from_fn(SIDE, SIDE, |x, y| {
                let pixel = u64::from(y) << 32 | u64::from(x);
                let is_hit = mix2(seed, pixel).is_multiple_of(100);
                truth.pixel(x, y) * if is_hit { 50.0 } else { 0.5 }
            })
        };
        let rare: Vec<Image> = (0..8).map(rare).collect();
        let share = lone_share(&rare, &truth).unwrap();
        assert!((0.8..=0.876).contains(&share), "{share}");
        assert_eq!(lone_share(&[truth.clone(), truth.clone()], &truth), None);
    }

    /// A truth with noise of its own looks like a bias, until it is taken off.
    #[test]
    fn the_truths_noise_is_no_bias() {
        let exact = truth();
        let pictures: Vec<Image> = (0..4).map(|s| picture(&exact, s, 0.01, 0.0)).collect();
        let seeds: Vec<Image> = (10..18).map(|s| picture(&exact, s, 0.2, 0.0)).collect();
        let noisy = mean(&seeds).unwrap();
        let own = variance(&seeds, &noisy).unwrap() / 8.0;
        assert!((own / (0.04 / 8.0) - 1.0).abs() < 0.05, "{own}");
        let naive = split(&pictures, &noisy, 0.0).unwrap();
        assert!((naive.bias / own.sqrt() - 1.0).abs() < 0.05, "{naive:?}");
        let freed = split(&pictures, &noisy, own).unwrap();
        assert!(freed.bias < 0.2 * naive.bias, "{freed:?}");
    }
}

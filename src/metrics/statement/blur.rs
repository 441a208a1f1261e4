//! The bias that kernels leave, from narrower kernels on the same photons.
//!
//! Every query of a pass that tells the blur
//! ([`blur_weight`](crate::film::blur_weight)) evaluates each kernel it meets three
//! times: as it is, and with half and a quarter of its area. All kernels of a round
//! scale with one number s, so what the narrower ones find is, in the mean, what the
//! renderer would find in a later round. Where the blur of a pixel goes like
//! s^p, the step from s to s / 2^(1/2) shows 1 - r of it, r = 2^(-p/2), and the
//! next step r (1 - r): the ratio of the steps tells r, and the first step,
//! over 1 - r, what blur is left. For smooth light p is 2 and r is 1/2; at
//! folds p is smaller, where light is blurred symmetrically larger. What kernels
//! do not resolve yet has ratios near 1 that will fall: the ratios of steps that
//! nobody has seen go back to the usual one.
//!
//! The two kernels share their photons, so their difference has far less noise
//! than that of two renders. What noise it has must not count as bias: the
//! squares that enter are products of two of four groups of replicates, whose
//! noise is independent, so that it averages out.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::{
    film::{Film, Image, Layer},
    spectrum::Rgb,
};

use super::{Ground, box_kernel, coarse, convolve, relative, standing_out};
use crate::metrics::{convolve::gaussian, plane::Plane};

/// Ratio of the steps before it is known, and how far a picture's ratio strays
/// from it (standard deviation): 21 scenes say 0.59 and 0.04 after 128 to 376
/// passes (`cargo bench --bench prediction -- --curves`). Smooth light has 1/2.
const USUAL: f64 = 0.58;
const STRAYS: f64 = 0.08;

/// What stays of the difference between a ratio and the usual one from each step
/// to the next, and how many steps are followed. A fold that kernels do not
/// resolve yet has ratios near 1, which fall as they come to resolve it: with 1
/// here, as if they never did, `hall_of_mirrors` stated 1.5 to 1.9 times its error.
const STAYS: f64 = 0.75;
const FOLLOWED: u32 = 12;

/// Bounds of the ratio: of a picture's, and of a neighbourhood's. Blur that
/// falls more slowly than the largest says cannot be told from light.
const PICTURE: [f64; 2] = [0.25, 0.85];
const NEARBY: [f64; 2] = [0.25, 0.9];

/// The picture's ratio counts in a neighbourhood like steps as large as so many
/// standard deviations of their noise.
const TRUST: f64 = 20.0;

/// Standard deviations in pixels of the weights with which squared steps are
/// averaged for a pixel, and for the ratio around it; where they end.
const OWN: (f64, usize) = (1.0, 2);
const AROUND: (f64, usize) = (2.0, 4);

/// The squared step of a pixel differs from those around where it does by more
/// than so many standard deviations of its noise.
const APART: f64 = 2.0;

/// Blur that is left takes a pixel's brightness down or up by this factor at
/// most.
const CORRECTED: f64 = 3.0;

/// Pixels along the blocks whose sums tell how sure the picture's sums are:
/// wider than what kernels correlate.
pub(super) const BLOCK: usize = 8;

/// The bias of a picture, relative to its brightness.
pub(super) struct Blur {
    /// Squared bias of each pixel: right in the mean, and as often below zero
    /// as above where there is none.
    pub(super) own: Plane,
    /// Squared bias, averaged over the nearest pixels.
    pub(super) pooled: Plane,
    /// Relative standard deviation of all squares by what is not known of the
    /// ratio of the steps.
    pub(super) doubt: f64,
    /// Power of the kernels' scale with which the bias falls, over the whole
    /// picture.
    pub(super) order: f64,
    /// First step, signed, averaged over the nearest pixels.
    step: Plane,
    /// The blur that is left, in first steps.
    left: Plane,
    /// Colours of the light that was gathered, of mean one.
    hues: Vec<Rgb>,
    /// Bias of the colour's mean over the relative bias.
    scales: Vec<f64>,
}

impl Blur {
    pub(super) fn of(film: &Film, ground: &Ground) -> Self {
        let indirect = film.layer_image(Layer::Indirect);
        let light = ground.caustics.pixels().iter().zip(indirect.pixels());
        let hues: Vec<Rgb> = light.map(|(&c, &d)| hue(c + d)).collect();
        let colours = hues.par_iter().zip(&ground.squares);
        let scales: Vec<f64> = colours
            .map(|(&hue, &squares)| scale(hue, squares))
            .collect();
        let [firsts, seconds, spread, step] = {
            let groups = film.blur();
            let told = |i: usize| {
                if !ground.lit[i] {
                    return [0.0; 4];
                }
                let relative = |group: &Vec<[f64; 2]>| group[i].map(|step| step / scales[i]);
                let steps = Steps::of(groups.iter().map(relative));
                [Steps::square, Steps::product, Steps::noise, Steps::first].map(|f| f(&steps))
            };
            let told: Vec<[f64; 4]> = (0..scales.len()).into_par_iter().map(told).collect();
            [0, 1, 2, 3].map(|k| ground.plane(|i| told[i][k]))
        };
        let (ratio, unsure) = ratio_of(&firsts, &seconds);
        let spread = convolve(&spread, &box_kernel(2), &box_kernel(2));
        let left = around(&firsts, &seconds, &spread, ratio);
        let grown = |squares: &Plane| Plane::join(squares, &left, |s, l| s * l * l);
        let near = gaussian(OWN.1, OWN.0);
        Self {
            pooled: grown(&certain(&firsts, &convolve(&firsts, &near, &near), &spread)),
            own: grown(&firsts),
            doubt: 2.0 * unsure * slope(ratio),
            order: -2.0 * libm::log2(ratio),
            step: convolve(&step, &near, &near),
            left,
            hues,
            scales,
        }
    }

    /// Sets errors in relation to the picture without the blur that is left: beside
    /// a bright line the truth is darker than the picture, and what is too much
    /// there is more of it than it looks.
    pub(super) fn correct(&mut self, ground: &mut Ground) {
        let steps = self.step.values().iter().zip(self.left.values());
        for (i, (step, left)) in steps.enumerate() {
            if *step == 0.0 {
                continue;
            }
            let bias = self.hues[i] * (step * left * self.scales[i]);
            ground.take_off(i, bias, CORRECTED);
            let scale = scale(self.hues[i], ground.squares[i]);
            let grows = (self.scales[i] / scale).powi(2);
            self.own.values_mut()[i] *= grows;
            self.pooled.values_mut()[i] *= grows;
            self.scales[i] = scale;
        }
    }

    /// The bias of every pixel and channel, in the colour of the light that
    /// was gathered.
    pub(super) fn image(&self, ground: &Ground) -> Image {
        let pixels = self.hues.iter().enumerate().map(|(i, &hue)| {
            let size = self.pooled.values()[i]
                .sqrt()
                .copysign(self.step.values()[i]);
            (hue * (size * self.scales[i])).map(coarse)
        });
        Image::new(ground.width as u32, ground.height as u32, pixels.collect())
    }
}

/// Light of this colour, and a mean of one, over its relative size.
fn scale(hue: Rgb, squares: Rgb) -> f64 {
    1.0 / relative(hue * hue, squares).sqrt()
}

/// The blur that is left, in first steps, by the ratio of the second to the first:
/// the sum of all steps, whose ratios go back to the usual one.
fn left(ratio: f64) -> f64 {
    let (mut sum, mut step, mut next) = (1.0, 1.0, ratio);
    for _ in 0..FOLLOWED {
        step *= next;
        sum += step;
        next = USUAL + STAYS * (next - USUAL);
    }
    sum + step * USUAL / (1.0 - USUAL)
}

/// How much the blur that is left changes with the ratio, relative to it.
fn slope(ratio: f64) -> f64 {
    const APART: f64 = 1e-3;
    (left(ratio + APART) - left(ratio - APART)) / (2.0 * APART * left(ratio))
}

/// Sums over groups of replicates of what each finds of the two steps.
#[derive(Default)]
struct Steps {
    count: f64,
    sums: [f64; 2],
    /// Of the squares of the first step, and of its products with the second.
    squares: f64,
    products: f64,
}

impl Steps {
    fn of(groups: impl Iterator<Item = [f64; 2]>) -> Self {
        groups.fold(Self::default(), |s, [first, second]| Self {
            count: s.count + 1.0,
            sums: [s.sums[0] + first, s.sums[1] + second],
            squares: s.squares + first * first,
            products: s.products + first * second,
        })
    }

    /// Ordered pairs of different groups.
    fn pairs(&self) -> f64 {
        self.count * (self.count - 1.0)
    }

    /// The square of the first step: the mean of the products of two different
    /// groups.
    fn square(&self) -> f64 {
        (self.sums[0] * self.sums[0] - self.squares) / self.pairs()
    }

    /// The product of both steps, likewise.
    fn product(&self) -> f64 {
        (self.sums[0] * self.sums[1] - self.products) / self.pairs()
    }

    /// What the square strays by where there is no step: the variance of a
    /// group, times the root of two over the pairs.
    fn noise(&self) -> f64 {
        let deviations = self.squares - self.sums[0] * self.sums[0] / self.count;
        deviations.max(0.0) / (self.count - 1.0) * (2.0 / self.pairs()).sqrt()
    }

    /// The first step.
    fn first(&self) -> f64 {
        self.sums[0] / self.count
    }
}

/// A colour with a mean of one; grey for black.
fn hue(colour: Rgb) -> Rgb {
    let mean = colour.mean();
    if mean > 0.0 {
        colour / mean
    } else {
        Rgb::WHITE
    }
}

/// The ratio of the second step to the first over the whole picture, and its
/// standard deviation. The estimate of a noisy picture is drawn to the usual
/// ratio, as Bayes has it for normal distributions.
fn ratio_of(firsts: &Plane, seconds: &Plane) -> (f64, f64) {
    let blocks = block_sums(firsts).into_iter().zip(block_sums(seconds));
    let blocks: Vec<(f64, f64)> = blocks.collect();
    let first: f64 = blocks.iter().map(|b| b.0).sum();
    let second: f64 = blocks.iter().map(|b| b.1).sum();
    if first <= 0.0 {
        return (USUAL, STRAYS);
    }
    let found = (second / first).clamp(0.0, 1.0);
    let squares: f64 = blocks
        .iter()
        .map(|(f, s)| (s - found * f) * (s - found * f))
        .sum();
    let variance = squares / (first * first);
    let trust = STRAYS * STRAYS / (STRAYS * STRAYS + variance);
    let ratio = USUAL + trust * (found - USUAL);
    (
        ratio.clamp(PICTURE[0], PICTURE[1]),
        (trust * variance).sqrt(),
    )
}

/// The squared step of each pixel: those averaged over the nearest pixels, but
/// for what stands out from its noise (`spread`); and of that, what is not
/// likely to be noise: half of one that is half as large as the standard deviation
/// of its noise.
fn certain(own: &Plane, nearby: &Plane, spread: &Plane) -> Plane {
    let apart = Plane::join(own, nearby, |own, near| own - near);
    let apart = Plane::join(&apart, spread, |apart, noise| {
        standing_out(apart, (APART * noise).powi(2))
    });
    let squares = Plane::join(nearby, &apart, |near, apart| near + apart);
    let noise = 0.5 / averaged(OWN.0).sqrt();
    Plane::join(&squares, spread, |s, v| {
        if s > 0.0 {
            s * s / (s + noise * v)
        } else {
            0.0
        }
    })
}

/// As many independent pixels as Gaussian weights of this width average over.
fn averaged(sigma: f64) -> f64 {
    4.0 * PI * sigma * sigma
}

/// The blur that is left, in first steps, by the ratio of the steps around every
/// pixel.
fn around(firsts: &Plane, seconds: &Plane, spread: &Plane, ratio: f64) -> Plane {
    let wide = gaussian(AROUND.1, AROUND.0);
    let [firsts, seconds] = [firsts, seconds].map(|p| convolve(p, &wide, &wide));
    let prior = TRUST / averaged(AROUND.0).sqrt();
    let ratios = Plane::join(&seconds, spread, |s, v| s + prior * v * ratio);
    let weights = Plane::join(&firsts, spread, |f, v| f.max(0.0) + prior * v);
    Plane::join(&ratios, &weights, |r, w| {
        let near = if w > 0.0 { r / w } else { ratio };
        left(near.clamp(NEARBY[0], NEARBY[1]))
    })
}

/// Sums over the blocks of a plane.
pub(super) fn block_sums(plane: &Plane) -> Vec<f64> {
    let columns = plane.width().div_ceil(BLOCK);
    let mut sums = vec![0.0; columns * plane.height().div_ceil(BLOCK)];
    for y in 0..plane.height() {
        for (x, value) in plane.row(y).iter().enumerate() {
            sums[y / BLOCK * columns + x / BLOCK] += value;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_the_sum_of_the_steps() {
        // Of the usual ratio it is a geometric series.
        assert!((left(USUAL) - 1.0 / (1.0 - USUAL)).abs() < 1e-12);
        let (mut sum, mut step, mut ratio) = (0.0, 1.0, 0.3);
        while step > 1e-15 {
            sum += step;
            step *= ratio;
            ratio = 0.25 * USUAL + 0.75 * ratio;
        }
        assert!((left(0.3) / sum - 1.0).abs() < 1e-3, "{} {sum}", left(0.3));
        // Less than if an unresolved fold never came to be resolved.
        assert!(left(0.9) > left(0.7) && left(0.9) < 0.6 / (1.0 - 0.9));
        let rise = (left(0.61) - left(0.6)) / 0.01 / left(0.605);
        assert!((slope(0.605) / rise - 1.0).abs() < 1e-2);
    }

    /// Errors grow where the truth is darker than the picture, shrink where it is
    /// brighter, and the bias in W/m2/sr stays what it was.
    #[test]
    fn errors_are_set_beside_the_picture_without_its_blur() {
        let mut ground = Ground {
            likely: vec![Rgb::grey(1.0); 3],
            squares: vec![Rgb::grey(1.25); 3],
            floor: 0.25,
            variances: Vec::new(),
            deviations: Vec::new(),
            unit: 1.0,
            relative_noise: 0.0,
            lit: Vec::new(),
            caustic: Vec::new(),
            caustics: Image::new(3, 1, vec![Rgb::BLACK; 3]),
            width: 3,
            height: 1,
        };
        let plane = |values: [f64; 3]| Plane::new(3, 1, values.to_vec());
        let before = scale(Rgb::WHITE, Rgb::grey(1.25));
        let step = [0.25, 0.0, -9.0].map(|bias| bias / before);
        let mut blur = Blur {
            own: plane([1.0; 3]),
            pooled: plane([2.0; 3]),
            doubt: 0.0,
            order: 1.0,
            step: plane(step),
            left: plane([2.0; 3]),
            hues: vec![Rgb::WHITE; 3],
            scales: vec![before; 3],
        };
        blur.correct(&mut ground);
        for (i, likely) in [0.5, 1.0, CORRECTED].into_iter().enumerate() {
            assert!((ground.likely[i].0[0] - likely).abs() < 1e-15, "{i}");
            let square = likely * likely + 0.25;
            assert!((ground.squares[i].0[1] / square - 1.0).abs() < 1e-15, "{i}");
            assert!((blur.own.values()[i] * square / 1.25 - 1.0).abs() < 1e-14);
            assert!((blur.pooled.values()[i] * square / 1.25 - 2.0).abs() < 1e-14);
            assert!((blur.scales[i] / square.sqrt() - 1.0).abs() < 1e-15);
        }
    }

    /// What stands out from its noise keeps its place, what does not is that of its
    /// surroundings; without noise every pixel is its own.
    #[test]
    fn squared_steps_are_sharp_where_they_are_certain() {
        let plane = |v: f64| Plane::new(1, 1, vec![v]);
        let of =
            |own: f64, noise: f64| certain(&plane(own), &plane(1.0), &plane(noise)).values()[0];
        assert_eq!(of(9.0, 0.0), 9.0);
        assert_eq!(of(0.0, 0.0), 0.0);
        let faint = 0.5 / averaged(1.0).sqrt();
        for (own, noise, square) in [(2.0, 0.5, 1.0), (0.5, 9.0, 1.0), (5.0, 1.0, 4.0)] {
            let expected = square * square / (square + faint * noise);
            assert!((of(own, noise) - expected).abs() < 1e-15, "{own} {noise}");
        }
    }

    #[test]
    fn squares_of_steps_do_not_hold_their_noise() {
        let groups = [[0.3, 0.1], [0.1, 0.2], [-0.1, 0.0], [0.5, 0.3]];
        let steps = Steps::of(groups.into_iter());
        let (mut square, mut product) = (0.0, 0.0);
        for (i, a) in groups.iter().enumerate() {
            for (_, b) in groups.iter().enumerate().filter(|(j, _)| *j != i) {
                square += a[0] * b[0] / 12.0;
                product += a[0] * b[1] / 12.0;
            }
        }
        assert!((steps.square() - square).abs() < 1e-15);
        assert!((steps.product() - product).abs() < 1e-15);
        assert!((steps.first() - 0.2).abs() < 1e-15);
        // Squared deviations sum to 0.2: a variance of 0.2 / 3 of each group.
        assert!((steps.noise() - 0.2 / 3.0 / 6f64.sqrt()).abs() < 1e-15);
    }
}

//! What a picture says about its own error, from the sums of its film alone.
//!
//! The error of a pixel is the root of the mean over its channels of
//! (x - truth)^2 / (x~^2 + 0.01 mean^2), where x~ is the picture itself,
//! smoothed as far as it is noisy, since the truth is not known: so
//! [`relmse`](super::relmse) has it but for that. Two things make it up:
//!
//! - *noise*, the spread of the eight replicates (`noise`);
//! - *bias*, the blur of the kernels that gather photons, from what narrower
//!   kernels find of the same photons (`blur`).
//!
//! A *lit* pixel is one around which, in 5 x 5 pixels, the mean is above a
//! hundredth of the picture's. Dark ones are left out: a black background would
//! make every picture look better. The *caustic region* is made of the lit
//! pixels that owe more than a tenth of their light to the caustic layer.
//!
//! "At 90 %" means: with a probability of 0.9 the error is no larger. Of the
//! whole picture that is a bound for the error of *this* picture, not for the
//! mean over many. `docs/accuracy.md` has the experiment that checks it.

mod blur;
mod figures;
mod noise;
mod spread;

use rayon::prelude::*;

use super::{
    convolve::{convolve, kernel, normalized},
    noise::relative_deviation,
    plane::Plane,
};
use crate::{
    film::{Film, Image, Layer, REPLICATES},
    spectrum::Rgb,
};

pub use figures::Figures;

/// A pixel is lit where the mean around it is above this part of the
/// picture's.
const LIT: f64 = 0.01;

/// A lit pixel belongs to the caustic region where the caustic layer holds
/// more than this part of its light.
const CAUSTIC: f64 = 0.1;

/// Weight of the squared mean in the denominator of relative errors.
const MEAN_WEIGHT: f64 = 0.01;

/// Fewest replicates that tell anything of an error.
const FEWEST: usize = 4;

/// What a picture says about its own error.
#[derive(Clone, Debug)]
pub struct Statement {
    /// Standard error of the picture, W/m2/sr, to eight binary digits.
    pub noise: Image,
    /// Size of the bias that is left in the picture, W/m2/sr: above zero where
    /// the picture is too bright, below where it is too dark. What of it is
    /// certain: where noise hides it, it is zero. To eight binary digits.
    pub bias: Image,
    /// What [`relative_noise`](super::relative_noise) makes of [`Film::noise`].
    pub relative_noise: f64,
    /// Relative error of every pixel at 90 %.
    pub bound: Plane,
    /// Which pixels are lit.
    pub lit: Vec<bool>,
    /// Which pixels belong to the caustic region.
    pub caustic: Vec<bool>,
    /// The error of all lit pixels.
    pub whole: Figures,
    /// The error of the caustic region, if there is one.
    pub caustics: Option<Figures>,
}

/// The picture to which errors are set in relation.
struct Ground {
    /// What each pixel is likely to be, W/m2/sr.
    likely: Vec<Rgb>,
    /// Squares of the denominators, per pixel and channel; zero only where
    /// the whole picture is black.
    squares: Vec<Rgb>,
    /// What they have beyond the pixel's own square.
    floor: f64,
    /// Variances of the picture, as each pixel knows its own, (W/m2/sr)^2.
    variances: Vec<Rgb>,
    /// In units of the picture's mean, which single precision holds at any scale.
    deviations: Vec<noise::Deviations>,
    /// That unit, W/m2/sr.
    unit: f64,
    /// What the variances come to, as [`Statement`] has it.
    relative_noise: f64,
    lit: Vec<bool>,
    caustic: Vec<bool>,
    /// The layer of that name.
    caustics: Image,
    width: usize,
    height: usize,
}

impl Statement {
    /// What `film` says about its error; `target` is a relative error of which
    /// it is to be said how many pixels exceed it. `None` before every
    /// replicate has a pass, or of a black picture.
    pub fn of(film: &Film, target: Option<f64>) -> Option<Self> {
        if film.replicate_passes().contains(&0) {
            return None;
        }
        let Evidence {
            ground,
            noise,
            blur,
            total,
        } = Evidence::of(film)?;
        let quantile = noise::two_sided();
        let figures = |region: &[bool]| Figures::of((&noise, &blur, &total), region, target);
        Some(Self {
            whole: figures(&ground.lit)?,
            caustics: figures(&ground.caustic),
            noise: noise.image(&ground),
            bias: blur.image(&ground),
            relative_noise: ground.relative_noise,
            bound: Plane::join(&total, &total, |t, _| quantile * t.sqrt()),
            lit: ground.lit,
            caustic: ground.caustic,
        })
    }

    /// What `film` lets suppose of the error of all lit pixels, also when only
    /// some replicates have passes: good for a forecast, not for a statement.
    /// `None` before four replicates have one, or of a black picture.
    pub fn early(film: &Film) -> Option<Figures> {
        let present = present(film);
        if present.len() < FEWEST {
            return None;
        }
        let e = Evidence::of(film)?;
        Figures::of((&e.noise, &e.blur, &e.total), &e.ground.lit, None)
    }
}

/// The replicates that have passes.
fn present(film: &Film) -> Vec<usize> {
    let passes = film.replicate_passes();
    (0..REPLICATES).filter(|&r| passes[r] > 0).collect()
}

/// What a film says of noise and bias.
struct Evidence {
    ground: Ground,
    noise: noise::Noise,
    blur: blur::Blur,
    /// Squared errors of the pixels, pooled.
    total: Plane,
}

impl Evidence {
    fn of(film: &Film) -> Option<Self> {
        let mut ground = Ground::of(film)?;
        let mut blur = blur::Blur::of(film, &ground);
        blur.correct(&mut ground);
        let noise = noise::Noise::of(film, &ground);
        Some(Self {
            total: Plane::join(&noise.pooled, &blur.pooled, |n, b| n + b),
            ground,
            noise,
            blur,
        })
    }
}

impl Ground {
    fn of(film: &Film) -> Option<Self> {
        let (width, height) = (film.width() as usize, film.height() as usize);
        let image = film.image();
        let mean = image.mean().mean();
        if mean.is_nan() || mean <= 0.0 {
            return None;
        }
        let floor = MEAN_WEIGHT * mean * mean;
        // Without the darkest and the brightest replicate: a spark would hide
        // itself in its own denominator.
        let present = present(film);
        let known = |i: usize| {
            let (replicates, variance) = film.spread_at(i);
            let steady = noise::without_extremes(&replicates, &present);
            let deviations = noise::deviations(&replicates, &present, mean);
            ((steady, variance), deviations)
        };
        let pixels = (0..width * height).into_par_iter().map(known);
        let ((steady, variances), deviations): ((Vec<Rgb>, Vec<Rgb>), Vec<_>) = pixels.unzip();
        let smooth = [0, 1, 2].map(|c| {
            let plane = |of: &[Rgb]| Plane::new(width, height, of.iter().map(|p| p[c]).collect());
            smoothed([&steady, image.pixels(), &variances].map(plane))
        });
        let likely: Vec<Rgb> = (0..width * height)
            .map(|i| Rgb([0, 1, 2].map(|c| smooth[c].values()[i])))
            .collect();
        let squares = likely.iter().map(|&x| x * x + Rgb::grey(floor)).collect();
        let around = box_kernel(2);
        let bright = convolve(&Plane::of(&image, Rgb::mean), &around, &around);
        let lit: Vec<bool> = bright.values().iter().map(|&b| b > LIT * mean).collect();
        let caustics = film.layer_image(Layer::Caustic);
        let shares = caustics.pixels().iter().zip(image.pixels());
        let caustic = shares.zip(&lit);
        let caustic = caustic.map(|((c, all), &lit)| lit && c.mean() > CAUSTIC * all.mean());
        Some(Self {
            likely,
            squares,
            floor,
            relative_noise: relative_deviation(&image, variances.iter().copied()),
            variances,
            deviations,
            unit: mean,
            caustic: caustic.collect(),
            caustics,
            lit,
            width,
            height,
        })
    }

    /// Takes a bias off what a pixel is likely to be, up to a factor.
    fn take_off(&mut self, pixel: usize, bias: Rgb, most: f64) {
        let x = self.likely[pixel];
        let x = Rgb([0, 1, 2].map(|c| (x[c] - bias[c]).max(x[c] / most).min(x[c] * most)));
        self.likely[pixel] = x;
        self.squares[pixel] = x * x + Rgb::grey(self.floor);
    }

    /// A plane of what `f` makes of each pixel's number.
    fn plane(&self, f: impl Fn(usize) -> f64 + Sync + Send) -> Plane {
        let values = (0..self.squares.len()).into_par_iter().map(f).collect();
        Plane::new(self.width, self.height, values)
    }
}

/// What pixels are likely to be: what most replicates say (`steady`), drawn to the
/// mean of the 3 x 3 pixels around, as far as what keeps a pixel apart from them may
/// be its noise (W. James and C. Stein, *Estimation with Quadratic Loss*, Berkeley
/// Symp. 1961). A dark pixel beside a bright one stays dark, whose errors would
/// otherwise look small. The mean around is that of the whole picture: where all
/// light comes by sparks, the pixels without one would look too dark by themselves.
fn smoothed([steady, picture, variances]: [Plane; 3]) -> Plane {
    let near = box_kernel(1);
    let [smooth, around] = [&picture, &variances].map(|p| convolve(p, &near, &near));
    let noise = Plane::join(&around, &variances, f64::max);
    let apart = Plane::join(&steady, &smooth, |own, near| own - near);
    let kept = Plane::join(&apart, &noise, standing_out);
    Plane::join(&smooth, &kept, |near, kept| near + kept)
}

/// What stands out of a difference from noise of that variance, which alone
/// would make it so large (James and Stein).
fn standing_out(apart: f64, variance: f64) -> f64 {
    if apart * apart > variance {
        apart * (1.0 - variance / (apart * apart))
    } else {
        0.0
    }
}

/// The nearest number of eight binary digits, half away from zero: no pixel's error
/// is known any better, and digits that say nothing take time and room in files.
fn coarse(x: f64) -> f64 {
    const DROPPED: u32 = 45;
    let half = 1 << (DROPPED - 1);
    f64::from_bits((x.to_bits() + half) & !((1 << DROPPED) - 1))
}

/// The mean over so many pixels to either side.
fn box_kernel(radius: usize) -> Vec<f64> {
    normalized(kernel(radius, |_| 1.0)).0
}

/// The mean over the channels of `squares` over those of the denominators.
fn relative(squares: Rgb, denominators: Rgb) -> f64 {
    Rgb([0, 1, 2].map(|c| squares[c] / denominators[c])).mean()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_digits_are_kept() {
        for (x, kept) in [
            (0.0, 0.0),
            (-3.0, -3.0),
            (1.0 + 1.0 / 256.0, 1.0 + 1.0 / 128.0),
            (-1.0 - 1.0 / 257.0, -1.0),
            (1.999, 2.0),
            (f64::INFINITY, f64::INFINITY),
        ] {
            assert_eq!(coarse(x), kept);
        }
        assert!((coarse(0.1) / 0.1 - 1.0).abs() <= 1.0 / 512.0);
        assert_eq!((coarse(0.1) as f32).to_bits() & 0xffff, 0);
    }

    /// Away from the edge of a shadow nothing changes; beside it dark pixels stay
    /// dark where there is little noise, and are drawn to the mean where there is
    /// much.
    #[test]
    fn pixels_are_smoothed_as_far_as_they_are_noisy() {
        let step = Plane::new(
            8,
            3,
            (0..24).map(|i| f64::from(u8::from(i % 8 > 3))).collect(),
        );
        let even = |v: f64| Plane::new(8, 3, vec![v; 24]);
        let of = |step: &Plane, noise| smoothed([step.clone(), step.clone(), even(noise)]);
        let at = |noise: f64, x: usize| of(&step, noise).row(1)[x];
        for noise in [0.0, 1e-4, 1.0] {
            assert!(at(noise, 1).abs() < 1e-15 && (at(noise, 6) - 1.0).abs() < 1e-15);
        }
        assert!(at(0.0, 3).abs() < 1e-15);
        assert!((at(1.0, 3) - 1.0 / 3.0).abs() < 1e-15);
        // What one spark in nine pixels brings is what each is likely to get.
        let mut sparks = even(1.0);
        sparks.values_mut()[12] = 10.0;
        let likely = smoothed([even(1.0), sparks, even(100.0)]);
        assert!(likely.row(1)[3..6].iter().all(|x| (x - 2.0).abs() < 1e-15));
        // A third apart: a ninth over the variance.
        assert!((at(0.02, 3) - (1.0 - (1.0 - 0.02 * 9.0)) / 3.0).abs() < 1e-12);
    }
}

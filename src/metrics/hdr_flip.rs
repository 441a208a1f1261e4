//! HDR-FLIP: the worst that FLIP finds over the exposures in which a picture
//! of high dynamic range may be looked at (P. Andersson, J. Nilsson, P. Shirley,
//! T. Akenine-Möller, *Visualizing Errors in Rendered High Dynamic Range
//! Images*, Eurographics short papers, 2021).
//!
//! The range is found from the reference: from the exposure that takes its
//! brightest pixel to 0.85 on the screen to the one that takes its median
//! there, in steps of one stop at most.

use rayon::prelude::*;

use super::{
    flip::flip,
    image_error::{SizeMismatch, check_sizes},
    opponent::luminance,
    plane::Plane,
};
use crate::{
    film::Image,
    numeric::trig::{exp2, log2},
    spectrum::Rgb,
};

/// Brightness on the screen that decides the range of exposures (section 3).
const WHITE_POINT: f64 = 0.85;

/// A median below this counts as this, as in the published tool: the step of
/// single precision at one.
const DARKEST: f64 = f32::EPSILON as f64;

/// The ACES film curve as fitted by K. Narkowicz (2016): a ratio of quadratics.
/// The exposure's pre-scale of 0.6 is part of the coefficients, the highest
/// power first.
const ABOVE: [f64; 3] = [2.51 * 0.6 * 0.6, 0.03 * 0.6, 0.0];
const BELOW: [f64; 3] = [2.43 * 0.6 * 0.6, 0.59 * 0.6, 0.14];

/// A range of exposures in stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The darkest.
    pub start: f64,
    /// The brightest.
    pub stop: f64,
    /// How many, at least two, evenly spaced.
    pub count: usize,
}

impl Exposures {
    /// The range for a reference, found from its greatest and its median
    /// luminance. None if it has no luminance above 2^-23, so that there is
    /// nothing to expose for.
    pub fn of(reference: &Image) -> Option<Self> {
        let bright = Plane::of(reference, luminance);
        let mut sorted = bright.values().to_vec();
        sorted.sort_by(f64::total_cmp);
        let largest = *sorted.last()?;
        // Of an even number the upper of the two in the middle.
        let median = sorted[sorted.len() / 2].max(DARKEST);
        if !(largest > DARKEST && largest.is_finite()) {
            return None;
        }
        let shown_white = inverse_curve(WHITE_POINT);
        let start = log2(shown_white / largest);
        let stop = log2(shown_white / median);
        Some(Self {
            start,
            stop,
            count: ((stop - start).ceil() as usize).max(2),
        })
    }

    /// Each of them in stops, the darkest first.
    fn stops(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / (self.count - 1) as f64;
        (0..self.count).map(move |i| self.start + step * i as f64)
    }
}

/// HDR-FLIP of two pictures of linear radiance over `exposures`, pixel by
/// pixel, in 0..=1. Negative values count as black. It is symmetric but for
/// the choice of the exposures.
///
/// # Errors
/// If the sizes differ.
pub fn hdr_flip(
    image: &Image,
    reference: &Image,
    exposures: Exposures,
) -> Result<Plane, SizeMismatch> {
    check_sizes(image, reference)?;
    let nothing = Plane::of(reference, |_| 0.0);
    exposures.stops().try_fold(nothing, |worst, stops| {
        let factor = exp2(stops);
        let found = flip(&shown(image, factor), &shown(reference, factor))?;
        Ok(Plane::join(&worst, &found, f64::max))
    })
}

/// The picture as a screen shows it: exposed and through the film curve.
fn shown(image: &Image, factor: f64) -> Image {
    let pixels = image.pixels().par_iter();
    let pixels = pixels.map(|p: &Rgb| p.map(|c| film_curve((c * factor).max(0.0))));
    Image::new(image.width(), image.height(), pixels.collect())
}

fn film_curve(x: f64) -> f64 {
    let quadratic = |[a, b, c]: [f64; 3]| (a * x + b) * x + c;
    let value = quadratic(ABOVE) / quadratic(BELOW);
    // Infinity over infinity, which white stands for.
    if value.is_nan() {
        1.0
    } else {
        value.clamp(0.0, 1.0)
    }
}

/// The positive value that the film curve takes to `y`.
fn inverse_curve(y: f64) -> f64 {
    let [a, b, c]: [f64; 3] = std::array::from_fn(|i| ABOVE[i] - y * BELOW[i]);
    // a > 0 > c below the curve's limit of 2.51 / 2.43: one root is positive.
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_and_its_inverse() {
        for y in [0.1, 0.5, WHITE_POINT] {
            assert!((film_curve(inverse_curve(y)) - y).abs() < 1e-15, "{y}");
        }
        assert_eq!(film_curve(0.0), 0.0);
        assert_eq!(film_curve(1e300), 1.0);
    }

    /// What `flip-evaluator` 1.7 says for rows of greys.
    #[test]
    fn exposures_of_the_published_tool() {
        for (greys, start, stop, count) in [
            (
                &[1.0, 2.0, 4.0, 8.0][..],
                -1.9167027473449707,
                -0.9167028069496155,
                2,
            ),
            (
                &[1.0, 2.0, 4.0, 8.0, 16.0],
                -2.9167027473449707,
                -0.9167028069496155,
                2,
            ),
            (
                &[0.0, 0.0, 0.0, 3.0],
                -0.5016653537750244,
                24.083297729492188,
                25,
            ),
        ] {
            let pixels = greys.iter().map(|&v| Rgb::grey(v)).collect();
            let image = Image::new(greys.len() as u32, 1, pixels);
            let found = Exposures::of(&image).unwrap();
            assert_eq!(found.count, count);
            // The tool computes in single precision.
            assert!((found.start - start).abs() < 1e-6, "{}", found.start);
            assert!((found.stop - stop).abs() < 2e-6, "{}", found.stop);
        }
        let dark = Image::new(1, 1, vec![Rgb::BLACK]);
        assert_eq!(Exposures::of(&dark), None);
    }
}

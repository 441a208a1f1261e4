//! FLIP: how different two pictures look when they take turns on a screen (P.
//! Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M.
//! Fairchild, *FLIP: A Difference Evaluator for Alternating Images*,
//! Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2),
//! 2020).
//!
//! A pixel's value lies in 0..=1. Both pictures are blurred as the eye blurs
//! them, channel by channel in an opponent space, and compared in a
//! perceptually uniform one; where edges or points appear or vanish the
//! difference is raised. Equations and symbols are those of the paper.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use rayon::prelude::*;

use super::{
    convolve::{along_columns, along_rows, convolve, gaussian, kernel, normalized},
    image_error::{SizeMismatch, check_sizes},
    opponent::{colour_difference, from_opponent, hunt_lab, luminance, opponent},
    plane::Plane,
};
use crate::{
    film::Image,
    numeric::trig::{exp, pow},
    spectrum::Rgb,
};

/// Pixels per degree of vision: a screen of 0.7 m and 3840 pixels across, seen
/// from 0.7 m, as the published tool assumes.
const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// A term of a contrast sensitivity function in space: a Gaussian of weight
/// sqrt(pi / b) a, exp(-pi^2 d^2 / b) at a distance of d degrees (section
/// 4.1.1, table 1).
struct Term {
    a: f64,
    b: f64,
}

/// Sensitivity to light and dark.
const ACHROMATIC: [Term; 1] = [Term { a: 1.0, b: 0.0047 }];
/// Sensitivity from red to green.
const RED_GREEN: [Term; 1] = [Term { a: 1.0, b: 0.0053 }];
/// Sensitivity from blue to yellow.
const BLUE_YELLOW: [Term; 2] = [Term { a: 34.1, b: 0.04 }, Term { a: 13.5, b: 0.025 }];

/// The largest `b` of the terms; it decides how far the filters reach.
const WIDEST: f64 = 0.04;

/// Width of a detected feature in degrees (section 4.2, `w`).
const FEATURE_WIDTH: f64 = 0.082;

/// LDR-FLIP of two pictures as a screen shows them: linear values in 0..=1;
/// what lies outside is clipped. It is symmetric.
///
/// # Errors
/// If the sizes differ.
pub fn flip(image: &Image, reference: &Image) -> Result<Plane, SizeMismatch> {
    check_sizes(image, reference)?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    if width * height == 0 {
        return Ok(Plane::new(width, height, Vec::new()));
    }
    let [a, b] = [image, reference].map(Seen::new);
    let values = (0..width * height).into_par_iter().map(|i| {
        let colour = colour_difference(a.colours[i], b.colours[i]);
        let edge = (a.edges.values()[i] - b.edges.values()[i]).abs();
        let point = (a.points.values()[i] - b.points.values()[i]).abs();
        let feature = (FRAC_1_SQRT_2 * edge.max(point)).sqrt();
        pow(colour, 1.0 - feature)
    });
    Ok(Plane::new(width, height, values.collect()))
}

/// What the eye takes from a picture.
struct Seen {
    /// Blurred colours, Hunt-adjusted.
    colours: Vec<[f64; 3]>,
    /// Strength of edges.
    edges: Plane,
    /// Strength of points and lines.
    points: Plane,
}

impl Seen {
    fn new(image: &Image) -> Self {
        let shown = |p: Rgb| p.map(|c| c.clamp(0.0, 1.0));
        let bright = Plane::of(image, |p| luminance(shown(p)));
        let [edges, points] = features(&bright);
        let channel = |c: usize| Plane::of(image, move |p| opponent(shown(p))[c]);
        let blurred = [
            blur(&channel(0), &ACHROMATIC),
            blur(&channel(1), &RED_GREEN),
            blur(&channel(2), &BLUE_YELLOW),
        ];
        let colours = (0..bright.values().len()).into_par_iter().map(|i| {
            let colour = blurred.each_ref().map(|plane| plane.values()[i]);
            hunt_lab(shown(from_opponent(colour)))
        });
        Self {
            colours: colours.collect(),
            edges,
            points,
        }
    }
}

/// The plane as the eye resolves it: filtered with the sum of the terms, whose
/// weights over the square of pixels add up to one.
fn blur(plane: &Plane, terms: &[Term]) -> Plane {
    // Three standard deviations of the widest term.
    let reach = 3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE;
    let radius = reach.ceil() as usize;
    let filters = terms.iter().map(|term| {
        let exponent = PI * PI / (term.b * PIXELS_PER_DEGREE * PIXELS_PER_DEGREE);
        let (weights, sum) = normalized(kernel(radius, |x| exp(-x * x * exponent)));
        (term.a * (PI / term.b).sqrt() * sum * sum, weights)
    });
    let filters: Vec<(f64, Vec<f64>)> = filters.collect();
    let total: f64 = filters.iter().map(|(weight, _)| weight).sum();
    let parts = filters.iter().map(|(weight, weights)| {
        let share = weight / total;
        let scaled: Vec<f64> = weights.iter().map(|w| w * share).collect();
        convolve(plane, &scaled, weights)
    });
    parts
        .reduce(|a, b| Plane::join(&a, &b, |a, b| a + b))
        .expect("a sensitivity has terms")
}

/// The strengths of edges and of points: lengths of the vectors of first and
/// of second derivatives of a Gaussian, across and down.
fn features(bright: &Plane) -> [Plane; 2] {
    let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * sigma).ceil() as usize;
    let bell = |x: f64| exp(-x * x / (2.0 * sigma * sigma));
    let smooth = gaussian(radius, sigma);
    let first = balanced(kernel(radius, |x| x * bell(x)));
    let second = balanced(kernel(radius, |x| {
        (x * x / (sigma * sigma) - 1.0) * bell(x)
    }));
    let smoothed = along_rows(bright, &smooth);
    [first, second].map(|derivative| {
        let across = along_columns(&along_rows(bright, &derivative), &smooth);
        let down = along_columns(&smoothed, &derivative);
        Plane::join(&across, &down, |a, b| (a * a + b * b).sqrt())
    })
}

/// The weights with the positive ones scaled to a sum of one and the negative
/// ones to minus one, so that a feature's strength does not depend on the
/// resolution.
fn balanced(mut weights: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| -> f64 { weights.iter().map(|w| (w * sign).max(0.0)).sum() };
    let (positive, negative) = (sum(1.0), sum(-1.0));
    for weight in &mut weights {
        *weight /= if *weight > 0.0 { positive } else { negative };
    }
    weights
}

#[cfg(test)]
mod tests;

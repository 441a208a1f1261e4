//! The colour spaces of FLIP (P. Andersson et al., *FLIP: A Difference
//! Evaluator for Alternating Images*, 2020, section 4.1): from linear sRGB to
//! the opponent space `YCxCz` and to Hunt-adjusted CIELAB. White is the sRGB white,
//! D65.

use std::sync::LazyLock;

use crate::{
    numeric::trig::{cbrt, pow},
    spectrum::Rgb,
};

type Matrix = [[f64; 3]; 3];

/// Linear sRGB to CIE XYZ: its columns are the primaries of IEC 61966-2-1,
/// scaled so that they add up to D65 with luminance one. Its chromaticity has
/// the five digits of the published tool, (0.31271, 0.32902), where the standard
/// prints four.
static TO_XYZ: LazyLock<Matrix> = LazyLock::new(|| {
    // XYZ of luminance one from a chromaticity.
    let xyz = |x: f64, y: f64| [x / y, 1.0, (1.0 - x - y) / y];
    let primaries = [xyz(0.64, 0.33), xyz(0.30, 0.60), xyz(0.15, 0.06)];
    let columns = transpose(&primaries);
    let scale = apply(&inverse(&columns), xyz(0.31271, 0.32902));
    columns.map(|row| [row[0] * scale[0], row[1] * scale[1], row[2] * scale[2]])
});

static FROM_XYZ: LazyLock<Matrix> = LazyLock::new(|| inverse(&TO_XYZ));

/// XYZ of linear (1, 1, 1).
static WHITE: LazyLock<[f64; 3]> = LazyLock::new(|| apply(&TO_XYZ, [1.0; 3]));

/// The greatest colour difference that FLIP reckons with: that of the green
/// and the blue primary.
static LARGEST: LazyLock<f64> = LazyLock::new(|| {
    let [green, blue] = [Rgb::new(0.0, 1.0, 0.0), Rgb::new(0.0, 0.0, 1.0)];
    pow(hyab(hunt_lab(green), hunt_lab(blue)), EXPONENT)
});

/// The exponent of colour differences (section 4.1.3, `q_c`).
const EXPONENT: f64 = 0.7;
/// Share of the largest difference where the slope changes (`p_c`).
const KNEE: f64 = 0.4;
/// The value that it is mapped to (`p_t`).
const KNEE_VALUE: f64 = 0.95;

/// Luminance of linear sRGB, white having one.
pub(super) fn luminance(linear: Rgb) -> f64 {
    dot(TO_XYZ[1], linear.0)
}

/// The opponent space `YCxCz` (its first component runs from -16 to 100), in
/// which the eye's contrast sensitivity is known by channel.
pub(super) fn opponent(linear: Rgb) -> [f64; 3] {
    let [x, y, z] = relative_xyz(linear);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Linear sRGB of an opponent colour.
pub(super) fn from_opponent([l, cx, cz]: [f64; 3]) -> Rgb {
    let y = (l + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    let white = *WHITE;
    Rgb(apply(
        &FROM_XYZ,
        std::array::from_fn(|i| relative[i] * white[i]),
    ))
}

/// CIELAB with chroma scaled by lightness, after R. Hunt: colours are harder to
/// tell apart in the dark.
pub(super) fn hunt_lab(linear: Rgb) -> [f64; 3] {
    let [x, y, z] = relative_xyz(linear).map(lightness_curve);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// The difference of two Hunt-adjusted colours in 0..=1: the `HyAB` distance (S.
/// Abasi, M. Amani Tehran, M. Fairchild, *Distance metrics for very large color
/// differences*, 2020), compressed, so that what is far apart counts nearly
/// alike.
pub(super) fn colour_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    let distance = pow(hyab(a, b), EXPONENT);
    let largest = *LARGEST;
    let knee = KNEE * largest;
    if distance < knee {
        KNEE_VALUE / knee * distance
    } else {
        KNEE_VALUE + (distance - knee) / (largest - knee) * (1.0 - KNEE_VALUE)
    }
}

fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, x, y] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (x * x + y * y).sqrt()
}

/// The cube root of CIE 15, with its straight part near black.
fn lightness_curve(t: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA {
        cbrt(t)
    } else {
        t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
    }
}

fn relative_xyz(linear: Rgb) -> [f64; 3] {
    let (xyz, white) = (apply(&TO_XYZ, linear.0), *WHITE);
    std::array::from_fn(|i| xyz[i] / white[i])
}

fn apply(matrix: &Matrix, v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| dot(row, v))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn transpose(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// By cofactors: row i of the inverse is a cross product of two columns over
/// the determinant.
fn inverse(m: &Matrix) -> Matrix {
    let columns = transpose(m);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let determinant = dot(columns[0], cross(columns[1], columns[2]));
    std::array::from_fn(|i| {
        cross(columns[(i + 1) % 3], columns[(i + 2) % 3]).map(|v| v / determinant)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) {
        let apart = (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        assert!(apart <= tolerance, "{a:?} {b:?}");
    }

    /// The standard prints four digits, for a white of four digits; the
    /// published tool has fractions, of which those of the luminance are here.
    #[test]
    fn the_matrix_is_that_of_srgb() {
        let printed = [
            [0.4124, 0.3576, 0.1805],
            [0.2126, 0.7152, 0.0722],
            [0.0193, 0.1192, 0.9505],
        ];
        for (row, expected) in TO_XYZ.iter().zip(printed) {
            close(*row, expected, 2e-4);
        }
        let fractions = [2613072.0, 8788810.0, 887015.0].map(|n: f64| n / 12288897.0);
        close(TO_XYZ[1], fractions, 1e-14);
    }

    #[test]
    fn known_colours() {
        close(opponent(Rgb::WHITE), [100.0, 0.0, 0.0], 1e-12);
        close(opponent(Rgb::BLACK), [-16.0, 0.0, 0.0], 1e-12);
        close(hunt_lab(Rgb::WHITE), [100.0, 0.0, 0.0], 1e-12);
        close(hunt_lab(Rgb::BLACK), [0.0; 3], 1e-12);
        // CIELAB of the red primary under D65 is (53.24, 80.09, 67.20).
        let [l, a, b] = hunt_lab(Rgb::new(1.0, 0.0, 0.0));
        close(
            [l, a * 100.0 / l, b * 100.0 / l],
            [53.24, 80.09, 67.20],
            6e-3,
        );
        let colour = Rgb::new(0.2, 0.7, 0.1);
        close(from_opponent(opponent(colour)).0, colour.0, 1e-14);
    }

    /// Nought for equal colours, one for green and blue, 0.95 at the knee,
    /// continuous there.
    #[test]
    fn differences_run_from_nought_to_one() {
        let [green, blue] = [Rgb::new(0.0, 1.0, 0.0), Rgb::new(0.0, 0.0, 1.0)].map(hunt_lab);
        assert_eq!(colour_difference(green, green), 0.0);
        assert!((colour_difference(green, blue) - 1.0).abs() < 1e-14);
        let at_knee = pow(KNEE * *LARGEST, 1.0 / EXPONENT);
        for step in [1.0 - 1e-9, 1.0 + 1e-9] {
            let value = colour_difference([at_knee * step, 0.0, 0.0], [0.0; 3]);
            assert!((value - KNEE_VALUE).abs() < 1e-8, "{value}");
        }
    }
}

//! The error against exact solutions falls with the number of passes as the
//! theory says, and does not stop falling.

mod common;

use std::f64::consts::PI;

use common::{as_gathered, ball, renderer, scene, scene_of};
use nephroid::{
    film::{Film, Image, Layer},
    metrics::{Slope, fit_slope, relmse},
    numeric::exact::Quantum,
    scene::Scene,
    spectrum::Rgb,
};

/// Mean relMSE of what `see` makes of films, over independent seeds, after each power
/// of two of passes from one round on.
fn errors(
    scene: &mut Scene,
    see: fn(&Film) -> Image,
    exact: &Image,
    seeds: u64,
    most: u32,
) -> Vec<(f64, f64)> {
    let mut curve: Vec<(f64, f64)> = Vec::new();
    for seed in 0..seeds {
        scene.settings.seed = 100 + seed;
        let renderer = renderer(scene);
        let mut film = Film::new(exact.width(), exact.height(), Quantum::for_typical(1.0));
        let mut k = 0;
        for pass in 0..most {
            film.add_pass(pass, &renderer.pass(pass).samples);
            let done = pass + 1;
            if done >= 8 && done.is_power_of_two() {
                let error = relmse(&see(&film), exact).expect("same size");
                if seed == 0 {
                    curve.push((f64::from(done), 0.0));
                }
                curve[k].1 += error / seeds as f64;
                k += 1;
            }
        }
    }
    curve
}

fn caustics(film: &Film) -> Image {
    film.layer_image(Layer::Caustic)
}

fn slope(curve: &[(f64, f64)]) -> Slope {
    let (xs, ys): (Vec<f64>, Vec<f64>) = curve.iter().copied().unzip();
    fit_slope(&xs, &ys).expect("at least three errors above zero")
}

/// Asserts that the last octave still brings at least a quarter of what the
/// whole curve brings per octave: a plateau is a defect.
fn assert_no_plateau(curve: &[(f64, f64)], slope: f64) {
    let [.., (_, before), (_, last)] = curve else {
        panic!("too few points")
    };
    let octave = (last / before).log2();
    assert!(
        octave < 0.25 * slope,
        "the last octave falls like N^{octave:.2}, the curve like N^{slope:.2}: {curve:?}"
    );
}

/// The caustic of a ball lens, with a fold and a focal line. With the kernel
/// shrinking by alpha = 2/3, the mean squared error of a smooth caustic falls
/// like N^(-2/3); at a fold the bias is larger, and the low-discrepancy
/// sequence makes the noise smaller, so the slope lies around it.
#[test]
fn caustic_of_a_ball_lens() {
    let (plane, beam, window, pixels) = (1.3, 0.95, 1.4, 48);
    let exact = ball::irradiance(plane, beam, window, pixels);
    let text = ball::scene_text(plane, beam, window, pixels, "photons: 8192");
    let curve = errors(&mut scene(&text), caustics, &exact, 3, 256);
    let fit = slope(&curve);
    assert!(
        (-1.2..=-0.5).contains(&fit.slope),
        "slope {} +- {}: {curve:?}",
        fit.slope,
        fit.standard_error
    );
    assert_no_plateau(&curve, fit.slope);
}

/// A uniform caustic: no bias, so the noise alone. The relative variance of an
/// Epanechnikov kernel of radius r among independent photons is
/// 4 / (3 pi r^2 n), with n photons on a square metre: the mean of N passes
/// falls like N^(-2/3). A low-discrepancy sequence stays below that, less so
/// as the kernels come to hold few photons, so the slope is smaller on the way
/// to the law. Camera samples that go in step with the photons would show as
/// octaves without progress.
#[test]
fn uniform_caustic() {
    let (mut scene, exact) = evenly_lit("");

    let curve = errors(&mut scene, as_gathered, &exact, 2, 2048);
    let fit = slope(&curve);
    for (passes, error) in &curve {
        let independent = independent_error(&scene, *passes);
        assert!(
            *error < 0.7 * independent,
            "{passes} passes: {error}, independent photons would give {independent}"
        );
    }
    assert!(
        (-1.6..=-0.4).contains(&fit.slope),
        "slope {} +- {}: {curve:?}",
        fit.slope,
        fit.standard_error
    );
    for pair in curve.windows(2) {
        assert!(
            pair[1].1 < pair[0].1,
            "an octave without progress: {curve:?}"
        );
    }
    // A single sheet of light: of the noise, hardly any is left.
    let sheets = errors(&mut scene, caustics, &exact, 2, 2048);
    for ((passes, error), (_, gathered)) in sheets.iter().zip(&curve) {
        assert!(
            *error < 0.1 * gathered,
            "{passes} passes: {error} of {gathered}"
        );
    }
}

/// A floor under a pane, lit from above: the caustic is even.
fn evenly_lit(render: &str) -> (Scene, Image) {
    let scene = scene_of(
        "eye: (0, 0, 0.3), look_at: (0, 0, 0), up: (0, 1, 0), height: 0.8",
        [16, 16],
        "(shape: Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: 4), material: \"white\"),
         (shape: Quad(corner: (-2, -2, 0.5), u: (4, 0, 0), v: (0, 4, 0)), material: \"glass\", open: true),
         (shape: Quad(corner: (-2, 2, 0.4), u: (4, 0, 0), v: (0, -4, 0)), material: \"glass\", open: true)",
        "Directional(direction: (0, 0, -1), irradiance: 1, beam: (center: (0, 0, 2), radius: 1))",
        &format!("photons: 1024, indirect: false{render}"),
    );
    // T = (1 - R) / (1 + R) with R = 0.04.
    let exact = Image::from_fn(16, 16, |_, _| Rgb::grey(0.96 / 1.04 / PI));
    (scene, exact)
}

/// Relative mean squared error of its mean over so many passes of independent
/// photons with circles for kernels.
fn independent_error(scene: &Scene, passes: f64) -> f64 {
    let renderer = renderer(scene);
    let density = 1024.0 * 0.96 / 1.04 / PI;
    let variance = |pass: u32| {
        let r = 0.8 / 16.0 * renderer.scale(pass / 8);
        4.0 / (3.0 * PI * r * r * density)
    };
    (0..passes as u32).map(variance).sum::<f64>() / (passes * passes)
}

/// Without low discrepancy and derivatives what is left is the law of
/// independent photons in circles, to the digit.
#[test]
fn independent_photons_in_circles_follow_their_law() {
    let (mut scene, exact) = evenly_lit(", sampler: Independent, kernel: Circle");
    for (passes, error) in errors(&mut scene, caustics, &exact, 24, 64) {
        let ratio = error / independent_error(&scene, passes);
        // Some 480 patches of the kernel's size: 6.5 % of chance.
        assert!((0.75..1.25).contains(&ratio), "{passes} passes: {ratio}");
    }
}

/// Soft direct light without shadows: independent samples give N^-1, the
/// pixels' own low-discrepancy sequences more.
#[test]
fn direct_light() {
    let mut scene = scene_of(
        "eye: (0, 0, 0.001), look_at: (0, 0, 0), up: (0, 1, 0), height: 1e-6",
        [24, 24],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\")",
        "Sphere(center: (0, 0, 1), radius: 0.5, radiance: 1)",
        "indirect: false",
    );
    let exact = Image::from_fn(24, 24, |_, _| Rgb::grey(0.25));
    let curve = errors(
        &mut scene,
        |film| film.layer_image(Layer::Direct),
        &exact,
        2,
        512,
    );
    let fit = slope(&curve);
    assert!(
        (-3.2..=-0.9).contains(&fit.slope),
        "slope {} +- {}: {curve:?}",
        fit.slope,
        fit.standard_error
    );
    assert_no_plateau(&curve, fit.slope);
}

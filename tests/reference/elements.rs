//! Radiosity: what is lost by taking the light of an element for constant.

use std::{f64::consts::PI, num::NonZero};

use nephroid::{
    film::Layer,
    metrics::fit_slope,
    reference::{Method, Options},
};

use super::{by_method, common::scene_of, job};

/// A lamp without extent before a wall, and the floor at its foot.
const POWER: f64 = 10.0;
const LAMP: [f64; 3] = [0.25, 0.0, 0.4];
const WALL: f64 = 0.5;
/// So dark that light which comes back to the floor adds less than a part in
/// a thousand.
const FLOOR: f64 = 0.001;

/// The part of the floor that is seen: its middle's distance from the wall,
/// and its width.
const MIDDLE: f64 = 0.3;
const WIDTH: f64 = 0.5;
const PIXELS: u32 = 8;

/// What the floor at (x, y) sends on of the wall's light: one integral over the
/// wall, by its middle points.
fn exact(x: f64, y: f64) -> f64 {
    const STEPS: u32 = 200;
    let step = 1.0 / f64::from(STEPS);
    let mut sum = 0.0;
    for i in 0..STEPS {
        let v = (f64::from(i) + 0.5) * step - 0.5;
        for j in 0..STEPS {
            let z = (f64::from(j) + 0.5) * step;
            let [a, b, c] = LAMP;
            let to_lamp = a * a + (v - b) * (v - b) + (z - c) * (z - c);
            let irradiance = POWER / (4.0 * PI) * a / to_lamp.powf(1.5);
            let r2 = x * x + (v - y) * (v - y) + z * z;
            sum += WALL * irradiance / PI * (x * z) / (r2 * r2);
        }
    }
    FLOOR / PI * sum * step * step
}

/// Mean of a column of pixels.
fn exact_column(column: u32) -> f64 {
    let pixel = WIDTH / f64::from(PIXELS);
    // Four points across a pixel and sixteen along the column.
    let mut sum = 0.0;
    for i in 0..4 {
        let at = f64::from(column) + (f64::from(i) + 0.5) / 4.0;
        for j in 0..16 {
            let y = (f64::from(j) + 0.5) / 16.0 * WIDTH - 0.5 * WIDTH;
            sum += exact(MIDDLE - 0.5 * WIDTH + at * pixel, y);
        }
    }
    sum / 64.0
}

/// Elements of half the size have less than half the error: it falls with about
/// the second power of the size where light is smooth.
#[test]
fn smaller_elements_are_more_exact() {
    let [x, y, z] = LAMP;
    let scene = scene_of(
        &format!(
            "eye: ({MIDDLE}, 0, 0.9), look_at: ({MIDDLE}, 0, 0), up: (0, 1, 0), height: {WIDTH}"
        ),
        [PIXELS, PIXELS],
        &format!(
            "(shape: Quad(corner: (0, -0.5, 0), u: (0, 1, 0), v: (0, 0, 1)), material: Diffuse(reflectance: {WALL})),
             (shape: Quad(corner: (0, -0.5, 0), u: (1, 0, 0), v: (0, 1, 0)), material: Diffuse(reflectance: {FLOOR}))"
        ),
        &format!("Point(position: ({x:?}, {y:?}, {z:?}), power: {POWER:?})"),
        "",
    );
    let truth: Vec<f64> = (0..PIXELS).map(exact_column).collect();
    // The diameter of the whole is 3^(1/2): so many elements for it make that many
    // along each side.
    let mut points = Vec::new();
    for (patches, along) in [(3, 2), (6, 4), (13, 8)] {
        let mut job = job(&scene, 64);
        job.settings.photons = Some(1 << 13);
        let options = Options {
            patches: NonZero::new(patches).expect("not zero"),
            ..Options::default()
        };
        let film = by_method(&scene, &job, Method::Radiosity, options);
        let indirect = film.layer_image(Layer::Indirect);
        let column = |x: u32| {
            let pixels = (0..PIXELS).map(|y| indirect.pixel(x, y)[1]);
            pixels.sum::<f64>() / f64::from(PIXELS)
        };
        let off = |x: u32| column(x) / truth[x as usize] - 1.0;
        let squares: f64 = (0..PIXELS).map(|x| off(x) * off(x)).sum();
        let error = (squares / f64::from(PIXELS)).sqrt();
        points.push((f64::from(along), error));
    }
    let (sizes, errors): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    for pair in errors.windows(2) {
        assert!(pair[1] < 0.5 * pair[0], "{errors:?}");
    }
    // 18 % and 1.2 % with many more passes.
    assert!((0.15..0.21).contains(&errors[0]), "{errors:?}");
    let fit = fit_slope(&sizes, &errors).expect("three points");
    assert!((-2.5..-1.5).contains(&fit.slope), "{fit:?} {errors:?}");
}

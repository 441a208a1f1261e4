//! Helpers of the oracle tests: scenes from text, passes, photons, and
//! estimates with their standard error.
//!
//! Every seed is fixed, so a test passes always or never; the bounds in
//! standard errors say how surprising a failure would be.

#![allow(
    dead_code,
    reason = "every test binary compiles this module and uses its own part of it"
)]

pub(crate) mod ball;
pub(crate) mod cells;

use std::{ops::ControlFlow, path::Path};

use nephroid::{
    film::{Film, Image, Layer},
    photon::{Emission, LightTally, Photon, trace},
    render::{Job, Outcome, REPLICATES, Renderer, run},
    sampling::{Purpose, Sequence, Stream},
    scene::{Scene, load_str},
};

/// A scene from its text.
pub(crate) fn scene(text: &str) -> Scene {
    load_str(text, "test.ron", Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A scene of the given parts, each as it stands in a file: the camera's
/// fields, width and height, and the lists of objects and lights. The
/// materials `white`, `grey`, `mirror` and `glass` are there.
pub(crate) fn scene_of(
    camera: &str,
    [width, height]: [u32; 2],
    objects: &str,
    lights: &str,
    render: &str,
) -> Scene {
    scene(&scene_text(
        camera,
        [width, height],
        objects,
        lights,
        render,
    ))
}

/// The text of [`scene_of`].
pub(crate) fn scene_text(
    camera: &str,
    [width, height]: [u32; 2],
    objects: &str,
    lights: &str,
    render: &str,
) -> String {
    format!(
        "(camera: ({camera}), image: (width: {width}, height: {height}),
          materials: {{
            \"white\": Diffuse(reflectance: 1),
            \"grey\": Diffuse(reflectance: 0.5),
            \"mirror\": Mirror(),
            \"glass\": Dielectric(ior: 1.5),
          }},
          objects: [{objects}], lights: [{lights}], render: ({render}))"
    )
}

/// Renders the scene as its own text says.
pub(crate) fn render(scene: &Scene) -> Outcome {
    run(scene, &Job::of(scene), &mut |_| ControlFlow::Continue(()))
}

/// The scene's renderer of the whole picture.
pub(crate) fn renderer(scene: &Scene) -> Renderer<'_> {
    let [w, h] = scene.resolution;
    Renderer::new(scene, &scene.settings, scene.resolution, [0, 0, w, h])
}

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    pub(crate) error: f64,
}

impl Estimate {
    /// Of independent, identically distributed values.
    pub(crate) fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        Self {
            mean,
            error: (squares / (n * (n - 1.0))).sqrt(),
        }
    }

    /// Asserts that the mean is `expected`, within five standard errors and
    /// the rounding of single precision photons, and that the standard error
    /// is at most `precision` (relative): a blurred answer proves nothing.
    /// Of eight replicates, five errors are exceeded once in 600 times
    /// (Student's t, 7 degrees of freedom).
    pub(crate) fn assert_is(self, expected: f64, precision: f64, what: &str) {
        let rounding = 1e-6 * expected.abs();
        assert!(
            (self.mean - expected).abs() <= 5.0 * self.error + rounding,
            "{what}: {self:?}, expected {expected}: {:.1} standard errors",
            (self.mean - expected) / self.error
        );
        assert!(
            self.error <= precision * expected.abs(),
            "{what}: {self:?} is not precise to {precision}"
        );
    }
}

/// The mean of each layer over the whole picture (green channel), with the
/// standard error from the spread of the eight replicates.
pub(crate) fn layer_means(scene: &Scene, rounds: u32) -> [Estimate; 4] {
    let renderer = renderer(scene);
    let mut replicates = [[0.0; REPLICATES as usize]; 4];
    for pass in 0..rounds * REPLICATES {
        let output = renderer.pass(pass);
        let scale = 1.0 / (output.samples.len() as f64 * f64::from(rounds));
        for sample in &output.samples {
            for layer in Layer::ALL {
                let replicate = (pass % REPLICATES) as usize;
                replicates[layer as usize][replicate] += sample[layer][1] * scale;
            }
        }
    }
    replicates.map(|values| Estimate::of(&values))
}

/// What became of one photon path.
pub(crate) struct Path1 {
    pub(crate) emission: Emission,
    pub(crate) photon: Option<Photon>,
    pub(crate) tally: LightTally,
}

/// Paths `0..count` of the scene's photon sequence.
pub(crate) fn photon_paths(scene: &Scene, count: u64) -> Vec<Path1> {
    let renderer = renderer(scene);
    let emitter = renderer.emitter().expect("a scene with caustics");
    let ctx = renderer.context();
    let sequence = Sequence::new(scene.settings.seed, Purpose::Photon, 0, 0);
    (0..count)
        .map(|i| {
            let mut stream = sequence.at(i);
            let emission = emitter.emit(&ctx, &mut stream);
            let mut tally = LightTally::default();
            // The first photon of a path; a second one has bounced.
            let mut photon = None;
            trace(
                &ctx,
                &emission,
                count as f64,
                &mut stream,
                &mut tally,
                &mut |p| {
                    photon.get_or_insert(p);
                },
            );
            Path1 {
                emission,
                photon,
                tally,
            }
        })
        .collect()
}

/// Stream number `i` of a family of streams that are independent of each
/// other, unlike the points of one low-discrepancy sequence.
pub(crate) fn independent(family: u64, i: u64) -> Stream {
    Sequence::new(family, Purpose::Pilot, 7, i).at(0)
}

/// The caustics that all passes of whole rounds together gathered, without any
/// correction.
pub(crate) fn as_gathered(film: &Film) -> Image {
    let picture = film.image();
    let caustic = film.layer_image(Layer::Caustic);
    let replicates: Vec<Image> = (0..8).map(|r| film.replicate_image(r)).collect();
    Image::from_fn(picture.width(), picture.height(), |x, y| {
        let sum = replicates.iter().map(|r| r.pixel(x, y));
        let mean = sum.reduce(|a, b| a + b).expect("eight") * 0.125;
        caustic.pixel(x, y) + (mean - picture.pixel(x, y))
    })
}

/// The green channel of all pixels.
pub(crate) fn greens(image: &Image) -> impl Iterator<Item = f64> + '_ {
    image.pixels().iter().map(|p| p[1])
}

/// Asserts equality up to a relative error.
pub(crate) fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!(
        (value - expected).abs() <= relative * expected.abs(),
        "{what}: {value} is not {expected} (off by {:e})",
        (value - expected) / expected
    );
}

/// Reflectance of one surface by Fresnel's equations in angles.
pub(crate) fn reflectance(angle: f64, index: f64) -> f64 {
    if angle == 0.0 {
        return ((index - 1.0) / (index + 1.0)).powi(2);
    }
    let t = (angle.sin() / index).asin();
    let s = ((angle - t).sin() / (angle + t).sin()).powi(2);
    let p = ((angle - t).tan() / (angle + t).tan()).powi(2);
    0.5 * (s + p)
}

//! The reference methods against closed forms, against each other, and against
//! the renderer.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod bias;
mod blind;
mod caustics;
mod closed;
mod limits;

use std::{num::NonZero, ops::ControlFlow};

use common::Estimate;
use nephroid::{
    film::Film,
    reference::{self, Method, Options},
    render::{Job, REPLICATES, run},
    scene::Scene,
};

/// Pixels along a block whose mean is compared: errors of neighbouring pixels
/// go together.
const BLOCK: u32 = 8;

/// Student's t for two samples of eight replicates has 14 degrees of freedom:
/// 7 is exceeded once in 160,000 tests, some 1500 of which are made here.
const MOST_ERRORS: f64 = 7.0;

/// Kernel radius with which progressive photon mapping begins here, in pixels:
/// its blur is much smaller than a block.
const RADIUS: f64 = 0.5;

/// Light paths a pass of the methods with photons, for each pixel, and photons
/// of an estimate: so that the circles of the first photon map are much smaller
/// than a block.
const PATHS_PER_PIXEL: u64 = 8;
const NEAREST: NonZero<u32> = NonZero::new(32).expect("not zero");

/// Whose picture is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    Photons,
    Method(Method),
}

use By::Photons;

const PATH: By = By::Method(Method::Path);
const LIGHT: By = By::Method(Method::Light);
const BDPT: By = By::Method(Method::Bdpt);
const METROPOLIS: By = By::Method(Method::Metropolis);
const PHOTON_MAP: By = By::Method(Method::PhotonMap);
const SPPM: By = By::Method(Method::Sppm);
const RADIOSITY: By = By::Method(Method::Radiosity);

impl By {
    /// What a method's errors on purpose may move between blocks, where
    /// `blur` is what the renderer's kernels may.
    fn slack(self, blur: f64) -> f64 {
        match self {
            Photons => blur,
            SPPM => 0.01 + 2.0 * blur,
            // Its circles do not shrink.
            PHOTON_MAP => 0.01 + 5.0 * blur,
            RADIOSITY => 0.01,
            By::Method(_) => 0.0,
        }
    }
}

/// A job of so many rounds of eight passes.
fn job(scene: &Scene, rounds: u32) -> Job {
    let mut job = Job::of(scene);
    job.settings.passes = rounds * REPLICATES;
    job
}

/// The film of a job by a method, with its default options.
fn by_method(scene: &Scene, job: &Job, method: Method, options: Options) -> Film {
    let on = &mut |_: &_| ControlFlow::Continue(());
    let outcome = reference::render(scene, job, method, options, on);
    outcome.unwrap_or_else(|e| panic!("{e}")).film
}

/// The scene's film after so many rounds of eight passes.
fn film(scene: &Scene, by: By, rounds: u32) -> Film {
    let mut job = job(scene, rounds);
    let By::Method(method) = by else {
        let on = &mut |_: &_| ControlFlow::Continue(());
        return run(scene, &job, on).film;
    };
    if [SPPM, PHOTON_MAP].contains(&by) {
        let [width, height] = job.resolution.map(u64::from);
        job.settings.photons = Some(PATHS_PER_PIXEL * width * height);
        job.settings.radius = RADIUS;
    }
    let options = Options {
        nearest: NEAREST,
        ..Options::default()
    };
    by_method(scene, &job, method, options)
}

/// Mean of each block of pixels, with the spread of the replicates.
fn blocks(film: &Film) -> Vec<Estimate> {
    let images: Vec<_> = (0..REPLICATES as usize)
        .map(|r| film.replicate_image(r))
        .collect();
    let mut found = Vec::new();
    for top in (0..film.height()).step_by(BLOCK as usize) {
        for left in (0..film.width()).step_by(BLOCK as usize) {
            let means: Vec<f64> = images
                .iter()
                .map(|image| {
                    let rows = top..(top + BLOCK).min(film.height());
                    let pixels = rows.flat_map(|y| {
                        (left..(left + BLOCK).min(film.width())).map(move |x| (x, y))
                    });
                    let (sum, count) = pixels.fold((0.0, 0.0), |(sum, count), (x, y)| {
                        (sum + image.pixel(x, y)[1], count + 1.0)
                    });
                    sum / count
                })
                .collect();
            found.push(Estimate::of(&means));
        }
    }
    found
}

/// Mean of the whole picture (or a layer's share of it), by replicates.
fn whole(film: &Film) -> Estimate {
    let means: Vec<f64> = (0..REPLICATES as usize)
        .map(|r| film.replicate_image(r).mean()[1])
        .collect();
    Estimate::of(&means)
}

/// Asserts that all pictures show the same, block by block; `precision` is the
/// largest standard error of a picture's mean, `blur` what the photons' kernels
/// may move between blocks, both relative to the mean of the picture.
fn assert_agree(scene: &Scene, all: &[(By, u32)], precision: f64, blur: f64, what: &str) {
    let films: Vec<(By, Film)> = all
        .iter()
        .map(|&(by, rounds)| (by, film(scene, by, rounds)))
        .collect();
    let (first, truth) = &films[0];
    let mean = whole(truth).mean;
    let (truth_blocks, truth_mean) = (blocks(truth), whole(truth));
    for (by, film) in &films {
        let own = whole(film);
        assert!(
            own.error <= precision * mean,
            "{what}: {by:?} is not precise: {own:?}"
        );
        assert_eq!(film.refused(), 0, "{what}: {by:?}");
    }
    for (by, film) in &films[1..] {
        let slack = by.slack(blur).max(first.slack(blur)) * mean;
        let pairs = blocks(film).into_iter().zip(&truth_blocks);
        let pairs = pairs.chain([(whole(film), &truth_mean)]);
        for (i, (a, b)) in pairs.enumerate() {
            let error = (a.error * a.error + b.error * b.error).sqrt();
            assert!(
                (a.mean - b.mean).abs() <= MOST_ERRORS * error + slack + 1e-9 * mean,
                "{what}: {by:?} and {first:?} differ in block {i}: {a:?} {b:?}, {:.1} errors",
                (a.mean - b.mean) / error
            );
        }
    }
}

const ROOM: &str = "
    (shape: Quad(center: (0, 0, 0), size: (2, 2), normal: (0, 0, 1)), material: \"grey\"),
    (shape: Quad(center: (0, 0, 2), size: (2, 2), normal: (0, 0, -1)), material: \"grey\"),
    (shape: Quad(center: (0, 1, 1), size: (2, 2), normal: (0, -1, 0)), material: \"grey\"),
    (shape: Quad(center: (-1, 0, 1), size: (2, 2), normal: (1, 0, 0)), material: Diffuse(reflectance: (0.6, 0.2, 0.1))),
    (shape: Quad(center: (1, 0, 1), size: (2, 2), normal: (-1, 0, 0)), material: Diffuse(reflectance: (0.1, 0.5, 0.2))),";

const VIEW: &str = "eye: (0, -3.2, 1), look_at: (0, 0, 1), fov: 40";

//! The reference methods against closed forms, against each other, and against
//! the renderer.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod bias;
mod blind;
mod caustics;
mod closed;
mod elements;
mod judgement;
mod limits;

use std::{num::NonZero, ops::ControlFlow};

use common::Estimate;
use nephroid::{
    film::Film,
    reference::{self, Method, Options},
    render::{Job, REPLICATES, run},
    scene::Scene,
};

/// Kernel radius with which progressive photon mapping begins here, in pixels.
const RADIUS: f64 = 0.5;

/// Light paths a pass of the methods that choose their number, for each pixel,
/// and photons
/// of an estimate of the first photon map: with fewer the estimate depends on
/// half a photon (`closed::an_even_caustic`).
const PATHS_PER_PIXEL: u64 = 32;
const NEAREST: u32 = 48;

/// Elements of radiosity along the scene.
const PATCHES: u32 = 32;

/// How wide kernels are: as they are in these tests, or twice that.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Width {
    Narrow,
    Wide,
}

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
    /// Whether the method makes errors on purpose that shrink with the width of
    /// its kernels or elements.
    fn has_blur(self) -> bool {
        [Photons, SPPM, PHOTON_MAP, RADIOSITY].contains(&self)
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
fn film_of(scene: &Scene, by: By, rounds: u32) -> Film {
    film(scene, by, rounds, (0, Width::Narrow, None))
}

/// The film of a part of the picture with a seed so many after the scene's.
fn film(
    scene: &Scene,
    by: By,
    rounds: u32,
    (seed, width, crop): (u64, Width, Option<[u32; 4]>),
) -> Film {
    let mut job = job(scene, rounds);
    job.settings.seed += seed;
    job.crop = crop;
    let is_wide = width == Width::Wide;
    if [SPPM, PHOTON_MAP, LIGHT].contains(&by) {
        let [width, height] = job.resolution.map(u64::from);
        job.settings.photons = Some(PATHS_PER_PIXEL * width * height);
        job.settings.radius = RADIUS;
    }
    if is_wide {
        job.settings.radius *= 2.0;
    }
    let By::Method(method) = by else {
        let on = &mut |_: &_| ControlFlow::Continue(());
        return run(scene, &job, on).film;
    };
    // A circle with four times the photons is twice as wide.
    let [nearest, patches] = if is_wide {
        [4 * NEAREST, PATCHES / 2]
    } else {
        [NEAREST, PATCHES]
    };
    let number = |n: u32| NonZero::new(n).expect("not zero");
    let options = Options {
        nearest: number(nearest),
        patches: number(patches),
    };
    by_method(scene, &job, method, options)
}

/// Mean of the whole picture (or a layer's share of it), by replicates.
fn whole(film: &Film) -> Estimate {
    let means: Vec<f64> = (0..REPLICATES as usize)
        .map(|r| film.replicate_image(r).mean()[1])
        .collect();
    Estimate::of(&means)
}

const ROOM: &str = "
    (shape: Quad(center: (0, 0, 0), size: (2, 2), normal: (0, 0, 1)), material: \"grey\"),
    (shape: Quad(center: (0, 0, 2), size: (2, 2), normal: (0, 0, -1)), material: \"grey\"),
    (shape: Quad(center: (0, 1, 1), size: (2, 2), normal: (0, -1, 0)), material: \"grey\"),
    (shape: Quad(center: (-1, 0, 1), size: (2, 2), normal: (1, 0, 0)), material: Diffuse(reflectance: (0.6, 0.2, 0.1))),
    (shape: Quad(center: (1, 0, 1), size: (2, 2), normal: (-1, 0, 0)), material: Diffuse(reflectance: (0.1, 0.5, 0.2))),";

const VIEW: &str = "eye: (0, -3.2, 1), look_at: (0, 0, 1), fov: 40";

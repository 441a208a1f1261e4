//! What a reference method needs of memory, and how many light paths of a pass
//! its budget leaves room for.

use thiserror::Error;

use crate::{
    film::PixelSample,
    material::Material,
    render::{Job, REPLICATES, film_bytes, mebibytes},
    scene::Scene,
};

use super::{
    Method, Options,
    flight::mean_bounces,
    metropolis,
    photons::BYTES_PER_PHOTON,
    radiosity,
    setup::{Contribution, Shares, film_pixels},
    sppm,
};

/// Fewest light paths of a pass for which any budget must leave room, where
/// nobody has asked for a number.
const FEWEST_PATHS: u64 = 1 << 12;

/// Most light paths of a pass: what comes after them would be out of reach.
const MOST_PATHS: u64 = 1 << 32;

/// Of a budget beyond this, in bytes, no more is used for photons: they are
/// numbered in 32 bits.
const LARGEST_BUDGET: u64 = 1 << 39;

/// Why a method does not render a job.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Refused {
    /// The memory budget is too small.
    #[error(
        "method {method} needs {} for a picture of {} x {} pixels with {paths} light paths a pass, but the memory budget is {}; {remedy}, or raise render.memory",
        mebibytes(*.needed), size[0], size[1], mebibytes(*.budget)
    )]
    TooLarge {
        /// Name of the method.
        method: &'static str,
        /// Width and height of the window in pixels.
        size: [u32; 2],
        /// Light paths of a pass.
        paths: u64,
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        budget: u64,
        /// What else helps.
        remedy: &'static str,
    },
    /// A diffuse surface cannot be divided into elements.
    #[error(
        "method radiosity cannot divide {object} into elements: it knows quads, discs, boxes, spheres, cylinders, triangles and meshes"
    )]
    NoElements {
        /// Name of the object.
        object: String,
    },
    /// An error is asked for, which pictures of no such method state: the
    /// render would never end.
    #[error(
        "method {method} cannot render until an error is reached: its pictures do not state their error"
    )]
    StatesNoError {
        /// Name of the method.
        method: &'static str,
    },
}

/// Whether a method can render a job.
///
/// # Errors
/// If it does not fit into the memory budget, the scene has a surface that
/// the method cannot work with, or the job asks for an error.
pub fn check(scene: &Scene, job: &Job, method: Method, options: Options) -> Result<(), Refused> {
    if job.error.is_some() {
        let method = method.name();
        return Err(Refused::StatesNoError { method });
    }
    if method == Method::Radiosity
        && let Some(object) = radiosity::obstacle(scene)
    {
        let object = object.to_owned();
        return Err(Refused::NoElements { object });
    }
    light_paths(scene, job, method, options).map(|_| ())
}

/// Light paths of a pass: as the settings say, or one for each pixel of the
/// film if they fit into the budget, or as many as do.
///
/// # Errors
/// If the settings' number, or what any number needs, exceeds the budget.
pub(super) fn light_paths(
    scene: &Scene,
    job: &Job,
    method: Method,
    options: Options,
) -> Result<u64, Refused> {
    let needs = Needs::of(scene, job, method, options);
    let budget = job.settings.memory;
    let most = budget
        .min(LARGEST_BUDGET)
        .saturating_sub(needs.fixed)
        .checked_div(needs.per_path)
        .map_or(MOST_PATHS, |most| most.min(MOST_PATHS));
    let wanted = job.settings.photons.filter(|_| method.has_light_paths());
    let paths = wanted.unwrap_or_else(|| {
        let default = film_pixels(scene.filter, job.window());
        default.min(most.max(FEWEST_PATHS))
    });
    if needs.fixed <= budget && paths <= most {
        return Ok(paths);
    }
    let [_, _, width, height] = job.window();
    Err(Refused::TooLarge {
        method: method.name(),
        size: [width, height],
        paths,
        needed: needs
            .fixed
            .saturating_add(needs.per_path.saturating_mul(paths)),
        budget,
        remedy: if wanted.is_some() && needs.fixed <= budget {
            "ask for fewer (--photons)"
        } else {
            "render it in parts (--crop)"
        },
    })
}

/// Bytes that a method needs.
struct Needs {
    /// Whatever the number of light paths.
    fixed: u64,
    /// For each light path of a pass.
    per_path: u64,
}

impl Needs {
    fn of(scene: &Scene, job: &Job, method: Method, options: Options) -> Self {
        let [_, _, width, height] = job.window();
        let pixels = u64::from(width) * u64::from(height);
        // Diffuse surfaces that a path meets on average.
        let met = if job.settings.indirect {
            mean_bounces(brightest(scene)).ceil() as u64
        } else {
            1
        };
        // What the samples bring that are worked on at once: for each place of
        // a light path one contribution, and one for each layer.
        let layers = PixelSample::default().layers.len() as u64;
        let splat = (met + layers) * size_of::<Contribution>() as u64;
        let splats = Shares::PATHS.chunk * Shares::PATHS.batch * splat;
        let passes = u64::from(job.settings.passes.max(1));
        let (own, per_path) = match method {
            Method::Path | Method::Whitted => (0, 0),
            Method::Light | Method::LightNaive | Method::Bdpt => (splats, 0),
            Method::Metropolis => {
                let pixels = film_pixels(scene.filter, job.window());
                (metropolis::states(pixels).saturating_mul(splat), 0)
            }
            // The photons of all passes are kept, those of caustics twice.
            Method::PhotonMap => {
                let passes = passes.next_multiple_of(u64::from(REPLICATES));
                (0, passes.saturating_mul((met + 1) * BYTES_PER_PHOTON))
            }
            Method::Sppm => {
                let runs = passes.min(u64::from(REPLICATES));
                let own = pixels.saturating_mul(runs * sppm::BYTES_PER_PIXEL);
                (own, met * BYTES_PER_PHOTON)
            }
            Method::Radiosity => {
                let elements = radiosity::count(scene, options.patches.get());
                let own = elements.saturating_mul(radiosity::BYTES_PER_ELEMENT);
                (own.saturating_add(radiosity::BYTES_OF_LANDINGS), 0)
            }
        };
        Self {
            fixed: film_bytes([width, height]).saturating_add(own),
            per_path,
        }
    }
}

/// The largest reflectance of the diffuse surfaces, in any channel.
fn brightest(scene: &Scene) -> f64 {
    let reflectances = scene.objects.iter().map(|object| match object.material {
        Material::Diffuse { reflectance } => reflectance.max(),
        Material::Mirror { .. } | Material::Dielectric { .. } | Material::Black => 0.0,
    });
    reflectances.fold(0.0, f64::max)
}

//! Passes of a reference method, and the loop over them.

use std::{fmt, ops::ControlFlow, time::Instant};

use serde::Serialize;

use crate::{
    film::{Film, PixelSample},
    metrics::relative_noise,
    plan::film_quantum,
    render::{Job, Progress, REPLICATES},
    scene::{Scene, Settings},
};

use super::{
    Method, Pinhole, bdpt, light, metropolis, naive, path,
    setup::{Contribution, Setup, Shares},
    whitted,
};

/// Everything that the passes of one render share.
pub struct Reference<'a> {
    setup: Setup<'a>,
    method: Method,
    pinhole: Pinhole,
}

impl<'a> Reference<'a> {
    /// Prepares a render of the window `crop` (x, y, width, height in pixels)
    /// of a picture of the given resolution. The pinhole of
    /// [`Method::LightNaive`] is as wide as two pixels of what is in the
    /// middle of the scene.
    pub fn new(
        scene: &'a Scene,
        settings: &Settings,
        method: Method,
        resolution: [u32; 2],
        crop: [u32; 4],
    ) -> Self {
        let setup = Setup::new(scene, settings, method, resolution, crop);
        let middle = scene.world.bounds().map(|b| b.bounding_sphere().center);
        let distance = middle.map_or(1.0, |m| (m - setup.camera.eye()).length());
        let distance = if distance > 0.0 { distance } else { 1.0 };
        Self {
            pinhole: Pinhole::for_distance(&setup.camera, distance),
            setup,
            method,
        }
    }

    /// The same with a given pinhole.
    #[must_use]
    pub fn with_pinhole(self, pinhole: Pinhole) -> Self {
        Self { pinhole, ..self }
    }

    /// Runs pass `index`: radiance per pixel and layer, row by row. Methods
    /// that look pixel by pixel take one sample of each; light tracing follows
    /// one path for each pixel of the film, bidirectional path tracing one
    /// pair of paths; Metropolis makes one step, beside its pilot.
    pub fn pass(&self, index: u32) -> Vec<PixelSample> {
        let (round, replicate) = (index / REPLICATES, index % REPLICATES);
        let setup = &self.setup;
        match self.method {
            Method::Path => setup.by_pixel(replicate, round, |film, mut stream| {
                path::radiance(setup, setup.camera.ray(film), &mut stream)
            }),
            Method::Whitted => setup.by_pixel(replicate, round, |film, stream| {
                whitted::radiance(setup, setup.camera.ray(film), stream)
            }),
            Method::Light => self.by_lights(replicate, round, |paths, stream, found| {
                light::trace(setup, paths, stream, found);
            }),
            Method::LightNaive => self.by_lights(replicate, round, |paths, stream, found| {
                naive::trace(setup, &self.pinhole, paths, stream, found);
            }),
            Method::Bdpt => bdpt::pass(setup, replicate, round),
            Method::Metropolis => metropolis::pass(setup, replicate, round),
        }
    }

    /// A pass of paths from the lights, points of one sequence.
    fn by_lights(
        &self,
        replicate: u32,
        round: u32,
        trace: impl Fn(u64, &mut crate::sampling::Stream, &mut Vec<Contribution>) + Sync,
    ) -> Vec<PixelSample> {
        let paths = self.setup.film_pixels();
        let sequence = self.setup.sequence(replicate, 0);
        self.setup.by_sample(paths, Shares::PATHS, |i, found| {
            let mut stream = sequence.at(u64::from(round) * paths + i);
            trace(paths, &mut stream, found);
        })
    }
}

/// A finished or interrupted render.
#[derive(Debug)]
pub struct Outcome {
    /// The sums of all passes.
    pub film: Film,
    /// What the render says about itself.
    pub report: Report,
    /// Whether the caller stopped it before its end.
    pub interrupted: bool,
}

/// The report of a render by a reference method.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of the software.
    pub version: String,
    /// Name of the method.
    pub method: String,
    /// Width and height of the rendered window in pixels.
    pub size: [u32; 2],
    /// Seed.
    pub seed: u64,
    /// Passes finished.
    pub passes: u32,
    /// Longest chain of surface interactions.
    pub max_depth: u32,
    /// Samples refused for not being finite; not zero is a defect.
    pub samples_refused: u64,
    /// Relative standard error of the picture from the spread of the
    /// replicates; `None` before the second replicate.
    pub noise: Option<f64>,
    /// What of the scene the method cannot see.
    pub blind_spots: Vec<String>,
    /// Wall time in seconds.
    pub seconds: f64,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} passes of method {} in {:.1} s",
            self.passes, self.method, self.seconds
        )?;
        if let Some(noise) = self.noise {
            write!(f, ", noise {:.2} %", 100.0 * noise)?;
        }
        if self.samples_refused > 0 {
            write!(
                f,
                "\n{} samples were not finite and were left out",
                self.samples_refused
            )?;
        }
        Ok(())
    }
}

/// Renders by a reference method. `on_progress` is called after every pass;
/// `Break` ends the render with what was reached.
pub fn render(
    scene: &Scene,
    job: &Job,
    method: Method,
    on_progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Outcome {
    let start = Instant::now();
    let crop = job.window();
    let reference = Reference::new(scene, &job.settings, method, job.resolution, crop);
    let mut film = Film::new(crop[2], crop[3], film_quantum(scene));
    let (mut done, mut interrupted) = (0, false);
    loop {
        film.add_pass(done, &reference.pass(done));
        done += 1;
        let elapsed = start.elapsed();
        let passes_total = job.passes_wanted(done, elapsed);
        let flow = on_progress(&Progress {
            passes_done: done,
            passes_total,
            photons_emitted: 0,
            elapsed,
        });
        if done >= passes_total {
            break;
        }
        if flow.is_break() {
            interrupted = true;
            break;
        }
    }
    let report = Report {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        method: method.name().to_owned(),
        size: [film.width(), film.height()],
        seed: job.settings.seed,
        passes: done,
        max_depth: job.settings.max_depth,
        samples_refused: film.refused(),
        noise: film
            .noise()
            .map(|noise| relative_noise(&film.image(), &noise)),
        blind_spots: method.blind_spots(scene),
        seconds: start.elapsed().as_secs_f64(),
    };
    Outcome {
        film,
        report,
        interrupted,
    }
}

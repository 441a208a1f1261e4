//! Passes of a reference method, and the loop over them.

use std::{fmt, num::NonZero, ops::ControlFlow, time::Instant};

use serde::Serialize;

use crate::{
    film::{Film, PixelSample},
    metrics::relative_noise,
    render::{Job, Part, Progress, REPLICATES, Subject},
    scene::Scene,
};

use super::{
    Method, Options, Pinhole, Refused, bdpt, check, light, memory, metropolis, naive, path,
    photon_map::Maps,
    radiosity::Solver,
    setup::{Contribution, Setup, Shares},
    sppm::Run,
    whitted,
};

/// Everything that the passes of one render share.
pub struct Reference<'a> {
    setup: Setup<'a>,
    method: Method,
    pinhole: Pinhole,
    nearest: NonZero<u32>,
    /// Passes of each replicate that the settings ask for.
    rounds: u32,
    subject: Subject,
    /// Only of the method that needs it.
    solver: Option<Solver<'a>>,
}

impl<'a> Reference<'a> {
    /// Prepares the render of a job by a method. The pinhole of
    /// [`Method::LightNaive`] is as wide as two pixels of what is in the
    /// middle of the scene.
    ///
    /// # Errors
    /// As [`check`].
    pub fn new(
        scene: &'a Scene,
        job: &Job,
        method: Method,
        options: Options,
    ) -> Result<Self, Refused> {
        check(scene, job, method, options)?;
        let paths = memory::light_paths(scene, job, method, options)?;
        let (settings, resolution) = (&job.settings, job.resolution);
        let setup = Setup::new(scene, settings, method, resolution, job.window(), paths);
        let middle = scene.world.bounds().map(|b| b.bounding_sphere().center);
        let distance = middle.map_or(1.0, |m| (m - setup.camera.eye()).length());
        let distance = if distance > 0.0 { distance } else { 1.0 };
        let subject = Subject {
            photons_per_pass: if method.has_light_paths() {
                setup.light_paths()
            } else {
                0
            },
            options: match method {
                Method::Radiosity => format!("--patches {}", options.patches),
                _ => String::new(),
            },
            blind_spots: method.blind_spots(scene),
            ..Subject::without_photons(scene, job, method.name())
        };
        Ok(Self {
            subject,
            pinhole: Pinhole::for_distance(&setup.camera, distance),
            setup,
            method,
            nearest: options.nearest,
            rounds: settings.passes.max(1).div_ceil(REPLICATES),
            solver: (method == Method::Radiosity)
                .then(|| Solver::new(scene, options.patches.get())),
        })
    }

    /// The same with a given pinhole.
    #[must_use]
    pub fn with_pinhole(self, pinhole: Pinhole) -> Self {
        Self { pinhole, ..self }
    }

    /// What is rendered. What a method needs that remembers (see
    /// [`Method::remembers`]) is no part of it.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// The passes from the first on, without end.
    pub fn passes(&self) -> Passes<'_> {
        Passes {
            reference: self,
            next: 0,
            memory: Memory::default(),
        }
    }

    /// Pass `index`: radiance per pixel and layer, row by row. Passes of a
    /// method that remembers (see [`Method::remembers`]) have to be asked for
    /// in turn from the first on, with one memory; those of others in any
    /// order, with any.
    pub fn pass(&self, index: u32, memory: &mut Memory) -> Vec<PixelSample> {
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
            Method::PhotonMap => {
                let paths = setup.light_paths() * u64::from(self.rounds);
                let maps = memory.maps[replicate as usize]
                    .get_or_insert_with(|| Maps::new(setup, replicate, paths, self.nearest));
                setup.by_pixel(replicate, round, |film, mut stream| {
                    maps.radiance(setup, setup.camera.ray(film), &mut stream)
                })
            }
            Method::Sppm => memory.runs[replicate as usize]
                .get_or_insert_with(|| Run::new(setup))
                .pass(setup, replicate, round),
            Method::Radiosity => self
                .solver
                .as_ref()
                .map(|solver| solver.pass(setup, replicate, round))
                .unwrap_or_default(),
        }
    }

    /// The passes from pass `index` on. Those of a method that builds on what
    /// came before take the time of all passes before them.
    pub fn passes_from(&self, index: u32) -> Passes<'_> {
        let mut passes = self.passes();
        if self.method == Method::Sppm {
            for _ in 0..index {
                passes.next();
            }
        }
        passes.next = index;
        passes
    }

    /// Light paths that start in all passes before pass `index`; 0 of methods
    /// for which their number cannot be chosen.
    pub fn light_paths(&self, index: u32) -> u64 {
        let passes = match self.method {
            // All at the first pass of a replicate.
            Method::PhotonMap => u64::from(self.rounds) * u64::from(index.min(REPLICATES)),
            method if method.has_light_paths() => u64::from(index),
            _ => 0,
        };
        passes * self.setup.light_paths()
    }

    /// A pass of paths from the lights, points of one sequence.
    fn by_lights(
        &self,
        replicate: u32,
        round: u32,
        trace: impl Fn(u64, &mut crate::sampling::Stream, &mut Vec<Contribution>) + Sync,
    ) -> Vec<PixelSample> {
        let paths = self.setup.light_paths();
        let sequence = self.setup.sequence(replicate, 0);
        self.setup.by_sample(paths, Shares::PATHS, |i, found| {
            let mut stream = sequence.at(u64::from(round) * paths + i);
            trace(paths, &mut stream, found);
        })
    }
}

/// The passes of a render, one after the other: radiance per pixel and layer,
/// row by row. The mean of the passes of a replicate is its picture.
///
/// Methods that look pixel by pixel take one sample of each; those that trace
/// paths from the lights trace as many as the settings say, or one for each
/// pixel of the film; bidirectional path tracing follows one pair of paths for
/// each pixel of the film, Metropolis makes one step, beside its pilot.
pub struct Passes<'a> {
    reference: &'a Reference<'a>,
    next: u32,
    memory: Memory,
}

/// What methods keep from pass to pass, by replicates.
#[derive(Default)]
pub struct Memory {
    /// Of the first photon map.
    maps: [Option<Maps>; REPLICATES as usize],
    /// Of progressive photon mapping.
    runs: [Option<Run>; REPLICATES as usize],
}

impl Iterator for Passes<'_> {
    type Item = Vec<PixelSample>;

    fn next(&mut self) -> Option<Vec<PixelSample>> {
        let index = self.next;
        self.next = index.checked_add(1)?;
        Some(self.reference.pass(index, &mut self.memory))
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
    /// Number of the first of them; not 0 for a part of a picture.
    pub first_pass: u64,
    /// Longest chain of surface interactions.
    pub max_depth: u32,
    /// Paths from the lights, of methods for which their number can be chosen.
    pub light_paths: u64,
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
        if self.first_pass > 0 {
            let end = self.first_pass + u64::from(self.passes);
            write!(f, " ({}..{end})", self.first_pass)?;
        }
        if self.light_paths > 0 {
            write!(f, ", {} light paths", self.light_paths)?;
        }
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

impl Report {
    /// The report of some passes by a reference method.
    pub fn of(part: &Part) -> Self {
        let (subject, film) = (part.subject(), part.film());
        Self {
            version: subject.version.clone(),
            method: subject.method.clone(),
            size: [film.width(), film.height()],
            seed: subject.seed,
            passes: part.passes(),
            first_pass: part.runs().first().map_or(0, |run| run.start),
            max_depth: subject.max_depth,
            light_paths: part.photons_emitted(),
            samples_refused: film.refused(),
            noise: film
                .noise()
                .map(|noise| relative_noise(&film.image(), &noise)),
            blind_spots: subject.blind_spots.clone(),
            seconds: part.seconds(),
        }
    }
}

/// Adds the passes to `part` that it still lacks; whether the caller stopped it
/// before its end. `after_pass` is called after every pass; `Break` ends the
/// render. The part must be of the subject of `reference`, and its passes those
/// from the job's first one on; of a method that remembers it must be empty.
pub fn go_on(
    reference: &Reference<'_>,
    job: &Job,
    part: &mut Part,
    after_pass: &mut dyn FnMut(&Progress, &Part) -> ControlFlow<()>,
) -> bool {
    let mut memory = Memory::default();
    job.add_passes(part, after_pass, &mut |part, index| {
        let samples = reference.pass(index, &mut memory);
        let before = reference.light_paths(index);
        let emitted = reference.light_paths(index.saturating_add(1)) - before;
        part.add_samples(index, &samples, emitted);
    })
}

/// Renders by a reference method. `on_progress` is called after every pass;
/// `Break` ends the render with what was reached.
///
/// # Errors
/// As [`check`], before any work.
pub fn render(
    scene: &Scene,
    job: &Job,
    method: Method,
    options: Options,
    on_progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Outcome, Refused> {
    let start = Instant::now();
    let reference = Reference::new(scene, job, method, options)?;
    let mut part = Part::new(reference.subject().clone());
    part.set_seconds(start.elapsed().as_secs_f64());
    let interrupted = go_on(&reference, job, &mut part, &mut |progress, _| {
        on_progress(progress)
    });
    Ok(Outcome {
        report: Report::of(&part),
        film: part.into_film(),
        interrupted,
    })
}

//! Runs passes until there are enough, and reports.

use std::{
    ops::ControlFlow,
    time::{Duration, Instant},
};

use crate::{
    film::Film,
    metrics::relative_noise,
    photon::Tally,
    plan::film_quantum,
    sampling::{Purpose, Sequence},
    scene::{Scene, Settings},
};

use super::{
    LightReport, REPLICATES, Renderer, Report,
    memory::{TooLarge, photon_budget},
};

/// Starts with which the power that is not aimed at casters is estimated.
const NOT_AIMED_SAMPLES: u64 = 4096;

/// What to render and when to stop.
#[derive(Clone, Debug)]
pub struct Job {
    /// Settings, the scene's own or overridden.
    pub settings: Settings,
    /// Width and height of the whole picture in pixels.
    pub resolution: [u32; 2],
    /// Window to render: x, y, width, height in pixels; all without.
    pub crop: Option<[u32; 4]>,
    /// Stop starting passes after this time; `settings.passes` is then no
    /// limit.
    pub time: Option<Duration>,
}

impl Job {
    /// The job that the scene's file describes.
    pub fn of(scene: &Scene) -> Self {
        Self {
            settings: scene.settings.clone(),
            resolution: scene.resolution,
            crop: None,
            time: None,
        }
    }
}

impl Job {
    /// Whether the job fits into its memory budget.
    ///
    /// # Errors
    /// If it does not; see [`TooLarge`].
    pub fn check(&self) -> Result<(), TooLarge> {
        let [_, _, width, height] = self.window();
        photon_budget([width, height], self.settings.memory).map(|_| ())
    }

    /// The number of passes to run in all, as far as it is known after `done`
    /// of them.
    pub fn passes_wanted(&self, done: u32, elapsed: Duration) -> u32 {
        let Some(limit) = self.time else {
            return self.settings.passes.max(1);
        };
        if elapsed >= limit {
            return done;
        }
        let rate = f64::from(done) / elapsed.as_secs_f64().max(1e-9);
        // At least one more; `as` saturates.
        ((limit.as_secs_f64() * rate) as u32).max(done + 1)
    }

    /// The window to render: x, y, width, height in pixels.
    pub fn window(&self) -> [u32; 4] {
        self.crop
            .unwrap_or([0, 0, self.resolution[0], self.resolution[1]])
    }
}

/// How far a render has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Passes finished.
    pub passes_done: u32,
    /// Passes wanted; an estimate where the time decides.
    pub passes_total: u32,
    /// Photon paths emitted.
    pub photons_emitted: u64,
    /// Wall time since the start.
    pub elapsed: Duration,
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

/// Sums over passes that do not belong to pixels.
#[derive(Default)]
struct Totals {
    emitted: u64,
    stored: u64,
    photons_refused: u64,
    truncated: u64,
    queries: u64,
    visited: u64,
    tested: u64,
    accepted: u64,
    tally: Tally,
}

/// Renders. `on_progress` is called after every pass; `Break` ends the render
/// with what was reached.
pub fn run(
    scene: &Scene,
    job: &Job,
    on_progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Outcome {
    let start = Instant::now();
    let crop = job.window();
    let renderer = Renderer::new(scene, &job.settings, job.resolution, crop);
    let mut film = Film::new(crop[2], crop[3], film_quantum(scene));
    let mut totals = Totals {
        tally: Tally::new(scene.lights.len()),
        ..Totals::default()
    };
    let mut done = 0;
    let mut interrupted = false;
    loop {
        let pass = renderer.pass(done);
        film.add_pass(done, &pass.samples);
        totals.emitted += pass.emitted;
        totals.stored += pass.stored;
        totals.photons_refused += pass.refused;
        totals.truncated += pass.truncated;
        totals.queries += pass.queries;
        totals.visited += pass.visited;
        totals.tested += pass.tested;
        totals.accepted += pass.accepted;
        totals.tally.merge(&pass.tally);
        done += 1;
        let elapsed = start.elapsed();
        let total = job.passes_wanted(done, elapsed);
        let progress = Progress {
            passes_done: done,
            passes_total: total,
            photons_emitted: totals.emitted,
            elapsed,
        };
        let flow = on_progress(&progress);
        if done >= total {
            break;
        }
        if flow.is_break() {
            interrupted = true;
            break;
        }
    }
    let report = report(scene, job, &renderer, &film, &totals, done, start.elapsed());
    Outcome {
        film,
        report,
        interrupted,
    }
}

fn report(
    scene: &Scene,
    job: &Job,
    renderer: &Renderer<'_>,
    film: &Film,
    totals: &Totals,
    passes: u32,
    elapsed: Duration,
) -> Report {
    let ledger = Report::ledger(&totals.tally, totals.emitted);
    let lights = scene
        .lights
        .iter()
        .enumerate()
        .zip(ledger)
        .map(|((i, light), ledger)| LightReport {
            name: light.name.clone(),
            power: light.light.power().map(crate::spectrum::Rgb::mean),
            launched: ledger.launched,
            not_aimed: renderer.emitter().and_then(|e| {
                let pilot = Sequence::new(job.settings.seed, Purpose::Pilot, 1, i as u64);
                e.aims()[i].not_aimed(pilot, NOT_AIMED_SAMPLES)
            }),
            ledger,
        })
        .collect::<Vec<_>>();
    let sum = |f: fn(&LightReport) -> f64| lights.iter().map(f).sum::<f64>();
    let launched = sum(|l| l.ledger.launched);
    let last_round = passes.saturating_sub(1) / REPLICATES;
    Report {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        size: [film.width(), film.height()],
        seed: job.settings.seed,
        passes,
        photons_emitted: totals.emitted,
        photons_stored: totals.stored,
        photons_refused: totals.photons_refused,
        queries: totals.queries,
        visited: totals.visited,
        tested: totals.tested,
        accepted: totals.accepted,
        photons_per_pass: renderer.photons(),
        radius: [renderer.scale(0), renderer.scale(last_round)],
        indirect: renderer.plan().indirect,
        caustics: renderer.emitter().is_some(),
        max_depth: job.settings.max_depth,
        camera_paths_truncated: totals.truncated,
        flux_truncated: if launched > 0.0 {
            sum(|l| l.ledger.truncated) / launched
        } else {
            0.0
        },
        samples_refused: film.refused(),
        noise: film
            .noise()
            .map(|noise| relative_noise(&film.image(), &noise)),
        seconds: elapsed.as_secs_f64(),
        lights,
    }
}

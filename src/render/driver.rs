//! Runs passes until there are enough, and reports.

use std::{
    ops::ControlFlow,
    time::{Duration, Instant},
};

use crate::{
    film::Film,
    metrics::{Statement, relative_noise},
    photon::LightTally,
    scene::{Scene, Settings},
};

use super::{
    ErrorReport, LightReport, Part, REPLICATES, Renderer, Report, RoundReport, Schedule, Subject,
    asking::Asking,
    memory::{TooLarge, photon_budget},
};

/// What to render and when to stop.
#[derive(Clone, Debug)]
pub struct Job {
    /// Settings, the scene's own or overridden. `settings.passes` is where the
    /// passes end: the first one that is not rendered.
    pub settings: Settings,
    /// The first pass to render, below `settings.passes`; 0 unless others
    /// render those before it.
    pub first_pass: u32,
    /// Width and height of the whole picture in pixels.
    pub resolution: [u32; 2],
    /// Window to render: x, y, width, height in pixels; all without.
    pub crop: Option<[u32; 4]>,
    /// Stop starting passes after this time; `settings.passes` is then no
    /// limit.
    pub time: Option<Duration>,
    /// Stop once the picture states that its relative error is at most this,
    /// 0.05 for 5 %, at 90 %; `settings.passes` is then no limit. Reference
    /// methods state no error and refuse such a job.
    pub error: Option<f64>,
}

impl Job {
    /// The job that the scene's file describes.
    pub fn of(scene: &Scene) -> Self {
        Self {
            settings: scene.settings.clone(),
            first_pass: 0,
            resolution: scene.resolution,
            crop: None,
            time: None,
            error: None,
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
            return match self.error {
                Some(_) => u32::MAX,
                None => self.settings.passes.saturating_sub(self.first_pass).max(1),
            };
        };
        if elapsed >= limit {
            return done;
        }
        let rate = f64::from(done) / elapsed.as_secs_f64().max(1e-9);
        // At least one more; `as` saturates.
        ((limit.as_secs_f64() * rate) as u32).max(done.saturating_add(1))
    }

    /// Adds passes to `part` until there are as many as wanted, one at least if
    /// there was none; whether the caller stopped it before that.
    pub(crate) fn add_passes(
        &self,
        part: &mut Part,
        after_pass: &mut dyn FnMut(&Progress, &Part) -> ControlFlow<()>,
        add: &mut dyn FnMut(&mut Part, u32),
    ) -> bool {
        let start = Instant::now();
        let before = part.seconds();
        let mut progress = part.progress(0);
        loop {
            let done = progress.passes_done;
            progress.passes_total = self.passes_wanted(done, progress.elapsed);
            // Beyond the last number there are no passes.
            let next = self.first_pass.checked_add(done);
            let (Some(next), true) = (next, done == 0 || done < progress.passes_total) else {
                return false;
            };
            add(part, next);
            part.set_seconds(before + start.elapsed().as_secs_f64());
            progress = part.progress(0);
            progress.passes_total = self.passes_wanted(progress.passes_done, progress.elapsed);
            let flow = after_pass(&progress, part);
            if flow.is_break() && progress.passes_done < progress.passes_total {
                return true;
            }
        }
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
    /// The error that was last stated, if one is asked for.
    pub stated: Option<RoundReport>,
}

/// A finished or interrupted render.
#[derive(Debug)]
pub struct Outcome {
    /// The sums of all passes.
    pub film: Film,
    /// What the render says about itself.
    pub report: Report,
    /// What the picture says about its error; `None` before every replicate
    /// has a pass, and of a black picture.
    pub statement: Option<Statement>,
    /// Whether the caller stopped it before its end.
    pub interrupted: bool,
}

impl Outcome {
    /// Whether the picture states an error of at most so much.
    pub fn reaches(&self, error: f64) -> bool {
        let stated = self.statement.as_ref();
        stated.is_some_and(|s| s.whole.bound <= error)
    }
}

/// Renders. `on_progress` is called after every pass; `Break` ends the render
/// with what was reached.
pub fn run(
    scene: &Scene,
    job: &Job,
    on_progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Outcome {
    let start = Instant::now();
    let renderer = Renderer::new(scene, &job.settings, job.resolution, job.window());
    let mut part = Part::new(Subject::of(scene, job, &renderer));
    part.set_seconds(start.elapsed().as_secs_f64());
    let interrupted = go_on(&renderer, job, &mut part, &mut |progress, _| {
        on_progress(progress)
    });
    let statement = Statement::of(part.film(), job.error);
    Outcome {
        report: Report::stating(&part, statement.as_ref(), job.error),
        film: part.into_film(),
        statement,
        interrupted,
    }
}

/// Adds the passes to `part` that it still lacks; whether the caller stopped it
/// before its end. `after_pass` is called after every pass, with what is there
/// then; `Break` ends the render. So does an error that was asked for and is
/// reached, at the rounds at which it is asked for. The part must be of the subject of `renderer`
/// and `job`, and its passes those from the job's first one on.
pub fn go_on(
    renderer: &Renderer<'_>,
    job: &Job,
    part: &mut Part,
    after_pass: &mut dyn FnMut(&Progress, &Part) -> ControlFlow<()>,
) -> bool {
    let mut asking = Asking::of(job);
    if asking.is_reached_by(part) {
        return false;
    }
    let mut is_reached = false;
    let mut ask_and_tell = |progress: &Progress, part: &Part| {
        is_reached = asking.is_reached_by(part);
        let stated = asking.stated();
        match after_pass(
            &Progress {
                stated,
                ..*progress
            },
            part,
        ) {
            ControlFlow::Continue(()) if is_reached => ControlFlow::Break(()),
            flow => flow,
        }
    };
    let was_stopped = job.add_passes(part, &mut ask_and_tell, &mut |part, index| {
        part.add_pass(index, &renderer.pass(index));
    });
    was_stopped && !is_reached
}

impl Report {
    /// The report of some passes by the renderer's own method.
    pub fn of(part: &Part) -> Self {
        Self::stating(part, Statement::of(part.film(), None).as_ref(), None)
    }

    /// The same with what its film was found to say about its error, set
    /// against a target.
    pub fn stating(part: &Part, statement: Option<&Statement>, target: Option<f64>) -> Self {
        let subject = &part.subject;
        let totals = part.totals.total();
        let ledger = Self::ledger(&totals.tally, totals.emitted);
        let facts = subject.lights.iter();
        // Without any pass the ledgers are empty.
        let ledger = ledger
            .into_iter()
            .chain(std::iter::repeat(LightTally::default()));
        let lights = facts
            .zip(ledger)
            .map(|(facts, ledger)| LightReport {
                name: facts.name.clone(),
                power: facts.power,
                launched: ledger.launched,
                not_aimed: facts.not_aimed,
                ledger,
            })
            .collect::<Vec<_>>();
        let sum = |f: fn(&LightReport) -> f64| lights.iter().map(f).sum::<f64>();
        let launched = sum(|l| l.ledger.launched);
        let film = &part.film;
        let runs = part.runs();
        let schedule = Schedule::new(subject.radius);
        let scale = |pass: u64| schedule.scale((pass / u64::from(REPLICATES)) as u32);
        let first_pass = runs.first().map_or(0, |run| run.start);
        let last_pass = runs.last().map_or(0, |run| run.end.saturating_sub(1));
        Self {
            version: subject.version.clone(),
            size: [film.width(), film.height()],
            seed: subject.seed,
            passes: part.passes(),
            first_pass,
            photons_emitted: totals.emitted,
            photons_stored: totals.stored,
            photons_refused: totals.photons_refused,
            queries: totals.queries,
            visited: totals.visited,
            tested: totals.tested,
            accepted: totals.accepted,
            photons_per_pass: subject.photons_per_pass,
            radius: [scale(first_pass), scale(last_pass)],
            effects: subject.effects.clone(),
            indirect: subject.indirect,
            caustics: subject.caustics,
            max_depth: subject.max_depth,
            camera_paths_truncated: totals.truncated,
            flux_truncated: if launched > 0.0 {
                sum(|l| l.ledger.truncated) / launched
            } else {
                0.0
            },
            samples_refused: film.refused(),
            noise: match statement {
                Some(statement) => Some(statement.relative_noise),
                None => film
                    .noise()
                    .map(|noise| relative_noise(&film.image(), &noise)),
            },
            error: statement.map(|s| ErrorReport::of(s, target)),
            last_round: None,
            seconds: part.seconds,
            lights,
        }
    }
}

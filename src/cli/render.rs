//! `nephroid render`: from what was typed to the files.
//!
//! Everything that can be found wrong is found before the first photon: the
//! names of the files, whether they can be written, the scene, the crop.

use std::{num::NonZero, ops::ControlFlow, time::Instant};

use nephroid::{
    reference::{self, Options, Reference},
    render::{self, Job, Part, Progress, Renderer, RoundReport, Subject},
    scene::Scene,
};

use super::{
    Exit, Failure,
    args::RenderArgs,
    checkpoint::{self, Keeper},
    effects::EffectChoice,
    interrupt::Interrupt,
    media::Media,
    outlook::Outlook,
    outputs::{self, Json, Told},
    progress::{self, Goal, Reporter},
    tell,
    values::{Crop, Method, default_outputs},
};

/// Renders and writes the files.
pub(super) fn run(typed: &RenderArgs) -> Result<Exit, Failure> {
    let outputs = if typed.output.is_empty() {
        default_outputs(&typed.scene)
    } else {
        typed.output.clone()
    };
    let json = typed.json.as_deref().map(Json::of);
    let checkpoint = checkpoint::file(typed);
    if typed.checkpoint_every.is_some() && checkpoint.is_none() {
        let message = "--checkpoint-every needs a file: add --checkpoint FILE";
        return Err(Failure::bad_input(message));
    }
    outputs::probe(&outputs, json.as_ref(), checkpoint.as_slice())?;
    // Before the scene: its meshes are read in parallel.
    super::use_threads(typed.threads)?;
    let scene =
        progress::load(&typed.scene, typed.quiet).map_err(|mistakes| Failure::scene(&mistakes))?;
    let job = job(typed, &scene)?;
    check_fit(typed, &scene, &job)?;
    if !typed.quiet {
        for warning in Media::of(&scene).warnings {
            tell(format_args!("warning: {warning}"));
        }
    }
    if let (Method::Reference(method), false) = (typed.method, typed.quiet) {
        for blind_spot in method.blind_spots(&scene) {
            tell(format_args!("note: {blind_spot}"));
        }
    }
    let interrupt = Interrupt::listen("the pass under way is finished and saved");
    let mut keeper = Keeper::of(typed);
    let Ended {
        part,
        was_stopped,
        last_round,
    } = render(typed, &scene, &job, &interrupt, &mut keeper)?;
    let was_interrupted = was_stopped && interrupt.is_requested();
    interrupt.start_saving();
    let told = Told::of(&part, job.error, last_round);
    let kept = keeper.map_or(Ok(()), |keeper| keeper.finish(&part));
    let mut faults = outputs::save(&part, &told, &outputs, json.as_ref());
    faults.extend(kept.err());
    if !faults.is_empty() {
        return Err(Failure::fault(faults.join("\nerror: ")));
    }
    if !typed.quiet {
        told.say(outputs.iter().map(|o| o.path.as_path()));
    }
    Ok(if was_interrupted {
        Exit::Interrupted
    } else if told.falls_short(job.error) {
        Exit::ShortOfError
    } else {
        Exit::Done
    })
}

/// The scene's settings with what was typed laid over them.
fn job(typed: &RenderArgs, scene: &Scene) -> Result<Job, Failure> {
    let mut settings = scene.settings.clone();
    let mut first_pass = 0;
    if let Some(passes) = typed.passes {
        settings.passes = passes.end;
        first_pass = passes.first;
    }
    if let Some(seed) = typed.seed {
        settings.seed = seed;
    }
    if typed.photons.is_some() {
        settings.photons = typed.photons;
    }
    EffectChoice::apply(&typed.effects, &mut settings);
    let resolution = typed.resolution.unwrap_or(scene.resolution);
    if let Some(crop) = typed.crop {
        check_crop(crop, resolution)?;
    }
    let job = Job {
        settings,
        first_pass,
        resolution,
        crop: typed
            .crop
            .map(|c| [c.origin[0], c.origin[1], c.size[0], c.size[1]]),
        time: typed.time,
        error: typed.error,
    };
    Ok(job)
}

/// Whether the method can render the job, and what was typed concerns it.
fn check_fit(typed: &RenderArgs, scene: &Scene, job: &Job) -> Result<(), Failure> {
    let unused = |flag: &str, why: &str| {
        let name = match typed.method {
            Method::Photons => "photons",
            Method::Reference(method) => method.name(),
        };
        let message = format!("{flag} is not for --method {name}: {why}; leave it out");
        Err(Failure::bad_input(message))
    };
    let is = |method| typed.method == Method::Reference(method);
    if typed.nearest.is_some() && !is(reference::Method::PhotonMap) {
        return unused("--nearest", "only photon-map looks for nearest photons");
    }
    if typed.patches.is_some() && !is(reference::Method::Radiosity) {
        return unused("--patches", "only radiosity divides surfaces");
    }
    if typed.error.is_some() && typed.method != Method::Photons {
        return unused("--error", "only pictures of the renderer state their error");
    }
    match typed.method {
        Method::Photons => job.check().map_err(Failure::bad_input),
        Method::Reference(method) => {
            if method.remembers() {
                let why = "its passes need what those before them have left";
                if checkpoint::file(typed).is_some() {
                    return unused("a checkpoint", why);
                }
                if job.first_pass > 0 {
                    return unused("a range of --passes", why);
                }
            }
            if typed.photons.is_some() && !method.has_light_paths() {
                let why = "it starts no paths at the lights, or one for each from the eye";
                return unused("--photons", why);
            }
            reference::check(scene, job, method, options(typed)).map_err(Failure::bad_input)
        }
    }
}

/// What was typed for single methods.
fn options(typed: &RenderArgs) -> Options {
    let default = Options::default();
    Options {
        nearest: typed.nearest.unwrap_or(default.nearest),
        patches: typed
            .patches
            .and_then(NonZero::new)
            .unwrap_or(default.patches),
    }
}

fn check_crop(crop: Crop, resolution: [u32; 2]) -> Result<(), Failure> {
    let ends = |axis: usize| u64::from(crop.origin[axis]) + u64::from(crop.size[axis]);
    if ends(0) <= u64::from(resolution[0]) && ends(1) <= u64::from(resolution[1]) {
        return Ok(());
    }
    let ([x, y], [w, h], [width, height]) = (crop.origin, crop.size, resolution);
    Err(Failure::bad_input(format!(
        "the crop {x},{y},{w}x{h} does not lie inside the picture of {width} x {height} pixels"
    )))
}

/// What a render leaves.
struct Ended {
    part: Part,
    /// Whether it was stopped before its end.
    was_stopped: bool,
    /// What was seen of its error after full rounds.
    last_round: Option<RoundReport>,
}

/// Runs the passes that are not done yet.
fn render(
    typed: &RenderArgs,
    scene: &Scene,
    job: &Job,
    interrupt: &Interrupt,
    keeper: &mut Option<Keeper<'_>>,
) -> Result<Ended, Failure> {
    // With a time or an error given the scene's number of passes is no limit,
    // but one that was typed is; what is reached first ends the render.
    let is_open = job.time.is_some() || job.error.is_some();
    let goal = Goal {
        passes: match typed.passes {
            Some(passes) => Some(passes.end - passes.first),
            None => (!is_open).then(|| job.settings.passes - job.first_pass),
        },
        time: job.time,
        error: job.error,
    };
    let is_enough = |passes: u32| goal.passes.is_some_and(|n| passes >= n);
    let mut reporter = Reporter::new(typed.quiet);
    let mut outlook = Outlook::new(reporter.is_heard());
    let is_told = reporter.is_heard() || typed.json.is_some();
    let mut after_pass = |progress: &Progress, part: &Part| {
        if is_told {
            outlook.look(progress, part, goal);
        }
        reporter.show(progress, goal, &outlook.words(progress, goal));
        if let Some(keeper) = keeper {
            keeper.after_pass(part);
        }
        if is_enough(progress.passes_done) || interrupt.is_requested() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let start = Instant::now();
    let (part, was_stopped) = match typed.method {
        Method::Photons => {
            let renderer = Renderer::new(scene, &job.settings, job.resolution, job.window());
            let subject = Subject::of(scene, job, &renderer);
            let mut part = checkpoint::start(typed, job, subject)?;
            part.set_seconds(part.seconds() + start.elapsed().as_secs_f64());
            let was_stopped = !is_enough(part.passes())
                && render::go_on(&renderer, job, &mut part, &mut after_pass);
            (part, was_stopped)
        }
        Method::Reference(method) => {
            let reference =
                Reference::new(scene, job, method, options(typed)).map_err(Failure::bad_input)?;
            let mut part = checkpoint::start(typed, job, reference.subject().clone())?;
            part.set_seconds(part.seconds() + start.elapsed().as_secs_f64());
            let was_stopped = !is_enough(part.passes())
                && reference::go_on(&reference, job, &mut part, &mut after_pass);
            (part, was_stopped)
        }
    };
    reporter.finish();
    Ok(Ended {
        part,
        was_stopped,
        last_round: outlook.last_round(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crop_lies_inside_the_picture() {
        let crop = |x, y, w, h| Crop {
            origin: [x, y],
            size: [w, h],
        };
        assert!(check_crop(crop(0, 0, 8, 6), [8, 6]).is_ok());
        assert!(check_crop(crop(7, 5, 1, 1), [8, 6]).is_ok());
        assert!(check_crop(crop(1, 0, 8, 6), [8, 6]).is_err());
        assert!(check_crop(crop(0, 1, 8, 6), [8, 6]).is_err());
        assert!(check_crop(crop(u32::MAX, 0, 8, 6), [8, 6]).is_err());
    }
}

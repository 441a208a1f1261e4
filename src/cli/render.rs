//! `nephroid render`: from what was typed to the files.
//!
//! Everything that can be found wrong is found before the first photon: the
//! names of the files, whether they can be written, the scene, the crop.

use std::{fmt::Display, fs, num::NonZero, ops::ControlFlow, path::Path, time::Duration};

use serde::Serialize;

use nephroid::{
    film::{self, Attribute, Film, OutputError, Provenance, Window, atomic},
    reference::{self, Options},
    render::{self, Job, Progress},
    scene::Scene,
};

use super::{
    Exit, Failure,
    args::RenderArgs,
    deliver,
    interrupt::Interrupt,
    media::Media,
    progress::{self, Goal, Reporter},
    tell,
    values::{Crop, Format, Method, Output, default_outputs},
};

/// Where the report goes as JSON.
enum Json<'a> {
    StandardOutput,
    File(&'a Path),
}

/// What a render has brought, by whichever method.
struct Finished {
    film: Film,
    interrupted: bool,
    /// The report for people, and as JSON, or why it can't be.
    words: String,
    json: Result<String, String>,
    /// Attributes of the method.
    attributes: Vec<(String, Attribute)>,
}

impl Finished {
    fn new(film: Film, interrupted: bool, report: &(impl Display + Serialize)) -> Self {
        Self {
            film,
            interrupted,
            words: report.to_string(),
            json: serde_json::to_string_pretty(report).map_err(|e| e.to_string()),
            attributes: Vec::new(),
        }
    }
}

/// Renders and writes the files.
pub(super) fn run(typed: &RenderArgs) -> Result<Exit, Failure> {
    let outputs = if typed.output.is_empty() {
        default_outputs(&typed.scene)
    } else {
        typed.output.clone()
    };
    let json = typed.json.as_deref().map(|path| match path.to_str() {
        Some("-") => Json::StandardOutput,
        _ => Json::File(path),
    });
    probe(&outputs, json.as_ref())?;
    // Before the scene: its meshes are read in parallel.
    if let Some(threads) = typed.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build_global()
            .map_err(|e| Failure::fault(format!("cannot start {threads} threads: {e}")))?;
    }
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
    let (outcome, last) = render(typed, &scene, &job, &interrupt)?;
    let was_interrupted = outcome.interrupted && interrupt.is_requested();
    interrupt.start_saving();
    let provenance = Provenance {
        scene_hash: fingerprint(&typed.scene),
        seed: job.settings.seed,
        photons: last.photons_emitted,
        render_seconds: last.elapsed.as_secs_f64(),
        further: outcome.attributes.clone(),
    };
    save(&outcome, &outputs, &job, &provenance, json.as_ref())?;
    if !typed.quiet {
        tell(outcome.words.trim_end());
        for output in &outputs {
            tell(format_args!("wrote {}", output.path.display()));
        }
    }
    Ok(if was_interrupted {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

/// Finds out whether the files can be written, before any work.
fn probe(outputs: &[Output], json: Option<&Json>) -> Result<(), Failure> {
    let mut paths: Vec<&Path> = outputs.iter().map(|o| o.path.as_path()).collect();
    if let Some(Json::File(path)) = json {
        paths.push(path);
    }
    for (i, path) in paths.iter().enumerate() {
        if paths[..i].contains(path) {
            let message = format!("{} is to be written twice", path.display());
            return Err(Failure::bad_input(message));
        }
        atomic::probe(path).map_err(|e| match e {
            OutputError::Io { .. } | OutputError::Encode { .. } => Failure::fault(e),
            _ => Failure::bad_input(e),
        })?;
    }
    Ok(())
}

/// The scene's settings with what was typed laid over them.
fn job(typed: &RenderArgs, scene: &Scene) -> Result<Job, Failure> {
    let mut settings = scene.settings.clone();
    if let Some(passes) = typed.passes {
        settings.passes = passes;
    }
    if let Some(seed) = typed.seed {
        settings.seed = seed;
    }
    if typed.photons.is_some() {
        settings.photons = typed.photons;
    }
    let resolution = typed.resolution.unwrap_or(scene.resolution);
    if let Some(crop) = typed.crop {
        check_crop(crop, resolution)?;
    }
    let job = Job {
        settings,
        resolution,
        crop: typed
            .crop
            .map(|c| [c.origin[0], c.origin[1], c.size[0], c.size[1]]),
        time: typed.time,
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
    match typed.method {
        Method::Photons => job.check().map_err(Failure::bad_input),
        Method::Reference(method) => {
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

/// Runs the passes; also the last progress that was reported.
fn render(
    typed: &RenderArgs,
    scene: &Scene,
    job: &Job,
    interrupt: &Interrupt,
) -> Result<(Finished, Progress), Failure> {
    // With a time given the scene's number of passes is no limit, but one that
    // was typed is, and the one that is reached first ends the render.
    let goal = match job.time {
        None => Goal {
            passes: Some(job.settings.passes),
            time: None,
        },
        time => Goal {
            passes: typed.passes,
            time,
        },
    };
    let mut reporter = Reporter::new(typed.quiet);
    let mut last = Progress {
        passes_done: 0,
        passes_total: job.settings.passes,
        photons_emitted: 0,
        elapsed: Duration::ZERO,
    };
    let mut on_progress = |progress: &Progress| {
        reporter.show(progress, goal);
        last = *progress;
        let is_enough = goal.passes.is_some_and(|n| progress.passes_done >= n);
        if is_enough || interrupt.is_requested() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let finished = match typed.method {
        Method::Photons => {
            let outcome = render::run(scene, job, &mut on_progress);
            Finished::new(outcome.film, outcome.interrupted, &outcome.report)
        }
        Method::Reference(method) => {
            let options = options(typed);
            let outcome = reference::render(scene, job, method, options, &mut on_progress)
                .map_err(Failure::bad_input)?;
            let name = Attribute::Text(method.name().to_owned());
            Finished {
                attributes: vec![("method".to_owned(), name)],
                ..Finished::new(outcome.film, outcome.interrupted, &outcome.report)
            }
        }
    };
    reporter.finish();
    Ok((finished, last))
}

/// Writes every file, also after one has failed: what was computed is worth
/// more than the order of the messages.
fn save(
    outcome: &Finished,
    outputs: &[Output],
    job: &Job,
    provenance: &Provenance,
    json: Option<&Json>,
) -> Result<(), Failure> {
    let film = &outcome.film;
    let window = Window {
        full: job.resolution,
        origin: job.crop.map_or([0, 0], |[x, y, ..]| [x, y]),
    };
    let mut faults: Vec<String> = Vec::new();
    for Output { path, format } in outputs {
        let written = match format {
            Format::Exr => film::write_film(path, film, window, provenance),
            Format::Png => film::write_png(path, &film.image(), job.settings.exposure),
        };
        faults.extend(written.err().map(|e| e.to_string()));
    }
    if let Some(json) = json
        && let Err(fault) = save_report(outcome, json)
    {
        faults.push(fault);
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(Failure::fault(faults.join("\nerror: ")))
    }
}

fn save_report(outcome: &Finished, json: &Json) -> Result<(), String> {
    let text = outcome.json.clone()?;
    match json {
        Json::StandardOutput => deliver(text),
        Json::File(path) => {
            atomic::write_whole(path, |file| writeln!(file, "{text}")).map_err(|e| e.to_string())
        }
    }
}

/// A fingerprint of the scene file's text: 128-bit FNV-1a in hexadecimal. Tells
/// apart what changed by accident; it is no proof against intent, and files the
/// scene names are not part of it.
fn fingerprint(scene: &Path) -> String {
    // The file was there a moment ago; if it is gone, its print is unknown.
    fs::read(scene).map_or_else(
        |_| String::new(),
        |bytes| format!("{:032x}", fnv_1a(&bytes)),
    )
}

/// Fowler, Noll, Vo: FNV-1a with 128 bits; the constants are the authors'.
fn fnv_1a(bytes: &[u8]) -> u128 {
    const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    bytes.iter().fold(OFFSET, |hash, &byte| {
        (hash ^ u128::from(byte)).wrapping_mul(PRIME)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fingerprints_follow_the_published_vectors() {
        assert_eq!(fnv_1a(b"a"), 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
        assert_eq!(fnv_1a(b"foobar"), 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18);
    }

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

//! `nephroid study`: what accuracy costs, from what was typed to the report.

mod table;
mod telling;
pub(super) mod values;

use std::{
    collections::BTreeSet,
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
    time::Duration,
};

use nephroid::{
    scene::{self, Scene},
    study::{self, Fault, Request, Source, Study, Subject, Way},
};

pub(super) use self::table::digits;
use self::telling::Telling;
use super::{
    Exit, Failure, args::StudyArgs, deliver, interrupt::Interrupt, progress, tell, values::Method,
};

/// Time for a reference where passes decide about the curves.
const REFERENCE_TIME: Duration = Duration::from_secs(600);

/// Time for a reference in times of a curve.
const REFERENCE_CURVES: u32 = 8;

impl From<Method> for Way {
    fn from(method: Method) -> Self {
        match method {
            Method::Photons => Self::Photons,
            Method::Reference(method) => Self::Reference(method),
        }
    }
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Output(e) => Self::fault(e),
            other => Self::bad_input(other),
        }
    }
}

/// A scene that was read.
struct Loaded {
    name: String,
    title: String,
    scene: Scene,
    print: String,
    reference: Option<PathBuf>,
}

/// Studies the scenes.
pub(super) fn run(typed: &StudyArgs) -> Result<Exit, Failure> {
    let request = request(typed)?;
    request.check()?;
    // Before the scenes: their meshes are read in parallel.
    if let Some(threads) = typed.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build_global()
            .map_err(|e| Failure::fault(format!("cannot start {threads} threads: {e}")))?;
    }
    let loaded = load(typed)?;
    let subjects: Vec<Subject<'_>> = loaded
        .iter()
        .map(|l| Subject {
            name: l.name.clone(),
            title: l.title.clone(),
            scene: &l.scene,
            print: l.print.clone(),
            truth: l.reference.as_deref().map_or(Source::Make, Source::Given),
        })
        .collect();
    let outline = study::outline(&subjects, &request)?;
    if typed.list || !typed.quiet {
        tell(table::outline(&outline));
    }
    if typed.list {
        return Ok(Exit::Done);
    }
    let interrupt = Interrupt::listen("finished runs are kept, and the same command goes on");
    let mut telling = Telling::new(typed.quiet);
    let mut watch = |event: &study::Event| {
        telling.show(event);
        if interrupt.is_requested() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let done = study::study(&subjects, &request, &typed.output, &mut watch);
    telling.finish();
    let study = match done {
        Ok(study) => study,
        Err(Fault::Interrupted) => return Ok(Exit::Interrupted),
        Err(fault) => return Err(fault.into()),
    };
    interrupt.start_saving();
    report(typed, &study)
}

fn report(typed: &StudyArgs, study: &Study) -> Result<Exit, Failure> {
    study::report::write(study, &typed.output).map_err(Failure::fault)?;
    if !typed.quiet {
        tell(table::times(study));
        let page = typed.output.join("index.html");
        tell(format_args!("wrote {}", page.display()));
    }
    if typed.json {
        let text = serde_json::to_string_pretty(study).map_err(Failure::fault)?;
        deliver(text).map_err(Failure::fault)?;
    }
    Ok(Exit::Done)
}

fn request(typed: &StudyArgs) -> Result<Request, Failure> {
    let defaults = Request::default();
    let time = match (typed.time, typed.passes) {
        (None, None) => defaults.time,
        (time, _) => time,
    };
    let reference_method = match typed.reference_method {
        None => None,
        Some(Method::Reference(method)) => Some(method),
        Some(Method::Photons) => {
            return Err(Failure::bad_input(
                "a reference has to be independent of the renderer: name another method than photons",
            ));
        }
    };
    let ways: Vec<Way> = typed.methods.iter().map(|&m| m.into()).collect();
    Ok(Request {
        methods: (!ways.is_empty()).then_some(ways),
        seeds: typed.seeds,
        time,
        passes: typed.passes,
        targets: typed.targets.iter().map(|e| e.0).collect(),
        resolution: typed.resolution,
        reference_method,
        reference_time: typed
            .reference_time
            .or_else(|| time?.checked_mul(REFERENCE_CURVES))
            .unwrap_or(REFERENCE_TIME),
        sweeps: typed.sweep.clone(),
    })
}

/// Reads the scenes and finds their references.
fn load(typed: &StudyArgs) -> Result<Vec<Loaded>, Failure> {
    let mut names = BTreeSet::new();
    let mut all = Vec::new();
    for path in &typed.scenes {
        let scene = progress::load(path, typed.quiet).map_err(|e| Failure::scene(&e))?;
        let stem = path.file_stem().unwrap_or(path.as_os_str());
        let stem = stem.to_string_lossy().into_owned();
        let cannot = |e| Failure::bad_input(format!("cannot read {}: {e}", path.display()));
        let text = fs::read(path).map_err(cannot)?;
        all.push(Loaded {
            title: title(&String::from_utf8_lossy(&text)),
            print: scene::fingerprint(&scene.inputs).to_string(),
            reference: reference(typed, &stem)?,
            scene,
            name: unique(&stem, &mut names),
        });
    }
    Ok(all)
}

/// The stem, with a number behind it where it was there before.
fn unique(stem: &str, names: &mut BTreeSet<String>) -> String {
    let mut name = stem.to_owned();
    let mut number = 2;
    while !names.insert(name.clone()) {
        name = format!("{stem}-{number}");
        number += 1;
    }
    name
}

/// The picture that was given for the scene, if any.
fn reference(typed: &StudyArgs, stem: &str) -> Result<Option<PathBuf>, Failure> {
    let Some(given) = &typed.reference else {
        return Ok(None);
    };
    if given.is_dir() {
        let path = given.join(format!("{stem}.exr"));
        if path.is_file() {
            return Ok(Some(path));
        }
        return Err(Failure::bad_input(format!(
            "there is no reference {} for the scene {stem}",
            path.display()
        )));
    }
    if typed.scenes.len() > 1 {
        let message = "one reference cannot judge several scenes; name a directory with a file \
                       SCENE.exr for each";
        return Err(Failure::bad_input(message));
    }
    check_file(given)?;
    Ok(Some(given.clone()))
}

fn check_file(path: &Path) -> Result<(), Failure> {
    if path.is_file() {
        return Ok(());
    }
    let message = format!("there is no reference {}", path.display());
    Err(Failure::bad_input(message))
}

/// The first sentence of the comment at the head of a scene file.
fn title(text: &str) -> String {
    let lines = text.lines().map(str::trim);
    let comment: Vec<&str> = lines
        .map_while(|line| line.strip_prefix("//"))
        .map(str::trim)
        .take_while(|line| !line.is_empty())
        .collect();
    let comment = comment.join(" ");
    match comment.split_once(". ") {
        Some((first, _)) => format!("{first}."),
        None => comment,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_first_sentences() {
        let text = "// A ball of glass\n// on a table. It shines.\n//\n// Look for: this.\n(\n)";
        assert_eq!(title(text), "A ball of glass on a table.");
        assert_eq!(title("// Only this\n()"), "Only this");
        assert_eq!(title("(camera: ())"), "");
    }

    #[test]
    fn names_are_unique() {
        let mut names = BTreeSet::new();
        let mut next = |stem: &str| unique(stem, &mut names);
        assert_eq!(next("cup"), "cup");
        assert_eq!(next("cup-2"), "cup-2");
        assert_eq!(next("cup"), "cup-3");
    }
}

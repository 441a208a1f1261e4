//! What becomes of a finished part: pictures, report, words.

use std::path::Path;

use nephroid::{
    film::{self, Attribute, Image, OutputError, Provenance, Window, atomic},
    metrics::Statement,
    reference,
    render::{self, ErrorReport, Part, REPLICATES, RoundReport},
};

use super::{
    Failure, deliver, tell,
    values::{Format, Output},
};

/// Where the report goes as JSON.
pub(super) enum Json<'a> {
    StandardOutput,
    File(&'a Path),
}

impl<'a> Json<'a> {
    /// What was typed means this.
    pub(super) fn of(path: &'a Path) -> Self {
        match path.to_str() {
            Some("-") => Self::StandardOutput,
            _ => Self::File(path),
        }
    }
}

/// Finds out whether the files can be written, before any work. `checkpoints`
/// are further ones.
pub(super) fn probe(
    outputs: &[Output],
    json: Option<&Json>,
    checkpoints: &[&Path],
) -> Result<(), Failure> {
    let mut paths: Vec<&Path> = outputs.iter().map(|o| o.path.as_path()).collect();
    paths.extend(checkpoints);
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

/// The report of a part, by whichever method.
pub(super) struct Told {
    words: String,
    /// The same as JSON, or why it can't be.
    json: Result<String, String>,
    /// What the picture says about its error, if it does.
    statement: Option<Statement>,
    error: Option<ErrorReport>,
    last_round: Option<RoundReport>,
}

impl Told {
    /// `target` is the relative error that was asked for, `last_round` what was
    /// seen after full rounds: told if the part ends inside a round.
    pub(super) fn of(part: &Part, target: Option<f64>, last_round: Option<RoundReport>) -> Self {
        fn both(report: &(impl std::fmt::Display + serde::Serialize)) -> Told {
            Told {
                words: report.to_string(),
                json: serde_json::to_string_pretty(report).map_err(|e| e.to_string()),
                statement: None,
                error: None,
                last_round: None,
            }
        }
        if part.subject().is_by_photons() {
            let statement = Statement::of(part.film(), target);
            let is_inside_round = !part.passes().is_multiple_of(REPLICATES);
            let report = render::Report {
                last_round: last_round.filter(|_| is_inside_round),
                ..render::Report::stating(part, statement.as_ref(), target)
            };
            Told {
                error: report.error,
                last_round: report.last_round,
                statement,
                ..both(&report)
            }
        } else {
            both(&reference::Report::of(part))
        }
    }

    /// Says the report and what was written.
    pub(super) fn say<'a>(&self, written: impl IntoIterator<Item = &'a Path>) {
        tell(self.words.trim_end());
        for path in written {
            tell(format_args!("wrote {}", path.display()));
        }
        if let Some(error) = &self.error {
            let verdict = match (self.falls_short(error.target), error.target) {
                (true, Some(target)) => format!("; {} % is not reached", 100.0 * target),
                (false, Some(target)) => format!("; {} % is reached", 100.0 * target),
                (_, None) => String::new(),
            };
            let before = self.last_round.map(|round| format!("; {round}"));
            tell(format_args!(
                "{error}{}{verdict}",
                before.unwrap_or_default()
            ));
        }
    }

    /// Whether an error was asked for that the picture does not state to keep.
    pub(super) fn falls_short(&self, target: Option<f64>) -> bool {
        let stated = self.statement.as_ref().map(|s| s.whole.bound);
        target.is_some_and(|target| stated.is_none_or(|stated| stated > target))
    }

    /// What a file says about the error of its picture.
    fn attributes(&self) -> Vec<(String, Attribute)> {
        let Some(error) = &self.error else {
            return Vec::new();
        };
        let regions = [("error", Some(error.lit)), ("causticError", error.caustics)];
        let mut all = Vec::new();
        for (prefix, figures) in regions {
            let Some(f) = figures else { continue };
            let named = [
                ("", Some(f.error)),
                ("Bound", Some(f.bound)),
                ("Noise", Some(f.noise)),
                ("Bias", Some(f.bias)),
                ("OfAll", Some(f.error_of_all)),
                ("BoundOfAll", Some(f.bound_of_all)),
                ("Percentile95", Some(f.percentile_95)),
                ("Percentile99", Some(f.percentile_99)),
                ("Outside", f.outside),
            ];
            let known = named.into_iter().filter_map(|(name, v)| Some((name, v?)));
            all.extend(known.map(|(name, v)| (format!("{prefix}{name}"), Attribute::Number(v))));
        }
        all
    }

    /// The layers of a file that show the error of its picture.
    fn layers(&self) -> Vec<(&str, &Image)> {
        self.statement.as_ref().map_or_else(Vec::new, |s| {
            vec![("error.noise", &s.noise), ("error.bias", &s.bias)]
        })
    }
}

/// Writes every file, also after one has failed: what was computed is worth
/// more than the order of the messages. The faults, in words.
pub(super) fn save(
    part: &Part,
    told: &Told,
    outputs: &[Output],
    json: Option<&Json>,
) -> Vec<String> {
    let subject = part.subject();
    let [x, y, ..] = subject.window;
    let window = Window {
        full: subject.resolution,
        origin: [x, y],
    };
    let mut faults: Vec<String> = Vec::new();
    for Output { path, format } in outputs {
        let written = match format {
            Format::Exr => {
                let mut provenance = provenance(part);
                provenance.further.extend(told.attributes());
                film::write_film_with(path, part.film(), &told.layers(), window, &provenance)
            }
            Format::Png => film::write_png(path, &part.film().image(), subject.exposure),
        };
        faults.extend(written.err().map(|e| e.to_string()));
    }
    if let Some(json) = json
        && let Err(fault) = save_report(told, json)
    {
        faults.push(fault);
    }
    faults
}

/// How the picture came about.
fn provenance(part: &Part) -> Provenance {
    let subject = part.subject();
    let mut further = Vec::new();
    if !subject.is_by_photons() {
        let name = Attribute::Text(subject.method.clone());
        further.push(("method".to_owned(), name));
    }
    let first = part.runs().first().map_or(0, |run| run.start);
    if first > 0 {
        further.push(("firstPass".to_owned(), Attribute::Number(first as f64)));
    }
    Provenance {
        scene_hash: subject.fingerprint().to_string(),
        seed: subject.seed,
        photons: part.photons_emitted(),
        render_seconds: part.seconds(),
        further,
    }
}

fn save_report(told: &Told, json: &Json) -> Result<(), String> {
    let text = told.json.clone()?;
    match json {
        Json::StandardOutput => deliver(text),
        Json::File(path) => {
            atomic::write_whole(path, |file| writeln!(file, "{text}")).map_err(|e| e.to_string())
        }
    }
}

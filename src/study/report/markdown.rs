//! The figures of a study as tables in Markdown, for texts: `table.md`.

use libm::sqrt;

use super::{
    tables::targets,
    words::{digits, escape, per_cent, slope},
};
use crate::study::{Effect, Point, SceneStudy, Series, Study};

/// What stands where there is no number.
const NONE: &str = "-";

/// The tables: what each error takes by each method, where the truth comes from,
/// and what each effect costs.
pub(super) fn tables(study: &Study) -> String {
    let all = || study.scenes.iter().flat_map(|s| &s.series);
    let targets = targets(all());
    let levels = targets.iter().map(|t| level(*t));
    let head = ["scene", "method"].map(str::to_owned).into_iter();
    let tail = ["slope (90 %)", "last: error", "noise", "bias"].map(str::to_owned);
    let heads: Vec<String> = head.chain(levels).chain(tail).collect();
    let mut out = format!(
        "Processor seconds to an error (root of relMSE, mean over the seeds; `<`: the first picture \
         is better already, `~`: by the fitted law beyond the last picture, `{NONE}`: out of its \
         reach), and the last picture taken apart. Made by {}, {} cores, {} threads, {}.\n\n",
        plain(&study.software),
        study.machine.cores,
        study.machine.threads,
        plain(&study.machine.processor),
    );
    out += &row(&heads);
    out += &format!("|---|---|{}\n", "---:|".repeat(heads.len() - 2));
    for scene in &study.scenes {
        for (i, series) in scene.series.iter().enumerate() {
            let name = if i == 0 {
                code(&scene.name)
            } else {
                String::new()
            };
            out += &row(&line(name, series, &targets));
        }
    }
    out += "\nLayers: methods marked † are judged by some layers of the picture only.\n\n";
    for scene in &study.scenes {
        out += &format!("- {}: {}\n", code(&scene.name), plain(&scene.truth.words));
        for absent in &scene.absent {
            let (method, reason) = (plain(&absent.method), plain(&absent.reason));
            out += &format!("  - no curve of {method}: {reason}\n");
        }
    }
    out + &effects(&study.scenes)
}

/// A curve.
fn line(scene: String, series: &Series, targets: &[f64]) -> Vec<String> {
    let mark = if series.layers.is_empty() { "" } else { " †" };
    let mut cells = vec![scene, plain(&series.label) + mark];
    cells.extend(targets.iter().map(|target| time(series, *target)));
    let fit = series.fit.as_ref().map(|fit| {
        let [low, high] = fit.slope_interval.map(slope);
        format!("{} ({low} to {high})", slope(fit.slope))
    });
    cells.push(fit.unwrap_or_else(|| NONE.to_owned()));
    let last = series.points.last();
    let split = last.and_then(|point| point.split);
    let errors = [
        last.map(error_of),
        split.map(|split| split.noise),
        split.map(|split| split.bias),
    ];
    cells.extend(errors.map(|error| error.map_or_else(|| NONE.to_owned(), level)));
    cells
}

/// The root of the mean relMSE of a point's runs.
fn error_of(point: &Point) -> f64 {
    let sum: f64 = point.runs.iter().map(|run| run.relmse).sum();
    sqrt(sum / point.runs.len() as f64)
}

/// Seconds to an error.
fn time(series: &Series, target: f64) -> String {
    let found = series.times.iter().find(|time| time.error == target);
    let Some((time, seconds)) = found.and_then(|t| Some((t, t.cpu_seconds?))) else {
        return NONE.to_owned();
    };
    let first = series.points.first();
    let mark = if time.extrapolated {
        "~"
    } else if first.is_some_and(|point| error_of(point) <= target) {
        "< "
    } else {
        ""
    };
    format!("{mark}{}", digits(seconds, 2))
}

/// What each effect costs, if any was priced.
fn effects(scenes: &[SceneStudy]) -> String {
    if scenes.iter().all(|scene| scene.effects.is_empty()) {
        return String::new();
    }
    let heads = [
        "scene",
        "effect",
        "light",
        "error with it",
        "without it",
        "seconds with it",
        "without it",
    ];
    let mut out = "\nWhat each effect costs, by eight passes of the renderer:\n\n".to_owned();
    out += &row(&heads.map(str::to_owned));
    out += "|---|---|---:|---:|---:|---:|---:|\n";
    for scene in scenes {
        for (i, effect) in scene.effects.iter().enumerate() {
            let name = if i == 0 {
                code(&scene.name)
            } else {
                String::new()
            };
            out += &row(&effect_line(name, effect));
        }
    }
    out
}

fn effect_line(scene: String, effect: &Effect) -> Vec<String> {
    let error = |error: Option<f64>| error.map_or_else(|| NONE.to_owned(), level);
    let light = format!("{} ± {}", level(effect.light), level(effect.light_error));
    vec![
        scene,
        plain(&effect.title),
        light,
        error(effect.with_error),
        error(effect.without_error),
        digits(effect.with_seconds, 2),
        digits(effect.without_seconds, 2),
    ]
}

/// A share with two digits.
fn level(share: f64) -> String {
    per_cent(share, 2).replace('\u{a0}', " ")
}

fn row(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

/// Text that is no markup, neither of Markdown's tables nor of HTML.
fn plain(text: &str) -> String {
    let safe = escape(text).replace('\r', " ");
    safe.chars().fold(String::new(), |mut out, c| {
        match c {
            '|' => out += "&#124;",
            '`' => out += "&#96;",
            '\\' => out += "&#92;",
            '[' => out += "&#91;",
            _ => out.push(c),
        }
        out
    })
}

/// A name as code, which takes it as it is but for what would end it.
fn code(name: &str) -> String {
    let kept = name.replace(['`', '|', '\n', '\r'], " ");
    format!("`{}`", escape(&kept))
}

//! Progress: a bar on a terminal, plain lines elsewhere, nothing when quiet.

use std::{
    io::{self, IsTerminal},
    path::Path,
    time::Duration,
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use nephroid::{
    render::Progress,
    scene::{self, Diagnostics, Scene, mesh_file::Loading},
};

/// Steps of the bar: finer than any terminal is wide.
const STEPS: u64 = 1000;

/// Least time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Smallest mesh file with a progress line, in bytes: it takes about a second.
const LARGE_FILE: usize = 64 << 20;
/// Smallest mesh whose building is told of, in triangles.
const LARGE_MESH: usize = 1 << 20;

/// Loads a scene, with a progress line for large mesh files where a person
/// looks on.
pub(crate) fn load(path: &Path, quiet: bool) -> Result<Scene, Diagnostics> {
    if quiet || !io::stderr().is_terminal() {
        return scene::load(path);
    }
    // The bar stays invisible until it is first told something.
    let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("{wide_bar} {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let scene = scene::load_watched(path, &|at| {
        if let Some((done, text)) = loading_line(at) {
            bar.set_position((done * STEPS as f64) as u64);
            bar.set_message(text);
        }
    });
    bar.finish_and_clear();
    scene
}

/// The part that is done and what to say; nothing for what is small.
fn loading_line(at: Loading) -> Option<(f64, String)> {
    match at {
        Loading::Reading { file, done, total } if total >= LARGE_FILE => {
            let (mib, all) = (done >> 20, total >> 20);
            let text = format!("{file}: {mib} of {all} MiB");
            Some((done as f64 / total as f64, text))
        }
        Loading::Building { triangles } if triangles >= LARGE_MESH => {
            let text = format!("building a tree over {}triangles", si(triangles as f64));
            Some((1.0, text))
        }
        _ => None,
    }
}

/// Shows how far a render is.
pub(crate) enum Reporter {
    /// A bar on standard error.
    Bar(ProgressBar),
    /// Lines on standard error; the time of the last one.
    Lines(Option<Duration>),
    /// Nothing.
    Quiet,
}

/// Where a render will stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Number of passes, if one was asked for.
    pub(crate) passes: Option<u32>,
    /// Time, if one was asked for.
    pub(crate) time: Option<Duration>,
    /// Relative error, if one was asked for.
    pub(crate) error: Option<f64>,
}

impl Reporter {
    /// The way that suits where standard error goes.
    pub(crate) fn new(quiet: bool) -> Self {
        if quiet {
            Self::Quiet
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{wide_bar} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_message("first pass");
            bar.tick();
            Self::Bar(bar)
        } else {
            Self::Lines(None)
        }
    }

    /// Whether anybody is told anything.
    pub(crate) fn is_heard(&self) -> bool {
        !matches!(self, Self::Quiet)
    }

    /// Shows `progress` towards `goal`, with what is expected.
    pub(crate) fn show(&mut self, progress: &Progress, goal: Goal, expected: &[String]) {
        match self {
            Self::Bar(bar) => {
                bar.set_position((fraction(progress, goal) * STEPS as f64) as u64);
                bar.set_message(line(progress, goal, expected));
            }
            Self::Lines(last) => {
                let is_last = goal.passes == Some(progress.passes_done);
                let is_due = last.is_none_or(|last| progress.elapsed >= last + LINE_EVERY);
                if is_due || is_last {
                    *last = Some(progress.elapsed);
                    super::tell(line(progress, goal, expected));
                }
            }
            Self::Quiet => {}
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// The part of the way that is done: 0 to 1, by the goal that is nearer.
fn fraction(progress: &Progress, goal: Goal) -> f64 {
    let by_passes = goal
        .passes
        .map_or(0.0, |n| f64::from(progress.passes_done) / f64::from(n));
    let by_time = goal.time.map_or(0.0, |time| {
        progress.elapsed.as_secs_f64() / time.as_secs_f64()
    });
    // Errors of many samples fall like the root of their number.
    let by_error = progress.stated.zip(goal.error);
    let by_error = by_error.map_or(0.0, |(stated, target)| (target / stated.lit.bound).powi(2));
    by_passes.max(by_time).max(by_error).clamp(0.0, 1.0)
}

/// Time left by the goal that is nearer, from the pace so far.
fn left(progress: &Progress, goal: Goal) -> Option<Duration> {
    let done = f64::from(progress.passes_done);
    let by_passes = goal.passes.filter(|_| done > 0.0).map(|n| {
        let open = f64::from(n.saturating_sub(progress.passes_done));
        progress.elapsed.mul_f64(open / done)
    });
    let by_time = goal.time.map(|time| time.saturating_sub(progress.elapsed));
    match (by_passes, by_time) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

fn line(progress: &Progress, goal: Goal, expected: &[String]) -> String {
    let pass = progress.passes_done;
    let mut parts = vec![match goal.passes {
        Some(n) => format!("pass {pass}/{n}"),
        None => format!("pass {pass}"),
    }];
    let seconds = progress.elapsed.as_secs_f64();
    if progress.photons_emitted > 0 && seconds > 0.0 {
        let pace = progress.photons_emitted as f64 / seconds;
        parts.push(format!("{}photons/s", si(pace)));
    }
    if let Some((stated, target)) = progress.stated.zip(goal.error) {
        let [error, target] = [stated.lit.bound, target].map(|e| 100.0 * e);
        parts.push(format!("error {error:.2} % of {target} %"));
    }
    parts.extend_from_slice(expected);
    if let Some(left) = left(progress, goal) {
        parts.push(format!("{} left", clock(left)));
    }
    parts.join(", ")
}

/// Three digits, a prefix and spaces, ready for a unit: `1.23 M `, `45 `.
fn si(value: f64) -> String {
    let (value, prefix) = match value {
        v if v >= 1e9 => (v / 1e9, "G "),
        v if v >= 1e6 => (v / 1e6, "M "),
        v if v >= 1e3 => (v / 1e3, "k "),
        v => (v, ""),
    };
    let digits = match value {
        v if v >= 100.0 || prefix.is_empty() => 0,
        v if v >= 10.0 => 1,
        _ => 2,
    };
    format!("{value:.digits$} {prefix}")
}

/// A length of time in its two largest units: `1h 05m`, `3m 20s`, `12s`.
pub(super) fn clock(time: Duration) -> String {
    let seconds = time.as_secs() + u64::from(time.subsec_millis() >= 500);
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s}s"),
        (0, m, s) => format!("{m}m {s:02}s"),
        (h, m, _) => format!("{h}h {m:02}m"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(passes_done: u32, photons_emitted: u64, seconds: u64) -> Progress {
        Progress {
            passes_done,
            passes_total: 64,
            photons_emitted,
            elapsed: Duration::from_secs(seconds),
            stated: None,
        }
    }

    fn goal(passes: Option<u32>, seconds: Option<u64>) -> Goal {
        Goal {
            passes,
            time: seconds.map(Duration::from_secs),
            error: None,
        }
    }

    #[test]
    fn lines_say_passes_pace_and_time_left() {
        let progress = at(16, 24_600_000, 20);
        assert_eq!(
            line(&progress, goal(Some(64), None), &[]),
            "pass 16/64, 1.23 M photons/s, 1m 00s left"
        );
        assert_eq!(
            line(&progress, goal(Some(64), Some(30)), &[]),
            "pass 16/64, 1.23 M photons/s, 10s left"
        );
        assert_eq!(
            line(&at(16, 0, 20), goal(None, Some(30)), &[]),
            "pass 16, 10s left"
        );
    }

    #[test]
    fn lines_say_the_error_where_one_is_asked_for() {
        let progress = Progress {
            stated: Some(super::super::outlook::stated_after(16, 0.0814)),
            ..at(16, 0, 20)
        };
        let asked = Goal {
            error: Some(0.05),
            ..goal(None, Some(30))
        };
        assert_eq!(
            line(&progress, asked, &["5 % in about 40s".to_owned()]),
            "pass 16, error 8.14 % of 5 %, 5 % in about 40s, 10s left"
        );
        let line = line(&progress, goal(None, Some(30)), &[]);
        assert_eq!(line, "pass 16, 10s left");
        let far = Goal {
            time: None,
            ..asked
        };
        assert!((fraction(&progress, far) - 0.377).abs() < 1e-3);
    }

    #[test]
    fn the_nearer_goal_counts() {
        assert_eq!(fraction(&at(16, 0, 20), goal(Some(64), None)), 0.25);
        assert_eq!(fraction(&at(16, 0, 20), goal(Some(64), Some(40))), 0.5);
        assert_eq!(fraction(&at(48, 0, 20), goal(Some(64), Some(40))), 0.75);
        assert_eq!(fraction(&at(48, 0, 90), goal(None, Some(40))), 1.0);
    }

    #[test]
    fn only_large_files_are_told_of() {
        let reading = |done, total| Loading::Reading {
            file: "a.ply",
            done,
            total,
        };
        assert_eq!(loading_line(reading(5, 10)), None);
        assert_eq!(
            loading_line(reading(32 << 20, 128 << 20)),
            Some((0.25, "a.ply: 32 of 128 MiB".to_owned()))
        );
        assert_eq!(loading_line(Loading::Building { triangles: 99 }), None);
        let text = loading_line(Loading::Building {
            triangles: 2_500_000,
        })
        .unwrap()
        .1;
        assert_eq!(text, "building a tree over 2.50 M triangles");
    }

    #[test]
    fn numbers_and_times() {
        for (value, text) in [
            (0.4, "0 "),
            (45.0, "45 "),
            (1234.0, "1.23 k "),
            (45_600.0, "45.6 k "),
            (789e6, "789 M "),
            (2.5e9, "2.50 G "),
        ] {
            assert_eq!(si(value), text);
        }
        for (millis, text) in [
            (400, "0s"),
            (1_600, "2s"),
            (200_000, "3m 20s"),
            (3_900_000, "1h 05m"),
        ] {
            assert_eq!(clock(Duration::from_millis(millis)), text);
        }
    }
}

//! What a study is going to do, and what it found, as text.

use std::time::Duration;

use nephroid::study::{Outline, SceneStudy, Series, Study, TimeTo};

use crate::cli::progress::clock;

/// What will be done with each scene, and how long it may take.
pub(super) fn outline(scenes: &[Outline]) -> String {
    let mut text = String::new();
    for scene in scenes {
        text.push_str(&format!("{}: {}", scene.name, scene.curves.join("; ")));
        match &scene.witnesses[..] {
            [] => {}
            [only] => text.push_str(&format!("\n  reference by {only}")),
            several => {
                let names = several.join(", ");
                text.push_str(&format!(
                    "\n  reference by the best of {names}, which has no curve"
                ));
            }
        }
        for absent in &scene.absent {
            text.push_str(&format!("\n  without {}: {}", absent.method, absent.reason));
        }
        text.push('\n');
    }
    let limits: Option<Vec<Duration>> = scenes.iter().map(|s| s.limit).collect();
    match limits {
        Some(limits) => {
            let all = limits.iter().sum();
            text.push_str(&format!("at most about {} in all", clock(all)));
        }
        None => text.push_str("passes decide how long it takes"),
    }
    text
}

/// Processor time to each error, a table for each scene.
pub(super) fn times(study: &Study) -> String {
    let tables: Vec<String> = study.scenes.iter().map(table).collect();
    tables.join("\n\n")
}

fn table(scene: &SceneStudy) -> String {
    let mut text = format!(
        "{}, {} x {} pixels: seconds of processor time to an error\n{}",
        scene.name, scene.resolution[0], scene.resolution[1], scene.truth.words
    );
    let longest = |s: &Series| s.label.chars().count();
    let width = scene.series.iter().map(longest).max().unwrap_or(0).max(8);
    if let Some(first) = scene.series.first() {
        text.push_str(&format!("\n{:width$}", ""));
        for time in &first.times {
            text.push_str(&format!("{:>10}", percent(time.error)));
        }
        text.push_str(&format!("{:>10}{:>10}", "last", "slope"));
    }
    for series in &scene.series {
        text.push_str(&format!("\n{:width$}", series.label));
        for &time in &series.times {
            text.push_str(&format!("{:>10}", seconds(time)));
        }
        let last = series.points.last().map_or(String::new(), |point| {
            let n = point.runs.len() as f64;
            let mean = point.runs.iter().map(|r| r.relmse).sum::<f64>() / n;
            percent(mean.sqrt())
        });
        let slope = series
            .fit
            .map_or(String::new(), |fit| format!("{:.2}", fit.slope));
        text.push_str(&format!("{last:>10}{slope:>10}"));
        if !series.layers.is_empty() {
            text.push_str(&format!("  only {}", series.layers.join(", ")));
        }
    }
    for absent in &scene.absent {
        text.push_str(&format!("\nwithout {}: {}", absent.method, absent.reason));
    }
    text
}

/// A time in three digits; `~` before one from beyond the last point, `-` for
/// one that is not known.
fn seconds(time: TimeTo) -> String {
    let Some(seconds) = time.cpu_seconds else {
        return "-".to_owned();
    };
    let mark = if time.extrapolated { "~" } else { "" };
    format!("{mark}{}", digits(seconds))
}

fn percent(error: f64) -> String {
    format!("{} %", digits(100.0 * error))
}

/// Three digits, without noughts at the end.
pub(in crate::cli) fn digits(value: f64) -> String {
    let places = match value {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        v if v >= 1.0 => 2,
        v if v >= 0.1 => 3,
        _ => 4,
    };
    let text = format!("{value:.places$}");
    if text.contains('.') {
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (1234.5, "1234"),
            (100.0, "100"),
            (12.34, "12.3"),
            (3.0, "3"),
            (0.3, "0.3"),
            (0.01234, "0.0123"),
        ] {
            assert_eq!(digits(value), text);
        }
        let time = |cpu_seconds, extrapolated| {
            seconds(TimeTo {
                error: 0.1,
                cpu_seconds,
                extrapolated,
            })
        };
        assert_eq!(time(None, true), "-");
        assert_eq!(time(Some(2.5), true), "~2.5");
        assert_eq!(time(Some(2.5), false), "2.5");
    }
}

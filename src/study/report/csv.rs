//! The runs as a table for other programs: `study.csv` (RFC 4180).

use crate::study::{Series, Study};

use super::words::error_of;

/// A column: its name and what it means.
pub(super) const COLUMNS: [(&str, &str); 17] = [
    ("scene", "name of the scene"),
    ("series", "name of the curve, unique within its scene"),
    ("method", "method, as render --method has it"),
    ("setting", "setting that was varied; empty for the defaults"),
    ("value", "its value"),
    (
        "layers",
        "layers that were judged, with spaces between; empty for all",
    ),
    ("passes", "passes"),
    ("seed", "seed"),
    ("wall_seconds", "time by the clock in seconds"),
    ("cpu_seconds", "processor time of all threads in seconds"),
    ("error", "root of relmse; 0.01 is 1 %"),
    (
        "relmse",
        "mean of (x - r)² / (r² + 0.01 mean(r)²) over pixels and channels",
    ),
    (
        "relmse_trimmed",
        "the same without the worst 0.1 % of the pixels",
    ),
    ("rmse", "root of the mean of (x - r)², in units of radiance"),
    ("mean_ratio", "mean of the picture over that of the truth"),
    ("flip", "FLIP, what an eye sees: 0 to 1"),
    (
        "stated",
        "error that the picture states about itself; empty if it does not",
    ),
];

/// All runs of a study, one a line.
pub(super) fn table(study: &Study) -> String {
    let mut out = COLUMNS.map(|(name, _)| name).join(",") + "\r\n";
    for scene in &study.scenes {
        for series in &scene.series {
            for line in lines(&scene.name, series) {
                out += &line;
            }
        }
    }
    out
}

fn lines(scene: &str, series: &Series) -> impl Iterator<Item = String> {
    let sweep = series.sweep.as_ref();
    let of_series = [
        scene,
        &series.label,
        &series.method,
        sweep.map_or("", |s| &s.name),
        sweep.map_or("", |s| &s.value),
        &series.layers.join(" "),
    ]
    .map(field)
    .join(",");
    let runs = |point: &'_ crate::study::Point| {
        let passes = point.passes;
        let lines = point.runs.iter().map(|run| {
            let numbers = [
                run.wall_seconds,
                run.cpu_seconds,
                error_of(run).unwrap_or(f64::NAN),
                run.relmse,
                run.relmse_trimmed,
                run.rmse,
                run.mean_ratio,
                run.flip,
            ];
            // The shortest digits that read back as the same number.
            let numbers = numbers.map(|n| n.to_string()).join(",");
            let stated = run.stated.map_or(String::new(), |n| n.to_string());
            format!("{of_series},{passes},{},{numbers},{stated}\r\n", run.seed)
        });
        lines.collect::<Vec<_>>()
    };
    let lines: Vec<String> = series.points.iter().flat_map(runs).collect();
    lines.into_iter()
}

/// A text as a field: quoted if it has to be.
pub(super) fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) || text.starts_with(' ') || text.ends_with(' ') {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_must() {
        assert_eq!(field("plain"), "plain");
        assert_eq!(field("a, \"b\"\n"), "\"a, \"\"b\"\"\n\"");
        assert_eq!(field(" a"), "\" a\"");
    }
}

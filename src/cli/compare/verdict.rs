//! What a comparison found, as a table, as JSON, and against the bounds.

use nephroid::metrics::{Metric, Score};
use serde_json::{Map, Value, json};

use super::pictures::Pictures;
use crate::cli::{args::CompareArgs, values::Crop};

/// The scores of one layer and region, for each picture that is judged.
pub(super) struct Entry {
    pub(super) layer: String,
    /// None for the whole.
    pub(super) region: Option<Crop>,
    /// By picture.
    pub(super) scores: Vec<Vec<Score>>,
}

impl Entry {
    /// What it is about, in words.
    fn title(&self) -> String {
        let layer = match self.layer.as_str() {
            "" => "picture",
            name => name,
        };
        match self.region {
            None => layer.to_owned(),
            Some(Crop { origin, size }) => {
                let ([x, y], [w, h]) = (origin, size);
                format!("{layer}, region {x},{y},{w}x{h}")
            }
        }
    }
}

/// A bound that does not hold, in words.
pub(super) fn violations(typed: &CompareArgs, names: &[String], entries: &[Entry]) -> Vec<String> {
    let upper = typed.max.iter().map(|bound| (bound, true));
    let bounds = upper.chain(typed.min.iter().map(|bound| (bound, false)));
    let mut found = Vec::new();
    for (bound, is_upper) in bounds {
        for entry in entries {
            for (name, scores) in names.iter().zip(&entry.scores) {
                let score = scores.iter().find(|score| score.metric == bound.metric);
                let value = score.and_then(|score| score.value);
                let holds = value.is_some_and(|v| {
                    if is_upper {
                        v <= bound.value
                    } else {
                        v >= bound.value
                    }
                });
                if !holds {
                    let value = value.map_or("not defined".to_owned(), |v| v.to_string());
                    found.push(format!(
                        "{} of {name} ({}) is {value}, not at {} {}",
                        bound.metric.name(),
                        entry.title(),
                        if is_upper { "most" } else { "least" },
                        bound.value,
                    ));
                }
            }
        }
    }
    found
}

/// The result for people.
pub(super) fn table(pictures: &Pictures, names: &[String], entries: &[Entry]) -> String {
    let [width, height] = pictures.size();
    let reference = pictures.reference.path.display();
    let mut text = format!("against {reference}, {width} x {height} pixels\n");
    let columns = names.iter().map(|name| name.chars().count().max(22));
    let columns: Vec<usize> = columns.collect();
    text.push_str(&format!("{:18}", ""));
    for (name, &column) in names.iter().zip(&columns) {
        text.push_str(&format!("  {name:column$}"));
    }
    for entry in entries {
        text = format!("{}\n{}", text.trim_end(), entry.title());
        for (i, score) in entry.scores[0].iter().enumerate() {
            text = format!("{}\n  {:16}", text.trim_end(), score.metric.name());
            for (scores, &column) in entry.scores.iter().zip(&columns) {
                text.push_str(&format!("  {:column$}", shown(scores[i])));
            }
        }
    }
    text.trim_end().to_owned()
}

/// A value to five digits; beside a mean of relative squares its root.
fn shown(score: Score) -> String {
    let Some(value) = score.value else {
        return "not defined".to_owned();
    };
    let number = if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{value:.5}")
    } else {
        format!("{value:.4e}")
    };
    match score.metric {
        Metric::RelMse | Metric::RelMseTrimmed => {
            format!("{number} ({:.3} %)", 100.0 * value.sqrt())
        }
        _ => number,
    }
}

/// The result for machines. Values that are not defined or infinite are null.
pub(super) fn as_json(
    pictures: &Pictures,
    names: &[String],
    entries: &[Entry],
    violations: &[String],
) -> Value {
    let mut comparisons = Vec::new();
    for entry in entries {
        for (name, scores) in names.iter().zip(&entry.scores) {
            let metrics: Map<String, Value> = scores
                .iter()
                .map(|score| (score.metric.name().to_owned(), json!(score.value)))
                .collect();
            comparisons.push(json!({
                "picture": name,
                "layer": (!entry.layer.is_empty()).then_some(&entry.layer),
                "region": entry.region.map(|Crop { origin: [x, y], size: [w, h] }| [x, y, w, h]),
                "metrics": metrics,
            }));
        }
    }
    json!({
        "reference": pictures.reference.path.display().to_string(),
        "resolution": pictures.size(),
        "comparisons": comparisons,
        "ok": violations.is_empty(),
        "violations": violations,
    })
}

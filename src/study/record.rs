//! What a study found: the data behind every curve and table of its report,
//! and the contents of `study.json`.
//!
//! An *error* is relative: the root of relMSE, the mean over pixels and
//! channels of `(x - r)^2 / (r^2 + 0.01 mean(r)^2)`. Seconds of processor time
//! are those of all threads together; they cover the passes and what prepares
//! them, not the reading of the scene.

use serde::{Deserialize, Serialize};

/// Number of the format that this version writes and reads.
pub const FORMAT: u32 = 2;

/// A whole study.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// [`FORMAT`].
    pub format: u32,
    /// Program and version.
    pub software: String,
    /// When it was finished, as far as it is: date and time, UTC, RFC 3339.
    pub made: String,
    /// Where it was made.
    pub machine: Machine,
    /// Scenes in the order they were named.
    pub scenes: Vec<SceneStudy>,
}

/// The machine that a study ran on.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Name of the processor.
    pub processor: String,
    /// Cores that the system offers.
    pub cores: u32,
    /// Threads that the renders used.
    pub threads: u32,
    /// Operating system and architecture.
    pub system: String,
}

/// What was found about one scene.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SceneStudy {
    /// Name of the file without its ending.
    pub name: String,
    /// What it shows, in a sentence (the first comment of the file).
    pub title: String,
    /// Size of the pictures in pixels.
    pub resolution: [u32; 2],
    /// What the pictures are judged by.
    pub truth: Truth,
    /// One curve each.
    pub series: Vec<Series>,
    /// Methods without a curve, and why.
    pub absent: Vec<Absent>,
    /// What each effect costs and brings.
    pub effects: Vec<Effect>,
}

/// What kind of truth pictures are judged by.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TruthKind {
    /// A formula.
    ClosedForm,
    /// A picture that was given.
    Given,
    /// Long runs of an independent method.
    Made,
}

/// What the pictures of a scene are judged by.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// Its kind.
    pub kind: TruthKind,
    /// One sentence for the reader: where it comes from.
    pub words: String,
    /// The method that made it.
    pub method: Option<String>,
    /// Seeds whose mean it is.
    pub seeds: u32,
    /// Passes of each seed.
    pub passes: u32,
    /// Its own error, from the spread of its seeds; `None` if unknown.
    pub error: Option<f64>,
    /// Processor time it took.
    pub cpu_seconds: Option<f64>,
    /// The picture, a PNG beside the report; relative path.
    pub picture: Option<String>,
}

/// One curve of error against time.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Series {
    /// Name in legends, unique within the scene.
    pub label: String,
    /// Name of the method, as `render --method` has it.
    pub method: String,
    /// The setting that was varied, and its value; `None` for the defaults.
    pub sweep: Option<Setting>,
    /// What of the scene the method cannot see, or blurs, one sentence each.
    pub blind_spots: Vec<String>,
    /// The layers of the picture that were judged; all if empty.
    pub layers: Vec<String>,
    /// By growing passes.
    pub points: Vec<Point>,
    /// A power law through the points; `None` with fewer than three.
    pub fit: Option<Fit>,
    /// Time to each error that was asked for.
    pub times: Vec<TimeTo>,
    /// Pictures kept for the reader, by growing passes.
    pub pictures: Vec<Picture>,
}

/// A setting and its value, as the scene language names them.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// Name of the setting.
    pub name: String,
    /// Its value.
    pub value: String,
}

/// All runs of a series with equally many passes.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// Passes.
    pub passes: u32,
    /// One for each seed.
    pub runs: Vec<Run>,
    /// Error of the mean of all runs' pictures and spread of the single ones:
    /// what is bias and what is noise. `None` with a single seed.
    pub split: Option<Split>,
}

/// One picture and what it cost.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Seed.
    pub seed: u64,
    /// Wall time.
    pub wall_seconds: f64,
    /// Processor time of all threads.
    pub cpu_seconds: f64,
    /// Mean of squared relative errors (see the module's text).
    pub relmse: f64,
    /// The same without the worst 0.1 % of the pixels.
    pub relmse_trimmed: f64,
    /// Root of the mean squared error, in units of radiance.
    pub rmse: f64,
    /// Mean of the picture over that of the truth.
    pub mean_ratio: f64,
    /// What the eye sees (FLIP at 67 pixels a degree), 0 to 1.
    pub flip: f64,
    /// The error that the picture states about itself.
    pub stated: Option<f64>,
}

/// An error taken apart; both parts are errors, whose squares add up to that
/// of a run.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// What differs from seed to seed.
    pub noise: f64,
    /// What all seeds have in common, freed of what is left of their noise and
    /// of the truth's; 0 where nothing is left.
    pub bias: f64,
}

/// `error = factor * cpu_seconds^slope`, by least squares of the logarithms.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Fit {
    /// Error after one second.
    pub factor: f64,
    /// Exponent; -0.5 for independent samples.
    pub slope: f64,
    /// 90 % confidence interval of the slope.
    pub slope_interval: [f64; 2],
}

/// What an error costs.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TimeTo {
    /// The error asked for.
    pub error: f64,
    /// Processor time; `None` if it was not reached.
    pub cpu_seconds: Option<f64>,
    /// Whether the time comes from between two points (false) or from the fit
    /// beyond the last one (true).
    pub extrapolated: bool,
}

/// A picture beside the report; paths are relative to it.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Picture {
    /// Passes.
    pub passes: u32,
    /// Seed.
    pub seed: u64,
    /// Processor time it took.
    pub cpu_seconds: f64,
    /// Its error.
    pub error: f64,
    /// PNG for the eye, all of one scene with the same exposure.
    pub file: String,
    /// PNG of the error by pixel, in the colours of `nephroid compare`.
    pub map: String,
}

/// A method without a curve.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Absent {
    /// Name of the method.
    pub method: String,
    /// Why there is no curve, in a sentence.
    pub reason: String,
}

/// What one effect brings and costs: the same render, of eight passes, with and
/// without it.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// Its name in scene files.
    pub name: String,
    /// How people call it.
    pub title: String,
    /// Share of the picture's light that is missing without it; about nought
    /// for one that only finds the same light with less noise.
    pub light: f64,
    /// Standard error of that share.
    pub light_error: f64,
    /// Processor time with it.
    pub with_seconds: f64,
    /// Processor time without it.
    pub without_seconds: f64,
    /// Error with it; `None` if the truth cannot tell.
    pub with_error: Option<f64>,
    /// Error without it: noise, blur, and what is missing.
    pub without_error: Option<f64>,
}

//! What a benchmark found, as it is written to a file.

use serde::{Deserialize, Serialize};

use super::super::record::Machine;

/// Number of the benchmark: scenes, references, targets and the measure. What
/// differs here cannot be compared.
pub const BENCHMARK: u32 = 1;

/// The scenes of the benchmark.
pub const STANDARD_SCENES: [&str; 5] =
    ["glass_sphere", "cornell_glass", "cup", "pool", "mesh_glass"];

/// The errors whose time is asked for.
pub const TARGETS: [f64; 3] = [0.2, 0.1, 0.05];

/// A whole benchmark.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Benchmark {
    /// [`BENCHMARK`].
    pub benchmark: u32,
    /// Program and version.
    pub software: String,
    /// When it was finished: date and time, UTC, RFC 3339.
    pub made: String,
    /// Where it was made.
    pub machine: Machine,
    /// The errors whose time was asked for: roots of relMSE without the worst
    /// 0.1 % of the pixels.
    pub targets: Vec<f64>,
    /// Scenes in the order of the benchmark.
    pub scenes: Vec<BenchmarkScene>,
}

/// What was found about one scene.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BenchmarkScene {
    /// Its name.
    pub name: String,
    /// Print of the scene, the files that it names, and the reference.
    pub print: String,
    /// One run for each seed.
    pub runs: Vec<BenchmarkRun>,
}

/// One render.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BenchmarkRun {
    /// Seed.
    pub seed: u64,
    /// Processor time of a fixed piece of work just before: how fast the
    /// machine was.
    pub unit_seconds: f64,
    /// Processor time to each target; none for those not reached.
    pub cpu_seconds: Vec<Option<f64>>,
    /// Processor time and error after 1, 2, 3, 4, 6, 8, 12, ... passes.
    pub curve: Vec<(f64, f64)>,
}

impl BenchmarkScene {
    /// Geometric mean over the seeds of the time to a target, and the factor
    /// by which its standard error may move it; `None` if a seed did not
    /// reach it. The factor is 1 with a single seed.
    pub fn time(&self, target: usize) -> Option<(f64, f64)> {
        let seconds: Option<Vec<f64>> = self
            .runs
            .iter()
            .map(|run| run.cpu_seconds.get(target).copied().flatten())
            .collect();
        let logs: Vec<f64> = seconds?.into_iter().map(libm::log).collect();
        let (mean, error) = mean_and_error(&logs)?;
        Some((libm::exp(mean), libm::exp(error)))
    }
}

/// Mean and standard error, 0 for a single value; `None` without any.
pub(super) fn mean_and_error(values: &[f64]) -> Option<(f64, f64)> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    match values.len() {
        0 => None,
        1 => Some((mean, 0.0)),
        _ => {
            let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
            Some((mean, (squares / (n * (n - 1.0))).sqrt()))
        }
    }
}

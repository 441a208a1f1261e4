//! The benchmark: the renderer's own time to fixed errors on fixed scenes, and
//! whether it differs from an earlier one by more than chance.

mod record;
mod verdict;

use std::ops::ControlFlow;

pub use record::{BENCHMARK, Benchmark, BenchmarkRun, BenchmarkScene, STANDARD_SCENES, TARGETS};
pub use verdict::{Judgement, Verdict, verdicts};

use crate::{
    film::{Film, Image},
    metrics::relmse_trimmed,
    plan::film_quantum,
    render::Renderer,
    scene::{Scene, Settings},
};

use super::{clock::Stopwatch, fault::Fault, fit::time_to};

/// Part of the pixels that is left out: a single bright one would rule.
const WORST: f64 = 0.001;

/// Steps of the machine's own measure, some tenths of a second.
const UNIT_STEPS: u64 = 100_000_000;

/// What a scene is measured by.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What its picture should be.
    pub reference: &'a Image,
    /// Errors whose time is asked for.
    pub targets: &'a [f64],
    /// Most passes.
    pub passes: u32,
}

impl Task<'_> {
    /// Renders with a seed until the smallest of the errors is reached, or the
    /// passes are spent. `told` hears of every pass.
    ///
    /// # Errors
    /// [`Fault::Invalid`] if the reference is not of the scene's size,
    /// [`Fault::Interrupted`].
    pub fn run(
        &self,
        seed: u64,
        told: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<BenchmarkRun, Fault> {
        let unit_seconds = unit_seconds();
        let [width, height] = self.scene.resolution;
        let settings = Settings {
            seed,
            ..self.scene.settings.clone()
        };
        let mut clock = Stopwatch::default();
        let size = self.scene.resolution;
        let renderer =
            clock.time(|| Renderer::new(self.scene, &settings, size, [0, 0, width, height]));
        let mut film = Film::new(width, height, film_quantum(self.scene));
        let least = self.targets.iter().copied().fold(f64::INFINITY, f64::min);
        let mut curve: Vec<(f64, f64)> = Vec::new();
        for done in 1..=self.passes {
            clock.time(|| film.add_pass(done - 1, &renderer.pass(done - 1).samples));
            if is_look(done) || done == self.passes {
                let error = relmse_trimmed(&film.image(), self.reference, WORST)
                    .map_err(|e| Fault::Invalid(format!("the reference does not fit: {e}")))?
                    .sqrt();
                curve.push((clock.cpu_seconds(), error));
                if error <= least {
                    break;
                }
            }
            if told(done).is_break() {
                return Err(Fault::Interrupted);
            }
        }
        let time = |&target: &f64| time_to(&curve, None, target).cpu_seconds;
        Ok(BenchmarkRun {
            seed,
            unit_seconds,
            cpu_seconds: self.targets.iter().map(time).collect(),
            curve,
        })
    }
}

/// Whether the error is looked at after so many passes: 1, 2, 3, 4, 6, 8, 12,
/// 16, ..., so that the time between two looks grows with the time.
fn is_look(passes: u32) -> bool {
    passes.is_power_of_two() || (passes.is_multiple_of(3) && (passes / 3).is_power_of_two())
}

/// Processor time of a fixed piece of work that no version changes: what two
/// benchmarks differ in here is the machine.
fn unit_seconds() -> f64 {
    let mut clock = Stopwatch::default();
    clock.time(|| {
        let mut x = 0.5f64;
        for _ in 0..UNIT_STEPS {
            // A chain of dependent operations: the logistic map.
            x = 3.9 * x * (1.0 - x);
        }
        std::hint::black_box(x)
    });
    clock.cpu_seconds()
}

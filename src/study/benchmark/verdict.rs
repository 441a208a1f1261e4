//! Two benchmarks beside each other.

use crate::metrics::student_quantile;

use super::record::{BENCHMARK, Benchmark, BenchmarkRun, BenchmarkScene, mean_and_error};

/// Confidence of a verdict about all scenes together.
const CONFIDENCE: f64 = 0.95;

/// What can be said about a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It takes less time than before.
    Faster,
    /// It takes more time than before.
    Slower,
    /// The difference may be chance, or the machine's.
    Same,
}

/// How a scene's times have changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Name of the scene.
    pub name: String,
    /// New time over old time, the geometric mean over seeds and targets.
    pub ratio: f64,
    /// Bounds of the ratio that chance and the machine leave open.
    pub interval: [f64; 2],
    /// What follows.
    pub verdict: Verdict,
}

/// Compares each scene that both have, seed by seed and target by target. A
/// difference counts when it is larger than the spread over the seeds (with
/// Student's distribution, by Sidak's rule for several scenes) and the
/// machine's own change of speed explain together. A second list says what
/// could not be compared.
///
/// # Errors
/// In words, if the two are not the same benchmark.
pub fn verdicts(old: &Benchmark, new: &Benchmark) -> Result<(Vec<Judgement>, Vec<String>), String> {
    if old.benchmark != BENCHMARK || old.targets != new.targets {
        return Err(format!(
            "it is of benchmark {} with targets {:?}; this is {BENCHMARK} with {:?}",
            old.benchmark, old.targets, new.targets
        ));
    }
    let (mut judged, mut left_out) = (Vec::new(), Vec::new());
    let mut pairs = Vec::new();
    for scene in &new.scenes {
        let Some(before) = old.scenes.iter().find(|s| s.name == scene.name) else {
            left_out.push(format!("{}: not in the earlier benchmark", scene.name));
            continue;
        };
        if before.print == scene.print {
            pairs.push((before, scene));
        } else {
            left_out.push(format!("{}: scene or reference have changed", scene.name));
        }
    }
    // Every one of several true hypotheses is kept with the joint confidence.
    let confidence = libm::pow(CONFIDENCE, 1.0 / pairs.len().max(1) as f64);
    for (before, after) in pairs {
        match judge(before, after, confidence) {
            Some(judgement) => judged.push(judgement),
            None => left_out.push(format!(
                "{}: needs two seeds that reach a target in both",
                after.name
            )),
        }
    }
    Ok((judged, left_out))
}

fn judge(before: &BenchmarkScene, after: &BenchmarkScene, confidence: f64) -> Option<Judgement> {
    let run_of = |seed| before.runs.iter().find(move |run| run.seed == seed);
    let pairs: Vec<(&BenchmarkRun, &BenchmarkRun)> = after
        .runs
        .iter()
        .filter_map(|run| Some((run_of(run.seed)?, run)))
        .collect();
    let times: Vec<f64> = pairs.iter().filter_map(|(a, b)| log_ratio(a, b)).collect();
    if times.len() < 2 {
        return None;
    }
    let (mean, error) = mean_and_error(&times)?;
    let speeds: Vec<f64> = pairs
        .iter()
        .map(|(a, b)| libm::log(b.unit_seconds / a.unit_seconds))
        .collect();
    let (machine, _) = mean_and_error(&speeds)?;
    let half = student_quantile(confidence, times.len() as u32 - 1) * error + machine.abs();
    let interval = [mean - half, mean + half];
    Some(Judgement {
        name: after.name.clone(),
        ratio: libm::exp(mean),
        interval: interval.map(libm::exp),
        verdict: match interval {
            [_, high] if high < 0.0 => Verdict::Faster,
            [low, _] if low > 0.0 => Verdict::Slower,
            _ => Verdict::Same,
        },
    })
}

/// Logarithm of the ratio of times of one seed, the mean over the targets that
/// both reached.
fn log_ratio(before: &BenchmarkRun, after: &BenchmarkRun) -> Option<f64> {
    let both = before.cpu_seconds.iter().zip(&after.cpu_seconds);
    let logs: Vec<f64> = both
        .filter_map(|(a, b)| Some(libm::log((*b)? / (*a)?)))
        .collect();
    mean_and_error(&logs).map(|(mean, _)| mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{sampling::mix2, study::Machine};

    fn benchmark(runs: Vec<BenchmarkRun>) -> Benchmark {
        Benchmark {
            benchmark: BENCHMARK,
            software: String::new(),
            made: String::new(),
            machine: Machine::this(),
            targets: vec![0.2, 0.1],
            scenes: vec![BenchmarkScene {
                name: "cup".to_owned(),
                print: "a".to_owned(),
                runs,
            }],
        }
    }

    fn run(seed: u64, unit_seconds: f64, times: [Option<f64>; 2]) -> BenchmarkRun {
        BenchmarkRun {
            seed,
            unit_seconds,
            cpu_seconds: times.to_vec(),
            curve: Vec::new(),
        }
    }

    /// Worked by hand: ratios 1/2 with no spread, then a spread that hides it.
    #[test]
    fn differences_count_beyond_noise() {
        let old = benchmark(
            (0..3)
                .map(|s| run(s, 1.0, [Some(2.0), Some(8.0)]))
                .collect(),
        );
        let new = benchmark(
            (0..3)
                .map(|s| run(s, 1.0, [Some(1.0), Some(4.0)]))
                .collect(),
        );
        let (judged, left_out) = verdicts(&old, &new).unwrap();
        assert!(left_out.is_empty());
        assert_eq!(judged[0].verdict, Verdict::Faster);
        assert!((judged[0].ratio - 0.5).abs() < 1e-12);
        assert_eq!(verdicts(&new, &old).unwrap().0[0].verdict, Verdict::Slower);
        // ln ratios -ln 2 + {-1, 0, 1}: standard error 1/sqrt(3), t(2, 95 %) = 4.303.
        let e = std::f64::consts::E;
        let spread = [1.0 / e, 1.0, e];
        let uneven: Vec<_> = (0u64..)
            .zip(spread)
            .map(|(s, f)| run(s, 1.0, [Some(f), Some(4.0 * f)]))
            .collect();
        let (judged, _) = verdicts(&old, &benchmark(uneven)).unwrap();
        assert_eq!(judged[0].verdict, Verdict::Same);
        let half = 4.302_653 / 3f64.sqrt();
        assert!((judged[0].interval[1] / (0.5 * half.exp()) - 1.0).abs() < 1e-5);
    }

    /// What the machine alone explains is no difference of the program.
    #[test]
    fn a_slower_machine_is_no_slower_program() {
        let old = benchmark((0..3).map(|s| run(s, 1.0, [Some(1.0), None])).collect());
        let new = benchmark(
            (0..3)
                .map(|s| run(s, 1.3, [Some(1.25), Some(3.0)]))
                .collect(),
        );
        assert_eq!(verdicts(&old, &new).unwrap().0[0].verdict, Verdict::Same);
        let new = benchmark(
            (0..3)
                .map(|s| run(s, 1.1, [Some(1.25), Some(3.0)]))
                .collect(),
        );
        assert_eq!(verdicts(&old, &new).unwrap().0[0].verdict, Verdict::Slower);
    }

    /// With nothing but noise a verdict is rare: one benchmark in twenty.
    #[test]
    fn noise_is_no_verdict() {
        let uniform = |a: u64, b: u64| (mix2(a, b) >> 11) as f64 / (1u64 << 53) as f64;
        let noisy = |k: u64| {
            let seconds = |s, t| Some(1.0 + 0.3 * uniform(k, 10 * s + t));
            benchmark(
                (0..5)
                    .map(|s| run(s, 1.0, [seconds(s, 0), seconds(s, 1)]))
                    .collect(),
            )
        };
        let wrong = (0..400)
            .filter(|&k| {
                let (judged, _) = verdicts(&noisy(2 * k), &noisy(2 * k + 1)).unwrap();
                judged[0].verdict != Verdict::Same
            })
            .count();
        // 20 expected, with a standard deviation of 4.4.
        assert!((3..=38).contains(&wrong), "{wrong} of 400");
    }

    #[test]
    fn what_cannot_be_compared_is_said() {
        let old = benchmark((0..3).map(|s| run(s, 1.0, [Some(1.0), None])).collect());
        let mut other = old.clone();
        other.scenes[0].print = "b".to_owned();
        let (judged, left_out) = verdicts(&old, &other).unwrap();
        assert!(judged.is_empty() && left_out[0].contains("changed"));
        other.scenes[0].name = "pool".to_owned();
        assert!(verdicts(&old, &other).unwrap().1[0].contains("not in"));
        other.targets = vec![0.3];
        assert!(verdicts(&old, &other).is_err());
        let one = benchmark(vec![run(9, 1.0, [Some(1.0), None])]);
        assert!(verdicts(&old, &one).unwrap().1[0].contains("two seeds"));
    }
}

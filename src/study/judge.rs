//! Measures the pictures of a curve against a truth.

use crate::{
    film::Image,
    metrics::{Comparison, Light, Metric, Region, Score},
};

use super::{
    fault::Fault,
    fit::{fit, time_to},
    record::{Fit, Point, Run, TimeTo},
    run::{Finished, Snapshot},
    split::split,
    store::Store,
    truth::Yardstick,
};

/// The measures that a run has.
const METRICS: [Metric; 5] = [
    Metric::RelMse,
    Metric::RelMseTrimmed,
    Metric::Rmse,
    Metric::MeanRatio,
    Metric::Flip,
];

/// Passes from which on a power law is fitted: one of each replicate. What
/// comes before tells of the preparations.
const FIRST_OF_FIT: u32 = 8;

/// A curve as it was measured.
pub(super) struct Judged {
    pub(super) points: Vec<Point>,
    /// Points that the truth is not good enough to judge.
    pub(super) left_out: usize,
    /// Seconds and error of each point, means over the runs and freed of the
    /// truth's own error.
    pub(super) curve: Vec<(f64, f64)>,
    pub(super) fit: Option<Fit>,
    pub(super) times: Vec<TimeTo>,
}

/// Measures all pictures of the runs.
pub(super) fn judge(
    runs: &[Finished],
    store: &Store,
    yardstick: &Yardstick,
    exposure: f64,
    targets: &[f64],
) -> Result<Judged, Fault> {
    let pictures: Result<Vec<Vec<Image>>, Fault> = runs.iter().map(|r| r.pictures(store)).collect();
    let pictures = pictures?;
    let looks = runs.iter().map(|r| r.snapshots.len()).min().unwrap_or(0);
    let mut judged = Judged {
        points: Vec::new(),
        left_out: 0,
        curve: Vec::new(),
        fit: None,
        times: Vec::new(),
    };
    for look in 0..looks {
        let of_seeds: Vec<Image> = pictures.iter().map(|p| p[look].clone()).collect();
        let measured: Result<Vec<Run>, Fault> = runs
            .iter()
            .zip(&of_seeds)
            .map(|(run, picture)| {
                measure(run.seed, run.snapshots[look], picture, yardstick, exposure)
            })
            .collect();
        let measured = measured?;
        let n = measured.len() as f64;
        let relmse = measured.iter().map(|r| r.relmse).sum::<f64>() / n;
        if !yardstick.can_judge(relmse) {
            judged.left_out += 1;
            continue;
        }
        let seconds = measured.iter().map(|r| r.cpu_seconds).sum::<f64>() / n;
        judged
            .curve
            .push((seconds, (relmse - yardstick.variance).sqrt()));
        judged.points.push(Point {
            passes: runs[0].snapshots[look].passes,
            split: split(&of_seeds, &yardstick.picture, yardstick.variance),
            runs: measured,
        });
    }
    judged.fit = power_law(&judged.points, runs.len(), yardstick.variance);
    let time = |&target: &f64| time_to(&judged.curve, judged.fit, target);
    judged.times = targets.iter().map(time).collect();
    Ok(judged)
}

fn measure(
    seed: u64,
    snapshot: Snapshot,
    picture: &Image,
    yardstick: &Yardstick,
    exposure: f64,
) -> Result<Run, Fault> {
    let light = Light::Radiance { exposure };
    let compared = Comparison::new(picture, &yardstick.picture, light, &METRICS, None)
        .map_err(|e| Fault::Invalid(e.to_string()))?;
    let scores = compared.scores(Region::whole(picture));
    let value = |metric: Metric| {
        let score = scores.iter().find(|score: &&Score| score.metric == metric);
        score.and_then(|score| score.value).unwrap_or(0.0)
    };
    Ok(Run {
        seed,
        wall_seconds: snapshot.wall_seconds,
        cpu_seconds: snapshot.cpu_seconds,
        relmse: value(Metric::RelMse),
        relmse_trimmed: value(Metric::RelMseTrimmed),
        rmse: value(Metric::Rmse),
        mean_ratio: value(Metric::MeanRatio),
        flip: value(Metric::Flip),
        stated: snapshot.stated,
    })
}

/// The law of the points from the first round on, or of all if those are too
/// few.
fn power_law(points: &[Point], seeds: usize, variance: f64) -> Option<Fit> {
    let rounds = |p: &&Point| p.passes >= FIRST_OF_FIT;
    let enough = points.iter().filter(rounds).count() >= 3;
    let chosen: Vec<&Point> = points.iter().filter(|p| !enough || rounds(p)).collect();
    let of_seed = |i: usize| -> Vec<(f64, f64)> {
        let at = |point: &&Point| {
            let run = &point.runs[i];
            (run.cpu_seconds, (run.relmse - variance).max(0.0).sqrt())
        };
        chosen.iter().map(at).collect()
    };
    let curves: Vec<Vec<(f64, f64)>> = (0..seeds).map(of_seed).collect();
    fit(&curves)
}

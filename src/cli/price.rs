//! `nephroid price`: what an error costs, from a short look.

use std::{ops::ControlFlow, time::Instant};

use nephroid::{
    metrics::{Figures, Statement},
    render::{self, Forecast, Interval, Job, Part, Price, REPLICATES, Renderer, Subject},
    study::Stopwatch,
};
use serde_json::{Value, json};

use super::{
    Exit, Failure,
    args::PriceArgs,
    check, deliver,
    effects::EffectChoice,
    media::Media,
    outlook,
    progress::{Goal, Reporter, clock},
    tell, use_threads,
};

/// Rounds that are enough to look at.
const MOST_ROUNDS: u32 = 8;

/// What was seen of the picture.
struct Pilot {
    resolution: [u32; 2],
    passes: u32,
    /// Wall time, and processor seconds for each second of it.
    seconds: f64,
    busy: f64,
    stated: Figures,
    forecast: Forecast,
}

/// Looks at the scene and prints what errors cost, on standard output.
pub(super) fn run(typed: &PriceArgs) -> Result<Exit, Failure> {
    // Before the scene: its meshes are read in parallel.
    use_threads(typed.threads)?;
    let name = typed.scene.display().to_string();
    let quiet = typed.quiet || typed.json;
    let Some(scene) = check::scene_in_order(&typed.scene, quiet, typed.json)? else {
        return Ok(Exit::BadInput);
    };
    let mut job = Job::of(&scene);
    job.resolution = typed.resolution.unwrap_or(scene.resolution);
    job.settings.passes = MOST_ROUNDS * REPLICATES;
    job.settings.seed = typed.seed.unwrap_or(job.settings.seed);
    job.settings.photons = typed.photons.or(job.settings.photons);
    EffectChoice::apply(&typed.effects, &mut job.settings);
    job.check().map_err(Failure::bad_input)?;
    if !quiet {
        for warning in Media::of(&scene).warnings {
            tell(format_args!("warning: {warning}"));
        }
    }
    let pilot = look(&scene, &job, typed, quiet)
        .ok_or_else(|| Failure::fault("the picture is black so far: nothing can be told of it"))?;
    let targets = if typed.error.is_empty() {
        outlook::LIST.to_vec()
    } else {
        typed.error.clone()
    };
    let prices = targets.into_iter();
    let prices = prices.filter_map(|target| Some((target, pilot.forecast.price(target)?)));
    let prices: Vec<(f64, Price)> = prices.collect();
    deliver(if typed.json {
        pilot.json(&name, &prices).to_string()
    } else {
        pilot.words(&name, &prices)
    })
    .map_err(Failure::fault)?;
    Ok(Exit::Done)
}

/// Renders the first rounds; `None` if the picture is black.
fn look(
    scene: &nephroid::scene::Scene,
    job: &Job,
    typed: &PriceArgs,
    quiet: bool,
) -> Option<Pilot> {
    let mut reporter = Reporter::new(quiet);
    let goal = Goal {
        passes: Some(job.settings.passes),
        time: Some(typed.pilot),
        error: None,
    };
    let mut forecast = Forecast::new();
    let mut stated = None;
    let mut watch = Stopwatch::default();
    let part = watch.time(|| {
        let start = Instant::now();
        let renderer = Renderer::new(scene, &job.settings, job.resolution, job.window());
        let mut part = Part::new(Subject::of(scene, job, &renderer));
        part.set_seconds(start.elapsed().as_secs_f64());
        render::go_on(&renderer, job, &mut part, &mut |progress, part| {
            let passes = progress.passes_done;
            forecast.clock(passes, progress.elapsed.as_secs_f64());
            reporter.show(progress, goal, &[]);
            if render::ends_asked_round(passes) {
                stated = Statement::of(part.film(), None).map(|s| s.whole);
                if let Some(figures) = &stated {
                    forecast.observe(passes, figures);
                }
            }
            let is_round = passes.is_multiple_of(REPLICATES);
            if is_round && progress.elapsed >= typed.pilot {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        part
    });
    reporter.finish();
    let wall = watch.wall().as_secs_f64();
    Some(Pilot {
        resolution: job.resolution,
        passes: part.passes(),
        seconds: part.seconds(),
        busy: if wall > 0.0 {
            watch.cpu_seconds() / wall
        } else {
            1.0
        },
        stated: stated?,
        forecast,
    })
}

impl Pilot {
    /// The price list for people.
    fn words(&self, name: &str, prices: &[(f64, Price)]) -> String {
        let [width, height] = self.resolution;
        let [error, bound] = [self.stated.error, self.stated.bound].map(outlook::percent);
        let mut text = format!(
            "{name}, {width} x {height} pixels\nafter {} passes in {}: error {error} %, at most {bound} % at 90 %\n\n",
            self.passes,
            span(self.seconds)
        );
        let head = ["error", "passes", "time", "processor time"].map(str::to_owned);
        let rows: Vec<[String; 4]> = std::iter::once(head)
            .chain(
                prices
                    .iter()
                    .map(|(target, price)| self.row(*target, price)),
            )
            .collect();
        let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
        let widths: [usize; 4] = std::array::from_fn(width);
        for row in &rows {
            let cells = row.iter().zip(widths).enumerate();
            let cells = cells.map(|(k, (cell, width))| match k {
                0 => format!("{cell:>width$}"),
                _ => format!("{cell:width$}"),
            });
            text += cells.collect::<Vec<_>>().join("   ").trim_end();
            text += "\n";
        }
        text += "(in brackets: between which two it lies with a probability of 90 %)";
        text
    }

    fn row(&self, target: f64, price: &Price) -> [String; 4] {
        let rest = match price {
            Price::Held => ["held already", "", ""].map(str::to_owned),
            Price::Passes { passes, seconds } => [
                interval(passes, count),
                interval(seconds, span),
                interval(&self.processor(seconds), span),
            ],
            Price::Beyond { passes, seconds } => [
                format!("more than {}", count(*passes)),
                format!("more than {}", span(*seconds)),
                "too far to tell".to_owned(),
            ],
        };
        let [a, b, c] = rest;
        [format!("{} %", outlook::percent(target)), a, b, c]
    }

    /// Processor time for wall time.
    fn processor(&self, seconds: &Interval) -> Interval {
        Interval {
            middle: self.busy * seconds.middle,
            low: self.busy * seconds.low,
            high: seconds.high.map(|high| self.busy * high),
        }
    }

    fn json(&self, name: &str, prices: &[(f64, Price)]) -> Value {
        let price = |(target, price): &(f64, Price)| {
            let mut value = match price {
                Price::Held => json!({ "state": "held" }),
                Price::Passes { passes, seconds } => json!({
                    "state": "predicted",
                    "passes": passes,
                    "seconds": seconds,
                    "cpu_seconds": self.processor(seconds),
                }),
                Price::Beyond { passes, seconds } => json!({
                    "state": "beyond",
                    "more_than_passes": passes,
                    "more_than_seconds": seconds,
                }),
            };
            value["error"] = json!(target);
            value
        };
        json!({
            "scene": name,
            "ok": true,
            "resolution": self.resolution,
            "pilot": {
                "passes": self.passes,
                "seconds": self.seconds,
                "cpu_seconds": self.busy * self.seconds,
                "error": self.stated,
            },
            "prices": prices.iter().map(price).collect::<Vec<_>>(),
        })
    }
}

/// The middle, and in brackets the ends.
fn interval(of: &Interval, show: fn(f64) -> String) -> String {
    let [low, middle] = [of.low, of.middle].map(show);
    match of.high {
        Some(high) => format!("{middle} ({low} to {})", show(high)),
        None => format!("{middle} ({low} or more)"),
    }
}

fn count(passes: f64) -> String {
    format!("{passes:.0}")
}

/// A length of time, to a tenth of a second where it is short.
fn span(seconds: f64) -> String {
    if seconds < 9.95 {
        format!("{seconds:.1}s")
    } else {
        clock(outlook::length(seconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_in_words() {
        let of = |high| Interval {
            middle: 32.0,
            low: 8.0,
            high,
        };
        assert_eq!(interval(&of(Some(100.0)), count), "32 (8 to 100)");
        assert_eq!(interval(&of(None), span), "32s (8.0s or more)");
        assert_eq!(span(f64::INFINITY), span(1e300), "no panic");
    }
}

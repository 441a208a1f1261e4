//! Who makes the reference: short trials of all methods that could.
//!
//! No method is the best for all scenes: paths from the eye hardly ever meet a
//! small lamp through glass, photons leak through thin walls. So each candidate
//! renders eight passes of eight seeds, and what it would reach in the same work
//! is predicted from its spread and its blur. The choice depends on scene,
//! settings and seeds alone: work is counted in passes, each with a fixed price.

use crate::{film::Image, reference::Method, spectrum::Rgb};

use super::{
    fault::Fault,
    making::{FIRST_STAGE, SEEDS, has_blur, settings_of},
    request::{Event, Subject, Watch, Way},
    run::{Prepared, question},
    sight::Sight,
    split::{blur, mean, variance},
    store::{Store, record_name},
    truth::{Layers, joined},
};

/// Added to the numbers of a reference's seeds: a choice must not depend on how
/// far the reference was when a study was interrupted.
const OTHER_SEEDS: u64 = 1 << 32;

/// Work for which errors are predicted, in passes of path tracing for each seed.
const HORIZON: f64 = 4096.0;

/// A candidate that misses more of the light than this, which another one
/// surely finds, is blind for some of it.
const MISSING: f64 = 0.1;
/// Standard errors by which that has to be sure.
const SURELY: f64 = 4.0;

/// What a trial has shown.
#[derive(Clone, Copy, Debug)]
struct Trial {
    /// Relative variance of the mean of all seeds.
    variance: f64,
    /// Bound on the square of its relative blur.
    blur: f64,
    /// The light of its picture.
    light: Brightness,
}

/// Mean of pictures over pixels and channels, and its standard error.
#[derive(Clone, Copy, Debug)]
struct Brightness {
    mean: f64,
    error: f64,
}

impl Brightness {
    fn of(pictures: &[Image]) -> Self {
        let means: Vec<f64> = pictures.iter().map(|p| p.mean().mean()).collect();
        let n = means.len() as f64;
        let mean = means.iter().sum::<f64>() / n;
        let squares: f64 = means.iter().map(|m| (m - mean) * (m - mean)).sum();
        Self {
            mean,
            error: libm::sqrt(squares / (n * (n - 1.0))),
        }
    }
}

impl Trial {
    /// The square of the error that is expected after work of [`HORIZON`].
    fn expected(&self, method: Method) -> f64 {
        let growth = HORIZON / work(method) / f64::from(FIRST_STAGE);
        if has_blur(method) {
            // Squared radii fall like n^(-1/3), and with them blur; the
            // variance of what is found in them like 1 / (n r^2).
            (self.variance + self.blur) / libm::pow(growth, 2.0 / 3.0)
        } else {
            self.variance / growth
        }
    }

    /// Whether it misses light that `other` finds.
    fn misses(&self, other: &Self) -> bool {
        let error = libm::hypot(self.light.error, other.light.error);
        other.light.mean - self.light.mean > SURELY * error + MISSING * other.light.mean
    }
}

/// Processor time of a pass, with all that a reference needs beside it, over
/// that of path tracing: geometric means of five scenes (`cup`, `glass_sphere`,
/// `cornell_glass`, `pool`, `tumbler`).
fn work(method: Method) -> f64 {
    match method {
        Method::Light => 0.7,
        Method::Bdpt => 2.0,
        Method::Metropolis => 3.5,
        // Two sets of runs.
        Method::Sppm => 2.4,
        _ => 1.0,
    }
}

/// The best of the candidates, which all see the same; the first of equals.
pub(super) fn choose(
    subject: &Subject<'_>,
    candidates: &[(Method, Sight)],
    size: [u32; 2],
    store: &Store,
    watch: &mut Watch<'_>,
) -> Result<(Method, Sight), Fault> {
    if let [only] = candidates {
        return Ok(only.clone());
    }
    let way = Way::Reference(candidates[0].0);
    let names: Vec<&str> = candidates.iter().map(|(method, _)| method.name()).collect();
    let key = format!(
        "choice; {}; layers {:?}; {}",
        names.join(" "),
        candidates[0].1.layers(),
        question(subject, way, &subject.scene.settings, size)
    );
    let name = record_name(&format!("{} choice", subject.name), &key);
    if let Some((chosen, _)) = store.read::<String>(&name, &key)
        && let Some(known) = candidates.iter().find(|(m, _)| m.name() == chosen)
    {
        return Ok(known.clone());
    }
    let mut runs = Vec::new();
    for (method, sight) in candidates {
        runs.push(pictures(subject, *method, sight, size, watch)?);
    }
    let trials = compared(candidates, &runs);
    let best = best_of(&trials);
    let expected = trials.iter().map(|(method, trial)| {
        let blind = trials.iter().any(|(_, other)| trial.misses(other));
        let error = 100.0 * libm::sqrt(trial.expected(*method));
        let flaw = if blind { ", misses light" } else { "" };
        format!("{} {error:.2} %{flaw}", method.name())
    });
    let _ = watch(&Event::Note(format!(
        "{}: reference by {}; errors expected after equal work: {}",
        subject.name,
        candidates[best].0.name(),
        expected.collect::<Vec<_>>().join("; ")
    )));
    store.write(&name, &key, &candidates[best].0.name(), &[])?;
    Ok(candidates[best].clone())
}

/// What the pictures of all candidates show. All are relative to the picture
/// whose light is surest: a spark in a picture of its own would hide itself.
fn compared(candidates: &[(Method, Sight)], runs: &[[Vec<Image>; 2]]) -> Vec<(Method, Trial)> {
    let doubt = |[own, _]: &&[Vec<Image>; 2]| {
        let light = Brightness::of(own);
        light.error / light.mean.max(f64::MIN_POSITIVE)
    };
    let surest = runs.iter().min_by(|a, b| doubt(a).total_cmp(&doubt(b)));
    let truth = surest.and_then(|[own, _]| mean(own));
    let trials = candidates
        .iter()
        .zip(runs)
        .map(|((method, _), [own, wide])| {
            let single = truth.as_ref().and_then(|t| variance(own, t));
            let trial = Trial {
                variance: single.unwrap_or(f64::INFINITY) / f64::from(SEEDS),
                blur: truth
                    .as_ref()
                    .and_then(|t| blur(own, wide, t))
                    .unwrap_or(0.0),
                light: Brightness::of(own),
            };
            (*method, trial)
        });
    trials.collect()
}

/// The number of the best trial.
fn best_of(trials: &[(Method, Trial)]) -> usize {
    let is_blind = |trial: &Trial| trials.iter().any(|(_, other)| trial.misses(other));
    let rank = |i: &usize| {
        let (method, trial) = &trials[*i];
        (is_blind(trial), trial.expected(*method))
    };
    let order = |a: &usize, b: &usize| {
        let ((blind_a, error_a), (blind_b, error_b)) = (rank(a), rank(b));
        blind_a.cmp(&blind_b).then(error_a.total_cmp(&error_b))
    };
    (0..trials.len()).min_by(order).unwrap_or(0)
}

/// What a method shows in its trial: the pictures of all seeds and, where it
/// has blur, as many with circles of twice the width.
fn pictures(
    subject: &Subject<'_>,
    method: Method,
    sight: &Sight,
    size: [u32; 2],
    watch: &mut Watch<'_>,
) -> Result<[Vec<Image>; 2], Fault> {
    let sets = if has_blur(method) { 2 } else { 1 };
    let mut own = Vec::new();
    for index in 0..sets * SEEDS {
        let layers = run(subject, method, index, size, watch)?;
        own.push(joined(&layers, sight));
    }
    let wide = own.split_off(SEEDS as usize);
    Ok([own, wide])
}

/// The layers of one run of a trial.
fn run(
    subject: &Subject<'_>,
    method: Method,
    index: u32,
    [width, height]: [u32; 2],
    watch: &mut Watch<'_>,
) -> Result<Layers, Fault> {
    let mut settings = settings_of(index, &subject.scene.settings);
    settings.seed -= OTHER_SEEDS;
    let way = Way::Reference(method);
    let prepared = Prepared::new(way, subject.scene, &settings, [width, height])?;
    let mut sums: Layers =
        std::array::from_fn(|_| Image::from_fn(width, height, |_, _| Rgb::BLACK));
    for (pass, samples) in (0..FIRST_STAGE).zip(prepared.passes(0)) {
        let passes = f64::from(FIRST_STAGE);
        for (layer, sum) in sums.iter_mut().enumerate() {
            let pixels = sum.pixels().iter().zip(&samples).map(|(&sum, sample)| {
                // One that is not finite counts as black, as on a film.
                if sample.total().is_finite() {
                    sum + sample.layers[layer] / passes
                } else {
                    sum
                }
            });
            *sum = Image::new(width, height, pixels.collect());
        }
        let flow = watch(&Event::Working {
            scene: subject.name.clone(),
            task: format!(
                "trial of {} for the reference, run {}",
                method.name(),
                index + 1
            ),
            passes: pass + 1,
            elapsed: std::time::Duration::ZERO,
            limit: None,
        });
        if flow.is_break() {
            return Err(Fault::Interrupted);
        }
    }
    Ok(sums)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(variance: f64, blur: f64, light: f64) -> Trial {
        Trial {
            variance,
            blur,
            light: Brightness {
                mean: light,
                error: 0.01,
            },
        }
    }

    /// A spark that is in one of the pictures only is measured by those of a
    /// method that is sure of its light.
    #[test]
    fn sparks_do_not_hide_themselves() {
        let picture = |seed: usize, spark: f64, noise: f64| {
            Image::from_fn(8, 8, |x, y| {
                let is_spark = (x + 8 * y) as usize == 5 * seed;
                let sign = if seed.is_multiple_of(2) { 1.0 } else { -1.0 };
                let spark = if is_spark && seed == 3 { spark } else { 0.0 };
                Rgb::grey(1.0 + sign * noise + spark)
            })
        };
        let seeds = |spark, noise| (0..8).map(|i| picture(i, spark, noise)).collect();
        let candidates = [Method::Path, Method::Bdpt].map(|method| (method, Sight::whole()));
        let runs = [
            [seeds(6400.0, 0.0), Vec::new()],
            [seeds(0.0, 0.1), Vec::new()],
        ];
        let trials = compared(&candidates, &runs);
        assert!(trials[0].1.variance > 1e3, "{trials:?}");
        assert!(trials[1].1.variance < 0.002, "{trials:?}");
        assert_eq!(best_of(&trials), 1);
    }

    #[test]
    fn the_least_error_wins() {
        let bdpt = (Method::Bdpt, trial(0.1, 0.0, 1.0));
        let path = (Method::Path, trial(0.1, 0.0, 1.0));
        assert_eq!(best_of(&[bdpt, path]), 1, "the same in half the time");
        let noisy = (Method::Path, trial(0.3, 0.0, 1.0));
        assert_eq!(best_of(&[bdpt, noisy]), 0);
        // Light that it has not found makes no noise.
        let blind = (Method::Path, trial(0.001, 0.0, 0.7));
        assert_eq!(best_of(&[bdpt, blind]), 0);
        assert_eq!(best_of(&[blind, bdpt]), 1);
        // Photons find what paths hardly do, unless they blur too much.
        let rare = (Method::Bdpt, trial(50.0, 0.0, 1.0));
        let photons = (Method::Sppm, trial(0.1, 0.01, 1.0));
        assert_eq!(best_of(&[rare, photons]), 1);
        let blurred = (Method::Sppm, trial(0.001, 0.2, 1.0));
        assert_eq!(best_of(&[bdpt, blurred]), 0);
    }
}

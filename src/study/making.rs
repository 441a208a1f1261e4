//! References that a study makes itself.
//!
//! Eight seeds of a method go on in stages of doubling passes until their mean
//! is good enough. The spread of the seeds is its noise. A method that blurs has
//! eight more with circles of twice the width; see `split::blur`.

use std::{collections::HashMap, ops::ControlFlow, time::Duration};

use serde::{Deserialize, Serialize};

use crate::{
    film::{Image, Layer},
    reference::Method,
    scene::Settings,
    spectrum::Rgb,
};

use super::{
    clock::Stopwatch,
    fault::Fault,
    record::{Truth, TruthKind},
    request::{Event, Request, Subject, Watch, Way},
    run::{Prepared, in_single, question},
    sight::{Sight, blind_spots},
    store::{Store, record_name},
    truth::{Knowledge, Known, Layers},
};

/// Independent runs of a reference: seven degrees of freedom for its error.
pub(super) const SEEDS: u32 = 8;

/// Passes of the first stage of a reference, for each seed.
pub(super) const FIRST_STAGE: u32 = 8;

/// Fewest passes of each seed with which a reference may be good enough: with
/// fewer, what is rare may not have been met at all.
const FEWEST: u32 = 64;

/// How far a seed of a reference is.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
struct Effort {
    passes: u32,
    wall_seconds: f64,
    cpu_seconds: f64,
}

/// One seed of a reference.
struct Seed<'a> {
    prepared: Prepared<'a>,
    effort: Effort,
    /// Means over the passes, in single precision as they are kept.
    layers: Layers,
    name: String,
    key: String,
}

impl Seed<'_> {
    /// Goes on to `target` passes and keeps what it has then.
    fn advance(
        &mut self,
        target: u32,
        store: &Store,
        told: &mut dyn FnMut(u32, Duration) -> ControlFlow<()>,
    ) -> Result<(), Fault> {
        let done = self.effort.passes;
        if done >= target {
            return Ok(());
        }
        let mut clock = Stopwatch::default();
        let mut sums = self.layers.each_ref().map(|image| {
            let pixels = image.pixels().iter().map(|&p| p * f64::from(done));
            pixels.collect::<Vec<Rgb>>()
        });
        let mut passes = clock.time(|| self.prepared.passes(done));
        for pass in done..target {
            clock.time(|| {
                let samples = passes.next().unwrap_or_default();
                for (i, sample) in samples.iter().enumerate() {
                    // One that is not finite counts as black, as on a film.
                    if sample.total().is_finite() {
                        for (sum, &value) in sums.iter_mut().zip(&sample.layers) {
                            sum[i] += value;
                        }
                    }
                }
            });
            if told(pass + 1, clock.wall()).is_break() {
                return Err(Fault::Interrupted);
            }
        }
        drop(passes);
        let [width, height] = [self.layers[0].width(), self.layers[0].height()];
        self.layers = sums.map(|sum| {
            let pixels = sum.into_iter().map(|s| s / f64::from(target));
            in_single(&Image::new(width, height, pixels.collect()))
        });
        self.effort = Effort {
            passes: target,
            wall_seconds: self.effort.wall_seconds + clock.wall().as_secs_f64(),
            cpu_seconds: self.effort.cpu_seconds + clock.cpu_seconds(),
        };
        let named = Layer::ALL.map(|layer| (layer.name(), &self.layers[layer as usize]));
        store.write(&self.name, &self.key, &self.effort, &named)?;
        Ok(())
    }
}

/// Whether the pictures of the method are blurred by circles that the settings'
/// radius begins with.
pub(super) fn has_blur(method: Method) -> bool {
    method == Method::Sppm
}

/// The settings of the seed `index` of a reference, numbered from the other
/// end than those of the runs that are judged; where there are two sets, the
/// second has circles of twice the width.
pub(super) fn settings_of(index: u32, settings: &Settings) -> Settings {
    let width = if index < SEEDS { 1.0 } else { 2.0 };
    Settings {
        seed: u64::MAX - u64::from(index),
        radius: width * settings.radius,
        ..settings.clone()
    }
}

/// Makes a reference: eight seeds of `method`, in stages of doubling passes,
/// until `is_enough` says so of it or the time that was asked for is up.
pub(super) fn make(
    subject: &Subject<'_>,
    (method, sight): (Method, &Sight),
    request: &Request,
    size: [u32; 2],
    store: &Store,
    is_enough: &dyn Fn(&Known) -> bool,
    watch: &mut Watch<'_>,
) -> Result<Known, Fault> {
    let sets = if has_blur(method) { 2 } else { 1 };
    let seeds: Result<Vec<Seed<'_>>, Fault> = (0..sets * SEEDS)
        .map(|i| seed(subject, method, i, size, store))
        .collect();
    let mut seeds = seeds?;
    let limit = request.reference_time.as_secs_f64();
    loop {
        let passes = seeds.iter().map(|s| s.effort.passes);
        let (least, most) = (passes.clone().min(), passes.max());
        let (least, most) = (least.unwrap_or(0), most.unwrap_or(0));
        // A stage that was interrupted comes to its end first.
        if least < most || most == 0 {
            let target = most.max(FIRST_STAGE);
            stage_of(subject, method, target, &mut seeds, store, request, watch)?;
            continue;
        }
        let known = known(subject, method, sight, &seeds);
        let error = known.record.error.unwrap_or(0.0);
        let _ = watch(&Event::Note(format!(
            "{}: reference by {}: error {:.2} % after {least} passes of {SEEDS} seeds",
            subject.name,
            method.name(),
            100.0 * error
        )));
        if least >= FEWEST && is_enough(&known) {
            return Ok(known);
        }
        // Another stage of as many passes, or of as many as time allows; one
        // that brings next to nothing is not worth its time.
        let spent: f64 = seeds.iter().map(|s| s.effort.wall_seconds).sum();
        let room = ((limit - spent) * f64::from(least) / spent.max(1e-9)) as u32;
        let stage = least.min(room);
        if stage < least.div_ceil(8) || least > u32::MAX / 2 {
            return Ok(known);
        }
        let target = least + stage;
        stage_of(subject, method, target, &mut seeds, store, request, watch)?;
    }
}

/// Takes all seeds to `target` passes.
fn stage_of(
    subject: &Subject<'_>,
    method: Method,
    target: u32,
    seeds: &mut [Seed<'_>],
    store: &Store,
    request: &Request,
    watch: &mut Watch<'_>,
) -> Result<(), Fault> {
    let spent = |seeds: &[Seed<'_>]| seeds.iter().map(|s| s.effort.wall_seconds).sum::<f64>();
    for i in 0..seeds.len() {
        let before = Duration::from_secs_f64(spent(seeds));
        let task = format!(
            "reference by {}, run {} of {}",
            method.name(),
            i + 1,
            seeds.len()
        );
        seeds[i].advance(target, store, &mut |passes, elapsed| {
            watch(&Event::Working {
                scene: subject.name.clone(),
                task: task.clone(),
                passes,
                elapsed: before + elapsed,
                limit: Some(request.reference_time),
            })
        })?;
    }
    Ok(())
}

/// A seed of a reference where it was left, or at its beginning.
fn seed<'a>(
    subject: &Subject<'a>,
    method: Method,
    index: u32,
    size: [u32; 2],
    store: &Store,
) -> Result<Seed<'a>, Fault> {
    let settings = settings_of(index, &subject.scene.settings);
    let way = Way::Reference(method);
    let key = format!("reference; {}", question(subject, way, &settings, size));
    let words = format!("{} reference {} {index}", subject.name, method.name());
    let name = record_name(&words, &key);
    let kept = store.read::<Effort>(&name, &key);
    let kept = kept.and_then(|(effort, pictures)| {
        let mut found: HashMap<String, Image> = pictures.into_iter().collect();
        let mut take = |layer: Layer| found.remove(layer.name());
        let [a, b, c, d] = Layer::ALL.map(&mut take);
        Some((effort, [a?, b?, c?, d?]))
    });
    let (effort, layers) = kept.unwrap_or_else(|| {
        let black = Image::from_fn(size[0], size[1], |_, _| Rgb::BLACK);
        (Effort::default(), std::array::from_fn(|_| black.clone()))
    });
    Ok(Seed {
        prepared: Prepared::new(way, subject.scene, &settings, size)?,
        effort,
        layers,
        name,
        key,
    })
}

fn known(subject: &Subject<'_>, method: Method, sight: &Sight, seeds: &[Seed<'_>]) -> Known {
    let passes = seeds.iter().map(|s| s.effort.passes).min().unwrap_or(0);
    let (own, wide) = seeds.split_at(SEEDS as usize);
    let layers = |seeds: &[Seed<'_>]| seeds.iter().map(|s| s.layers.clone()).collect();
    let knowledge = Knowledge::Seeds {
        own: layers(own),
        wide: layers(wide),
    };
    let mut known = Known {
        record: Truth {
            kind: TruthKind::Made,
            words: String::new(),
            method: Some(method.name().to_owned()),
            seeds: SEEDS,
            passes,
            error: None,
            cpu_seconds: Some(seeds.iter().map(|s| s.effort.cpu_seconds).sum()),
            picture: None,
        },
        knowledge,
    };
    let yardstick = known.yardstick(sight);
    let error = yardstick.error();
    known.record.error = Some(error);
    let measure = if has_blur(method) {
        format!(
            "by their spread its noise is {:.2} %, by as many runs with circles of twice the width \
             its blur at most {:.2} %",
            100.0 * libm::sqrt(yardstick.variance),
            100.0 * libm::sqrt(yardstick.blur)
        )
    } else {
        format!("by their spread its own error is {:.2} %", 100.0 * error)
    };
    known.record.words = format!(
        "The mean of {SEEDS} independent runs of method {} with {passes} passes each; {measure}.",
        method.name(),
    );
    if sight.is_whole() && !has_blur(method) {
        // Of what it does see.
        for flaw in blind_spots(Way::Reference(method), subject.scene) {
            let more = format!(" The spread does not show this: {flaw}.");
            known.record.words.push_str(&more);
        }
    }
    if !yardstick.is_settled() {
        known.record.words.push_str(
            " Most of that is due to single bright paths, which are too rare for a sure statement: \
             it may be worse, and what differs from it need not be an error.",
        );
    }
    if !sight.is_whole() {
        known.record.words.push_str(&format!(
            " No method sees all light of this scene: only the layers {} are judged.",
            sight.names().join(", ")
        ));
    }
    known
}

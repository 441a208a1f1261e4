//! What pictures are judged by.

use std::{collections::HashMap, ops::ControlFlow, path::Path, time::Duration};

use serde::{Deserialize, Serialize};

use crate::{
    film::{Image, Layer, read_exr_layers},
    reference::Method,
    scene::Settings,
    spectrum::Rgb,
};

use super::{
    clock::Stopwatch,
    fault::Fault,
    record::{Truth, TruthKind},
    request::{Event, Request, Source, Subject, Watch, Way},
    run::{Prepared, in_single, question, sum},
    sight::{Sight, blind_spots},
    split::{lone_share, mean, variance},
    store::{Store, record_name},
};

/// Independent runs of a reference: seven degrees of freedom for its error.
const SEEDS: u32 = 8;

/// Passes of the first stage of a reference, for each seed.
const FIRST_STAGE: u32 = 8;

/// Fewest passes of each seed with which a reference may be good enough: with
/// fewer, what is rare may not have been met at all.
const FEWEST: u32 = 64;

/// The most that single runs may contribute to the variance of a reference
/// whose spread can be believed; half-way from normal noise to rare paths.
const MOST_ALONE: f64 = 0.65;

/// How many times smaller than what it judges the error of a reference has to
/// be. Its share in what is measured is then at most a ninth in the square,
/// and that is taken off, too.
pub(super) const MARGIN: f64 = 3.0;

/// Four layers, in the order of [`Layer::ALL`].
type Layers = [Image; 4];

/// What is known about a scene's picture.
enum Knowledge {
    /// The picture alone.
    Picture(Image),
    /// Its layers.
    Layers(Box<Layers>),
    /// Layers by independent seeds, whose mean it is.
    Seeds(Vec<Layers>),
}

/// A truth, ready to judge.
pub(super) struct Known {
    /// What is said of it; without its picture.
    pub(super) record: Truth,
    knowledge: Knowledge,
}

/// What one curve is judged by.
#[derive(Clone, Debug)]
pub(super) struct Yardstick {
    /// The picture.
    pub(super) picture: Image,
    /// Its own relative variance; 0 where none is known.
    pub(super) variance: f64,
    /// The part of it that comes from single runs; see [`lone_share`].
    lone: f64,
}

impl Yardstick {
    /// Whether it can judge a picture at that relMSE: the error without its
    /// own share is at least three times its own.
    pub(super) fn can_judge(&self, relmse: f64) -> bool {
        relmse - self.variance >= MARGIN * MARGIN * self.variance
    }

    /// Whether its variance can be believed: it is not made by rare paths, of
    /// which there may be more that nobody has found.
    pub(super) fn is_settled(&self) -> bool {
        self.lone <= MOST_ALONE
    }
}

impl Known {
    /// What pictures of these layers are judged by.
    pub(super) fn yardstick(&self, sight: &Sight) -> Yardstick {
        let exact = |picture| Yardstick {
            picture,
            variance: 0.0,
            lone: 0.0,
        };
        match &self.knowledge {
            Knowledge::Picture(picture) => exact(picture.clone()),
            Knowledge::Layers(layers) => exact(joined(layers, sight)),
            Knowledge::Seeds(seeds) => {
                let seeds: Vec<Image> = seeds.iter().map(|s| joined(s, sight)).collect();
                let picture = mean(&seeds).unwrap_or_else(|| seeds[0].clone());
                let single = variance(&seeds, &picture).unwrap_or(0.0);
                Yardstick {
                    variance: single / seeds.len() as f64,
                    lone: lone_share(&seeds, &picture).unwrap_or(0.0),
                    picture,
                }
            }
        }
    }

    /// A truth that needs no render: a formula or a picture.
    ///
    /// # Errors
    /// [`Fault::Invalid`] for a picture that is missing, has another size, is
    /// not finite or black.
    pub(super) fn given(
        subject: &Subject<'_>,
        [width, height]: [u32; 2],
    ) -> Result<Option<Self>, Fault> {
        let (kind, words, knowledge) = match subject.truth {
            Source::Make => return Ok(None),
            Source::ClosedForm { words, radiance } => {
                let layer =
                    |layer: Layer| Image::from_fn(width, height, |x, y| radiance(x, y)[layer]);
                let layers = Box::new(Layer::ALL.map(layer));
                (
                    TruthKind::ClosedForm,
                    words.to_owned(),
                    Knowledge::Layers(layers),
                )
            }
            Source::Given(path) => {
                let name = path.file_name().unwrap_or(path.as_os_str()).display();
                let words =
                    format!("A picture that was given, {name}; its own error is not known.");
                (TruthKind::Given, words, read(path, [width, height])?)
            }
        };
        let record = Truth {
            kind,
            words,
            method: None,
            seeds: 0,
            passes: 0,
            error: None,
            cpu_seconds: None,
            picture: None,
        };
        let known = Self { record, knowledge };
        let light = known.yardstick(&Sight::whole()).picture.mean();
        if !(light.is_finite() && light.mean() > 0.0) {
            return Err(Fault::Invalid(format!(
                "{}: the truth is black or not finite; there is nothing to be judged by",
                subject.name
            )));
        }
        Ok(Some(known))
    }
}

/// The sum of the layers that are seen.
fn joined(layers: &Layers, sight: &Sight) -> Image {
    let seen = sight.layers().iter().map(|&l| layers[l as usize].clone());
    seen.reduce(|a, b| sum(&a, &b))
        .unwrap_or_else(|| Image::from_fn(layers[0].width(), layers[0].height(), |_, _| Rgb::BLACK))
}

/// The picture and, if it has them all, the layers of a file.
fn read(path: &Path, size: [u32; 2]) -> Result<Knowledge, Fault> {
    let refuse = |what: String| Fault::Invalid(format!("{}: {what}", path.display()));
    let mut found: HashMap<String, Image> = read_exr_layers(path)
        .map_err(|e| Fault::Invalid(e.to_string()))?
        .into_iter()
        .collect();
    let Some(picture) = found.remove("") else {
        return Err(refuse("it has no channels R, G, B".to_owned()));
    };
    if [picture.width(), picture.height()] != size {
        let [width, height] = size;
        return Err(refuse(format!(
            "it has {} x {} pixels and the study {width} x {height}; render it in that size or use --resolution",
            picture.width(),
            picture.height()
        )));
    }
    let layers = Layer::ALL.map(|layer| found.remove(layer.name()));
    let fits = |image: &Image| [image.width(), image.height()] == size;
    let is_finite = |image: &Image| image.pixels().iter().all(|p| p.is_finite());
    if !is_finite(&picture) || !layers.iter().flatten().all(is_finite) {
        return Err(refuse("it has pixels that are not finite".to_owned()));
    }
    Ok(match layers {
        [Some(a), Some(b), Some(c), Some(d)] if [&a, &b, &c, &d].into_iter().all(fits) => {
            Knowledge::Layers(Box::new([a, b, c, d]))
        }
        _ => Knowledge::Picture(picture),
    })
}

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
    let seeds: Result<Vec<Seed<'_>>, Fault> = (0..SEEDS)
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
        let task = format!("reference by {}, seed {} of {SEEDS}", method.name(), i + 1);
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
    // From the other end than those of the runs that are judged.
    let settings = Settings {
        seed: u64::MAX - u64::from(index),
        ..subject.scene.settings.clone()
    };
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
    let knowledge = Knowledge::Seeds(seeds.iter().map(|s| s.layers.clone()).collect());
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
    let error = yardstick.variance.sqrt();
    known.record.error = Some(error);
    known.record.words = format!(
        "The mean of {SEEDS} independent runs of method {} with {passes} passes each; \
         by their spread its own error is {:.2} %.",
        method.name(),
        100.0 * error
    );
    if sight.is_whole() {
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

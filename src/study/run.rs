//! One run: passes of one method with one seed, and pictures after 1, 2, 4,
//! 8, ... of them.

use std::{ops::ControlFlow, time::Duration};

use serde::{Deserialize, Serialize};

use crate::{
    film::{Film, Image, PixelSample},
    metrics::relative_noise,
    plan::film_quantum,
    reference::Reference,
    render::Renderer,
    scene::{Scene, Settings},
};

use super::{
    clock::Stopwatch,
    curves::Curve,
    fault::Fault,
    record::FORMAT,
    request::{Event, Request, Subject, Watch, Way},
    sight::Sight,
    store::{Pictures, Store, record_name},
};

/// The passes of a way.
pub(super) enum Passes<'a> {
    Photons(Box<Renderer<'a>>),
    Reference(Box<Reference<'a>>),
}

impl<'a> Passes<'a> {
    pub(super) fn new(
        way: Way,
        scene: &'a Scene,
        settings: &Settings,
        resolution: [u32; 2],
    ) -> Self {
        let [width, height] = resolution;
        let whole = [0, 0, width, height];
        match way {
            Way::Photons => {
                Self::Photons(Box::new(Renderer::new(scene, settings, resolution, whole)))
            }
            Way::Reference(method) => Self::Reference(Box::new(Reference::new(
                scene, settings, method, resolution, whole,
            ))),
        }
    }

    pub(super) fn pass(&self, index: u32) -> Vec<PixelSample> {
        match self {
            Self::Photons(renderer) => renderer.pass(index).samples,
            Self::Reference(reference) => reference.pass(index),
        }
    }
}

/// A look at a run.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Snapshot {
    pub(super) passes: u32,
    pub(super) wall_seconds: f64,
    pub(super) cpu_seconds: f64,
    /// The noise that the picture states; only of whole pictures.
    pub(super) stated: Option<f64>,
}

impl Snapshot {
    /// The name of its picture.
    pub(super) fn picture(self) -> String {
        format!("passes{}", self.passes)
    }
}

/// A finished run, as far as it is in memory.
pub(super) struct Finished {
    pub(super) seed: u64,
    pub(super) snapshots: Vec<Snapshot>,
    /// The picture of the last of them.
    pub(super) last: Image,
    name: String,
    key: String,
}

impl Finished {
    /// All its pictures, in the order of the snapshots.
    ///
    /// # Errors
    /// [`Fault::Invalid`] if somebody has taken the file away since.
    pub(super) fn pictures(&self, store: &Store) -> Result<Vec<Image>, Fault> {
        let kept = store.read::<Vec<Snapshot>>(&self.name, &self.key);
        let pictures = kept.and_then(|(_, pictures)| in_order(&self.snapshots, pictures));
        pictures.ok_or_else(|| {
            Fault::Invalid(format!(
                "the pictures of {} have changed or gone while the study was at work",
                self.name
            ))
        })
    }
}

/// When a run ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum Until {
    /// Passes double while twice the wall time so far fits into the time, up
    /// to a number of passes.
    Time(Option<Duration>, u32),
    /// After exactly so many.
    Passes(u32),
}

/// What every question about a render names.
pub(super) fn question(
    subject: &Subject<'_>,
    way: Way,
    settings: &Settings,
    size: [u32; 2],
) -> String {
    let settings = Settings {
        passes: 0,
        exposure: None,
        ..settings.clone()
    };
    format!(
        "format {FORMAT}; nephroid {}; scene {} {}; {} x {}; {}; {settings:?}",
        env!("CARGO_PKG_VERSION"),
        subject.name,
        subject.print,
        size[0],
        size[1],
        way.name(),
    )
}

/// The runs of a curve, one for each seed: those that were kept, and the rest
/// made now. The first decides how many passes all of them have.
pub(super) fn runs(
    subject: &Subject<'_>,
    curve: &Curve,
    request: &Request,
    resolution: [u32; 2],
    store: &Store,
    watch: &mut Watch<'_>,
) -> Result<Vec<Finished>, Fault> {
    let share = request.time.map(|time| time / request.seeds);
    let mut until = Until::Time(share, request.passes.unwrap_or(u32::MAX));
    let mut runs: Vec<Finished> = Vec::new();
    for i in 0..request.seeds {
        let settings = Settings {
            seed: curve.settings.seed.wrapping_add(i.into()),
            ..curve.settings.clone()
        };
        let question = question(subject, curve.way, &settings, resolution);
        let key = format!("{question}; layers {:?}; {until:?}", curve.sight.layers());
        let words = format!(
            "{} {} seed {}",
            subject.name,
            curve.way.name(),
            settings.seed
        );
        let name = record_name(&words, &key);
        let kept = store.read::<Vec<Snapshot>>(&name, &key);
        let kept = kept.and_then(|(snapshots, pictures)| {
            let last = in_order(&snapshots, pictures)?.pop()?;
            Some((snapshots, last))
        });
        let (snapshots, last) = match kept {
            Some(kept) => kept,
            None => {
                let task = format!("{}, seed {} of {}", curve.label, i + 1, request.seeds);
                let mut told = |passes, elapsed| {
                    watch(&Event::Working {
                        scene: subject.name.clone(),
                        task: task.clone(),
                        passes,
                        elapsed,
                        limit: share,
                    })
                };
                let passes = || Passes::new(curve.way, subject.scene, &settings, resolution);
                let (snapshots, pictures) = render(
                    subject.scene,
                    resolution,
                    passes,
                    &curve.sight,
                    until,
                    &mut told,
                )?;
                let names: Vec<String> = snapshots.iter().map(|s| s.picture()).collect();
                let named: Vec<(&str, &Image)> =
                    names.iter().map(String::as_str).zip(&pictures).collect();
                store.write(&name, &key, &snapshots, &named)?;
                // As it is read again: in single precision.
                let last = pictures.last().map(in_single).ok_or_else(|| {
                    Fault::Invalid(format!("{}: a run without passes", subject.name))
                })?;
                (snapshots, last)
            }
        };
        if let (Until::Time(..), Some(last)) = (until, snapshots.last()) {
            until = Until::Passes(last.passes);
        }
        runs.push(Finished {
            seed: settings.seed,
            snapshots,
            last,
            name,
            key,
        });
    }
    Ok(runs)
}

/// Renders until it is enough; what each look cost, and the pictures.
fn render<'a>(
    scene: &Scene,
    [width, height]: [u32; 2],
    passes: impl FnOnce() -> Passes<'a>,
    sight: &Sight,
    until: Until,
    told: &mut dyn FnMut(u32, Duration) -> ControlFlow<()>,
) -> Result<(Vec<Snapshot>, Vec<Image>), Fault> {
    let mut clock = Stopwatch::default();
    let passes = clock.time(passes);
    let mut film = Film::new(width, height, film_quantum(scene));
    let (mut snapshots, mut pictures) = (Vec::new(), Vec::new());
    for done in 1u32.. {
        clock.time(|| film.add_pass(done - 1, &passes.pass(done - 1)));
        let is_last = matches!(until, Until::Passes(n) if done >= n);
        if done.is_power_of_two() || is_last {
            let picture = judged(&film, sight);
            let noise = film.noise().filter(|_| sight.is_whole());
            snapshots.push(Snapshot {
                passes: done,
                wall_seconds: clock.wall().as_secs_f64(),
                cpu_seconds: clock.cpu_seconds(),
                stated: noise.map(|noise| relative_noise(&picture, &noise)),
            });
            pictures.push(picture);
            let is_enough = match until {
                Until::Passes(_) => is_last,
                Until::Time(time, most) => {
                    done > most / 2 || time.is_some_and(|time| 2 * clock.wall() > time)
                }
            };
            if is_enough {
                break;
            }
        }
        if told(done, clock.wall()).is_break() {
            return Err(Fault::Interrupted);
        }
    }
    Ok((snapshots, pictures))
}

/// What is judged of a film.
fn judged(film: &Film, sight: &Sight) -> Image {
    if sight.is_whole() {
        return film.image();
    }
    let layers = sight.layers().iter().map(|&layer| film.layer_image(layer));
    let sum = layers.reduce(|a, b| sum(&a, &b));
    sum.unwrap_or_else(|| film.image())
}

/// The sum of two pictures of one size.
pub(super) fn sum(a: &Image, b: &Image) -> Image {
    let pixels = a.pixels().iter().zip(b.pixels()).map(|(&a, &b)| a + b);
    Image::new(a.width(), a.height(), pixels.collect())
}

/// The picture as a file in single precision has it.
pub(super) fn in_single(image: &Image) -> Image {
    let pixels = image.pixels().iter();
    let rounded = pixels.map(|p| p.map(|c| f64::from(c as f32)));
    Image::new(image.width(), image.height(), rounded.collect())
}

/// The pictures of the snapshots among those of a file.
fn in_order(snapshots: &[Snapshot], mut pictures: Pictures) -> Option<Vec<Image>> {
    let mut take = |snapshot: &Snapshot| {
        let name = snapshot.picture();
        let at = pictures.iter().position(|(found, _)| *found == name)?;
        Some(pictures.swap_remove(at).1)
    };
    snapshots.iter().map(&mut take).collect()
}

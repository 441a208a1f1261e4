//! One run: passes of one method with one seed, and pictures after 1, 2, 4,
//! 8, ... of them.

use std::{ops::ControlFlow, time::Duration};

use serde::{Deserialize, Serialize};

use crate::{
    film::{Film, Image, PixelSample},
    metrics::relative_noise,
    plan::film_quantum,
    reference::{Method, Options, Reference},
    render::{Job, Renderer},
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

/// A way to a picture, ready for passes.
pub(super) enum Prepared<'a> {
    Photons(Box<Renderer<'a>>),
    Reference(Box<Reference<'a>>),
}

impl<'a> Prepared<'a> {
    /// # Errors
    /// [`Fault::Invalid`] if the method refuses the scene.
    pub(super) fn new(
        way: Way,
        scene: &'a Scene,
        settings: &Settings,
        resolution: [u32; 2],
    ) -> Result<Self, Fault> {
        let job = job(settings, resolution);
        Ok(match way {
            Way::Photons => {
                let renderer = Renderer::new(scene, settings, resolution, job.window());
                Self::Photons(Box::new(renderer))
            }
            Way::Reference(method) => {
                let reference = Reference::new(scene, &job, method, Options::default());
                let reference = reference.map_err(|e| Fault::Invalid(e.to_string()))?;
                Self::Reference(Box::new(reference))
            }
        })
    }

    /// The passes from pass `first` on, without end.
    pub(super) fn passes(&self, first: u32) -> Box<dyn Iterator<Item = Vec<PixelSample>> + '_> {
        match self {
            Self::Photons(renderer) => Box::new((first..).map(|i| renderer.pass(i).samples)),
            Self::Reference(reference) => Box::new(reference.passes_from(first)),
        }
    }
}

/// The render of a whole picture.
pub(super) fn job(settings: &Settings, resolution: [u32; 2]) -> Job {
    Job {
        settings: settings.clone(),
        first_pass: 0,
        resolution,
        crop: None,
        time: None,
        error: None,
    }
}

/// Whether a render gets better from pass to pass. The first photon map does
/// not: it is built for a number of passes.
pub(super) fn is_progressive(way: Way) -> bool {
    way != Way::Reference(Method::PhotonMap)
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

impl Until {
    /// Whether it is enough after `done` passes in the time `spent`, where as
    /// many again would take the time `next`.
    fn is_enough(self, done: u32, spent: Duration, next: Duration) -> bool {
        match self {
            Self::Passes(n) => done >= n,
            Self::Time(time, most) => {
                done > most / 2 || time.is_some_and(|time| spent + next > time)
            }
        }
    }
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
        let settings = &Settings {
            seed: curve.settings.seed.wrapping_add(i.into()),
            ..curve.settings.clone()
        };
        let question = question(subject, curve.way, settings, resolution);
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
                let task = Task {
                    way: curve.way,
                    scene: subject.scene,
                    settings,
                    resolution,
                    sight: &curve.sight,
                };
                let (snapshots, pictures) = task.render(until, &mut told)?;
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

/// What a run renders.
struct Task<'a> {
    way: Way,
    scene: &'a Scene,
    settings: &'a Settings,
    resolution: [u32; 2],
    sight: &'a Sight,
}

/// Is told how many passes are done and for how long; may break.
type Told<'a> = dyn FnMut(u32, Duration) -> ControlFlow<()> + 'a;

impl Task<'_> {
    /// Renders until it is enough; what each look cost, and the pictures.
    fn render(
        &self,
        until: Until,
        told: &mut Told<'_>,
    ) -> Result<(Vec<Snapshot>, Vec<Image>), Fault> {
        if is_progressive(self.way) {
            self.growing(until, told)
        } else {
            self.one_by_one(until, told)
        }
    }

    /// One render that is looked at on its way.
    fn growing(
        &self,
        until: Until,
        told: &mut Told<'_>,
    ) -> Result<(Vec<Snapshot>, Vec<Image>), Fault> {
        let mut clock = Stopwatch::default();
        let prepared = clock.time(|| self.prepare(self.settings))?;
        let mut passes = clock.time(|| prepared.passes(0));
        let mut film = self.film();
        let (mut snapshots, mut pictures) = (Vec::new(), Vec::new());
        for done in 1u32.. {
            clock.time(|| {
                if let Some(samples) = passes.next() {
                    film.add_pass(done - 1, &samples);
                }
            });
            let is_last = matches!(until, Until::Passes(n) if done >= n);
            if done.is_power_of_two() || is_last {
                let (snapshot, picture) = self.look(&film, done, &clock);
                snapshots.push(snapshot);
                pictures.push(picture);
                if until.is_enough(done, clock.wall(), clock.wall()) {
                    break;
                }
            }
            if told(done, clock.wall()).is_break() {
                return Err(Fault::Interrupted);
            }
        }
        Ok((snapshots, pictures))
    }

    /// A render for each number of passes.
    fn one_by_one(
        &self,
        until: Until,
        told: &mut Told<'_>,
    ) -> Result<(Vec<Snapshot>, Vec<Image>), Fault> {
        let (mut snapshots, mut pictures) = (Vec::new(), Vec::new());
        let mut before = Duration::ZERO;
        let mut wanted = 1u32;
        loop {
            let settings = Settings {
                passes: wanted,
                ..self.settings.clone()
            };
            let mut clock = Stopwatch::default();
            let prepared = clock.time(|| self.prepare(&settings))?;
            let mut passes = prepared.passes(0);
            let mut film = self.film();
            for pass in 0..wanted {
                clock.time(|| {
                    if let Some(samples) = passes.next() {
                        film.add_pass(pass, &samples);
                    }
                });
                if told(pass + 1, before + clock.wall()).is_break() {
                    return Err(Fault::Interrupted);
                }
            }
            let (snapshot, picture) = self.look(&film, wanted, &clock);
            snapshots.push(snapshot);
            pictures.push(picture);
            before += clock.wall();
            if until.is_enough(wanted, before, clock.wall() * 2) {
                return Ok((snapshots, pictures));
            }
            wanted *= 2;
        }
    }

    fn prepare(&self, settings: &Settings) -> Result<Prepared<'_>, Fault> {
        Prepared::new(self.way, self.scene, settings, self.resolution)
    }

    fn film(&self) -> Film {
        let [width, height] = self.resolution;
        Film::new(width, height, film_quantum(self.scene))
    }

    fn look(&self, film: &Film, passes: u32, clock: &Stopwatch) -> (Snapshot, Image) {
        let picture = judged(film, self.sight);
        let noise = film.noise().filter(|_| self.sight.is_whole());
        let snapshot = Snapshot {
            passes,
            wall_seconds: clock.wall().as_secs_f64(),
            cpu_seconds: clock.cpu_seconds(),
            stated: noise.map(|noise| relative_noise(&picture, &noise)),
        };
        (snapshot, picture)
    }
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

//! One run: passes of one method with one seed, and pictures after 1, 2, 4,
//! 8, ... of them.

use std::{ops::ControlFlow, time::Duration};

use serde::{Deserialize, Serialize};

use crate::{
    film::{Film, Image, PixelSample},
    metrics::relative_noise,
    plan::film_quantum,
    reference::{Memory, Options, Reference},
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

/// The passes of a way.
pub(super) enum Passes<'a> {
    Photons(Box<Renderer<'a>>),
    Reference(Box<(Reference<'a>, Memory)>),
}

impl<'a> Passes<'a> {
    pub(super) fn new(
        way: Way,
        scene: &'a Scene,
        settings: &Settings,
        resolution: [u32; 2],
    ) -> Result<Self, Fault> {
        let job = Job {
            settings: settings.clone(),
            resolution,
            ..Job::of(scene)
        };
        Ok(match way {
            Way::Photons => Self::Photons(Box::new(Renderer::new(
                scene,
                settings,
                resolution,
                job.window(),
            ))),
            Way::Reference(method) => {
                let reference = Reference::new(scene, &job, method, Options::default())
                    .map_err(|e| Fault::Invalid(e.to_string()))?;
                Self::Reference(Box::new((reference, Memory::default())))
            }
        })
    }

    /// Pass `index`; those of methods that remember in turn.
    pub(super) fn pass(&mut self, index: u32) -> Vec<PixelSample> {
        match self {
            Self::Photons(renderer) => renderer.pass(index).samples,
            Self::Reference(both) => {
                let (reference, memory) = both.as_mut();
                reference.pass(index, memory)
            }
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

impl Until {
    /// Whether a run ends after so many passes and so much wall time.
    fn is_enough(self, done: u32, wall: Duration) -> bool {
        match self {
            Self::Passes(n) => done >= n,
            Self::Time(time, most) => done > most / 2 || time.is_some_and(|time| 2 * wall > time),
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
                let work = Work {
                    scene: subject.scene,
                    way: curve.way,
                    settings: &settings,
                    resolution,
                    sight: &curve.sight,
                };
                let (snapshots, pictures) = work.render(until, &mut told)?;
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

/// What is rendered, and what of it is looked at.
struct Work<'a> {
    scene: &'a Scene,
    way: Way,
    settings: &'a Settings,
    resolution: [u32; 2],
    sight: &'a Sight,
}

/// Is told of every pass and the wall time so far.
type Told<'a> = dyn FnMut(u32, Duration) -> ControlFlow<()> + 'a;

impl Work<'_> {
    /// Renders until it is enough; what each look cost, and the pictures. A
    /// picture goes on from the one before, but for a method whose preparations
    /// depend on how many passes will follow.
    fn render(
        &self,
        until: Until,
        told: &mut Told<'_>,
    ) -> Result<(Vec<Snapshot>, Vec<Image>), Fault> {
        let (mut snapshots, mut pictures) = (Vec::new(), Vec::new());
        let mut keep = |snapshot, picture| {
            snapshots.push(snapshot);
            pictures.push(picture);
        };
        if !matches!(self.way, Way::Reference(method) if method.is_planned()) {
            self.go_on(self.settings.passes, until, &mut keep, told)?;
            return Ok((snapshots, pictures));
        }
        for k in 0.. {
            let passes = match until {
                Until::Passes(n) => n.min(1 << k),
                Until::Time(..) => 1 << k,
            };
            let mut last = None;
            self.go_on(
                passes,
                Until::Passes(passes),
                &mut |a, b| last = Some((a, b)),
                told,
            )?;
            let (snapshot, picture) = last.ok_or(Fault::Interrupted)?;
            keep(snapshot, picture);
            if until.is_enough(passes, Duration::from_secs_f64(snapshot.wall_seconds)) {
                break;
            }
        }
        Ok((snapshots, pictures))
    }

    /// A single render that is prepared for so many passes; `keep` is given
    /// what is there at every look.
    fn go_on(
        &self,
        prepared: u32,
        until: Until,
        keep: &mut dyn FnMut(Snapshot, Image),
        told: &mut Told<'_>,
    ) -> Result<(), Fault> {
        let settings = Settings {
            passes: prepared,
            ..self.settings.clone()
        };
        let mut clock = Stopwatch::default();
        let mut passes =
            clock.time(|| Passes::new(self.way, self.scene, &settings, self.resolution))?;
        let [width, height] = self.resolution;
        let mut film = Film::new(width, height, film_quantum(self.scene));
        for done in 1u32.. {
            clock.time(|| film.add_pass(done - 1, &passes.pass(done - 1)));
            let is_last = matches!(until, Until::Passes(n) if done >= n);
            if done.is_power_of_two() || is_last {
                let picture = judged(&film, self.sight);
                let noise = film.noise().filter(|_| self.sight.is_whole());
                let stated = noise.map(|noise| relative_noise(&picture, &noise));
                let snapshot = Snapshot {
                    passes: done,
                    wall_seconds: clock.wall().as_secs_f64(),
                    cpu_seconds: clock.cpu_seconds(),
                    stated,
                };
                keep(snapshot, picture);
                if until.is_enough(done, clock.wall()) {
                    break;
                }
            }
            if told(done, clock.wall()).is_break() {
                return Err(Fault::Interrupted);
            }
        }
        Ok(())
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

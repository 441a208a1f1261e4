//! The order of work: runs, truth, judgement, pictures.

use std::{path::Path, time::SystemTime};

use crate::{
    film::{Film, OutputError, atomic::write_whole, exposure_factor},
    metrics::relmse,
};

use super::{
    curves::{Curve, Programme},
    effects::effects,
    fault::Fault,
    judge::{Judged, judge},
    making::make,
    pictures::Gallery,
    pilot::choose,
    record::{Absent, FORMAT, Machine, SceneStudy, Series, Study},
    request::{Event, Request, Subject, Watch, Way},
    run::{Finished, runs},
    sight::Sight,
    store::Store,
    truth::{Known, MARGIN},
};

/// Bytes per pixel beside those of a film and of the pictures of a curve: two
/// sets of eight seeds of a reference with four layers, the truth and what is
/// made of it.
const BYTES_PER_PIXEL: u64 = 16 * 4 * 24 + 16 * 24 + 4 * 24;
/// Bytes per pixel of a picture.
const BYTES_PER_PICTURE: u64 = 24;
/// Looks at a run that memory has to hold: 2^20 passes.
const MOST_LOOKS: u64 = 21;

/// Studies the scenes and keeps everything in `directory`: `study.json`,
/// `pictures/`, and in `runs/` what a repeated call goes on from. `watch` is
/// told of every pass; when it breaks, the finished runs stay.
///
/// # Errors
/// [`Fault::Invalid`] for a request or a directory that makes no sense,
/// [`Fault::Output`] if a file cannot be written, [`Fault::Interrupted`].
pub fn study(
    subjects: &[Subject<'_>],
    request: &Request,
    directory: &Path,
    watch: &mut Watch<'_>,
) -> Result<Study, Fault> {
    request.check()?;
    if subjects.is_empty() {
        return Err(Fault::Invalid("there is no scene to study".to_owned()));
    }
    let mut programmes = Vec::new();
    for (i, subject) in subjects.iter().enumerate() {
        if subjects[..i].iter().any(|other| other.name == subject.name) {
            let message = format!("two scenes have the name {}", subject.name);
            return Err(Fault::Invalid(message));
        }
        // All that can be refused is refused before the first run.
        let programme = Programme::new(subject, request)?;
        let size = size(subject, request);
        check_memory(subject, request, size)?;
        let given = Known::given(subject, size)?;
        programmes.push((subject, programme, given, size));
    }
    let store = Store::open(directory)?;
    let mut study = Study {
        format: FORMAT,
        software: format!("nephroid {}", env!("CARGO_PKG_VERSION")),
        made: String::new(),
        machine: Machine::this(),
        scenes: Vec::new(),
    };
    for (subject, programme, given, size) in programmes {
        let work = Work {
            subject,
            request,
            size,
            store: &store,
            directory,
        };
        study.scenes.push(work.scene(programme, given, watch)?);
        study.made = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        // After every scene: what is known is of use whatever comes next.
        write(&study, directory)?;
    }
    let _ = watch(&Event::Wrote(directory.join(FILE)));
    Ok(study)
}

/// The file of the whole study.
const FILE: &str = "study.json";

fn write(study: &Study, directory: &Path) -> Result<(), OutputError> {
    let path = directory.join(FILE);
    let text = serde_json::to_string_pretty(study).map_err(|e| OutputError::Encode {
        path: path.clone(),
        reason: e.to_string(),
    })?;
    write_whole(&path, |file| writeln!(file, "{text}"))
}

fn size(subject: &Subject<'_>, request: &Request) -> [u32; 2] {
    request.resolution.unwrap_or(subject.scene.resolution)
}

/// Whether the pictures that are held at once fit into the scene's budget.
fn check_memory(subject: &Subject<'_>, request: &Request, size: [u32; 2]) -> Result<(), Fault> {
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    let looks = u64::from(request.seeds) * MOST_LOOKS * BYTES_PER_PICTURE;
    let each = 2 * Film::BYTES_PER_PIXEL as u64 + BYTES_PER_PIXEL + looks;
    let needed = pixels.saturating_mul(each);
    let budget = subject.scene.settings.memory;
    if needed <= budget {
        return Ok(());
    }
    Err(Fault::Invalid(format!(
        "{}: a study of {} x {} pixels with {} seeds may need {} MiB, but the memory budget is {} MiB; \
         study a smaller --resolution, or raise render.memory",
        subject.name,
        size[0],
        size[1],
        request.seeds,
        needed.div_ceil(1 << 20),
        budget >> 20
    )))
}

/// The study of one scene.
struct Work<'a> {
    subject: &'a Subject<'a>,
    request: &'a Request,
    size: [u32; 2],
    store: &'a Store,
    directory: &'a Path,
}

/// A curve with its runs and what they are worth.
struct Measured {
    curve: Curve,
    runs: Vec<Finished>,
    judged: Judged,
}

impl Work<'_> {
    fn scene(
        &self,
        mut programme: Programme,
        given: Option<Known>,
        watch: &mut Watch<'_>,
    ) -> Result<SceneStudy, Fault> {
        let witness = match &programme.witnesses[..] {
            [] => None,
            all => Some(choose(self.subject, all, self.size, self.store, watch)?),
        };
        if let Some((method, _)) = witness {
            programme.settle(method);
        }
        let Programme {
            curves, mut absent, ..
        } = programme;
        let mut rendered = Vec::new();
        for curve in curves {
            let runs = runs(
                self.subject,
                &curve,
                self.request,
                self.size,
                self.store,
                watch,
            )?;
            rendered.push((curve, runs));
        }
        let truth = match (given, &witness) {
            (Some(known), _) => known,
            (None, witness) => {
                let (method, sight) = witness.as_ref().ok_or_else(|| {
                    Fault::Invalid(format!("{}: there is no truth", self.subject.name))
                })?;
                let is_enough = |known: &Known| judges_all(known, &rendered);
                let (subject, request, store) = (self.subject, self.request, self.store);
                let witness = (*method, sight);
                make(
                    subject, witness, request, self.size, store, &is_enough, watch,
                )?
            }
        };
        let seen = witness.map_or_else(Sight::whole, |(_, sight)| sight);
        let whole = truth.yardstick(&seen);
        let exposure = exposure_factor(&whole.picture, self.subject.scene.settings.exposure);
        let mut record = truth.record.clone();
        let mut measured = Vec::new();
        for (curve, runs) in rendered {
            let yardstick = truth.yardstick(&curve.sight);
            let targets = &self.request.targets;
            let judged = judge(&runs, self.store, &yardstick, exposure, targets)?;
            measured.push(Measured {
                curve,
                runs,
                judged,
            });
        }
        let left_out: usize = measured.iter().map(|m| m.judged.left_out).sum();
        if left_out > 0 {
            let note = format!(
                "{left_out} points are left out, because their error is not {MARGIN} times that \
                 of the reference; more --reference-time, a larger lamp or a \
                 --reference from elsewhere would judge them."
            );
            let _ = watch(&Event::Note(format!("{}: {note}", self.subject.name)));
            record.words = format!("{} {note}", record.words);
        }
        measured.retain(|m| {
            let is_there = !m.judged.points.is_empty();
            if !is_there {
                absent.push(Absent {
                    method: m.curve.label.clone(),
                    reason: "the reference is too noisy to judge any of its pictures; \
                             allow it more --reference-time, or give a --reference"
                        .to_owned(),
                });
            }
            is_there
        });
        let (name, curves) = (&self.subject.name, measured.len());
        let gallery = Gallery::new(self.directory, name, exposure, curves, self.size)?;
        record.picture = Some(gallery.hang("truth", &whole.picture)?);
        let series = self.series(measured, &truth, &gallery)?;
        let judges_photons = series.iter().any(|s| s.method == Way::Photons.name());
        let effects = if judges_photons {
            let truth = seen.is_whole().then_some(&whole);
            effects(self.subject, self.size, truth, self.store, watch)?
        } else {
            Vec::new()
        };
        Ok(SceneStudy {
            name: self.subject.name.clone(),
            title: self.subject.title.clone(),
            resolution: self.size,
            truth: record,
            series,
            absent,
            effects,
        })
    }

    /// The records of the curves, with pictures at times that all of them
    /// have: that of the one that ends first, and an eighth of it.
    fn series(
        &self,
        measured: Vec<Measured>,
        truth: &Known,
        gallery: &Gallery<'_>,
    ) -> Result<Vec<Series>, Fault> {
        let ends = measured.iter().filter_map(|m| m.judged.curve.last());
        let end = ends
            .map(|&(seconds, _)| seconds)
            .fold(f64::INFINITY, f64::min);
        let times = [end, end / 8.0];
        let mut all = Vec::new();
        for Measured {
            curve,
            runs,
            judged,
        } in measured
        {
            let yardstick = truth.yardstick(&curve.sight);
            let wanted = [&times[..], &self.request.targets];
            let pictures = gallery.show(
                &curve.label,
                &runs[0],
                &judged.points,
                &yardstick,
                self.store,
                wanted,
            )?;
            all.push(Series {
                label: curve.label,
                method: curve.way.name().to_owned(),
                sweep: curve.sweep,
                blind_spots: curve.blind_spots,
                layers: curve.sight.names(),
                points: judged.points,
                fit: judged.fit,
                times: judged.times,
                pictures,
            });
        }
        Ok(all)
    }
}

/// Whether the truth is good enough for the last pictures of all curves.
fn judges_all(known: &Known, rendered: &[(Curve, Vec<Finished>)]) -> bool {
    rendered.iter().all(|(curve, runs)| {
        let yardstick = known.yardstick(&curve.sight);
        let errors = runs
            .iter()
            .filter_map(|r| relmse(&r.last, &yardstick.picture).ok());
        yardstick.is_settled() && yardstick.can_judge(errors.sum::<f64>() / runs.len() as f64)
    })
}

//! Which renders a scene's study takes, and who tells the truth about it.

use std::time::Duration;

use crate::{
    film::Layer,
    film::read_exr_layers,
    reference::{self, Method, Options},
    scene::Settings,
};

use super::{
    fault::Fault,
    record::{Absent, Setting},
    request::{Request, Source, Subject, Way},
    run::{is_progressive, job},
    sight::{Sight, blind_spots, sight, witnesses},
};

/// A curve that is to be found.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Name in legends.
    pub(super) label: String,
    pub(super) way: Way,
    pub(super) sweep: Option<Setting>,
    /// All of a run's settings but passes and seed.
    pub(super) settings: Settings,
    pub(super) blind_spots: Vec<String>,
    /// What is judged.
    pub(super) sight: Sight,
}

/// All that a scene's study takes.
#[derive(Clone, Debug)]
pub(super) struct Programme {
    pub(super) curves: Vec<Curve>,
    pub(super) absent: Vec<Absent>,
    /// Who may make the reference, if one is to be made; all see the same.
    pub(super) witnesses: Vec<(Method, Sight)>,
}

/// What a study is going to do with a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Name of the scene.
    pub name: String,
    /// Names of the curves.
    pub curves: Vec<String>,
    /// Names of the methods of which the best makes the reference, if one is to
    /// be made; it has no curve.
    pub witnesses: Vec<&'static str>,
    /// Methods without a curve, and why.
    pub absent: Vec<Absent>,
    /// Wall time that it may take at most; `None` where passes decide.
    pub limit: Option<Duration>,
}

/// What a study of these scenes is going to do.
///
/// # Errors
/// [`Fault::Invalid`] for what a study refuses.
pub fn outline(subjects: &[Subject<'_>], request: &Request) -> Result<Vec<Outline>, Fault> {
    request.check()?;
    let one = |subject: &Subject<'_>| {
        let programme = Programme::new(subject, request)?;
        let rendering = request
            .time
            .map(|time| time * programme.curves.len() as u32);
        let reference = if programme.witnesses.is_empty() {
            Duration::ZERO
        } else {
            request.reference_time
        };
        Ok(Outline {
            name: subject.name.clone(),
            curves: programme.curves.into_iter().map(|c| c.label).collect(),
            witnesses: programme.witnesses.iter().map(|(m, _)| m.name()).collect(),
            absent: programme.absent,
            limit: rendering.map(|time| time + reference),
        })
    };
    subjects.iter().map(one).collect()
}

impl Programme {
    /// # Errors
    /// [`Fault::Invalid`] if nobody can tell the truth, or the picture that
    /// should cannot be read.
    pub(super) fn new(subject: &Subject<'_>, request: &Request) -> Result<Self, Fault> {
        let scene = subject.scene;
        let mut programme = Self {
            curves: Vec::new(),
            absent: Vec::new(),
            witnesses: Vec::new(),
        };
        let (truth, has_layers) = match subject.truth {
            Source::ClosedForm { .. } => (Sight::whole(), true),
            Source::Given(path) => {
                let names = read_exr_layers(path).map_err(|e| Fault::Invalid(e.to_string()))?;
                let has = |layer: Layer| names.iter().any(|(name, _)| name == layer.name());
                (Sight::whole(), Layer::ALL.into_iter().all(has))
            }
            Source::Make => {
                programme.witnesses = witnesses_of(subject, request)?;
                (programme.witnesses[0].1.clone(), true)
            }
        };
        let mut ways: Vec<Way> = Vec::new();
        for way in request
            .methods
            .clone()
            .unwrap_or_else(|| Way::all().collect())
        {
            if !ways.contains(&way) {
                ways.push(way);
            }
        }
        if !request.sweeps.is_empty() && !ways.contains(&Way::Photons) {
            return Err(Fault::Invalid(
                "sweeps vary the settings of the method photons, which is not among those named"
                    .to_owned(),
            ));
        }
        for way in ways {
            if let Err(reason) = can_render(way, subject, request) {
                programme.leave_out(way, reason);
                continue;
            }
            let seen = sight(way, scene, &scene.settings);
            let judged = seen.and(&truth);
            let blind_spots = blind_spots(way, scene);
            let missing = || blind_spots.join("; ");
            if !judged.is_worth_judging() {
                programme.leave_out(way, missing());
            } else if !judged.is_whole() && !has_layers {
                let why = "the reference that was given has no layers to judge the rest by";
                programme.leave_out(way, format!("{}; {why}", missing()));
            } else if judged != truth && request.methods.is_none() {
                let layers = judged.names().join(", ");
                programme.leave_out(
                    way,
                    format!(
                        "{}; if it is named, it is judged by {layers} alone",
                        missing()
                    ),
                );
            } else {
                programme.add(subject, request, way, &blind_spots, &judged);
            }
        }
        if let [(only, _)] = programme.witnesses[..] {
            programme.settle(only);
        }
        Ok(programme)
    }

    /// The method makes the reference: it has no curve itself.
    pub(super) fn settle(&mut self, method: Method) {
        let curves = self.curves.len();
        self.curves.retain(|c| c.way != Way::Reference(method));
        if self.curves.len() < curves {
            let reason = "it made the reference, which it can't be judged by; \
                          another reference method can be named";
            self.leave_out(Way::Reference(method), reason.to_owned());
        }
    }

    fn leave_out(&mut self, way: Way, reason: String) {
        self.absent.push(Absent {
            method: way.name().to_owned(),
            reason,
        });
    }

    /// The curve of a way, and those of the settings that are varied.
    fn add(
        &mut self,
        subject: &Subject<'_>,
        request: &Request,
        way: Way,
        blind_spots: &[String],
        judged: &Sight,
    ) {
        let base = &subject.scene.settings;
        self.curves.push(Curve {
            label: way.name().to_owned(),
            way,
            sweep: None,
            settings: base.clone(),
            blind_spots: blind_spots.to_vec(),
            sight: judged.clone(),
        });
        if way != Way::Photons {
            return;
        }
        for (setting, settings) in request.sweeps.iter().flat_map(|s| s.variants(base)) {
            let label = format!("{}, {} {}", way.name(), setting.name, setting.value);
            if self.curves.iter().any(|c| c.label == label) {
                continue;
            }
            self.curves.push(Curve {
                label,
                way,
                sweep: Some(setting),
                settings,
                blind_spots: blind_spots.to_vec(),
                sight: judged.clone(),
            });
        }
    }
}

/// Whether the way renders the scene at all.
fn can_render(way: Way, subject: &Subject<'_>, request: &Request) -> Result<(), String> {
    let scene = subject.scene;
    let size = request.resolution.unwrap_or(scene.resolution);
    let job = job(&scene.settings, size);
    match way {
        Way::Photons => job.check().map_err(|e| e.to_string()),
        Way::Reference(method) => {
            reference::check(scene, &job, method, Options::default()).map_err(|e| e.to_string())
        }
    }
}

/// Who may make the reference: the method that was named, or those that see
/// most; only those that are not to be judged, if there are any. At least one.
fn witnesses_of(subject: &Subject<'_>, request: &Request) -> Result<Vec<(Method, Sight)>, Fault> {
    if let Some(named) = request.reference_method {
        let way = Way::Reference(named);
        let sight = sight(way, subject.scene, &subject.scene.settings);
        let can = is_progressive(way) && sight.is_worth_judging();
        return can.then(|| vec![(named, sight)]).ok_or_else(|| {
            Fault::Invalid(format!(
                "{}: method {} can't make a reference: {}",
                subject.name,
                named.name(),
                blind_spots(way, subject.scene).join("; ")
            ))
        });
    }
    let mut equals = witnesses(subject.scene, &subject.scene.settings);
    let can = |method: Method| can_render(Way::Reference(method), subject, request).is_ok();
    // If none can, memory is short for all, which is told later.
    if equals.iter().any(|(method, _)| can(*method)) {
        equals.retain(|(method, _)| can(*method));
    }
    let Some((_, best)) = equals.first().cloned() else {
        return Err(Fault::Invalid(format!(
            "{}: no reference method sees this scene; give a reference",
            subject.name
        )));
    };
    equals.retain(|(_, sight)| *sight == best);
    let named = request.methods.as_deref().unwrap_or_default();
    let is_free = |method: Method| !named.contains(&Way::Reference(method));
    if equals.iter().any(|(method, _)| is_free(*method)) {
        equals.retain(|(method, _)| is_free(*method));
    }
    Ok(equals)
}

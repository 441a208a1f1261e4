//! What is asked of a study.

use std::{fmt::Debug, ops::ControlFlow, path::PathBuf, time::Duration};

use crate::{
    film::PixelSample,
    reference::Method,
    scene::{Kernel, Sampler, Scene, Settings},
};

use super::{fault::Fault, record::Setting};

/// Most seeds of a curve.
const MOST_SEEDS: u32 = 64;
/// Most passes of a run.
const MOST_PASSES: u32 = 1 << 24;
/// Largest error that can be a target: 1000 %.
const LARGEST_TARGET: f64 = 10.0;

/// A way to a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Way {
    /// The renderer.
    Photons,
    /// A reference method.
    Reference(Method),
}

impl Way {
    /// Its name, as `render --method` has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Reference(method) => method.name(),
        }
    }

    /// Every way.
    pub fn all() -> impl Iterator<Item = Self> {
        let references = Method::ALL.into_iter().map(Self::Reference);
        std::iter::once(Self::Photons).chain(references)
    }
}

/// A setting of the renderer and the values that it takes in turn, each with a
/// curve of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Sweep {
    /// Photon paths of a pass.
    Photons(Vec<u64>),
    /// Kernel radius of the first round.
    Radius(Vec<f64>),
    /// The points at which it looks.
    Sampler(Vec<Sampler>),
    /// The area over which a photon's light is spread.
    Kernel(Vec<Kernel>),
    /// Longest chain of surface interactions.
    MaxDepth(Vec<u32>),
    /// Light between diffuse surfaces.
    Indirect(Vec<bool>),
}

impl Sweep {
    /// Each value as it is written, and `settings` with it.
    pub(super) fn variants(&self, settings: &Settings) -> Vec<(Setting, Settings)> {
        // As the scene language writes them, which is as Rust does.
        fn each<T: Copy + Debug>(
            name: &str,
            values: &[T],
            settings: &Settings,
            set: impl Fn(&mut Settings, T),
        ) -> Vec<(Setting, Settings)> {
            let variant = |&value: &T| {
                let mut settings = settings.clone();
                set(&mut settings, value);
                let text = format!("{value:?}");
                let setting = Setting {
                    name: name.to_owned(),
                    value: text.strip_suffix(".0").unwrap_or(&text).to_owned(),
                };
                (setting, settings)
            };
            values.iter().map(variant).collect()
        }
        match self {
            Self::Photons(values) => each("photons", values, settings, |s, v| s.photons = Some(v)),
            Self::Radius(values) => each("radius", values, settings, |s, v| s.radius = v),
            Self::Sampler(values) => each("sampler", values, settings, |s, v| s.sampler = v),
            Self::Kernel(values) => each("kernel", values, settings, |s, v| s.kernel = v),
            Self::MaxDepth(values) => each("max_depth", values, settings, |s, v| s.max_depth = v),
            Self::Indirect(values) => each("indirect", values, settings, |s, v| s.indirect = v),
        }
    }

    fn check(&self) -> Result<(), String> {
        let (name, count, sensible) = match self {
            Self::Photons(values) => ("photons", values.len(), values.iter().all(|&v| v > 0)),
            Self::Radius(values) => {
                let above = |v: &f64| *v > 0.0 && v.is_finite();
                ("radius", values.len(), values.iter().all(above))
            }
            Self::MaxDepth(values) => ("max_depth", values.len(), values.iter().all(|&v| v > 0)),
            Self::Sampler(values) => ("sampler", values.len(), true),
            Self::Kernel(values) => ("kernel", values.len(), true),
            Self::Indirect(values) => ("indirect", values.len(), true),
        };
        if count == 0 {
            return Err(format!("the sweep of {name} has no value"));
        }
        if !sensible {
            return Err(format!("values of {name} are above zero"));
        }
        Ok(())
    }
}

/// What all scenes of a study are asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The ways with a curve; all that see the scene if `None`.
    pub methods: Option<Vec<Way>>,
    /// Runs of each curve, with the seeds that follow the scene's; at least
    /// one, and two for a split into noise and bias.
    pub seeds: u32,
    /// Wall time of all runs of a curve together; passes double as long as
    /// they fit into each seed's share.
    pub time: Option<Duration>,
    /// Most passes of a run. One of `time` and `passes` is given.
    pub passes: Option<u32>,
    /// Errors whose price is asked for.
    pub targets: Vec<f64>,
    /// Size of the pictures in pixels; the scene's own if `None`.
    pub resolution: Option<[u32; 2]>,
    /// The method that makes references; chosen by what a scene needs if
    /// `None`.
    pub reference_method: Option<Method>,
    /// Wall time that the reference of a scene may take.
    pub reference_time: Duration,
    /// Settings of the renderer to vary.
    pub sweeps: Vec<Sweep>,
}

impl Default for Request {
    fn default() -> Self {
        Self {
            methods: None,
            seeds: 4,
            time: Some(Duration::from_secs(60)),
            passes: None,
            targets: vec![0.1, 0.03, 0.01, 0.003],
            resolution: None,
            reference_method: None,
            reference_time: Duration::from_secs(480),
            sweeps: Vec::new(),
        }
    }
}

impl Request {
    /// Whether it makes sense.
    ///
    /// # Errors
    /// [`Fault::Invalid`] with what does not.
    pub fn check(&self) -> Result<(), Fault> {
        let refuse = |text: String| Err(Fault::Invalid(text));
        if !(1..=MOST_SEEDS).contains(&self.seeds) {
            return refuse(format!("a curve has 1 to {MOST_SEEDS} seeds"));
        }
        if self.time.is_none() && self.passes.is_none() {
            return refuse("a study needs a time or a number of passes for its curves".to_owned());
        }
        if self.time.is_some_and(|t| t.is_zero()) || self.reference_time.is_zero() {
            return refuse("times are above zero".to_owned());
        }
        if self.passes.is_some_and(|n| !(1..=MOST_PASSES).contains(&n)) {
            return refuse(format!("a run has 1 to {MOST_PASSES} passes"));
        }
        let sensible = |e: &f64| *e > 0.0 && *e <= LARGEST_TARGET;
        if let Some(e) = self.targets.iter().find(|e| !sensible(e)) {
            return refuse(format!(
                "{} % is no error to ask for: targets lie above 0 % and up to {} %",
                100.0 * e,
                100.0 * LARGEST_TARGET
            ));
        }
        if self.methods.as_ref().is_some_and(Vec::is_empty) {
            return refuse("no method was named".to_owned());
        }
        for sweep in &self.sweeps {
            sweep.check().map_err(Fault::Invalid)?;
        }
        Ok(())
    }
}

/// Where the truth about a scene comes from.
#[derive(Clone, Copy)]
pub enum Source<'a> {
    /// A formula.
    ClosedForm {
        /// Where it comes from, in a sentence.
        words: &'a str,
        /// Radiance in the pixel of this column and row (the first is the top
        /// left) by layer.
        radiance: &'a dyn Fn(u32, u32) -> PixelSample,
    },
    /// A picture, an EXR file of the study's resolution. With the layers that
    /// the renderer writes, methods that see only part of the light can be
    /// judged, too.
    Given(&'a std::path::Path),
    /// Long runs of an independent method.
    Make,
}

/// A scene to study.
#[derive(Clone)]
pub struct Subject<'a> {
    /// Name in files and titles, unique within the study.
    pub name: String,
    /// What it shows, in a sentence.
    pub title: String,
    /// The scene.
    pub scene: &'a Scene,
    /// What tells it from other scenes of that name; see
    /// [`scene::fingerprint`](crate::scene::fingerprint).
    pub print: String,
    /// Where the truth comes from.
    pub truth: Source<'a>,
}

/// What a study tells of its progress.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// It is at work; told after each pass.
    Working {
        /// Name of the scene.
        scene: String,
        /// What is done, such as `photons, seed 2 of 4`.
        task: String,
        /// Passes done of it.
        passes: u32,
        /// Wall time of it so far.
        elapsed: Duration,
        /// Wall time that it may take at most; none where passes decide.
        limit: Option<Duration>,
    },
    /// Something worth a line.
    Note(String),
    /// A file was written.
    Wrote(PathBuf),
}

/// Is told what happens; `Break` ends the study.
pub type Watch<'a> = dyn FnMut(&Event) -> ControlFlow<()> + 'a;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_requests_are_refused() {
        let good = Request::default();
        assert!(good.check().is_ok());
        let bad = |change: &dyn Fn(&mut Request)| {
            let mut request = good.clone();
            change(&mut request);
            matches!(request.check(), Err(Fault::Invalid(_)))
        };
        assert!(bad(&|r| r.seeds = 0));
        assert!(bad(&|r| r.seeds = 1000));
        assert!(bad(&|r| r.time = None));
        assert!(bad(&|r| r.time = Some(Duration::ZERO)));
        assert!(bad(&|r| r.passes = Some(0)));
        assert!(bad(&|r| r.targets.push(0.0)));
        assert!(bad(&|r| r.targets.push(-0.1)));
        assert!(bad(&|r| r.targets.push(f64::NAN)));
        assert!(bad(&|r| r.targets.push(11.0)));
        assert!(bad(&|r| r.methods = Some(Vec::new())));
        assert!(bad(&|r| r.sweeps.push(Sweep::Photons(Vec::new()))));
        assert!(bad(&|r| r.sweeps.push(Sweep::Photons(vec![0]))));
        assert!(bad(&|r| r.sweeps.push(Sweep::Radius(vec![f64::INFINITY]))));
        assert!(bad(&|r| r.sweeps.push(Sweep::MaxDepth(vec![0]))));
    }

    #[test]
    fn a_sweep_changes_one_setting() {
        let settings = Settings::default();
        let variants = Sweep::Radius(vec![0.5, 4.0]).variants(&settings);
        let names: Vec<_> = variants.iter().map(|(s, _)| s.value.as_str()).collect();
        assert_eq!(names, ["0.5", "4"]);
        let expected = Settings {
            radius: 4.0,
            ..settings.clone()
        };
        assert_eq!(variants[1].1, expected);
        let variants = Sweep::Kernel(vec![Kernel::Circle]).variants(&settings);
        assert_eq!(
            (&*variants[0].0.name, &*variants[0].0.value),
            ("kernel", "Circle")
        );
        assert_eq!(variants[0].1.kernel, Kernel::Circle);
    }
}

//! The plots of a scene, and the names of their files.

use std::collections::BTreeSet;

use super::{
    curves::{Curve, Plot, Room},
    palette::Medium,
    split,
    tables::targets,
};
use crate::study::{SceneStudy, Series};

/// Letters of a scene's or setting's name that its files' names keep.
const NAME: usize = 48;

/// What a sweep varied, and its curves.
pub(super) struct Sweep<'a> {
    /// The method.
    pub(super) method: &'a str,
    /// The setting.
    pub(super) setting: &'a str,
    /// A curve for each value, and that of the defaults.
    pub(super) plot: Plot<'a>,
    /// Name of its file.
    pub(super) file: String,
}

/// All plots of a scene.
pub(super) struct Figures<'a> {
    /// Error against time of all methods with their defaults.
    pub(super) error: Plot<'a>,
    /// Name of its file.
    pub(super) error_file: String,
    /// Name of the file of noise and bias.
    pub(super) split_file: String,
    /// One for each setting that was varied.
    pub(super) sweeps: Vec<Sweep<'a>>,
}

impl<'a> Figures<'a> {
    /// The plots of `scene`, whose files begin with `stem`. A method looks the
    /// same in all scenes: its number is its place in `methods`.
    pub(super) fn new(scene: &'a SceneStudy, methods: &[&str], stem: &str) -> Self {
        let mut used = BTreeSet::new();
        let mut curves = Vec::new();
        let mut free = methods.len();
        for (place, series) in scene.series.iter().enumerate() {
            if series.sweep.is_some() {
                continue;
            }
            let own = methods
                .iter()
                .position(|m| *m == series.method)
                .unwrap_or(0);
            // A second series of a method takes a look that no method has.
            let number = if used.contains(&own) { free } else { own };
            free += usize::from(number == free);
            used.insert(number);
            curves.push(Curve {
                series,
                name: series.label.clone(),
                number,
                place,
            });
        }
        let error = Plot {
            title: format!("Error against processor time: {}", scene.name),
            targets: targets(curves.iter().map(|c| c.series)),
            curves,
            truth: scene.truth.error,
        };
        Self {
            error,
            error_file: format!("plots/{stem}-error.svg"),
            split_file: format!("plots/{stem}-noise-and-bias.svg"),
            sweeps: sweeps(scene, stem),
        }
    }

    /// Noise and bias; `None` if they are not known.
    pub(super) fn split(&self, medium: Medium, room: Room) -> Option<String> {
        let title = self.error.title.replacen("Error", "Noise and bias", 1);
        split::draw(&title, &self.error.curves, medium, room)
    }

    /// The files for paper: names and contents.
    pub(super) fn files(&self) -> Vec<(String, String)> {
        let paper = |plot: &Plot| plot.draw(Medium::Paper, Room::Wide);
        let mut files = vec![(self.error_file.clone(), paper(&self.error))];
        let split = self.split(Medium::Paper, Room::Wide);
        files.extend(split.map(|svg| (self.split_file.clone(), svg)));
        let sweeps = self.sweeps.iter();
        files.extend(sweeps.map(|s| (s.file.clone(), paper(&s.plot))));
        files
    }
}

fn sweeps<'a>(scene: &'a SceneStudy, stem: &str) -> Vec<Sweep<'a>> {
    let mut sweeps: Vec<Sweep> = Vec::new();
    for (place, series) in scene.series.iter().enumerate() {
        let Some(varied) = &series.sweep else {
            continue;
        };
        let (method, setting) = (series.method.as_str(), varied.name.as_str());
        let found = sweeps
            .iter()
            .position(|s| (s.method, s.setting) == (method, setting));
        let at = found.unwrap_or_else(|| {
            let number = sweeps.len() + 1;
            let name = slug(&format!("{method}-{setting}"));
            sweeps.push(Sweep {
                method,
                setting,
                plot: with_default(scene, method, setting),
                file: format!("plots/{stem}-sweep-{number}-{name}.svg"),
            });
            number - 1
        });
        push(&mut sweeps[at].plot, series, varied.value.clone(), place);
    }
    for sweep in &mut sweeps {
        sweep.plot.targets = targets(sweep.plot.curves.iter().map(|c| c.series));
    }
    sweeps
}

/// A plot that has the curve of the method's defaults, if there is one.
fn with_default<'a>(scene: &'a SceneStudy, method: &str, setting: &str) -> Plot<'a> {
    let mut plot = Plot {
        title: format!("What {setting} buys with {method}: {}", scene.name),
        curves: Vec::new(),
        targets: Vec::new(),
        truth: scene.truth.error,
    };
    let default = |s: &&Series| s.sweep.is_none() && s.method == method;
    if let Some((place, series)) = scene.series.iter().enumerate().find(|(_, s)| default(s)) {
        push(&mut plot, series, "default".to_owned(), place);
    }
    plot
}

fn push<'a>(plot: &mut Plot<'a>, series: &'a Series, name: String, place: usize) {
    let number = plot.curves.len();
    plot.curves.push(Curve {
        series,
        name,
        number,
        place,
    });
}

/// Beginnings of file names for `names`: plain letters, and no two alike even
/// where case does not count.
pub(super) fn stems<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let mut stems = Vec::new();
    for name in names {
        let plain = slug(name);
        let candidates = (1..).map(|n| {
            if n == 1 {
                plain.clone()
            } else {
                format!("{plain}-{n}")
            }
        });
        for stem in candidates {
            if taken.insert(stem.to_lowercase()) {
                stems.push(stem);
                break;
            }
        }
    }
    stems
}

/// A name in plain letters, digits, `_` and `-`.
fn slug(name: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || c == '_' {
            c
        } else {
            '-'
        }
    };
    let text: String = name.chars().take(NAME).map(plain).collect();
    let text = text.trim_matches('-');
    if text.is_empty() {
        "scene".to_owned()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_are_plain_and_unlike() {
        let names = [
            "glass",
            "Glass",
            "../../etc",
            "<script>",
            "光",
            "",
            "a/b",
            "a b",
        ];
        assert_eq!(
            stems(names.into_iter()),
            [
                "glass", "Glass-2", "etc", "script", "scene", "scene-2", "a-b", "a-b-2"
            ]
        );
    }
}

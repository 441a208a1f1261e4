//! Which pictures are set side by side: those of about equal time, and those of
//! about equal error.

use libm::{log10, pow};

use super::scale::drawable;
use crate::study::{Picture, SceneStudy, Series};

/// Levels of each kind that a scene shows.
const MOST: usize = 4;
/// How far pictures may be from the one they are set beside, as a factor.
const NEAR: f64 = 1.5;
/// How far levels are from each other at least.
const APART: f64 = 2.0;
/// Pictures of a scene that are looked at.
const CANDIDATES: usize = 500;

/// What pictures have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Alike {
    /// About the same processor time.
    Time,
    /// About the same error.
    Error,
}

/// Pictures with something in common, at most one of each series.
pub(super) struct Level<'a> {
    /// What they have about in common: the geometric mean of their seconds or
    /// errors.
    pub(super) about: f64,
    /// The series and their pictures.
    pub(super) shots: Vec<(usize, &'a Series, &'a Picture)>,
}

fn value(alike: Alike, picture: &Picture) -> f64 {
    match alike {
        Alike::Time => picture.cpu_seconds,
        Alike::Error => picture.error,
    }
}

/// A picture that may be shown: its series and the logarithm of its value.
type Candidate<'a> = (usize, &'a Series, &'a Picture, f64);

/// The levels at which most series (without those of sweeps) have a picture, by
/// growing value, and the place of the one to show first.
pub(super) fn levels(scene: &SceneStudy, alike: Alike) -> (Vec<Level<'_>>, usize) {
    let default = scene
        .series
        .iter()
        .enumerate()
        .filter(|(_, s)| s.sweep.is_none());
    let pictures = default.flat_map(|(place, s)| s.pictures.iter().map(move |p| (place, s, p)));
    let candidates: Vec<Candidate> = pictures
        .filter(|(_, _, p)| drawable(value(alike, p)))
        .map(|(place, s, p)| (place, s, p, log10(value(alike, p))))
        .take(CANDIDATES)
        .collect();
    let mut found: Vec<(f64, Level)> = Vec::new();
    // A comparison needs two, unless there is nothing to compare with.
    let first = candidates.first().map(|c| c.0);
    let least = if candidates.iter().all(|c| Some(c.0) == first) {
        1
    } else {
        2
    };
    while found.len() < MOST {
        let free = |c: &&Candidate| {
            found
                .iter()
                .all(|(log, _)| (log - c.3).abs() > log10(APART))
        };
        let groups = candidates
            .iter()
            .filter(free)
            .map(|c| (c.3, around(c.3, &candidates)));
        // The most pictures; of those the nearest to each other, then the first.
        let spread = |log: f64, group: &[&Candidate]| -> f64 {
            group.iter().map(|c| (c.3 - log).abs()).sum()
        };
        let best = groups.min_by(|(a, x), (b, y)| {
            let more = y.len().cmp(&x.len());
            more.then(spread(*a, x).total_cmp(&spread(*b, y)))
                .then(a.total_cmp(b))
        });
        let Some((log, group)) = best.filter(|(_, group)| group.len() >= least) else {
            break;
        };
        let middle = group.iter().map(|c| c.3 / group.len() as f64).sum();
        let shots = group.into_iter().map(|c| (c.0, c.1, c.2)).collect();
        let about = pow(10.0, middle);
        found.push((log, Level { about, shots }));
    }
    let first = found.first().map(|(log, _)| *log);
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let shown = found.iter().position(|(log, _)| Some(*log) == first);
    (
        found.into_iter().map(|(_, level)| level).collect(),
        shown.unwrap_or(0),
    )
}

/// Of each series the picture that is nearest to `log`, if it is near.
fn around<'a, 'b>(log: f64, candidates: &'b [Candidate<'a>]) -> Vec<&'b Candidate<'a>> {
    let far = |c: &Candidate| (c.3 - log).abs();
    let mut group: Vec<&Candidate> = Vec::new();
    for candidate in candidates.iter().filter(|c| far(c) <= log10(NEAR)) {
        match group.iter_mut().find(|held| held.0 == candidate.0) {
            Some(held) if far(candidate) < far(held) => *held = candidate,
            Some(_) => {}
            None => group.push(candidate),
        }
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(times: &[&[f64]]) -> SceneStudy {
        let picture = |seconds: &f64| {
            serde_json::json!({"passes": 1, "seed": 1, "cpu_seconds": seconds, "error": 0.1,
                               "file": "a", "map": "b"})
        };
        let series = |times: &&[f64]| {
            serde_json::json!({"label": "a", "method": "a", "sweep": null, "blind_spots": [],
                "layers": [], "points": [], "fit": null, "times": [],
                "pictures": times.iter().map(picture).collect::<Vec<_>>()})
        };
        let series: Vec<_> = times.iter().map(series).collect();
        let text = serde_json::json!({"name": "", "title": "", "resolution": [1, 1],
            "truth": {"kind": "given", "words": "", "method": null, "seeds": 0, "passes": 0,
                      "error": null, "cpu_seconds": null, "picture": null},
            "series": series, "absent": [], "effects": []});
        serde_json::from_value(text).unwrap()
    }

    fn shown(times: &[&[f64]]) -> (Vec<Vec<f64>>, usize) {
        let scene = scene(times);
        let (levels, first) = levels(&scene, Alike::Time);
        let times = |level: &Level| level.shots.iter().map(|s| s.2.cpu_seconds).collect();
        (levels.iter().map(times).collect(), first)
    }

    #[test]
    fn pictures_of_equal_time_meet() {
        // Close together but on two sides of 0.055, then two of three.
        let found = shown(&[&[0.05, 1.0], &[0.059, 3.0, 9.0], &[0.052, 0.065, 1.2]]);
        assert_eq!(found, (vec![vec![0.05, 0.059, 0.052], vec![1.0, 1.2]], 0));
        assert_eq!(shown(&[&[0.1], &[1.0]]), (vec![], 0));
        assert_eq!(shown(&[&[5.0, 0.1]]), (vec![vec![0.1], vec![5.0]], 0));
        assert_eq!(shown(&[&[f64::MIN_POSITIVE], &[0.0], &[]]).0.len(), 1);
    }
}

//! Studies through the library: what is measured against a formula is the true
//! error, runs survive interruptions, and noise, bias and reference are what
//! they are said to be.
//!
//! Every seed and number of passes is fixed; times are never asserted.

#[path = "../common/mod.rs"]
mod common;
mod effects;
mod keeping;
mod measuring;
mod refusals;
mod truth;

use std::{
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
    time::Duration,
};

use common::{ball, scene, scene_of};
use nephroid::{
    film::Image,
    scene::Scene,
    study::{Fault, Request, Series, Source, Study, Subject, Way, study},
};

/// A caustic and direct light on a floor, small and quick.
fn glass() -> Scene {
    scene_of(
        "eye: (0, -3, 2.5), look_at: (0, 0, 0.2), up: (0, 0, 1), fov: 40",
        [12, 10],
        "(shape: Quad(corner: (-2, -2, 0), u: (4, 0, 0), v: (0, 4, 0)), material: \"grey\"),
         (shape: Sphere(center: (0, 0, 0.6), radius: 0.5), material: \"glass\")",
        "Sphere(center: (1, 1, 3), radius: 0.5, radiance: 20)",
        "photons: 512",
    )
}

/// The caustic of a ball lens, whose picture is known in closed form.
fn lens() -> (Scene, Image) {
    let (plane, beam, window, pixels) = (1.3, 0.95, 1.4, 24);
    let exact = ball::irradiance(plane, beam, window, pixels);
    let text = ball::scene_text(plane, beam, window, pixels, "photons: 2048");
    (scene(&text), exact)
}

fn subject<'a>(name: &str, scene: &'a Scene, truth: Source<'a>) -> Subject<'a> {
    Subject {
        name: name.to_owned(),
        title: String::new(),
        scene,
        print: "test".to_owned(),
        truth,
    }
}

fn request(passes: u32, seeds: u32, methods: &[Way]) -> Request {
    Request {
        methods: Some(methods.to_vec()),
        seeds,
        time: None,
        passes: Some(passes),
        reference_time: Duration::from_secs(600),
        ..Request::default()
    }
}

fn run(subjects: &[Subject<'_>], request: &Request, directory: &Path) -> Result<Study, Fault> {
    study(subjects, request, directory, &mut |_| {
        ControlFlow::Continue(())
    })
}

/// The study without what depends on the clock.
fn timeless(mut study: Study) -> Study {
    study.made = String::new();
    for scene in &mut study.scenes {
        scene.truth.cpu_seconds = None;
        for effect in &mut scene.effects {
            (effect.with_seconds, effect.without_seconds) = (0.0, 0.0);
        }
        for series in &mut scene.series {
            (series.fit, series.times) = (None, Vec::new());
            // Which are worth to be shown depends on times.
            series.pictures = Vec::new();
            for run in series.points.iter_mut().flat_map(|p| &mut p.runs) {
                (run.wall_seconds, run.cpu_seconds) = (0.0, 0.0);
            }
        }
    }
    study
}

/// All files below a directory, by path.
fn files(directory: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(files(&path));
        } else {
            all.push(path);
        }
    }
    all.sort();
    all
}

fn series<'a>(study: &'a Study, label: &str) -> &'a Series {
    let mut series = study.scenes[0].series.iter();
    series.find(|s| s.label == label).expect(label)
}

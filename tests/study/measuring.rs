//! What is measured is the true error.

use std::{fs, ops::ControlFlow};

use nephroid::{
    film::{Film, Image, Layer, PixelSample},
    metrics::{relmse, relmse_trimmed, rmse},
    plan::film_quantum,
    reference::{Method, Options, render},
    render::{Job, Progress, Renderer},
    scene::Settings,
    spectrum::Rgb,
    study::{FORMAT, Source, Study, TruthKind, Way},
};

use crate::{glass, lens, request, run, series, subject};

/// The record says what comes out when the same passes are rendered and
/// measured by hand, in the pictures' single precision.
#[test]
fn a_closed_form_gives_the_true_error() {
    let (scene, exact) = lens();
    let caustic = |x: u32, y: u32| {
        let mut sample = PixelSample::default();
        sample[Layer::Caustic] = exact.pixel(x, y);
        sample
    };
    let truth = Source::ClosedForm {
        words: "the ball lens",
        radiance: &caustic,
    };
    let directory = tempfile::tempdir().unwrap();
    let request = request(16, 2, &[Way::Photons]);
    let found = run(
        &[subject("lens", &scene, truth)],
        &request,
        directory.path(),
    )
    .unwrap();
    assert_eq!(found.format, FORMAT);
    let record = &found.scenes[0];
    assert_eq!(record.truth.kind, TruthKind::ClosedForm);
    assert_eq!(record.truth.words, "the ball lens");
    let photons = series(&found, "photons");
    let passes: Vec<u32> = photons.points.iter().map(|p| p.passes).collect();
    assert_eq!(passes, [1, 2, 4, 8, 16]);
    for seed in 0..2 {
        let settings = Settings {
            seed: scene.settings.seed + seed,
            ..scene.settings.clone()
        };
        let [w, h] = scene.resolution;
        let renderer = Renderer::new(&scene, &settings, scene.resolution, [0, 0, w, h]);
        let mut film = Film::new(w, h, film_quantum(&scene));
        for pass in 0..16 {
            film.add_pass(pass, &renderer.pass(pass).samples);
            let Some(point) = photons.points.iter().find(|p| p.passes == pass + 1) else {
                continue;
            };
            let (run, image) = (&point.runs[seed as usize], film.image());
            assert_eq!(run.seed, settings.seed);
            for (value, expected) in [
                (run.relmse, relmse(&image, &exact).unwrap()),
                (
                    run.relmse_trimmed,
                    relmse_trimmed(&image, &exact, 0.001).unwrap(),
                ),
                (run.rmse, rmse(&image, &exact).unwrap()),
                (run.mean_ratio, image.mean().mean() / exact.mean().mean()),
            ] {
                let off = (value / expected - 1.0).abs();
                assert!(off < 1e-5, "pass {pass}: {value}, {expected}");
            }
            assert_eq!(
                run.stated.is_some(),
                pass > 0,
                "one replicate has no spread"
            );
        }
    }
    let point = photons.points.last().unwrap();
    let split = point.split.unwrap();
    assert!(split.noise > 0.0 && split.bias > 0.0, "{split:?}");
    let error = point.runs.iter().map(|r| r.relmse).sum::<f64>() / 2.0;
    let parts = split.noise.powi(2) + split.bias.powi(2);
    assert!((parts / error - 1.0).abs() < 1e-3, "{parts}, {error}");
    assert!(photons.fit.is_some(), "five points");
    for picture in &photons.pictures {
        for file in [&picture.file, &picture.map] {
            let size = image::image_dimensions(directory.path().join(file)).unwrap();
            assert_eq!(size, (24, 24), "{file}");
        }
    }
    let written = fs::read_to_string(directory.path().join("study.json")).unwrap();
    let read: Study = serde_json::from_str(&written).unwrap();
    assert_eq!(read, found, "what is on disk is what was returned");
}

/// Methods that carry photons from pass to pass give what `render` gives: one
/// render that goes on, and for the first photon map one for each number of
/// passes.
#[test]
fn other_photon_maps_are_looked_at_as_they_are() {
    let scene = glass();
    let half = |_, _| {
        let mut sample = PixelSample::default();
        sample[Layer::Direct] = Rgb::grey(0.5);
        sample
    };
    let truth = Source::ClosedForm {
        words: "grey",
        radiance: &half,
    };
    let [w, h] = scene.resolution;
    let grey = Image::from_fn(w, h, |_, _| Rgb::grey(0.5));
    let methods = [Method::PhotonMap, Method::Sppm];
    let ways = methods.map(Way::Reference);
    let directory = tempfile::tempdir().unwrap();
    let subjects = [subject("glass", &scene, truth)];
    let found = run(&subjects, &request(4, 1, &ways), directory.path()).unwrap();
    for method in methods {
        let series = series(&found, method.name());
        assert!(series.layers.is_empty() && series.blind_spots[0].contains("blurred"));
        assert_eq!(series.points.len(), 3);
        for point in &series.points {
            let mut job = Job::of(&scene);
            job.settings.passes = point.passes;
            let options = Options::default();
            let go_on = &mut |_: &Progress| ControlFlow::Continue(());
            let outcome = render(&scene, &job, method, options, go_on).unwrap();
            let expected = relmse(&outcome.film.image(), &grey).unwrap();
            let error = point.runs[0].relmse;
            assert!((error / expected - 1.0).abs() < 1e-5, "{error}, {expected}");
        }
    }
}

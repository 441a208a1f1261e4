//! Studies through the library: what is measured against a formula is the true
//! error, runs survive interruptions, and noise, bias and reference are what
//! they are said to be.
//!
//! Every seed and number of passes is fixed; times are never asserted.

mod common;

use std::{
    cell::Cell,
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
    time::Duration,
};

use common::{ball, scene, scene_of};
use nephroid::{
    film::{Film, Image, Layer, PixelSample, Window, write_exr},
    metrics::{relmse, relmse_trimmed, rmse},
    plan::film_quantum,
    reference::{Method, Options, render},
    render::{Job, Progress, Renderer},
    scene::{Scene, Settings},
    spectrum::Rgb,
    study::{
        Event, FORMAT, Fault, Request, Series, Source, Study, Subject, Sweep, TruthKind, Way,
        outline, study,
    },
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

/// A study that was stopped anywhere, or lost any file, comes to the same end.
#[test]
fn an_interrupted_study_goes_on() {
    let scene = glass();
    let ways = [Way::Photons, Way::Reference(Method::Path)];
    let request = request(4, 2, &ways);
    let subjects = [subject("glass", &scene, Source::Make)];
    let whole = tempfile::tempdir().unwrap();
    let passes = Cell::new(0u32);
    let straight = study(&subjects, &request, whole.path(), &mut |event| {
        passes.set(passes.get() + u32::from(matches!(event, Event::Working { .. })));
        ControlFlow::Continue(())
    });
    let straight = timeless(straight.unwrap());
    let all = passes.get();
    assert!(all > 60, "runs, reference and effect: {all}");

    // Stopped again and again, in the middle of runs and of the reference.
    let torn = tempfile::tempdir().unwrap();
    let (mut stops, mut repeated) = (0, 0);
    let resumed = loop {
        // Longer each time: stages of the reference have to fit.
        let mut left = 30 * (stops + 1);
        let done = study(&subjects, &request, torn.path(), &mut |event| {
            if matches!(event, Event::Working { .. }) {
                (left, repeated) = (left - 1, repeated + 1);
            }
            if left == 0 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        match done {
            Err(Fault::Interrupted) => stops += 1,
            other => break timeless(other.unwrap()),
        }
        assert!(stops < 1000, "it comes to no end");
    };
    assert_eq!(resumed, straight);
    assert!(stops >= 4, "{stops}");
    assert!(
        repeated < 3 * all,
        "finished runs are not made again: {repeated} of {all}"
    );

    // Finished: nothing is rendered any more.
    let again = study(&subjects, &request, torn.path(), &mut |event| {
        assert!(!matches!(event, Event::Working { .. }), "{event:?}");
        ControlFlow::Continue(())
    });
    assert_eq!(timeless(again.unwrap()), straight);

    // What a crash may leave: files cut off, gone, or of another question.
    for (i, path) in files(&torn.path().join("runs")).into_iter().enumerate() {
        if path.ends_with("study") {
            continue;
        }
        let bytes = fs::read(&path).unwrap();
        match i % 3 {
            0 => fs::write(&path, &bytes[..bytes.len() / 2]).unwrap(),
            1 => fs::remove_file(&path).unwrap(),
            _ => {}
        }
    }
    let mended = run(&subjects, &request, torn.path()).unwrap();
    assert_eq!(timeless(mended), straight);
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

/// Another scene under the same name, or another setting, is another question.
#[test]
fn kept_runs_answer_their_own_question() {
    let scene = glass();
    let directory = tempfile::tempdir().unwrap();
    let black = |_, _| PixelSample {
        layers: [Rgb::grey(1.0); 4],
        ..PixelSample::default()
    };
    let truth = Source::ClosedForm {
        words: "grey",
        radiance: &black,
    };
    let one = subject("glass", &scene, truth);
    let ask = |subject: &Subject<'_>, request: &Request| {
        let mut passes = 0;
        let study = study(
            std::slice::from_ref(subject),
            request,
            directory.path(),
            &mut |event| {
                let Event::Working { task, .. } = event else {
                    return ControlFlow::Continue(());
                };
                passes += u32::from(task.starts_with("photons"));
                ControlFlow::Continue(())
            },
        );
        (passes, study.unwrap())
    };
    // The last pass of a run needs no telling.
    let request = request(2, 2, &[Way::Photons]);
    assert_eq!(ask(&one, &request).0, 2);
    assert_eq!(ask(&one, &request).0, 0);
    let mut other = one.clone();
    other.print = "another".to_owned();
    assert_eq!(ask(&other, &request).0, 2);
    let swept = Request {
        sweeps: vec![Sweep::Radius(vec![1.0, 2.0])],
        ..request.clone()
    };
    let (passes, study) = ask(&one, &swept);
    assert_eq!(passes, 2, "a radius of 2 is what there was before");
    let labels: Vec<&str> = study.scenes[0]
        .series
        .iter()
        .map(|s| s.label.as_str())
        .collect();
    assert_eq!(
        labels,
        ["photons", "photons, radius 1", "photons, radius 2"]
    );
    let [default, narrow, same] = &study.scenes[0].series[..] else {
        panic!("three curves")
    };
    let errors = |s: &Series| -> Vec<f64> { s.points[0].runs.iter().map(|r| r.relmse).collect() };
    assert_eq!(errors(default), errors(same));
    assert_ne!(errors(default), errors(narrow));
    assert_eq!(narrow.sweep.as_ref().unwrap().value, "1");
}

/// A reference that is made is as far from the truth as it says, and a curve
/// that it judges is as far from the truth as with the closed form.
#[test]
fn a_made_reference_is_as_good_as_it_says() {
    // Soft light on a floor, seen from above: a quarter everywhere.
    let scene = scene_of(
        "eye: (0, 0, 0.001), look_at: (0, 0, 0), up: (0, 1, 0), height: 1e-6",
        [16, 16],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\")",
        "Sphere(center: (0, 0, 1), radius: 0.5, radiance: 1)",
        "indirect: false",
    );
    let quarter = |_, _| {
        let mut sample = PixelSample::default();
        sample[Layer::Direct] = Rgb::grey(0.25);
        sample
    };
    let exact = Source::ClosedForm {
        words: "a quarter",
        radiance: &quarter,
    };
    let request = Request {
        reference_method: Some(Method::Path),
        ..request(2, 4, &[Way::Photons, Way::Reference(Method::Path)])
    };
    let directories = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let known = run(
        &[subject("floor", &scene, exact)],
        &request,
        directories[0].path(),
    )
    .unwrap();
    let made = run(
        &[subject("floor", &scene, Source::Make)],
        &request,
        directories[1].path(),
    )
    .unwrap();
    let truth = &made.scenes[0].truth;
    assert_eq!((truth.kind, truth.seeds), (TruthKind::Made, 8));
    assert_eq!(truth.method.as_deref(), Some("path"));
    let stated = truth.error.unwrap();
    let picture = directories[1].path().join(truth.picture.as_ref().unwrap());
    assert!(picture.is_file());
    let last = |study: &Study| {
        let point = series(study, "photons").points.last().unwrap().clone();
        let relmse = point.runs.iter().map(|r| r.relmse).sum::<f64>() / 4.0;
        (relmse, point.split.unwrap())
    };
    let ((with_exact, exact_split), (with_made, made_split)) = (last(&known), last(&made));
    assert!(
        stated * stated * 10.0 <= with_made,
        "good enough, or it went on"
    );
    // What the reference's noise adds is its variance.
    let added = with_made - with_exact;
    assert!(
        (added - stated * stated).abs() < 0.06 * with_exact,
        "{added}, {stated}"
    );
    assert!((made_split.noise / exact_split.noise - 1.0).abs() < 0.02);
    // It does not judge itself, and the reason is told.
    let absent = &made.scenes[0].absent;
    assert!(
        absent
            .iter()
            .any(|a| a.method == "path" && a.reason.contains("made the reference"))
    );
    assert_eq!(known.scenes[0].series.len(), 2, "the formula judges both");
}

/// With no time for more than its first stage a reference judges only what is
/// much worse than itself, and says what it leaves out.
#[test]
fn a_noisy_reference_judges_nothing_better() {
    let scene = glass();
    let directory = tempfile::tempdir().unwrap();
    let request = Request {
        reference_method: Some(Method::Path),
        reference_time: Duration::from_nanos(1),
        ..request(64, 2, &[Way::Photons])
    };
    let subjects = [subject("glass", &scene, Source::Make)];
    let found = run(&subjects, &request, directory.path()).unwrap();
    let record = &found.scenes[0];
    assert_eq!(record.truth.passes, 8);
    assert!(
        record.truth.words.contains("left out"),
        "{}",
        record.truth.words
    );
    let own = record.truth.error.unwrap();
    for point in record.series.iter().flat_map(|s| &s.points) {
        let relmse = point.runs.iter().map(|r| r.relmse).sum::<f64>() / 2.0;
        assert!(
            relmse >= 10.0 * own * own * (1.0 - 1e-12),
            "{relmse}, {own}"
        );
        assert!(point.passes < 64);
    }
    if record.series.is_empty() {
        assert!(record.absent.iter().any(|a| a.reason.contains("too noisy")));
    }
}

/// What a method does not see is not held against it.
#[test]
fn methods_are_judged_by_what_they_see() {
    let scene = scene_of(
        "eye: (0, -3, 2.5), look_at: (0, 0, 0.2), up: (0, 0, 1), fov: 40",
        [10, 8],
        "(shape: Quad(corner: (-2, -2, 0), u: (4, 0, 0), v: (0, 4, 0)), material: \"grey\"),
         (shape: Sphere(center: (0, 0, 0.6), radius: 0.5), material: \"glass\")",
        "Point(position: (1, 1, 3), power: 20)",
        "photons: 512",
    );
    let path = Way::Reference(Method::Path);
    let light = Way::Reference(Method::Light);
    let ask = request(4, 2, &[Way::Photons, path, light]);
    let ask = Request {
        reference_method: Some(Method::Bdpt),
        ..ask
    };
    let directory = tempfile::tempdir().unwrap();
    let subjects = [subject("point", &scene, Source::Make)];
    let found = run(&subjects, &ask, directory.path()).unwrap();
    let judged = series(&found, "path");
    assert_eq!(judged.layers, ["direct", "emission"]);
    assert!(
        judged.blind_spots[0].contains("caustics"),
        "{:?}",
        judged.blind_spots
    );
    // Direct light by a point light has no noise but that of the pixels.
    let last = judged.points.last();
    assert!(last.is_none_or(|p| p.runs.iter().all(|r| (r.mean_ratio - 1.0).abs() < 0.2)));
    let absent = &found.scenes[0].absent;
    let reason = &absent.iter().find(|a| a.method == "light").unwrap().reason;
    assert!(reason.contains("black"), "{reason}");

    // Without being asked for, it is left out.
    let all = Request {
        methods: None,
        ..ask
    };
    let plan = outline(&subjects, &all).unwrap().remove(0);
    assert_eq!(plan.witness, Some("bdpt"));
    assert!(!plan.curves.contains(&"path".to_owned()), "{plan:?}");
    assert!(
        plan.absent
            .iter()
            .any(|a| a.method == "path" && a.reason.contains("direct"))
    );
}

/// A picture that was given judges as it is.
#[test]
fn a_given_picture_judges() {
    let scene = glass();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("truth.exr");
    let [w, h] = scene.resolution;
    let grey = Image::from_fn(w, h, |_, _| Rgb::grey(0.5));
    write_exr(&path, &[("", &grey)], Window::whole(w, h), &[]).unwrap();
    let request = request(2, 1, &[Way::Photons]);
    let given = subject("glass", &scene, Source::Given(&path));
    let found = run(
        std::slice::from_ref(&given),
        &request,
        &directory.path().join("a"),
    )
    .unwrap();
    assert_eq!(found.scenes[0].truth.kind, TruthKind::Given);
    assert_eq!(found.scenes[0].truth.error, None);
    let point = &series(&found, "photons").points[0];
    assert_eq!(point.split, None, "one seed");
    let refused = |image: &Image, words: &str| {
        let size = Window::whole(image.width(), image.height());
        write_exr(&path, &[("", image)], size, &[]).unwrap();
        let target = directory.path().join("b");
        let fault = run(std::slice::from_ref(&given), &request, &target).unwrap_err();
        assert!(
            matches!(fault, Fault::Invalid(_)) && fault.to_string().contains(words),
            "{fault}"
        );
        assert!(!target.exists(), "refused before anything is made");
    };
    refused(&Image::from_fn(w + 1, h, |_, _| Rgb::grey(0.5)), "pixels");
    refused(&Image::from_fn(w, h, |_, _| Rgb::BLACK), "black");
    refused(
        &Image::from_fn(w, h, |_, _| Rgb::grey(f64::NAN)),
        "not finite",
    );
}

#[test]
fn what_does_not_fit_is_refused() {
    let scene = glass();
    let directory = tempfile::tempdir().unwrap();
    let fault = |subjects: &[Subject<'_>], request: &Request| {
        run(subjects, request, directory.path())
            .unwrap_err()
            .to_string()
    };
    let one = subject("glass", &scene, Source::Make);
    let good = request(2, 1, &[Way::Photons]);
    let large = Request {
        resolution: Some([1 << 20, 1 << 20]),
        ..good.clone()
    };
    assert!(fault(std::slice::from_ref(&one), &large).contains("--resolution"));
    assert!(fault(&[], &good).contains("no scene"));
    assert!(fault(&[one.clone(), one.clone()], &good).contains("two scenes"));
    let blind = Request {
        reference_method: Some(Method::LightNaive),
        ..good.clone()
    };
    assert!(fault(std::slice::from_ref(&one), &blind).contains("blurred"));
    let sweep = Request {
        methods: Some(vec![Way::Reference(Method::Path)]),
        sweeps: vec![Sweep::Radius(vec![1.0])],
        ..good
    };
    assert!(fault(&[one], &sweep).contains("photons"));
    assert_eq!(
        files(directory.path()),
        [] as [PathBuf; 0],
        "nothing was made"
    );
}

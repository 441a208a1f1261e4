//! Runs that are kept: what an interrupted study goes on from.

use std::{cell::Cell, fs, ops::ControlFlow};

use nephroid::{
    film::PixelSample,
    reference::Method,
    spectrum::Rgb,
    study::{Event, Fault, Request, Series, Source, Subject, Sweep, Way, study},
};

use crate::{files, glass, request, run, subject, timeless};

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

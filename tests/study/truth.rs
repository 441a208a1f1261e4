//! References: made, given, and too noisy; who sees what.

use std::time::Duration;

use nephroid::{
    film::{Image, Layer, PixelSample, Window, write_exr},
    reference::Method,
    spectrum::Rgb,
    study::{Fault, Request, Source, Study, TruthKind, Way, outline},
};

use crate::{common::scene_of, glass, request, run, series, subject};

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
    assert_eq!(plan.witnesses, ["bdpt"]);
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

//! What effects bring and cost.

use std::ops::ControlFlow;

use nephroid::{
    film::{Image, Layer, PixelSample},
    metrics::relmse,
    reference::Method,
    render::Job,
    scene::{Choice, Effect, Scene},
    spectrum::Rgb,
    study::{Request, Source, Way},
};

use crate::{glass, lens, request, run, subject};

/// A scene that is nothing but a caustic: without it all light is missing and
/// the picture is black. What is switched off has no price.
#[test]
fn effects_are_priced() {
    let (scene, exact) = lens();
    let priced = |scene: &Scene| {
        let radiance = |x, y| {
            let mut sample = PixelSample::default();
            sample[Layer::Caustic] = exact.pixel(x, y);
            sample
        };
        let truth = Source::ClosedForm {
            words: "a lens",
            radiance: &radiance,
        };
        let directory = tempfile::tempdir().unwrap();
        let request = request(1, 1, &[Way::Photons]);
        let subjects = [subject("lens", scene, truth)];
        let first = run(&subjects, &request, directory.path()).unwrap();
        let again = run(&subjects, &request, directory.path()).unwrap();
        assert_eq!(first.scenes[0].effects, again.scenes[0].effects, "kept");
        first.scenes[0].effects.clone()
    };
    let effects = priced(&scene);
    let caustics = effects.iter().find(|e| e.name == "caustics").unwrap();
    assert_eq!((caustics.light, caustics.light_error), (1.0, 0.0));
    assert!(caustics.with_seconds > 0.0);
    // Black is off by r^2 / (r^2 + 0.01 mean^2), which is less than one.
    let black = Image::from_fn(exact.width(), exact.height(), |_, _| Rgb::BLACK);
    let expected = relmse(&black, &exact).unwrap().sqrt();
    assert!((caustics.without_error.unwrap() / expected - 1.0).abs() < 1e-6);
    assert!(caustics.with_error.unwrap() < 0.5 * expected);

    let (mut less, _) = lens();
    less.settings.effects.set(Effect::Caustics, Choice::Off);
    assert!(priced(&less).iter().all(|e| e.name != "caustics"));
}

/// Light that effects bring is what their layers hold; an effect that only
/// finds light better brings none.
#[test]
fn effects_bring_their_light() {
    let scene = glass();
    let directory = tempfile::tempdir().unwrap();
    let request = Request {
        reference_method: Some(Method::Path),
        ..request(1, 1, &[Way::Photons])
    };
    let subjects = [subject("glass", &scene, Source::Make)];
    let found = run(&subjects, &request, directory.path()).unwrap();
    let mut job = Job::of(&scene);
    job.settings.passes = 8;
    let film = nephroid::render::run(&scene, &job, &mut |_| ControlFlow::Continue(())).film;
    let share = |layer| film.layer_image(layer).mean().mean() / film.image().mean().mean();
    let effects = &found.scenes[0].effects;
    let light = |name: &str| {
        let effect = effects.iter().find(|e| e.name == name).expect(name);
        (effect.light, 5.0 * effect.light_error + 1e-9)
    };
    let (caustics, within) = light("caustics");
    let (least, most) = (share(Layer::Caustic), share(Layer::Indirect));
    assert!(least > 0.02);
    // Some of the light between surfaces comes from caustics.
    assert!(caustics > least - within && caustics < least + most + within);
    let (indirect, within) = light("indirect");
    assert!(
        (indirect - most).abs() < within + 0.05 * most,
        "{indirect} {most}"
    );
    let (glints, within) = light("glints");
    assert!(glints.abs() < within, "{glints} {within}");
}

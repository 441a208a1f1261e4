//! What the survey says of light, against renders; and the form in which it
//! says it.

use nephroid::{
    plan::{By, judge},
    render::REPLICATES,
    scene::{Choice, Effect, Scene, Settings},
    survey::{EffectReport, Measured, Survey},
};

use crate::common::{Estimate, renderer, scene_of};

/// A glass ball and a mirror under a point, a sphere and a window pane.
fn mixed(render: &str) -> Scene {
    scene_of(
        "eye: (0, -6, 3), look_at: (0, 0, 0.7), fov: 40",
        [32, 24],
        "(name: \"floor\", shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
         (name: \"wall\", shape: Quad(corner: (-3, 2, 0), u: (6, 0, 0), v: (0, 0, 4)), material: \"white\"),
         (name: \"ball\", shape: Sphere(center: (0, 0, 1), radius: 0.7), material: \"glass\"),
         (name: \"disc\", shape: Disc(center: (1.8, 0.5, 0.8), radius: 0.6, normal: (-1, -1, 0.2)), material: \"mirror\"),
         (name: \"pane\", shape: Quad(corner: (-2.4, -1, 0), u: (0, 2, 0), v: (0, 0, 2)), material: Dielectric(ior: 1.5, thin: true))",
        "Point(name: \"bulb\", position: (-1, -1, 4), power: 60),
         Sphere(name: \"lamp\", center: (1.5, -0.5, 3), radius: 0.3, power: 80)",
        render,
    )
}

fn effect(survey: &Survey, effect: Effect) -> &EffectReport {
    let mut all = survey.effects.iter();
    all.find(|e| e.effect == effect).expect("all effects")
}

fn light(survey: &Survey, of: Effect) -> Measured {
    effect(survey, of).light.expect("an effect that has light")
}

const ORIGINS: [Effect; 5] = [
    Effect::Sources,
    Effect::HardShadows,
    Effect::SoftShadows,
    Effect::Caustics,
    Effect::Indirect,
];

/// Shares by layer (direct, caustic, indirect, emission) of 32 passes.
fn rendered(scene: &Scene) -> [Estimate; 4] {
    let renderer = renderer(scene);
    let n = REPLICATES as usize;
    let mut sums = vec![[0.0; 4]; n];
    for pass in 0..4 * REPLICATES {
        for sample in &renderer.pass(pass).samples {
            for (k, layer) in sample.layers.iter().enumerate() {
                sums[pass as usize % n][k] += layer.mean();
            }
        }
    }
    let total: f64 = sums.iter().flatten().sum();
    std::array::from_fn(|k| {
        let values: Vec<f64> = sums.iter().map(|s| s[k] / total * n as f64).collect();
        Estimate::of(&values)
    })
}

#[test]
fn shares_of_light_are_those_of_a_render() {
    let scene = mixed("");
    let survey = Survey::of(&scene, &scene.settings, scene.resolution);
    let sum: f64 = ORIGINS.iter().map(|&e| light(&survey, e).share).sum();
    assert!((sum - 1.0).abs() < 1e-9, "shares sum to {sum}");
    let work: f64 = survey.effects.iter().filter_map(|e| e.work).sum();
    assert!(
        (work + survey.view_work - 1.0).abs() < 1e-9,
        "work sums to {work}"
    );

    let [direct, caustic, indirect, emission] = rendered(&scene);
    let [hard, soft] = [Effect::HardShadows, Effect::SoftShadows].map(|e| light(&survey, e));
    assert!(hard.share > 0.05 && soft.share > 0.05, "{hard:?} {soft:?}");
    let both = Measured {
        share: hard.share + soft.share,
        error: hard.error.hypot(soft.error),
    };
    for (what, found, expected) in [
        ("direct", both, direct),
        ("caustics", light(&survey, Effect::Caustics), caustic),
        ("indirect", light(&survey, Effect::Indirect), indirect),
        ("sources", light(&survey, Effect::Sources), emission),
    ] {
        let error = found.error.hypot(expected.error);
        assert!(
            (found.share - expected.mean).abs() <= 5.0 * error,
            "{what}: {found:?}, {expected:?} rendered"
        );
        assert!(error < 0.02, "{what}: {error} is no statement");
    }
    for by_way in [Effect::Mirrors, Effect::Refraction, Effect::Panes] {
        let share = effect(&survey, by_way).seen_through.expect("a way").share;
        assert!(share > 1e-3 && share < 0.5, "{by_way:?}: {share}");
    }
}

/// What is switched off is what the survey says is missing.
#[test]
fn omissions_are_measured() {
    let scene = mixed("indirect: false, effects: (caustics: Off)");
    let survey = Survey::of(&scene, &scene.settings, scene.resolution);
    let full = mixed("");
    let [_, caustic, indirect, _] = rendered(&full);
    let expected = caustic.mean + indirect.mean;
    let error = [Effect::Caustics, Effect::Indirect].map(|e| light(&survey, e).error);
    let error = error[0]
        .hypot(error[1])
        .hypot(caustic.error)
        .hypot(indirect.error);
    assert!(
        (survey.share_left_out() - expected).abs() < 5.0 * error,
        "{} left out, {expected} rendered",
        survey.share_left_out()
    );
    assert_eq!(survey.left_out.len(), 2);
    let whole = Survey::of(&full, &full.settings, full.resolution);
    assert!(whole.left_out.is_empty(), "{:?}", whole.left_out);
}

/// A hall of mirrors with a small depth limit: it says what limit would do.
#[test]
fn a_depth_limit_is_told() {
    let scene = mixed("max_depth: 2");
    let survey = Survey::of(&scene, &scene.settings, scene.resolution);
    let [omission] = survey.left_out.as_slice() else {
        panic!("{:?}", survey.left_out);
    };
    assert!(omission.what.contains("the depth limit 2"), "{omission:?}");
    let advised = omission.what.rsplit(' ').next().expect("a number");
    let advised: u32 = advised.parse().expect("a number");
    let settings = Settings {
        max_depth: advised,
        ..scene.settings.clone()
    };
    let better = Survey::of(&scene, &settings, scene.resolution);
    assert!(
        better.left_out.is_empty(),
        "{advised}: {:?}",
        better.left_out
    );
}

#[test]
fn a_survey_is_deterministic_and_follows_the_seed() {
    let scene = mixed("photons: 4096, indirect: false");
    let of = |seed: u64, threads: usize| {
        let settings = Settings {
            seed,
            ..scene.settings.clone()
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        pool.install(|| Survey::of(&scene, &settings, [24, 18]))
    };
    let one = of(0, 1);
    assert_eq!(one, of(0, 3));
    assert_ne!(one, of(1, 1));
}

/// Names that scripts may rely on.
#[test]
fn the_form_is_stable() {
    let scene = mixed("");
    let survey = Survey::of(&scene, &scene.settings, scene.resolution);
    let value = serde_json::to_value(&survey).expect("plain data");
    let keys = |v: &serde_json::Value| -> Vec<String> {
        v.as_object().expect("an object").keys().cloned().collect()
    };
    assert_eq!(
        keys(&value),
        [
            "effects",
            "funnels",
            "left_out",
            "more_funnels",
            "photons_per_pass",
            "resolution",
            "view_work"
        ]
    );
    let effects = value["effects"].as_array().expect("a list");
    let names: Vec<&str> = effects
        .iter()
        .filter_map(|e| e["effect"].as_str())
        .collect();
    assert_eq!(names, Effect::names());
    assert_eq!(
        keys(&effects[0]),
        [
            "by_user",
            "effect",
            "light",
            "on",
            "seen_through",
            "why",
            "without",
            "work"
        ]
    );
    assert_eq!(keys(&effects[0]["light"]), ["error", "share"]);
    assert_eq!(
        keys(&value["funnels"][0]),
        [
            "aimed", "landed", "light", "met", "object", "reason", "seen"
        ]
    );
    // Three casters, two lights.
    assert_eq!(value["funnels"].as_array().map(Vec::len), Some(6));
}

/// A full ball in air reflects nothing totally; with something in it, or a lamp,
/// or cut in half it may.
#[test]
fn a_full_ball_needs_no_total_reflection() {
    let floor =
        "(shape: Quad(corner: (-4, -4, 0), u: (8, 0, 0), v: (0, 8, 0)), material: \"grey\"),";
    let ball =
        "(name: \"ball\", shape: Sphere(center: (0, 0, 1.2), radius: 1), material: \"glass\"),";
    let far = "Point(position: (0, 0, 5), power: 1)";
    for (objects, lights, on) in [
        ("", far, false),
        ("", "Point(position: (0, 0, 1.5), power: 1)", true),
        (
            "(shape: Sphere(center: (0, 0, 1.5), radius: 0.1), material: \"grey\")",
            far,
            true,
        ),
        (
            "(shape: Plane(point: (0, 0, 0.5), normal: (0, 0, 1)), material: \"grey\")",
            far,
            true,
        ),
        (
            "(shape: Box(min: (2, 2, 0.1), max: (3, 3, 1)), material: \"glass\")",
            far,
            true,
        ),
    ] {
        let camera = "eye: (0, -6, 3), look_at: (0, 0, 0.7), fov: 40";
        let scene = scene_of(
            camera,
            [8, 6],
            &format!("{floor}{ball}{objects}"),
            lights,
            "",
        );
        let verdicts = judge(&scene, &scene.settings);
        let mut of = verdicts
            .iter()
            .filter(|v| v.effect == Effect::TotalReflection);
        let verdict = of.next().expect("a verdict");
        assert_eq!(verdict.on, on, "{objects} {lights}: {}", verdict.why);
    }
}

/// Every effect says why, on and off, and the scene's own word can be undone.
#[test]
fn every_verdict_has_a_reason() {
    for scene in [mixed(""), mixed("effects: (glints: Off, panes: On)")] {
        for v in judge(&scene, &scene.settings) {
            assert!(v.why.len() > 10, "{v:?}");
            let said = scene.settings.choice(v.effect);
            assert_eq!(v.by == By::User, said == Choice::Off, "{v:?}");
            assert_eq!(v.on, v.called_for && said != Choice::Off, "{v:?}");
        }
    }
}

/// Rays that look for glints are work, wherever in the picture they are.
#[test]
fn glints_are_work() {
    let work = |render: &str| {
        let scene = mixed(render);
        let survey = Survey::of(&scene, &scene.settings, scene.resolution);
        effect(&survey, Effect::Glints).work
    };
    let [with, without] = ["", "effects: (glints: Off)"].map(work);
    assert!(with.is_some_and(|w| w > 1e-4), "{with:?}");
    assert!(without.is_none_or(|w| w == 0.0), "{without:?}");
}

//! `nephroid check`, and what any command says of a broken scene.

use std::fs;

use crate::{code, names, run, text, workplace};

#[test]
fn a_broken_scene_is_bad_input() {
    let directory = workplace();
    fs::write(directory.path().join("broken.ron"), "(camera: (eye: (0, 0").unwrap();
    for command in ["render", "check"] {
        let output = run(directory.path(), &[command, "broken.ron"]);
        assert_eq!(code(&output), 2);
        assert!(text(&output.stderr).contains("broken.ron"));
        assert!(output.stdout.is_empty());
    }
    let output = run(directory.path(), &["check", "broken.ron", "--json"]);
    assert_eq!(code(&output), 2);
    let verdict: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(verdict["ok"], false);
    let mistakes = verdict["mistakes"].as_array().unwrap();
    assert_eq!(verdict["count"], mistakes.len());
    assert_eq!(mistakes[0]["file"], "broken.ron");
    assert_eq!(mistakes[0]["line"], 1);
    assert_eq!(names(directory.path()), ["broken.ron", "scene.ron"]);
}

#[test]
fn a_sound_scene_is_in_order() {
    let directory = workplace();
    let output = run(directory.path(), &["check", "scene.ron"]);
    assert_eq!(code(&output), 0);
    assert!(text(&output.stdout).contains("in order"));
    assert!(text(&output.stdout).contains("64 x 48"));
    let output = run(directory.path(), &["check", "scene.ron", "--json"]);
    let verdict: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(verdict["ok"], true);
    assert_eq!(verdict["resolution"], serde_json::json!([64, 48]));
    assert_eq!(verdict["objects"], 2);
    assert_eq!(verdict["casters"], 1);
    assert_eq!(verdict["lights"], 1);
}

/// A camera and a lamp in water, and ice that no priority tells from it.
#[test]
fn media_are_named_and_ties_are_warned_of() {
    let directory = workplace();
    let scene = |ice: &str| {
        format!(
            "(camera: (eye: (0, 0, 0), look_at: (1, 0, 0), fov: 40), image: (width: 8, height: 6),
              objects: [
                (name: \"water\", shape: Sphere(center: (0, 0, 0), radius: 2), material: Dielectric(ior: 1.33)),
                (name: \"ice\", shape: Sphere(center: (0, 0, 2), radius: 1), material: Dielectric({ice})),
              ],
              lights: [
                Point(name: \"diver\", position: (1, 0, 0), power: 1),
                Sphere(name: \"buoy\", center: (2, 0, 0), radius: 0.2, power: 1),
                Point(name: \"moon\", position: (9, 0, 0), power: 1),
              ])"
        )
    };
    for (ice, warned) in [
        ("ior: 1.31", true),
        ("ior: 1.33", false),
        ("ior: 1.31, priority: 1", false),
        ("ior: 1.31, outside: 1.33", false),
    ] {
        fs::write(directory.path().join("scene.ron"), scene(ice)).unwrap();
        let output = run(directory.path(), &["check", "scene.ron"]);
        assert_eq!(code(&output), 0);
        let said = text(&output.stdout);
        for line in [
            "the camera is inside `water`",
            "the light `diver` is inside `water`",
            "the light `buoy` may reach into `water`",
        ] {
            assert!(said.contains(line), "{line:?} is not in {said}");
        }
        assert!(!said.contains("moon"), "{said}");
        let warning = text(&output.stderr);
        let expected = "warning: `water` and `ice` overlap and have the same priority";
        assert_eq!(warning.contains(expected), warned, "{ice}: {warning}");
        let output = run(directory.path(), &["check", "scene.ron", "--json"]);
        let verdict: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(verdict["media"].as_array().unwrap().len(), 3);
        assert_eq!(verdict["warnings"].as_array().unwrap().is_empty(), !warned);
    }
}

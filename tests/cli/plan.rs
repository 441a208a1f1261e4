//! `nephroid plan`.

use std::fs;

use serde_json::Value;

use crate::{SCENE, code, run, text, workplace};

#[test]
fn a_plan_is_a_table() {
    let directory = workplace();
    let plan = |arguments: &[&str]| {
        let command = [&["plan", "scene.ron", "--resolution", "24x18"], arguments].concat();
        run(directory.path(), &command)
    };
    let output = plan(&[]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let table = text(&output.stdout);
    for word in [
        "24 x 18 pixels",
        "caustics",
        "`lights[0]` may shine on `objects[1]`",
        "every light has an extent",
        "left out: nothing",
    ] {
        assert!(table.contains(word), "no {word:?} in\n{table}");
    }
    assert_eq!(output.stdout, plan(&[]).stdout, "the same words twice");

    let output = plan(&["--effects", "caustics=off,indirect=off"]);
    let table = text(&output.stdout);
    assert!(table.contains("left out: about "), "{table}");
    assert!(table.contains("caustics are switched off"), "{table}");

    let output = plan(&["--json", "--seed", "3"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["ok"], true);
    assert_eq!(value["scene"], "scene.ron");
    assert_eq!(value["resolution"], serde_json::json!([24, 18]));
    assert_eq!(value["funnels"][0]["light"], "lights[0]");
    assert!(value["funnels"][0]["seen"].as_u64().unwrap() > 0);
}

#[test]
fn bad_input_is_told_as_by_check() {
    let directory = workplace();
    let broken = SCENE.replace("radius: 1", "raduis: 1");
    fs::write(directory.path().join("broken.ron"), broken).unwrap();
    let [plan, check] = ["plan", "check"].map(|c| run(directory.path(), &[c, "broken.ron"]));
    assert_eq!((code(&plan), code(&check)), (2, 2));
    assert_eq!(plan.stderr, check.stderr);
    assert!(plan.stdout.is_empty());
    let [plan, check] =
        ["plan", "check"].map(|c| run(directory.path(), &[c, "broken.ron", "--json"]));
    assert_eq!((code(&plan), plan.stdout), (2, check.stdout));

    for (list, said) in [
        ("caustic=off", "`caustics`?"),
        ("caustics=no", "caustics is `auto`, `off` or `on`"),
        ("caustics", "caustics=off"),
        ("refraction=off", "cannot be switched"),
        ("panes=off", "it is `auto` or `on`"),
    ] {
        for command in ["plan", "render"] {
            let output = run(directory.path(), &[command, "scene.ron", "--effects", list]);
            assert_eq!(code(&output), 2, "{list}");
            assert!(
                text(&output.stderr).contains(said),
                "{}",
                text(&output.stderr)
            );
        }
    }
}

/// A render takes the same list, and its report names what was simulated.
#[test]
fn a_render_takes_effects() {
    let directory = workplace();
    let effects = |list: &str| -> Vec<String> {
        let arguments = [
            "--passes",
            "1",
            "-o",
            "a.png",
            "--json",
            "-",
            "-q",
            "--effects",
            list,
        ];
        let output = crate::render(directory.path(), &arguments);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        let names = report["effects"].as_array().unwrap().iter();
        names.map(|n| n.as_str().unwrap().to_owned()).collect()
    };
    let (some, all) = (effects("caustics=off"), effects("all"));
    assert!(!some.contains(&"caustics".to_owned()), "{some:?}");
    assert!(some.contains(&"soft_shadows".to_owned()), "{some:?}");
    for name in ["caustics", "panes", "nesting"] {
        assert!(all.contains(&name.to_owned()), "{all:?}");
    }
}

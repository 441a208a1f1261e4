//! `nephroid price`, and what a render expects of itself.

use std::fs;

use serde_json::Value;

use crate::{SCENE, code, names, render, run, text, workplace};

const SMALL: [&str; 5] = [
    "price",
    "scene.ron",
    "--resolution=24x18",
    "--photons=2000",
    "--pilot=1ms",
];

#[test]
fn prices_are_a_table() {
    let directory = workplace();
    let output = run(directory.path(), &SMALL);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let table = text(&output.stdout);
    for word in [
        "24 x 18 pixels",
        "after 8 passes in ",
        "processor time",
        "\n 20 %",
        "\n0.5 %",
        "90 %)",
    ] {
        assert!(table.contains(word), "no {word:?} in\n{table}");
    }
    assert!(text(&output.stderr).contains("pass 1/64"), "it says so");
    assert_eq!(names(directory.path()), ["scene.ron"], "no picture");
}

/// The same scene, seed and passes: the same statement, and a price that what
/// `render --error` takes agrees with.
#[test]
fn prices_are_what_is_paid() {
    let directory = workplace();
    let list = [&SMALL[..], &["--error=99%,3%,0.001%", "--json"]].concat();
    let output = run(directory.path(), &list);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert!(output.stderr.is_empty());
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["ok"], true);
    assert_eq!(value["resolution"], serde_json::json!([24, 18]));
    assert_eq!(value["pilot"]["passes"], 8);
    let prices = value["prices"].as_array().unwrap();
    let states: Vec<&Value> = prices.iter().map(|p| &p["state"]).collect();
    assert_eq!(states, ["held", "predicted", "beyond"]);
    assert!(prices[2]["more_than_passes"].as_f64().unwrap() > 1000.0);

    let report = |arguments: &[&str]| -> Value {
        let output = render(directory.path(), arguments);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let seen = report(&["--passes", "8", "--quiet", "--json", "-"]);
    assert_eq!(seen["error"]["lit"], value["pilot"]["error"]);
    let paid = report(&["--error", "3%", "--quiet", "--json", "-"]);
    let passes = &prices[1]["passes"];
    let paid = paid["passes"].as_f64().unwrap();
    assert!(
        paid > 8.0 && passes["low"].as_f64().unwrap() <= paid,
        "{paid} {passes}"
    );
    let high = passes["high"].as_f64();
    assert!(high.is_none_or(|high| paid <= high), "{paid} {passes}");
    let [wall, busy] = ["seconds", "cpu_seconds"].map(|k| prices[1][k]["middle"].as_f64().unwrap());
    assert!(wall > 0.0 && busy > 0.0);
}

#[test]
fn bad_input_is_told() {
    let directory = workplace();
    for arguments in [
        &["price"][..],
        &["price", "nowhere.ron"],
        &["price", "scene.ron", "--error", "0"],
        &["price", "scene.ron", "--error", "5%,"],
        &["price", "scene.ron", "--pilot", "soon"],
        &["price", "scene.ron", "--resolution", "90000x90000"],
    ] {
        let output = run(directory.path(), arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(!output.stderr.is_empty() && output.stdout.is_empty());
    }
    let broken = SCENE.replace("radius: 1", "raduis: 1");
    fs::write(directory.path().join("broken.ron"), broken).unwrap();
    let [price, check] =
        ["price", "check"].map(|c| run(directory.path(), &[c, "broken.ron", "--json"]));
    assert_eq!((code(&price), price.stdout), (2, check.stdout));
    // A light without light: nothing can be told of a black picture.
    let dark = SCENE.replace("radiance: 200", "radiance: 1e-300");
    fs::write(directory.path().join("dark.ron"), dark).unwrap();
    let small = ["price", "dark.ron", "--resolution=8x6", "--pilot=1ms", "-q"];
    let output = run(directory.path(), &small);
    assert_eq!(code(&output), 1, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("black"));
}

/// A render that is asked for an error tells when it will be reached.
#[test]
fn a_render_tells_what_it_expects() {
    let directory = workplace();
    let asked = ["--passes", "9", "--error", "0.5%"];
    let output = render(directory.path(), &asked);
    let said = text(&output.stderr);
    let last = said.lines().find(|l| l.starts_with("pass 9/9"));
    let last = last.unwrap_or_else(|| panic!("{said}"));
    assert!(last.contains("0.5 % "), "{last}");
    assert!(
        last.contains(" in about ") || last.contains(" not before "),
        "{last}"
    );
    assert!(last.contains(" % at the end ("), "{last}");
}

//! `nephroid render`: what it writes, when it ends, what survives.

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Command, Stdio},
};

use exr::prelude::{AttributeValue, MetaData, Text};
use nephroid::film::read_exr;

use crate::{SMALL, code, names, program, render, run, text, workplace};

fn number(path: &Path, attribute: &str) -> f64 {
    let meta = MetaData::read_from_file(path, true).unwrap();
    let own = &meta.headers[0].own_attributes.other;
    match own.get(&Text::from(attribute)) {
        Some(AttributeValue::F64(value)) => *value,
        other => panic!("{attribute}: {other:?}"),
    }
}

#[test]
fn without_names_both_files_appear_here() {
    let directory = workplace();
    fs::create_dir(directory.path().join("here")).unwrap();
    let here = directory.path().join("here");
    let arguments = [&["render", "../scene.ron", "--passes", "1"][..], &SMALL].concat();
    let output = run(&here, &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert_eq!(names(&here), ["scene.exr", "scene.png"]);
    assert!(output.stdout.is_empty(), "words go to standard error");
    assert!(text(&output.stderr).contains("pass 1/1"));
    assert!(text(&output.stderr).contains("wrote scene.exr"));
    let png = image::open(here.join("scene.png")).unwrap();
    assert_eq!((png.width(), png.height()), (24, 18));
}

#[test]
fn what_was_typed_reaches_the_file() {
    let directory = workplace();
    let path = directory.path().join("a.exr");
    let arguments = [
        "-o",
        "a.exr",
        "-o",
        "b.PNG",
        "--passes",
        "3",
        "--seed",
        "18446744073709551615",
        "--threads",
        "2",
        "--quiet",
        "--json",
        "report.json",
    ];
    let output = render(directory.path(), &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert!(
        output.stderr.is_empty() && output.stdout.is_empty(),
        "quiet"
    );
    assert_eq!(
        names(directory.path()),
        ["a.exr", "b.PNG", "report.json", "scene.ron"]
    );
    assert_eq!(number(&path, "passes"), 3.0);
    let report = fs::read(directory.path().join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    assert!(report.is_object());
    let image = read_exr(&path, "").unwrap();
    assert_eq!((image.width(), image.height()), (24, 18));
    assert!(image.mean().mean() > 0.0);
}

#[test]
fn the_report_goes_to_standard_output_on_request() {
    let directory = workplace();
    let output = render(
        directory.path(),
        &["-o", "a.exr", "--passes", "1", "--json", "-"],
    );
    assert_eq!(code(&output), 0);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report.is_object());
    assert_eq!(names(directory.path()), ["a.exr", "scene.ron"]);
}

/// Another method makes the same files and says its name and what it misses.
#[test]
fn a_method_is_chosen_by_its_name() {
    let directory = workplace();
    let arguments = [
        "-o", "a.exr", "--passes", "2", "--method", "light", "--json", "-",
    ];
    let output = render(directory.path(), &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let words = text(&output.stderr);
    assert!(
        words.contains("note: method light: what mirrors and glass show"),
        "{words}"
    );
    assert!(words.contains("2 passes of method light"), "{words}");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["method"], "light");
    let path = directory.path().join("a.exr");
    let meta = MetaData::read_from_file(&path, true).unwrap();
    let named = meta.headers[0]
        .own_attributes
        .other
        .get(&Text::from("method"));
    assert_eq!(named, Some(&AttributeValue::Text(Text::from("light"))));
    assert!(read_exr(&path, "caustic").unwrap().mean().mean() > 0.0);
    let output = render(directory.path(), &["--method", "magic"]);
    assert_eq!(code(&output), 2);
    let words = text(&output.stderr);
    assert!(
        words.contains("magic") && words.contains("metropolis"),
        "{words}"
    );
}

/// What was typed for one method is not ignored by another.
#[test]
fn what_a_method_has_no_use_for_is_refused() {
    let directory = workplace();
    for (arguments, complaint) in [
        (
            ["--method", "path"].as_slice(),
            "--photons is not for --method path",
        ),
        (
            &["--method", "sppm", "--nearest", "9"],
            "--nearest is not for --method sppm",
        ),
        (&["--patches", "9"], "--patches is not for --method photons"),
        (
            &["--method", "radiosity"],
            "cannot divide objects[0] into elements",
        ),
    ] {
        let output = render(directory.path(), arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        let words = text(&output.stderr);
        assert!(words.contains(complaint), "{words}");
    }
    assert_eq!(names(directory.path()), ["scene.ron"]);
    let arguments = [
        "-o",
        "a.exr",
        "--passes",
        "2",
        "--method",
        "photon-map",
        "--nearest",
        "9",
        "--json",
        "-",
    ];
    let output = render(directory.path(), &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    // Each of two replicates has a map of its own.
    assert_eq!(report["light_paths"], 2 * 2000);
}

/// A picture that does not fit is refused by every method.
#[test]
fn a_budget_is_kept_by_every_method() {
    let directory = workplace();
    let scene = fs::read_to_string(directory.path().join("scene.ron")).unwrap();
    let scene = scene.trim_end().strip_suffix(')').unwrap();
    let small = format!("{scene} render: (memory: \"64 MiB\"))");
    fs::write(directory.path().join("scene.ron"), small).unwrap();
    for method in ["path", "light", "bdpt", "metropolis", "sppm", "photon-map"] {
        let arguments = [
            "render",
            "scene.ron",
            "--resolution",
            "640x480",
            "--method",
            method,
        ];
        let output = run(directory.path(), &arguments);
        let words = text(&output.stderr);
        assert_eq!(code(&output), 2, "{method}: {words}");
        assert!(
            words.contains(method) && words.contains("render.memory"),
            "{words}"
        );
    }
}

#[test]
fn a_crop_shows_its_part_of_the_picture() {
    let directory = workplace();
    let crop = ["-o", "part.exr", "--passes", "1", "--crop", "20,10,4x3"];
    let output = render(directory.path(), &crop);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let path = directory.path().join("part.exr");
    let image = read_exr(&path, "").unwrap();
    assert_eq!((image.width(), image.height()), (4, 3));
    let meta = MetaData::read_from_file(&path, true).unwrap();
    let header = &meta.headers[0];
    assert_eq!(
        header.own_attributes.layer_position,
        exr::prelude::Vec2(20, 10)
    );
    assert_eq!(
        header.shared_attributes.display_window.size,
        exr::prelude::Vec2(24, 18)
    );
}

/// However short the time, one pass is made; the clock decides how many more.
#[test]
fn time_ends_a_render_after_a_pass() {
    let directory = workplace();
    let output = render(directory.path(), &["-o", "a.exr", "--time", "1ms"]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert!(number(&directory.path().join("a.exr"), "passes") >= 1.0);
}

#[test]
fn a_failed_render_leaves_an_existing_file_alone() {
    let directory = workplace();
    fs::write(directory.path().join("a.exr"), "precious").unwrap();
    let broken = run(directory.path(), &["render", "missing.ron", "-o", "a.exr"]);
    assert_eq!(code(&broken), 2);
    assert_eq!(
        fs::read_to_string(directory.path().join("a.exr")).unwrap(),
        "precious"
    );
}

/// Waits for the first line of progress, interrupts, and finds what was reached.
#[cfg(unix)]
#[test]
fn an_interrupt_saves_what_was_reached() {
    for signal in ["-INT", "-TERM"] {
        let directory = workplace();
        let arguments = [
            "render",
            "scene.ron",
            "-o",
            "a.exr",
            "--passes",
            "4000000000",
        ];
        let mut child = program(directory.path())
            .args([&arguments[..], &SMALL].concat())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        said.read_line(&mut line).unwrap();
        assert!(line.starts_with("pass "), "{line}");
        let kill = Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        let rest: Vec<String> = said.lines().map(Result::unwrap).collect();
        assert_eq!(child.wait().unwrap().code(), Some(3), "{rest:?}");
        assert!(
            rest.iter().any(|line| line.contains("interrupted")),
            "{rest:?}"
        );
        assert_eq!(names(directory.path()), ["a.exr", "scene.ron"]);
        assert!(number(&directory.path().join("a.exr"), "passes") >= 1.0);
    }
}

/// Nobody reads what the program says: it works on.
#[test]
fn a_closed_pipe_does_not_stop_the_work() {
    let directory = workplace();
    let arguments = ["render", "scene.ron", "-o", "a.exr", "--passes", "2"];
    let mut child = program(directory.path())
        .args([&arguments[..], &SMALL].concat())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(names(directory.path()), ["a.exr", "scene.ron"]);
}

/// Of passes and time, the one that is reached first ends the render.
#[test]
fn passes_bound_a_timed_render() {
    let directory = workplace();
    let arguments = ["-o", "a.exr", "--time", "10h", "--passes", "2"];
    let output = render(directory.path(), &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert_eq!(number(&directory.path().join("a.exr"), "passes"), 2.0);
}

/// A report that cannot be delivered is a fault, but the picture is saved.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_the_report_is_a_fault() {
    let directory = workplace();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let arguments = [
        "render",
        "scene.ron",
        "-o",
        "a.exr",
        "--passes",
        "1",
        "--json",
        "-",
    ];
    let output = program(directory.path())
        .args([&arguments[..], &SMALL].concat())
        .stdout(full)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
        .wait_with_output()
        .unwrap();
    assert_eq!(code(&output), 1);
    assert!(text(&output.stderr).contains("standard output"));
    assert_eq!(names(directory.path()), ["a.exr", "scene.ron"]);
}

#[test]
fn an_error_that_is_asked_for_is_reached_or_missed() {
    let directory = workplace();
    let path = directory.path().join("a.exr");
    let arguments = ["-o", "a.exr", "--json", "a.json", "--error"];
    let output = render(directory.path(), &[&arguments[..], &["90%"]].concat());
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let last = text(&output.stderr).lines().last().unwrap();
    assert!(
        last.starts_with("error ") && last.ends_with("; 90 % is reached"),
        "{last}"
    );
    let report = fs::read_to_string(directory.path().join("a.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let error = &report["error"];
    assert_eq!(error["target"], 0.9);
    assert!(error["lit"]["bound"].as_f64().unwrap() <= 0.9, "{error}");
    assert_eq!(error["lit"]["bound"], number(&path, "errorBound"));
    assert!(number(&path, "errorNoise") > 0.0 && number(&path, "causticError") > 0.0);
    let meta = MetaData::read_from_file(&path, true).unwrap();
    let channels = &meta.headers[0].channels.list;
    for name in ["error.noise.R", "error.bias.B"] {
        assert!(channels.iter().any(|c| c.name.eq(name)), "{name}");
    }

    let missed = [&arguments[..], &["0.01%", "--passes", "16", "--quiet"]].concat();
    let output = render(directory.path(), &missed);
    assert_eq!(code(&output), 4, "{}", text(&output.stderr));
    assert_eq!(number(&path, "passes"), 16.0);

    let output = render(directory.path(), &["--error", "5", "--quiet"]);
    assert_eq!(code(&output), 2);
    assert!(
        text(&output.stderr).contains("5%"),
        "{}",
        text(&output.stderr)
    );
    let output = render(
        directory.path(),
        &["--error", "5%", "--method", "path", "--quiet"],
    );
    assert_eq!(code(&output), 2);
}

/// Twenty-one passes end inside the third round: the second is told of, too, as a
/// render of sixteen passes tells of itself, and files say nothing of it.
#[test]
fn inside_a_round_the_last_full_one_is_told_of() {
    let directory = workplace();
    let report = |passes: &str| -> serde_json::Value {
        let arguments = [
            "-o", "a.exr", "--json", "a.json", "--passes", passes, "--quiet",
        ];
        let output = render(directory.path(), &arguments);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
        fs::remove_file(directory.path().join("a.exr")).unwrap();
        let report = fs::read_to_string(directory.path().join("a.json")).unwrap();
        fs::remove_file(directory.path().join("a.json")).unwrap();
        serde_json::from_str(&report).unwrap()
    };
    let (whole, inside) = (report("16"), report("21"));
    let last = &inside["last_round"];
    assert_eq!(last["passes"], 16);
    for region in ["lit", "caustics"] {
        assert_eq!(last[region], whole["error"][region], "{region}");
        assert_ne!(last[region], inside["error"][region], "{region}");
    }
    assert!(whole["last_round"].is_null());

    let arguments = ["-o", "a.exr", "--passes", "13"];
    let output = render(directory.path(), &arguments);
    let line = text(&output.stderr).lines().last().unwrap();
    assert!(line.contains("; after 8 passes of full rounds "), "{line}");
}

//! `nephroid study`: what it refuses, what it writes, how it goes on.

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::Stdio,
};

use nephroid::study::{Study, TruthKind};

use crate::{code, names, program, run, text, workplace};

/// A small study of `scene.ron` with further arguments.
fn study(directory: &Path, arguments: &[&str]) -> std::process::Output {
    let small = ["study", "scene.ron", "-o", "report", "--resolution", "12x9"];
    run(directory, &[&small[..], arguments].concat())
}

fn read(directory: &Path) -> Study {
    let text = fs::read_to_string(directory.join("report/study.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// Little work; the reference has its first stage only.
const TINY: [&str; 8] = [
    "--passes",
    "2",
    "--seeds",
    "2",
    "--methods",
    "photons",
    "--reference-time",
    "1ms",
];

#[test]
fn mistakes_are_told_before_anything_is_made() {
    let directory = workplace();
    let here = directory.path();
    fs::create_dir(here.join("references")).unwrap();
    fs::write(here.join("broken.ron"), "(").unwrap();
    for (arguments, words) in [
        (&["--seeds", "0"][..], "seeds"),
        (&["--targets", "0%"], "above zero"),
        (&["--targets", "2000%"], "up to 1000 %"),
        (&["--time", "0s"], "time"),
        (&["--passes", "0"], "0"),
        (&["--methods", "magic"], "magic"),
        (&["--methods", "path", "--sweep", "radius=1"], "photons"),
        (&["--sweep", "radius=-1"], "above zero"),
        (&["--sweep", "colour=1"], "no such setting"),
        (&["--reference-method", "photons"], "independent"),
        (&["--reference-method", "light-naive"], "blurred"),
        (&["--reference", "none.exr"], "none.exr"),
        (&["--reference", "references"], "scene.exr"),
        (&["--reference", "scene.ron"], "scene.ron"),
        (&["--resolution", "900000x900000"], "--resolution"),
        (&["broken.ron"], "broken.ron"),
        (&["missing.ron"], "missing.ron"),
    ] {
        let mut all = vec!["study", "scene.ron", "-o", "report"];
        all.extend(arguments);
        let output = run(here, &all);
        assert_eq!(code(&output), 2, "{arguments:?}");
        let said = text(&output.stderr);
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert!(!here.join("report").exists(), "{arguments:?}");
    }
    fs::write(here.join("mine.txt"), "mine").unwrap();
    let output = run(here, &["study", "scene.ron", "-o", "."]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("not empty"));
}

#[test]
fn a_study_from_end_to_end() {
    let directory = workplace();
    let here = directory.path();
    let listed = study(here, &["--list", "--sweep", "radius=1"]);
    assert_eq!(code(&listed), 0);
    let said = text(&listed.stderr);
    assert!(
        said.contains("photons, radius 1")
            && said.contains("reference by the best of bdpt, path, metropolis, sppm"),
        "{said}"
    );
    assert!(said.contains("without whitted"), "{said}");
    assert!(!here.join("report").exists());

    let arguments = [&TINY[..], &["--json", "--threads", "2"]].concat();
    let output = study(here, &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("seconds of processor time"));
    let found = read(here);
    let shown: Study = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(shown, found);
    assert_eq!(found.machine.threads, 2);
    let scene = &found.scenes[0];
    assert_eq!((&*scene.name, scene.resolution), ("scene", [12, 9]));
    assert_eq!(scene.truth.kind, TruthKind::Made);
    assert!(names(here).contains(&"report".to_owned()));

    // Again: nothing is rendered, nothing is said.
    let output = study(here, &[&TINY[..], &["--quiet"]].concat());
    assert_eq!((code(&output), text(&output.stderr)), (0, ""));
    let mut again = read(here);
    again.made.clone_from(&found.made);
    again.machine.threads = 2;
    assert_eq!(again, found, "with the times of then");
}

#[test]
fn a_given_picture_is_the_truth() {
    let directory = workplace();
    let here = directory.path();
    let size = ["--resolution", "12x9", "--passes", "2", "--quiet"];
    let render = [
        &["render", "scene.ron", "-o", "scene.exr", "--method", "path"][..],
        &size,
    ];
    assert_eq!(code(&run(here, &render.concat())), 0);
    let given = [&TINY[..6], &["--reference", ".", "--quiet"]].concat();
    let output = study(here, &given);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let scene = read(here).scenes.remove(0);
    assert_eq!(scene.truth.kind, TruthKind::Given);
    assert!(
        scene.truth.words.contains("scene.exr"),
        "{}",
        scene.truth.words
    );
    assert!(
        here.join("report")
            .join(scene.truth.picture.unwrap())
            .is_file()
    );
}

/// Killed in the middle, the study keeps its finished runs, and goes on.
#[test]
fn a_killed_study_goes_on() {
    let directory = workplace();
    let here = directory.path();
    let arguments = [
        "study",
        "scene.ron",
        "-o",
        "report",
        "--resolution",
        "12x9",
        "--passes",
        "2",
        "--seeds",
        "3",
        "--methods",
        "photons,path",
        "--reference-time",
        "1ms",
    ];
    let runs = || {
        let mut runs = names(&here.join("report/runs"));
        runs.retain(|n| n.starts_with("scene-photons") && !n.contains(".exr"));
        runs
    };
    let mut child = program(here)
        .args(arguments)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Its first line comes before the first run, and runs follow soon.
    let mut said = String::new();
    BufReader::new(child.stderr.take().unwrap())
        .read_line(&mut said)
        .unwrap();
    while !here.join("report/runs").exists() || runs().is_empty() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = runs();
    let print = |name: &String| fs::read(here.join("report/runs").join(name)).unwrap();
    let before: Vec<Vec<u8>> = kept.iter().map(print).collect();
    let output = run(here, &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let after: Vec<Vec<u8>> = kept.iter().map(print).collect();
    assert_eq!(before, after, "what was finished was not made again");
    assert_eq!(runs().len(), 3);
    let scene = read(here).scenes.remove(0);
    assert_eq!(scene.series.len() + scene.absent.len(), 2);
}

//! `nephroid bench`.

use std::{fs, path::Path};

use nephroid::{
    film::{Window, write_exr},
    render::{Job, run as render_scene},
    scene,
    study::{Benchmark, Task},
};
use tempfile::TempDir;

use super::{SCENE, code, run, text};

/// A benchmark of one small scene under the name of one of the five.
fn workplace() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let scenes = directory.path().join("scenes");
    fs::create_dir_all(scenes.join("references")).unwrap();
    let small = SCENE.replace("width: 64, height: 48", "width: 16, height: 12");
    fs::write(scenes.join("cup.ron"), &small).unwrap();
    let scene = scene::load_str(&small, "cup.ron", Path::new(".")).unwrap();
    let mut job = Job::of(&scene);
    job.settings.passes = 32;
    job.settings.seed = 99;
    let film = render_scene(&scene, &job, &mut |_| std::ops::ControlFlow::Continue(())).film;
    let picture = film.image();
    let path = scenes.join("references/cup.exr");
    write_exr(&path, &[("", &picture)], Window::whole(16, 12), &[]).unwrap();
    directory
}

#[test]
fn a_benchmark_is_written_and_compared_with() {
    let place = workplace();
    let bench = |arguments: &[&str]| {
        let all = [
            &["bench", "cup", "--passes", "8", "--seeds", "2"],
            arguments,
        ]
        .concat();
        run(place.path(), &all)
    };
    let first = bench(&["--json", "old.json"]);
    assert_eq!(code(&first), 0, "{}", text(&first.stderr));
    assert!(text(&first.stderr).contains("cup"));
    let words = fs::read_to_string(place.path().join("old.json")).unwrap();
    let old: Benchmark = serde_json::from_str(&words).unwrap();
    assert_eq!(old.scenes[0].runs.len(), 2);
    for run in &old.scenes[0].runs {
        assert!(run.curve.windows(2).all(|w| w[0].0 < w[1].0), "{run:?}");
    }
    let excused = bench(&["--against", "old.json", "-q", "--json", "-"]);
    assert!([0, 5].contains(&code(&excused)));
    let again: Benchmark = serde_json::from_str(text(&excused.stdout)).unwrap();
    let errors =
        |b: &Benchmark| -> Vec<f64> { b.scenes[0].runs[0].curve.iter().map(|p| p.1).collect() };
    assert_eq!(errors(&old), errors(&again), "errors are the seed's alone");
    // A thousand times slower than before is slower on any machine.
    let mut quick = old.clone();
    for run in &mut quick.scenes[0].runs {
        for seconds in run.cpu_seconds.iter_mut().flatten() {
            *seconds *= 1e-3;
        }
    }
    let path = place.path().join("quick.json");
    fs::write(path, serde_json::to_string(&quick).unwrap()).unwrap();
    let slower = bench(&["--against", "quick.json"]);
    assert_eq!(code(&slower), 5, "{}", text(&slower.stderr));
    assert!(text(&slower.stderr).contains("slower"));
}

#[test]
fn what_is_missing_is_named() {
    let place = tempfile::tempdir().unwrap();
    let bench = |arguments: &[&str]| run(place.path(), &[&["bench"], arguments].concat());
    let none = bench(&["cup"]);
    assert_eq!(code(&none), 2);
    assert!(text(&none.stderr).contains("cup.ron") && text(&none.stderr).contains("--scenes"));
    fs::write(place.path().join("bad.json"), "{}").unwrap();
    let bad = bench(&["--against", "bad.json"]);
    assert_eq!(code(&bad), 2);
    assert!(
        text(&bad.stderr).contains("bad.json"),
        "{}",
        text(&bad.stderr)
    );
    assert_eq!(code(&bench(&["teapot"])), 2);
    assert_eq!(code(&bench(&["--seeds", "0"])), 2);
    assert_eq!(code(&bench(&["--json", "no/where.json"])), 1);
}

/// A render stops at the first look that is good enough, and a target that is
/// not reached has no time.
#[test]
fn a_run_ends_at_its_target() {
    let place = workplace();
    let scene = scene::load(&place.path().join("scenes/cup.ron")).unwrap();
    let path = place.path().join("scenes/references/cup.exr");
    let reference = nephroid::film::read_exr(&path, "").unwrap();
    let task = |targets| Task {
        scene: &scene,
        reference: &reference,
        targets,
        passes: 8,
    };
    let mut passes = 0;
    let mut told = |n| {
        passes = n;
        std::ops::ControlFlow::Continue(())
    };
    let easy = task(&[1e6, 1e5]).run(1, &mut told).unwrap();
    assert_eq!(easy.curve.len(), 1);
    assert_eq!(easy.cpu_seconds, [Some(easy.curve[0].0); 2]);
    let hard = task(&[1e6, 1e-9]).run(1, &mut told).unwrap();
    assert_eq!((passes, hard.curve.len()), (8, 6), "1, 2, 3, 4, 6, 8");
    assert_eq!(hard.cpu_seconds[1], None);
    let stopped = task(&[1e-9]).run(1, &mut |_| std::ops::ControlFlow::Break(()));
    assert!(stopped.is_err());
}

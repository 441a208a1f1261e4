//! What is not gone on from, and why; the file stays as it was.

use std::{fs, path::Path};

use crate::{done, names, run, text, workplace};

/// Whether a render with these arguments is refused for this reason, and has
/// touched nothing.
fn assert_refused(directory: &Path, arguments: &str, says: &str) {
    let before = names(directory);
    let kept = fs::read(directory.join("a.ckpt")).unwrap();
    for flag in ["--checkpoint", "--resume"] {
        let command = format!("render scene.ron -o new.exr {flag} a.ckpt {arguments}");
        let output = run(directory, &command);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains(says), "{command}: {said}");
        assert!(said.contains("a.ckpt"), "{command}: {said}");
    }
    assert_eq!(names(directory), before, "{arguments}");
    assert!(
        fs::read(directory.join("a.ckpt")).unwrap() == kept,
        "{arguments}"
    );
}

#[test]
fn checkpoints_of_other_renders() {
    let directory = workplace();
    let path = directory.path();
    done(
        path,
        "render scene.ron -q -o a.png --passes 3 --checkpoint a.ckpt",
    );
    for (arguments, says) in [
        ("--passes 8 --seed 4", "the seed is 3 there and 4 here"),
        (
            "--passes 8 --resolution 12x9",
            "the resolution is 24x18 there and 12x9 here",
        ),
        (
            "--passes 8 --crop 0,0,9x9",
            "the crop is 0,0,24x18 there and 0,0,9x9 here",
        ),
        (
            "--passes 8 --photons 999",
            "photons in a pass is 1000 there and 999 here",
        ),
        (
            "--passes 8 --method path",
            "the method is photons there and path here",
        ),
        ("--passes 2", "3 passes already, more than the 2 asked for"),
        (
            "--passes 1..8",
            "the passes 0..3, but the render starts with pass 1",
        ),
    ] {
        assert_refused(path, arguments, says);
    }
    let write = |name: &str, from: &str, to: &str| {
        let before = fs::read_to_string(path.join(name)).unwrap();
        assert!(before.contains(from));
        fs::write(path.join(name), before.replace(from, to)).unwrap();
        before
    };
    let scene = write("scene.ron", "fov: 45", "fov: 45.0");
    assert_refused(path, "--passes 8", "the scene file has changed");
    fs::write(path.join("scene.ron"), scene).unwrap();
    write("tile.obj", "0.6", "0.7");
    assert_refused(path, "--passes 8", "tile.obj has changed");
    write("tile.obj", "0.7", "0.6");
    done(
        path,
        "render scene.ron -q -o a.png --passes 4 --checkpoint a.ckpt",
    );
}

#[test]
fn damaged_checkpoints_and_other_files() {
    let directory = workplace();
    let path = directory.path();
    let file = path.join("a.ckpt");
    done(
        path,
        "render scene.ron -q -o a.png --passes 2 --checkpoint a.ckpt",
    );
    let whole = fs::read(&file).unwrap();
    let damaged = "the checkpoint is damaged";
    for end in [0, 5, 12, 40, whole.len() / 2, whole.len() - 1] {
        fs::write(&file, &whole[..end]).unwrap();
        assert_refused(path, "--passes 8", damaged);
    }
    for at in [20, 100, whole.len() / 2, whole.len() - 1] {
        let mut flipped = whole.clone();
        flipped[at] ^= 4;
        fs::write(&file, flipped).unwrap();
        assert_refused(path, "--passes 8", damaged);
    }
    let mut other = whole.clone();
    other[8] = 1;
    fs::write(&file, other).unwrap();
    assert_refused(path, "--passes 8", "format 1");
    fs::write(&file, "my diary").unwrap();
    assert_refused(path, "--passes 8", "no checkpoint of nephroid");
}

#[test]
fn mistakes_on_the_command_line() {
    let directory = workplace();
    let before = names(directory.path());
    for (arguments, says) in [
        ("--resume missing.ckpt", "missing.ckpt"),
        ("--checkpoint nowhere/a.ckpt", "nowhere does not exist"),
        ("--checkpoint a.exr", "twice"),
        ("--checkpoint-every 5s", "--checkpoint FILE"),
        ("--checkpoint a.ckpt --checkpoint-every 5", "5s"),
        (
            "--method sppm --checkpoint a.ckpt",
            "checkpoint is not for --method sppm",
        ),
        (
            "--method sppm --passes 2..4",
            "--passes is not for --method sppm",
        ),
        ("--method photon-map --passes 2..4", "those before them"),
        ("--passes 5..5", "empty"),
        ("--passes 5..", "64..128"),
    ] {
        let output = run(
            directory.path(),
            &format!("render scene.ron -o a.exr {arguments}"),
        );
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {said}");
        assert!(said.contains(says), "{arguments}: {said}");
        assert_eq!(names(directory.path()), before, "{arguments}");
    }
}

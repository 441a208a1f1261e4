//! The program as a user meets it: what it accepts, what it says, how it ends.

mod bench;
mod check;
mod lens;
mod plan;
mod price;
mod render;
mod study;

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use tempfile::TempDir;

const SCENE: &str = r#"(
    camera: (eye: (0, -5, 3.5), look_at: (0, 0, 0.3), up: (0, 0, 1), fov: 45),
    image: (width: 64, height: 48),
    materials: {
        "floor": Diffuse(reflectance: 0.5),
        "crown": Dielectric(ior: 1.5),
    },
    objects: [
        (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: "floor"),
        (shape: Sphere(center: (0, 0, 1), radius: 1), material: "crown"),
    ],
    lights: [Sphere(center: (2, -1, 4), radius: 0.15, radiance: 200)],
)
"#;

/// A small render, whatever the scene says.
const SMALL: [&str; 4] = ["--resolution", "24x18", "--photons", "2000"];

/// An empty directory with `scene.ron` in it.
fn workplace() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("scene.ron"), SCENE).unwrap();
    directory
}

fn program(directory: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nephroid"));
    command.current_dir(directory);
    command
}

fn run(directory: &Path, arguments: &[&str]) -> Output {
    program(directory).args(arguments).output().unwrap()
}

/// A small render with further arguments.
fn render(directory: &Path, arguments: &[&str]) -> Output {
    let command = [&["render", "scene.ron"], &SMALL[..], arguments].concat();
    run(directory, &command)
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("ended by itself")
}

/// The names in a directory, sorted.
fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn help_and_version() {
    let directory = workplace();
    for arguments in [
        &["--help"][..],
        &["render", "--help"],
        &["check", "--help"],
        &["compare", "--help"],
        &["study", "--help"],
    ] {
        let output = run(directory.path(), arguments);
        assert_eq!(code(&output), 0);
        assert!(output.stderr.is_empty());
        assert!(text(&output.stdout).contains("Exit codes"), "{arguments:?}");
    }
    let help = run(directory.path(), &["render", "--help"]);
    for flag in [
        "--output",
        "--passes",
        "--time",
        "--seed",
        "--threads",
        "--resolution",
        "--crop",
        "--photons",
        "--quiet",
        "--json",
    ] {
        assert!(text(&help.stdout).contains(flag), "{flag}");
    }
    let version = run(directory.path(), &["--version"]);
    let expected = concat!("nephroid ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(text(&version.stdout), expected);
}

/// Each mistake ends with code 2, names what is wrong, and writes nothing.
#[test]
fn mistakes_on_the_command_line() {
    let directory = workplace();
    fs::create_dir(directory.path().join("folder.exr")).unwrap();
    let before = names(directory.path());
    for (arguments, says) in [
        (&[][..], "Usage"),
        (&["rendr", "scene.ron"], "render"),
        (&["render"], "SCENE"),
        (&["render", "scene.ron", "--pases", "3"], "--passes"),
        (&["render", "scene.ron", "--passes", "0"], "--passes"),
        (&["render", "scene.ron", "--threads", "0"], "--threads"),
        (&["render", "scene.ron", "--photons", "0"], "--photons"),
        (&["render", "scene.ron", "--seed", "-1"], "-1"),
        (&["render", "scene.ron", "--time", "30"], "30s"),
        (&["render", "scene.ron", "--time", "0s"], "above zero"),
        (&["render", "scene.ron", "--resolution", "800"], "800x600"),
        (
            &["render", "scene.ron", "--resolution", "0x600"],
            "at least one pixel",
        ),
        (
            &["render", "scene.ron", "--resolution", "900000x900000"],
            "--crop",
        ),
        (&["render", "scene.ron", "--crop", "1,2"], "100,50,320x240"),
        (&["render", "scene.ron", "--crop", "60,0,5x5"], "64 x 48"),
        (&["render", "scene.ron", "-o", "a.jpg"], ".exr or .png"),
        (&["render", "scene.ron", "-o", "a"], ".exr or .png"),
        (
            &["render", "scene.ron", "-o", "nowhere/a.exr"],
            "nowhere does not exist",
        ),
        (
            &["render", "scene.ron", "-o", "scene.ron/a.exr"],
            "not a directory",
        ),
        (
            &["render", "scene.ron", "-o", "folder.exr"],
            "is a directory",
        ),
        (
            &["render", "scene.ron", "-o", "a.exr", "-o", "a.exr"],
            "twice",
        ),
        (
            &["render", "scene.ron", "--json", "nowhere/a.json"],
            "nowhere does not exist",
        ),
        (&["render", "missing.ron"], "missing.ron"),
        (&["check", "missing.ron"], "missing.ron"),
        (&["check", "folder.exr"], "folder.exr"),
    ] {
        let output = run(directory.path(), arguments);
        let said = text(&output.stderr);
        assert_eq!(code(&output), 2, "{arguments:?}: {said}");
        assert!(said.contains(says), "{arguments:?}: {said}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert_eq!(names(directory.path()), before, "{arguments:?}");
    }
}

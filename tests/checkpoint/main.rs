//! Renders that are killed, split, gone on from: the same bytes in the end, and
//! nothing wrong is ever gone on from.

mod failing;
mod kills;
mod merging;
mod refusals;
mod resuming;

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use nephroid::render::Part;
use tempfile::TempDir;

/// A lens of a mesh file beside a ball; two lights, so that ledgers have
/// something to sum.
const SCENE: &str = r#"(
    camera: (eye: (0, -5, 3.5), look_at: (0, 0, 0.3), fov: 45),
    image: (width: 24, height: 18),
    objects: [
        (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
        (shape: Sphere(center: (0, 0, 1), radius: 1), material: Dielectric(ior: 1.5)),
        (shape: Mesh(file: "tile.obj"), material: Mirror(reflectance: 0.8)),
    ],
    lights: [
        Sphere(center: (2, -1, 4), radius: 0.15, radiance: 200),
        Point(position: (-2, 1, 3), power: 20),
    ],
    render: (photons: 1000, seed: 3),
)
"#;

const TILE: &str = "v 1 1 0.2\nv 2 1 0.2\nv 2 2 0.6\nv 1 2 0.6\nf 1 2 3 4\n";

/// A directory with `scene.ron` and the file it names.
fn workplace() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("scene.ron"), SCENE).unwrap();
    fs::write(directory.path().join("tile.obj"), TILE).unwrap();
    directory
}

fn program(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nephroid"));
    command.current_dir(directory).args(arguments);
    command
}

fn run(directory: &Path, arguments: &str) -> Output {
    let arguments: Vec<&str> = arguments.split_whitespace().collect();
    program(directory, &arguments).output().unwrap()
}

/// Runs what must succeed; what it said.
fn done(directory: &Path, arguments: &str) -> String {
    let output = run(directory, arguments);
    let said = text(&output.stderr).to_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments}: {said}");
    said
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The names in a directory, sorted.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// All that a render leaves, but for the time it took, and apart what it saw of full
/// rounds: a run that comes in later, or merges parts, has not seen them.
#[derive(PartialEq)]
struct Product {
    exr: Vec<u8>,
    png: Vec<u8>,
    report: serde_json::Value,
    last_round: serde_json::Value,
}

/// The arguments that make a [`Product`].
const FILES: &str = "-o a.exr -o a.png --json a.json --quiet";

impl Product {
    /// What [`FILES`] has left in a directory.
    fn in_directory(directory: &Path) -> Self {
        let mut exr = fs::read(directory.join("a.exr")).unwrap();
        let name = b"renderSeconds\0double\0";
        let at = exr.windows(name.len()).position(|w| w == name).unwrap();
        let value = at + name.len() + 4;
        exr[value..value + 8].fill(0);
        let report = fs::read(directory.join("a.json")).unwrap();
        let mut report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        let seconds = report.as_object_mut().unwrap().remove("seconds").unwrap();
        assert!(seconds.as_f64().unwrap() > 0.0);
        let last_round = report.as_object_mut().unwrap().remove("last_round");
        let last_round = last_round.unwrap_or_default();
        let png = fs::read(directory.join("a.png")).unwrap();
        Self {
            exr,
            png,
            report,
            last_round,
        }
    }

    /// What an undisturbed render with further arguments makes.
    fn of(arguments: &str) -> Self {
        let directory = workplace();
        done(
            directory.path(),
            &format!("render scene.ron {FILES} {arguments}"),
        );
        Self::in_directory(directory.path())
    }

    fn assert_same(&self, other: &Self, what: &str) {
        assert_eq!(self.report, other.report, "{what}: reports");
        assert!(self.exr == other.exr, "{what}: EXR files differ");
        assert!(self.png == other.png, "{what}: PNG files differ");
    }
}

/// Passes in a checkpoint, which must be whole.
fn passes_in(path: &Path) -> u32 {
    Part::load(path).unwrap_or_else(|e| panic!("{e}")).passes()
}

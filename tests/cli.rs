//! The program as a user meets it: what it accepts, what it says, how it ends.

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Command, Output, Stdio},
};

use exr::prelude::{AttributeValue, MetaData, Text};
use nephroid::film::read_exr;
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

fn number(path: &Path, attribute: &str) -> f64 {
    let meta = MetaData::read_from_file(path, true).unwrap();
    let own = &meta.headers[0].own_attributes.other;
    match own.get(&Text::from(attribute)) {
        Some(AttributeValue::F64(value)) => *value,
        other => panic!("{attribute}: {other:?}"),
    }
}

#[test]
fn help_and_version() {
    let directory = workplace();
    for arguments in [
        &["--help"][..],
        &["render", "--help"],
        &["check", "--help"],
        &["compare", "--help"],
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

/// A small picture: bright at the top left.
fn draw(directory: &Path) {
    let picture =
        image::GrayImage::from_fn(20, 10, |i, j| image::Luma([250 - (10 * (i + j)) as u8 / 2]));
    picture.save(directory.join("picture.png")).unwrap();
}

#[test]
fn a_lens_is_designed_and_its_scene_loads() {
    let directory = workplace();
    draw(directory.path());
    let arguments = ["lens", "picture.png", "-o", "lens.exr", "--distance", "0.3"];
    let more = ["--width", "0.1", "--resolution", "64"];
    let output = run(directory.path(), &[&arguments[..], &more].concat());
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("64 x 32 heights"));
    assert!(text(&output.stderr).contains("correlation"));
    let scene = SCENE.replace(
        "objects: [",
        &format!("objects: [{},", text(&output.stdout)),
    );
    fs::write(directory.path().join("scene.ron"), scene).unwrap();
    let checked = run(directory.path(), &["check", "scene.ron"]);
    assert_eq!(code(&checked), 0, "{}", text(&checked.stderr));
    let twice = run(
        directory.path(),
        &[&arguments[..2], &["-o", "b.exr"], &arguments[4..], &more].concat(),
    );
    assert_eq!(code(&twice), 0);
    let bytes = |name: &str| fs::read(directory.path().join(name)).unwrap();
    assert!(bytes("lens.exr") == bytes("b.exr"));
}

#[test]
fn lenses_that_cannot_be_are_refused() {
    let directory = workplace();
    draw(directory.path());
    let black = image::GrayImage::new(8, 8);
    black.save(directory.path().join("black.png")).unwrap();
    let thin = image::GrayImage::new(8, 1);
    thin.save(directory.path().join("thin.png")).unwrap();
    image::GrayImage::new(9, 1)
        .save(directory.path().join("thinner.png"))
        .unwrap();
    let far = ["--distance", "0.3", "--width", "0.1"];
    let near = [
        "--distance",
        "0.01",
        "--width",
        "0.1",
        "--magnification",
        "9",
    ];
    for (picture, output, size, word) in [
        ("nowhere.png", "a.exr", &far[..], "nowhere.png"),
        ("scene.ron", "a.exr", &far, "not a PNG"),
        ("black.png", "a.exr", &far, "black"),
        ("thin.png", "a.exr", &far, "black"),
        ("thinner.png", "a.exr", &far, "slender"),
        ("picture.png", "a.png", &far, "must end in .exr"),
        ("picture.png", "no/a.exr", &far, "does not exist"),
        ("picture.png", "a.exr", &near, "turn too far"),
        ("picture.png", "a.exr", &far[..2], "--width"),
    ] {
        let command = [
            &["lens", picture, "-o", output],
            size,
            &["--resolution", "64"],
        ]
        .concat();
        let found = run(directory.path(), &command);
        assert_eq!(code(&found), 2, "{command:?}");
        assert!(
            text(&found.stderr).contains(word),
            "{}",
            text(&found.stderr)
        );
        assert!(!directory.path().join(output).exists());
    }
}

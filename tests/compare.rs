//! `nephroid compare` as a user meets it: what it measures, what it says, how
//! it ends.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use nephroid::{
    film::{Image, Window, read_exr, read_exr_layers, read_png, write_exr, write_png},
    metrics::{self, magma},
    spectrum::Rgb,
};
use serde_json::Value;
use tempfile::TempDir;

const WIDTH: u32 = 32;
const HEIGHT: u32 = 24;

/// A picture of radiances between 0.25 and 4; exact in single precision.
fn reference() -> Image {
    Image::from_fn(WIDTH, HEIGHT, |x, y| {
        let value = |a: u32, b: u32| f64::from(1 + (a * x + b * y) % 16) / 4.0;
        Rgb::new(value(3, 5), value(5, 1), value(1, 7))
    })
}

/// The reference off by a factor in its right half.
fn off(factor: f64) -> Image {
    let truth = reference();
    Image::from_fn(WIDTH, HEIGHT, |x, y| {
        truth.pixel(x, y) * if x < WIDTH / 2 { 1.0 } else { factor }
    })
}

fn half(image: &Image) -> Image {
    Image::from_fn(image.width(), image.height(), |x, y| {
        image.pixel(x, y) * 0.5
    })
}

/// A directory with `ref.exr`, `a.exr` (5/4 in the right half), `b.exr` (3/2
/// there) with the layers `caustic` and, but for `b`, `direct`; `a.png` and
/// `ref.png`.
fn workplace() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    for (name, image, direct) in [
        ("ref", reference(), true),
        ("a", off(1.25), true),
        ("b", off(1.5), false),
    ] {
        let caustic = half(&image);
        let mut layers = vec![("", &image), ("caustic", &caustic)];
        if direct {
            layers.push(("direct", &image));
        }
        let path = |extension| directory.path().join(name).with_extension(extension);
        write_exr(&path("exr"), &layers, Window::whole(WIDTH, HEIGHT), &[]).unwrap();
        write_png(&path("png"), &image, Some(-2.0)).unwrap();
    }
    directory
}

fn write(directory: &Path, name: &str, image: &Image) {
    let window = Window::whole(image.width(), image.height());
    write_exr(&directory.join(name), &[("", image)], window, &[]).unwrap();
}

fn compare(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nephroid"));
    command
        .current_dir(directory)
        .arg("compare")
        .args(arguments);
    command.output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("ended by itself")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

fn json(directory: &Path, arguments: &[&str]) -> Value {
    let output = compare(directory, &[arguments, &["--json"]].concat());
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn close(value: &Value, expected: f64) {
    let value = value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"));
    assert!(
        (value - expected).abs() <= 1e-12 * expected.abs(),
        "{value} {expected}"
    );
}

#[test]
fn numbers_are_those_of_the_library() {
    let directory = workplace();
    let found = json(directory.path(), &["a.exr", "ref.exr"]);
    assert_eq!(found["resolution"], serde_json::json!([32, 24]));
    assert_eq!(found["ok"], true);
    assert_eq!(found["comparisons"].as_array().unwrap().len(), 1);
    let only = &found["comparisons"][0];
    assert_eq!(only["picture"], "a.exr");
    assert_eq!(
        (&only["layer"], &only["region"]),
        (&Value::Null, &Value::Null)
    );
    let (a, truth) = (off(1.25), reference());
    let values = &only["metrics"];
    close(&values["rmse"], metrics::rmse(&a, &truth).unwrap());
    close(&values["mae"], metrics::mae(&a, &truth).unwrap());
    close(&values["relmse"], metrics::relmse(&a, &truth).unwrap());
    close(
        &values["relmse-trimmed"],
        metrics::relmse_trimmed(&a, &truth, 0.001).unwrap(),
    );
    close(
        &values["mean-ratio"],
        metrics::mean_ratio(&a, &truth).unwrap(),
    );
    let exposures = metrics::Exposures::of(&truth).unwrap();
    close(
        &values["hdr-flip"],
        metrics::hdr_flip(&a, &truth, exposures).unwrap().mean(),
    );
    for name in ["ssim", "flip"] {
        let value = values[name].as_f64().unwrap();
        assert!(0.0 < value && value < 1.0, "{name} {value}");
    }
}

/// What a PNG shows is compared in linear light; it has no high range.
#[test]
fn png_files() {
    let directory = workplace();
    let found = json(directory.path(), &["a.png", "ref.png"]);
    let values = &found["comparisons"][0]["metrics"];
    let read = |name| read_png(&directory.path().join(name)).unwrap();
    close(
        &values["rmse"],
        metrics::rmse(&read("a.png"), &read("ref.png")).unwrap(),
    );
    close(
        &values["flip"],
        metrics::flip(&read("a.png"), &read("ref.png"))
            .unwrap()
            .mean(),
    );
    assert_eq!(values["hdr-flip"], Value::Null);
}

/// An EXR, exposed as its PNG was, looks like the PNG but for the 256 steps.
#[test]
fn exposure_is_that_of_the_png() {
    let directory = workplace();
    let exposed = ["a.exr", "ref.exr", "--exposure", "-2"];
    let [exr, png] = [&exposed[..], &["a.png", "ref.png"]].map(|arguments| {
        let found = json(directory.path(), arguments);
        let values = &found["comparisons"][0]["metrics"];
        ["ssim", "flip"].map(|name| values[name].as_f64().unwrap())
    });
    assert!((exr[0] - png[0]).abs() < 1e-3, "{exr:?} {png:?}");
    assert!((exr[1] - png[1]).abs() < 5e-3, "{exr:?} {png:?}");
    let found = json(directory.path(), &["a.exr", "ref.exr", "--exposure", "1"]);
    let brighter = found["comparisons"][0]["metrics"]["flip"].as_f64().unwrap();
    assert!((brighter - exr[1]).abs() > 1e-2, "{brighter} {exr:?}");
}

#[test]
fn two_pictures_regions_and_layers() {
    let directory = workplace();
    let found = json(
        directory.path(),
        &[
            "a.exr",
            "b.exr",
            "--reference",
            "ref.exr",
            "--layers",
            "--metric",
            "mae",
            "--region",
            "0,0,16x24",
            "--region",
            "16,0,16,24",
        ],
    );
    // All three files have the picture and one layer; regions, pictures.
    let list = found["comparisons"].as_array().unwrap();
    assert_eq!(list.len(), 2 * 2 * 2);
    let right = reference();
    let right: f64 = (0..HEIGHT)
        .flat_map(|y| (16..WIDTH).map(move |x| (x, y)))
        .map(|(x, y)| right.pixel(x, y).mean())
        .sum::<f64>()
        / f64::from(16 * HEIGHT);
    for entry in list {
        let names = entry["metrics"].as_object().unwrap();
        assert_eq!(names.keys().collect::<Vec<_>>(), ["mae"]);
        let share = match entry["layer"].as_str() {
            None => 1.0,
            Some("caustic") => 0.5,
            Some(other) => panic!("{other}"),
        };
        let error = if entry["picture"] == "a.exr" {
            0.25
        } else {
            0.5
        };
        let region = entry["region"].as_array().unwrap();
        if region[0] == 0 {
            assert_eq!(entry["metrics"]["mae"], 0.0);
        } else {
            close(&entry["metrics"]["mae"], share * error * right);
        }
    }
}

#[test]
fn the_table_has_what_was_asked_for() {
    let directory = workplace();
    let output = compare(
        directory.path(),
        &[
            "a.exr",
            "b.exr",
            "--reference",
            "ref.exr",
            "--layer",
            "caustic",
            "--region",
            "1,2,20x20",
        ],
    );
    assert_eq!(code(&output), 0);
    assert!(output.stderr.is_empty());
    let said = text(&output.stdout);
    for part in [
        "ref.exr",
        "32 x 24",
        "a.exr",
        "b.exr",
        "caustic, region 1,2,20x20",
        " %)",
    ] {
        assert!(said.contains(part), "{part} in\n{said}");
    }
    for metric in metrics::Metric::ALL {
        let line = format!("\n  {} ", metric.name());
        assert!(said.contains(&line), "{line} in\n{said}");
    }
}

#[test]
fn bounds_decide_the_exit_code() {
    let directory = workplace();
    let ends = |arguments: &[&str]| {
        let output = compare(
            directory.path(),
            &[&["a.exr", "ref.exr"], arguments].concat(),
        );
        // What was measured is said in any case.
        assert!(text(&output.stdout).contains("rmse"), "{arguments:?}");
        (code(&output), text(&output.stderr).to_owned())
    };
    assert_eq!(
        ends(&["--max", "rmse=10", "--min", "ssim=0.1"]),
        (0, String::new())
    );
    let (code_of_max, said) = ends(&["--max", "rmse=10", "--max", "mae=1e-6"]);
    assert_eq!(code_of_max, 5);
    assert!(
        said.contains("mae of a.exr (picture)") && !said.contains("rmse"),
        "{said}"
    );
    let bound = metrics::rmse(&off(1.25), &reference()).unwrap();
    let exactly = format!("rmse={bound}");
    assert_eq!(ends(&["--max", &exactly]).0, 0, "a bound may be reached");
    assert_eq!(ends(&["--metric", "rmse", "--min", "ssim=1"]).0, 5);
    assert_eq!(ends(&["--max", "rmse=1e-9", "--region", "0,0,16x24"]).0, 0);
    assert_eq!(ends(&["--max", "rmse=1e-9", "--region", "8,0,16x24"]).0, 5);
    // What is not defined holds no bound.
    let (code_of_none, said) =
        ends(&["--max", "ssim=2", "--region", "0,0,4x4", "--metric", "rmse"]);
    assert_eq!(code_of_none, 5);
    assert!(said.contains("not defined"), "{said}");
    let better = [
        "b.exr",
        "a.exr",
        "--reference",
        "ref.exr",
        "--max",
        "rmse=0.5",
    ];
    let output = compare(directory.path(), &better);
    let worst = metrics::rmse(&off(1.5), &reference()).unwrap();
    assert!(worst > 0.5, "{worst}");
    assert_eq!(code(&output), 5, "each picture has to hold it");
    assert!(!text(&output.stderr).contains("of a.exr"));
}

/// Colours are those of the errors, the unit is stated, and both pictures
/// share it.
#[test]
fn errors_are_drawn() {
    let directory = workplace();
    let place = |name: &str| directory.path().join(name);
    let both = [
        "a.exr",
        "b.exr",
        "--reference",
        "ref.exr",
        "--map",
        "abs",
        "-o",
    ];
    let output = compare(
        directory.path(),
        &[&both[..], &["d.png", "--map-top", "0.5"]].concat(),
    );
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let said = text(&output.stderr);
    assert!(
        said.contains("an error of 0.5") && said.contains("wrote d.png"),
        "{said}"
    );
    let (truth, drawn) = (reference(), read_png(&place("d.png")).unwrap());
    assert_eq!((drawn.width(), drawn.height()), (2 * WIDTH, HEIGHT));
    assert_eq!(
        code(&compare(
            directory.path(),
            &[&both[..], &["d.exr"]].concat()
        )),
        0
    );
    let numbers = read_exr(&place("d.exr"), "").unwrap();
    for (picture, image) in [off(1.25), off(1.5)].iter().enumerate() {
        for (x, y) in [(0, 0), (20, 3), (31, 23), (17, 11)] {
            let error = (image.pixel(x, y) - truth.pixel(x, y)).map(f64::abs).mean();
            let column = x + WIDTH * picture as u32;
            let found = numbers.pixel(column, y)[0];
            assert!((found - error).abs() <= 1e-7 * error, "{found} {error}");
            let apart = drawn.pixel(column, y) - magma(error / 0.5);
            // Within half of one of 256 codes, whose widest step is 1/112.
            assert!(apart.map(f64::abs).max() <= 0.005, "{apart:?}");
        }
    }
    // The default for EXR files, and a picture without errors.
    let same = compare(directory.path(), &["ref.exr", "ref.exr", "-o", "none.png"]);
    assert_eq!(code(&same), 0);
    let none = read_png(&place("none.png")).unwrap();
    assert!(none.pixels().iter().all(|&p| p == none.pixel(0, 0)));
    for kind in ["relmse", "abs"] {
        let output = compare(
            directory.path(),
            &["ref.exr", "ref.exr", "-o", "n.png", "--map", kind],
        );
        assert_eq!(code(&output), 0, "{kind}");
    }
}

/// Each mistake ends with code 2, names what is wrong, and writes nothing.
#[test]
fn mistakes() {
    let directory = workplace();
    let here = directory.path();
    write(here, "small.exr", &Image::from_fn(8, 24, |_, _| Rgb::WHITE));
    let broken = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        Rgb::grey(if y == 2 && x > 3 { f64::NAN } else { 1.0 })
    });
    write(here, "nan.exr", &broken);
    let dark = Image::from_fn(WIDTH, HEIGHT, |_, _| Rgb::BLACK);
    write(here, "dark.exr", &dark);
    fs::write(here.join("text.exr"), "no picture").unwrap();
    fs::write(here.join("empty.png"), "").unwrap();
    let whole = fs::read(here.join("a.exr")).unwrap();
    fs::write(here.join("cut.exr"), &whole[..whole.len() / 2]).unwrap();
    let whole = fs::read(here.join("a.png")).unwrap();
    fs::write(here.join("cut.png"), &whole[..whole.len() / 2]).unwrap();
    for (arguments, says) in [
        (&["a.exr"][..], "<B>"),
        (&["a.exr", "none.exr"], "cannot read none.exr"),
        (&["text.exr", "a.exr"], "neither an EXR nor a PNG"),
        (&["a.png", "empty.png"], "neither an EXR nor a PNG"),
        (&["cut.exr", "a.exr"], "cannot read cut.exr"),
        (&["a.png", "cut.png"], "cannot read cut.png"),
        (&["a.exr", "ref.png"], "files of one kind"),
        (&["small.exr", "a.exr"], "small.exr has 8 x 24 pixels"),
        (
            &["nan.exr", "a.exr"],
            "28 of 768, the first in column 4 of row 2",
        ),
        (
            &["a.exr", "nan.exr"],
            "nan.exr has pixels that are not finite",
        ),
        (
            &["a.exr", "ref.exr", "--layer", "cauatic"],
            "it has caustic, direct",
        ),
        (
            &["a.png", "ref.png", "--layer", "caustic"],
            "a PNG has none",
        ),
        (
            &["a.exr", "b.exr", "--layer", "direct"],
            "b.exr has no layer direct",
        ),
        (&["a.exr", "ref.exr", "--region", "30,0,5x5"], "32 x 24"),
        (
            &["a.exr", "ref.exr", "--region", "30,0,5"],
            "a size in pixels",
        ),
        (&["a.exr", "ref.exr", "--max", "rms=1"], "relmse-trimmed"),
        (&["a.exr", "ref.exr", "--max", "rmse"], "relmse=0.0025"),
        (&["a.exr", "ref.exr", "--metric", "psnr"], "hdr-flip"),
        (&["a.exr", "ref.exr", "--map", "abs"], "--output"),
        (&["a.exr", "ref.exr", "-o", "new.gif"], ".exr or .png"),
        (&["a.exr", "ref.exr", "-o", "a.exr"], "would be overwritten"),
        (&["a.exr", "ref.exr", "-o", "no/new.png"], "does not exist"),
        (
            &["a.exr", "ref.exr", "-o", "new.png", "--map-top", "0"],
            "above zero",
        ),
        (&["a.exr", "dark.exr", "-o", "new.png"], "--map abs"),
        (&["a.png", "ref.png", "--exposure", "1"], "exposed already"),
        (
            &["a.png", "ref.png", "-o", "new.png", "--map", "hdr-flip"],
            "--map flip",
        ),
    ] {
        let output = compare(here, arguments);
        let said = text(&output.stderr);
        assert_eq!(code(&output), 2, "{arguments:?}: {said}");
        assert!(said.contains(says), "{arguments:?} says\n{said}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
    assert!(!here.join("new.png").exists());
    assert_eq!(fs::read(here.join("a.png")).unwrap(), whole);
}

/// Whatever a byte is changed to, reading ends with a picture or with words;
/// a header's claim alone takes no memory.
#[test]
fn damaged_files_are_refused_or_read() {
    let directory = workplace();
    let path = directory.path().join("damaged");
    let mut state = 1u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as usize
    };
    for (name, is_exr) in [("a.exr", true), ("a.png", false)] {
        let whole = fs::read(directory.path().join(name)).unwrap();
        let mut refused = 0;
        for _ in 0..200 {
            let mut bytes = whole.clone();
            // Most of what can go wrong is said in the header.
            let place = random() % bytes.len().min(600);
            bytes[place] = random() as u8;
            fs::write(&path, &bytes).unwrap();
            let wrong = if is_exr {
                read_exr_layers(&path).is_err()
            } else {
                read_png(&path).is_err()
            };
            refused += u32::from(wrong);
        }
        assert!(refused > 10, "{name}: {refused}");
    }
}

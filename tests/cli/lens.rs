//! `nephroid lens`.

use std::{fs, path::Path};

use crate::{SCENE, code, run, text, workplace};

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

//! Pictures rendered in parts.

use std::{fs, path::Path};

use crate::{FILES, Product, done, names, passes_in, run, text, workplace};

/// Renders a part with further arguments into a checkpoint.
fn part(directory: &Path, name: &str, arguments: &str) {
    let command = format!("render scene.ron -q -o {name}.png --checkpoint {name}.ckpt {arguments}");
    done(directory, &command);
}

/// Three uneven parts, rendered each in its place with its own number of
/// threads, merged in two steps in any order: the bytes of one run.
#[test]
fn parts_make_the_whole() {
    let truth = Product::of("--passes 21");
    let directory = workplace();
    let path = directory.path();
    part(path, "a", "--passes 0..5 --threads 1");
    part(path, "b", "--passes 5..16 --threads 3");
    part(path, "c", "--passes 16..21");
    done(path, &format!("merge b.ckpt c.ckpt a.ckpt {FILES}"));
    truth.assert_same(&Product::in_directory(path), "three parts");
    done(path, "merge -q c.ckpt b.ckpt -o bc.ckpt");
    assert_eq!(passes_in(&path.join("bc.ckpt")), 16);
    done(path, &format!("merge bc.ckpt a.ckpt {FILES} -o all.ckpt"));
    truth.assert_same(&Product::in_directory(path), "two steps");
    // The merged part is gone on from like any other.
    let longer = Product::of("--passes 24");
    done(
        path,
        &format!("render scene.ron {FILES} --resume all.ckpt --passes 24"),
    );
    longer.assert_same(&Product::in_directory(path), "gone on from merged parts");
}

/// One part alone is a picture, too, and says which passes it has.
#[test]
fn a_part_is_a_picture() {
    let truth = Product::of("--passes 3..9");
    assert_eq!(truth.report["first_pass"], 3);
    assert_eq!(truth.report["passes"], 6);
    let name = b"firstPass\0double\0";
    assert!(truth.exr.windows(name.len()).any(|w| w == name));
    let directory = workplace();
    part(directory.path(), "p", "--passes 3..9");
    done(directory.path(), &format!("merge p.ckpt {FILES}"));
    truth.assert_same(&Product::in_directory(directory.path()), "one part");
}

/// A reference method and a crop are split in the same way.
#[test]
fn references_and_crops_merge() {
    for more in [
        "--method path",
        "--method light --photons 300",
        "--method metropolis --crop 3,2,9x7",
    ] {
        let truth = Product::of(&format!("--passes 6 {more}"));
        let directory = workplace();
        part(directory.path(), "a", &format!("--passes 0..2 {more}"));
        part(directory.path(), "b", &format!("--passes 2..6 {more}"));
        done(directory.path(), &format!("merge a.ckpt b.ckpt {FILES}"));
        truth.assert_same(&Product::in_directory(directory.path()), more);
    }
}

#[test]
fn what_does_not_go_together_is_refused() {
    let directory = workplace();
    let path = directory.path();
    part(path, "a", "--passes 0..2");
    part(path, "b", "--passes 2..3");
    part(path, "d", "--passes 4..5");
    part(path, "f", "--passes 7..8");
    part(path, "seed", "--passes 2..4 --seed 8");
    part(path, "method", "--passes 2..4 --method path");
    let scene = fs::read_to_string(path.join("scene.ron")).unwrap();
    fs::write(
        path.join("scene.ron"),
        scene.replace("radius: 1)", "radius: 1.01)"),
    )
    .unwrap();
    part(path, "scene", "--passes 2..4");
    let mut cut = fs::read(path.join("a.ckpt")).unwrap();
    cut.pop();
    fs::write(path.join("cut.ckpt"), cut).unwrap();
    let before = names(path);
    for (parts, says) in [
        (
            "a.ckpt b.ckpt d.ckpt f.ckpt",
            "the passes 3..4 and 5..7 are missing",
        ),
        ("a.ckpt b.ckpt d.ckpt", "--passes 3..4"),
        ("a.ckpt a.ckpt", "pass 0 is in both"),
        ("a.ckpt seed.ckpt", "the seed is 3 there and 8 here"),
        (
            "a.ckpt method.ckpt",
            "the method is photons there and path here",
        ),
        ("a.ckpt scene.ckpt", "the scene file has changed"),
        ("a.ckpt cut.ckpt", "cut.ckpt: the checkpoint is damaged"),
        ("a.ckpt scene.ron", "scene.ron: this is no checkpoint"),
        ("a.ckpt nothing.ckpt", "nothing.ckpt"),
        ("a.ckpt -o all.jpg", ".ckpt"),
        ("", "PART"),
    ] {
        let output = run(path, &format!("merge {parts} -o all.exr"));
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{parts}: {said}");
        assert!(said.contains(says), "{parts}: {said}");
        assert_eq!(names(path), before, "{parts}");
    }
    // A part of another render is not written over.
    let foreign = fs::read(path.join("seed.ckpt")).unwrap();
    let output = run(path, "merge a.ckpt b.ckpt -o seed.ckpt");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert_eq!(fs::read(path.join("seed.ckpt")).unwrap(), foreign);
}

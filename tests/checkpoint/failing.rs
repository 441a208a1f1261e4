//! Checkpoints that cannot be written: the render goes on, older ones stay.

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
};

use crate::{Product, done, names, passes_in, program, run, text, workplace};

/// A render that ends when it is told to; it tells on standard error.
#[cfg(unix)]
fn without_end(directory: &Path, checkpoint: &str, every: &str) -> Child {
    let arguments = format!(
        "render scene.ron -o a.png --passes 4000000 --checkpoint {checkpoint} \
         --checkpoint-every {every}"
    );
    let arguments: Vec<&str> = arguments.split_whitespace().collect();
    let mut command = program(directory, &arguments);
    command.stderr(Stdio::piped()).spawn().unwrap()
}

/// Sends a signal.
#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status();
    assert!(sent.unwrap().success());
}

/// Files may not grow beyond a size below that of a checkpoint, as on a full
/// disk. The old checkpoint stays, the picture is made, and the code says that
/// a file is missing.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_keeps_the_old_checkpoint() {
    let directory = workplace();
    let path = directory.path();
    done(
        path,
        "render scene.ron -q -o a.png --passes 2 --checkpoint a.ckpt",
    );
    let kept = fs::read(path.join("a.ckpt")).unwrap();
    // The limit is in blocks of 512 or 1024 bytes, by the shell.
    let limit = kept.len() / 2048;
    let program = env!("CARGO_BIN_EXE_nephroid");
    let command = format!(
        "trap '' XFSZ; ulimit -f {limit}; exec {program} render scene.ron -o a.exr -o a.png \
         --json a.json --passes 6 --checkpoint a.ckpt --checkpoint-every 1ms --quiet"
    );
    let shell = Command::new("sh")
        .args(["-c", &command])
        .current_dir(path)
        .output();
    let output = shell.unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_eq!(
        said.matches("warning: cannot write a.ckpt").count(),
        1,
        "{said}"
    );
    assert!(said.contains("error: cannot write a.ckpt"), "{said}");
    assert!(fs::read(path.join("a.ckpt")).unwrap() == kept, "as it was");
    let files = [
        "a.ckpt",
        "a.exr",
        "a.json",
        "a.png",
        "scene.ron",
        "tile.obj",
    ];
    assert_eq!(names(path), files, "no half-written file");
    Product::of("--passes 6").assert_same(&Product::in_directory(path), "on a full disk");
    // With room again, it goes on from the old checkpoint.
    done(
        path,
        "render scene.ron -q -o a.png --passes 6 --checkpoint a.ckpt",
    );
    assert_eq!(passes_in(&path.join("a.ckpt")), 6);
}

/// The folder of the checkpoint goes away while it renders and comes back.
#[cfg(unix)]
#[test]
fn it_tries_again() {
    let directory = workplace();
    let path = directory.path();
    let [there, away] = ["kept", "away"].map(|name| path.join(name));
    fs::create_dir(&there).unwrap();
    let mut child = without_end(path, "kept/a.ckpt", "1ms");
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut hear = |words: &str| {
        let heard = said.find(|line| line.as_ref().unwrap().contains(words));
        assert!(heard.is_some(), "{words}");
    };
    hear("pass 1/");
    fs::rename(&there, &away).unwrap();
    hear("warning: cannot write kept/a.ckpt");
    fs::rename(&away, &there).unwrap();
    hear("kept/a.ckpt is written again");
    send("-TERM", &child);
    hear("interrupted");
    assert_eq!(
        child.wait().unwrap().code(),
        Some(3),
        "the last attempt counts"
    );
    assert!(passes_in(&there.join("a.ckpt")) >= 1);
}

/// Someone else's file that appears in its place while it renders is left
/// alone.
#[cfg(unix)]
#[test]
fn a_file_that_appears_is_not_overwritten() {
    let directory = workplace();
    let path = directory.path();
    let mut child = without_end(path, "a.ckpt", "10h");
    let mut first = String::new();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    said.read_line(&mut first).unwrap();
    fs::write(path.join("a.ckpt"), "precious").unwrap();
    send("-INT", &child);
    let rest: Vec<String> = said.lines().map(Result::unwrap).collect();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest:?}");
    let says = "a.ckpt: the file there does not belong to this render";
    assert!(rest.iter().any(|line| line.contains(says)), "{rest:?}");
    assert_eq!(fs::read_to_string(path.join("a.ckpt")).unwrap(), "precious");
    assert!(path.join("a.png").exists(), "the picture is saved");
    assert_eq!(run(path, "merge a.ckpt -o b.png").status.code(), Some(2));
}

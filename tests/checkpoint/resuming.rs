//! Going on: after an interruption, towards more passes, from another file.

use std::{
    fs,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use crate::{FILES, Product, done, names, passes_in, program, run, text, workplace};

/// A finished picture becomes a better one, in steps; the last step is done
/// already and writes the files only.
#[test]
fn more_passes_than_before() {
    let directory = workplace();
    let path = directory.path();
    done(
        path,
        &format!("render scene.ron {FILES} --passes 5 --checkpoint a.ckpt"),
    );
    Product::of("--passes 5").assert_same(&Product::in_directory(path), "with a checkpoint");
    let truth = Product::of("--passes 18");
    for times in 0..2 {
        fs::remove_file(path.join("a.exr")).unwrap();
        done(
            path,
            &format!("render scene.ron {FILES} --passes 18 --resume a.ckpt"),
        );
        let resumed = Product::in_directory(path);
        truth.assert_same(&resumed, "resumed");
        // The first one has seen the end of the second round.
        assert_eq!(truth.last_round["passes"], 16);
        if times == 0 {
            assert_eq!(resumed.last_round, truth.last_round);
        } else {
            assert!(resumed.last_round.is_null());
        }
        assert_eq!(passes_in(&path.join("a.ckpt")), 18, "{times}");
    }
    // A time that is over adds nothing.
    done(
        path,
        "render scene.ron -q -o t.png --time 1ms --resume a.ckpt",
    );
    assert_eq!(passes_in(&path.join("a.ckpt")), 18);
}

/// What is resumed stays as it was if the checkpoints go elsewhere; the farther
/// of the two is gone on from.
#[test]
fn from_one_file_into_another() {
    let directory = workplace();
    let path = directory.path();
    done(
        path,
        "render scene.ron -q -o a.png --passes 2 --checkpoint a.ckpt",
    );
    let kept = fs::read(path.join("a.ckpt")).unwrap();
    let arguments = "-o b.png --resume a.ckpt --checkpoint b.ckpt";
    let said = done(path, &format!("render scene.ron --passes 4 {arguments}"));
    assert!(
        said.contains("going on from a.ckpt: 2 passes are done"),
        "{said}"
    );
    let said = done(path, &format!("render scene.ron --passes 5 {arguments}"));
    assert!(
        said.contains("going on from b.ckpt: 4 passes are done"),
        "{said}"
    );
    assert_eq!(fs::read(path.join("a.ckpt")).unwrap(), kept);
    assert_eq!(passes_in(&path.join("b.ckpt")), 5);
}

/// An interrupted render has saved all its passes and ends with code 3; the
/// same command with fewer passes to go finishes it.
#[cfg(unix)]
#[test]
fn interrupts_lose_no_pass() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        let directory = workplace();
        let path = directory.path();
        let command = "render scene.ron -o a.exr -o a.png --json a.json --checkpoint a.ckpt";
        let endless = format!("{command} --passes 4000000 --checkpoint-every 1ms");
        let endless: Vec<&str> = endless.split_whitespace().collect();
        let mut child = program(path, &endless)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The first checkpoint says that it renders.
        while !path.join("a.ckpt").exists() {
            assert!(child.try_wait().unwrap().is_none());
            thread::sleep(Duration::from_millis(1));
        }
        let id = child.id().to_string();
        assert!(
            Command::new("kill")
                .args([signal, &id])
                .status()
                .unwrap()
                .success()
        );
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(3),
            "{signal}: {}",
            text(&output.stderr)
        );
        let files = [
            "a.ckpt",
            "a.exr",
            "a.json",
            "a.png",
            "scene.ron",
            "tile.obj",
        ];
        assert_eq!(names(path), files, "{signal}");
        let passes = passes_in(&path.join("a.ckpt"));
        let reached = Product::in_directory(path);
        assert_eq!(reached.report["passes"], passes, "the file has every pass");
        let arguments = format!("--passes {passes}");
        Product::of(&arguments).assert_same(&reached, signal);
        let arguments = format!("--passes {}", passes + 2);
        done(path, &format!("{command} {arguments} -q"));
        Product::of(&arguments).assert_same(&Product::in_directory(path), signal);
    }
}

/// Reference methods go on, too.
#[test]
fn references_go_on() {
    let directory = workplace();
    let path = directory.path();
    let command = format!("render scene.ron {FILES} --method bdpt --checkpoint a.ckpt");
    done(path, &format!("{command} --passes 3"));
    done(path, &format!("{command} --passes 10"));
    let truth = Product::of("--method bdpt --passes 10");
    truth.assert_same(&Product::in_directory(path), "bdpt");
    let output = run(
        path,
        "render scene.ron --method path --checkpoint a.ckpt --passes 20",
    );
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
}

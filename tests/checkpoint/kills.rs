//! Renders killed at any moment.

use std::{
    fs,
    path::Path,
    process::{Child, Stdio},
    thread,
    time::{Duration, Instant},
};

use crate::{FILES, Product, done, names, passes_in, program, workplace};

const PASSES: &str = "60";

/// What a series of kills came to.
#[derive(Debug, Default)]
struct Tally {
    /// Programs killed while they ran.
    kills: u32,
    /// Kills that left a file behind which was being written.
    in_writing: u32,
    /// Kills after which there was a checkpoint to go on from.
    gone_on: u32,
    /// Pictures that were finished and compared.
    pictures: u32,
}

/// Moments without a clock's help: a generator for tests (Steele, Lea and
/// Flood 2014, `SplitMix64`).
struct Moments(u64);

impl Moments {
    fn next(&mut self, most: Duration) -> Duration {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        most.mul_f64((z >> 11) as f64 / (1u64 << 53) as f64)
    }
}

fn is_writing(directory: &Path) -> bool {
    let names = names(directory);
    let extensions = names.iter().map(|name| Path::new(name).extension());
    extensions.flatten().any(|extension| extension == "part")
}

/// Waits for a moment; `false` if the program ended before.
fn wait(child: &mut Child, directory: &Path, moment: Duration, until_writing: bool) -> bool {
    let start = Instant::now();
    loop {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        let is_time = start.elapsed() >= moment;
        if is_time && (!until_writing || is_writing(directory)) {
            return true;
        }
        // Writing is soon over.
        if !is_time {
            thread::sleep(Duration::from_micros(200));
        }
    }
}

/// Kills renders at random moments, every second time while a file is being
/// written, and lets the same command go on, until it has killed so often.
fn kill(times: u32) -> Tally {
    let truth = Product::of(&format!("--passes {PASSES}"));
    let command = format!(
        "render scene.ron {FILES} --passes {PASSES} --checkpoint a.ckpt --checkpoint-every 1ms"
    );
    let command: Vec<&str> = command.split_whitespace().collect();
    let mut tally = Tally::default();
    let mut moments = Moments(1);
    while tally.kills < times {
        let directory = workplace();
        let (path, checkpoint) = (directory.path(), directory.path().join("a.ckpt"));
        // The time of a whole render with its checkpoints, at first; kills come
        // sooner, so that a picture takes some.
        let start = Instant::now();
        let mut most = Duration::from_millis(100);
        let mut passes = 0;
        loop {
            let mut child = program(path, &command)
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let until_writing = tally.kills % 2 == 1;
            if !wait(&mut child, path, moments.next(most), until_writing) {
                let output = child.wait_with_output().unwrap();
                assert!(output.status.success(), "{output:?}");
                break;
            }
            child.kill().unwrap();
            let status = child.wait().unwrap();
            if status.success() {
                break;
            }
            tally.kills += 1;
            tally.in_writing += u32::from(is_writing(path));
            if checkpoint.exists() {
                let now = passes_in(&checkpoint);
                assert!(now >= passes, "passes were lost: {now} after {passes}");
                passes = now;
                tally.gone_on += 1;
            }
            // Wherever it is slow to start, give it time to come farther.
            if start.elapsed() > most * 20 {
                most *= 2;
            }
        }
        tally.pictures += 1;
        assert_eq!(passes_in(&checkpoint).to_string(), PASSES);
        let left = [
            "a.ckpt",
            "a.exr",
            "a.json",
            "a.png",
            "scene.ron",
            "tile.obj",
        ];
        assert_eq!(names(path), left, "nothing is left behind");
        truth.assert_same(&Product::in_directory(path), "after kills");
    }
    tally
}

#[test]
fn killed_renders_go_on_to_the_same_bytes() {
    let tally = kill(12);
    assert!(tally.in_writing > 0 && tally.gone_on > 0, "{tally:?}");
}

/// `cargo test --release --test checkpoint -- --ignored --nocapture kills`
#[test]
#[ignore = "takes 13 s or more, and how many kills hit a write depends on the machine; \
            the test above does the same with twelve. A render that starts faster would mend it"]
#[allow(clippy::print_stdout, reason = "the figures are what it is run for")]
fn two_hundred_kills() {
    let tally = kill(200);
    println!("{tally:?}");
    assert!(tally.in_writing >= 50 && tally.gone_on >= 100, "{tally:?}");
}

/// A file that another program is writing is not taken away.
#[test]
fn only_what_nobody_writes_is_swept() {
    let directory = workplace();
    let path = directory.path();
    let part = |random: &str| path.join(format!(".a.ckpt{random}.part"));
    for random in ["abc123", "ABCdef", "toolong7", "sh_rt1"] {
        fs::write(part(random), "half").unwrap();
    }
    let other = fs::File::open(part("ABCdef")).unwrap();
    other.lock().unwrap();
    done(
        path,
        "render scene.ron -o a.png --passes 1 --checkpoint a.ckpt",
    );
    assert!(!part("abc123").exists(), "left by a killed program");
    for random in ["ABCdef", "toolong7", "sh_rt1"] {
        assert!(part(random).exists(), "{random}");
    }
}

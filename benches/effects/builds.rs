//! The program beside builds of it that do not have an effect.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use nephroid::{
    plan::judge,
    scene::{Effect, Settings},
};

use crate::{job::Job, price, row, say, scenes, this_program};

/// Scenes by which all that they lack is priced together: a build without what
/// one of them lacks is tried in all that lack as much.
const PLAIN: [&str; 6] = [
    "floor, point",
    "ball, lamp",
    "glass, lamp",
    "wedge, lamp",
    "mirror, lamp",
    "ball, point",
];

/// A scene that lacks the effect, and comes near to it.
fn lacking(effect: Effect) -> &'static str {
    match effect {
        Effect::Sources => "glass, point",
        Effect::HardShadows | Effect::Caustics => "ball, lamp",
        Effect::SoftShadows | Effect::Glints => "ball, point",
        Effect::Indirect => "floor, point",
        Effect::Refraction => "mirror, lamp",
        Effect::ShadingNormals => "wedge, lamp",
        Effect::Mirrors | Effect::TotalReflection | Effect::Panes | Effect::Nesting => {
            "glass, lamp"
        }
    }
}

/// Prices groups of effects, or those that are named.
pub(crate) fn compare(words: &[String]) {
    let (mut names, mut pairs, mut builder) = (Vec::new(), 0, build as Builder);
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--pairs" => {
                let value = words.next().map(|w| w.parse());
                pairs = value.and_then(Result::ok).expect("--pairs needs a number");
            }
            "--kept" => builder = kept,
            name => names.push(name),
        }
    }
    say("\nnot called for          left out         whole    share");
    if names.is_empty() {
        let groups = PLAIN.map(lacks);
        for (lacks, program) in built(builder, groups.iter().map(Vec::as_slice)) {
            let names: Vec<&str> = lacks.iter().map(|e| e.name()).collect();
            say(&format!("without {}:", names.join(", ")));
            let poorer = PLAIN.iter().filter(|s| contains(&self::lacks(s), lacks));
            for (i, other) in poorer.enumerate() {
                let pairs = if i == 0 { pairs } else { 0 };
                beside(&format!("{} effects", lacks.len()), other, &program, pairs);
            }
        }
        return;
    }
    let effects: Vec<Effect> = match names.as_slice() {
        ["all"] => Effect::ALL.to_vec(),
        names => names
            .iter()
            .map(|n| Effect::named(n).unwrap_or_else(|| panic!("no effect {n}")))
            .collect(),
    };
    let programs: Vec<(Effect, PathBuf)> = built(builder, effects.chunks(1))
        .into_iter()
        .map(|(effect, program)| (effect[0], program))
        .collect();
    for (effect, program) in &programs {
        beside(effect.title(), lacking(*effect), program, pairs);
    }
    price::table(&programs);
}

/// What finds the program without some effects.
type Builder = fn(&[Effect]) -> PathBuf;

/// The programs without each of some groups of effects. All are built before the
/// first is timed: compilers leave a machine warm.
fn built<'a>(
    builder: Builder,
    groups: impl Iterator<Item = &'a [Effect]>,
) -> Vec<(&'a [Effect], PathBuf)> {
    groups.map(|group| (group, builder(group))).collect()
}

/// What a scene does not call for.
fn lacks(scene: &str) -> Vec<Effect> {
    let scene = scenes::named(scene);
    let verdicts = judge(&scene, &Settings::default());
    let off = verdicts.into_iter().filter(|v| !v.called_for);
    off.map(|v| v.effect).collect()
}

fn contains(all: &[Effect], some: &[Effect]) -> bool {
    some.iter().all(|e| all.contains(e))
}

/// A line: what a build without something and the whole program take for the
/// same bits.
fn beside(what: &str, scene: &str, less: &Path, pairs: usize) {
    let (whole, job) = (this_program(), Job::new(scene));
    let [a, b] = [less, &whole].map(|program| job.by(program).bits);
    assert_eq!(a, b, "{what}, {scene}: the builds show different pictures");
    let [without, with] = [less, &whole].map(|program| job.cost(program));
    row(what, scene, without, with);
    if pairs > 0 {
        in_turns(job, less, &whole, pairs);
    }
}

/// Processor time of a process that is timed, about: the system counts it in
/// steps of some milliseconds.
const SECONDS_IN_TURNS: f64 = 0.8;

/// Times both programs by turns: the median of the ratios, and an interval that
/// holds it in 95 of 100 cases, by the ranks of the binomial law.
fn in_turns(job: Job, less: &Path, whole: &Path, pairs: usize) {
    let pass = 1e-6 * job.by(whole).time;
    let job = job.passes((SECONDS_IN_TURNS / pass).clamp(16.0, 1e4) as u32);
    let mut ratios: Vec<f64> = (0..pairs)
        .map(|i| {
            let by = |program| job.by(program).time;
            // Whoever comes second finds the machine as the first left it.
            if i % 2 == 0 {
                let without = by(less);
                by(whole) / without
            } else {
                let with = by(whole);
                with / by(less)
            }
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let n = pairs as f64;
    let off = (0.98 * n.sqrt()).ceil() as usize;
    let percent = |i: usize| 100.0 * (ratios[i.min(pairs - 1)] - 1.0);
    say(&format!(
        "{:20} in {pairs} turns, processor time: {:+.2} % ({:+.2} to {:+.2} %)",
        "",
        percent(pairs / 2),
        percent((pairs / 2).saturating_sub(off)),
        percent(pairs / 2 + off)
    ));
}

/// Builds this bench without effects; where the program is.
fn build(without: &[Effect]) -> PathBuf {
    let names: Vec<&str> = without.iter().map(|e| e.name()).collect();
    let names = names.join(",");
    let cargo = env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let output = Command::new(cargo)
        .args(["bench", "--no-run", "--bench", "effects"])
        .args(["--message-format", "json", "--manifest-path"])
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"))
        .arg("--target-dir")
        .arg(folder())
        .env("NEPHROID_WITHOUT", &names)
        .output();
    let output = output.unwrap_or_else(|e| panic!("cargo: {e}"));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "without {names}: {errors}");
    let text = String::from_utf8_lossy(&output.stdout);
    let program = text
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter(|message| message["target"]["name"] == "effects")
        .find_map(|message| message["executable"].as_str().map(PathBuf::from))
        .unwrap_or_else(|| panic!("cargo names no program: {text}"));
    // The next build takes its place.
    let place = place(without);
    fs::copy(&program, &place).unwrap_or_else(|e| panic!("{}: {e}", place.display()));
    place
}

/// What was built the last time.
fn kept(without: &[Effect]) -> PathBuf {
    let place = place(without);
    assert!(place.exists(), "{}: build it first", place.display());
    place
}

/// A folder of its own: nobody is to find a program there that lacks something.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("builds")
}

/// Where the program without some effects is kept.
fn place(without: &[Effect]) -> PathBuf {
    let names: Vec<&str> = without.iter().map(|e| e.name()).collect();
    folder().join(names.join("-"))
}

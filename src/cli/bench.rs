//! `nephroid bench`: the benchmark, from what was typed to the verdict.

use std::{
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
    time::SystemTime,
};

use nephroid::{
    film::{Image, atomic, read_exr},
    scene::{self, Digest, Scene},
    study::{
        self, BENCHMARK, Benchmark, BenchmarkScene, Judgement, Machine, STANDARD_SCENES, TARGETS,
        Task, Verdict,
    },
};

use super::{
    Exit, Failure, args::BenchArgs, deliver, interrupt::Interrupt, progress, study::digits, tell,
};

/// A scene and what its picture should be.
struct Loaded {
    name: String,
    print: String,
    scene: Scene,
    reference: Image,
}

/// Runs the benchmark.
pub(super) fn run(typed: &BenchArgs) -> Result<Exit, Failure> {
    let file = typed.json.as_deref().filter(|p| p.as_os_str() != "-");
    if let Some(file) = file {
        atomic::probe(file).map_err(Failure::fault)?;
    }
    let earlier = typed.against.as_deref().map(read).transpose()?;
    if let Some(threads) = typed.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build_global()
            .map_err(|e| Failure::fault(format!("cannot start {threads} threads: {e}")))?;
    }
    let is_named = |name: &&str| typed.names.is_empty() || typed.names.iter().any(|n| n == name);
    let names = STANDARD_SCENES.iter().copied().filter(is_named);
    let loaded: Result<Vec<Loaded>, Failure> = names.map(|name| load(typed, name)).collect();
    let interrupt = Interrupt::listen("a benchmark keeps nothing");
    let mut benchmark = Benchmark {
        benchmark: BENCHMARK,
        software: format!("nephroid {}", env!("CARGO_PKG_VERSION")),
        made: String::new(),
        machine: Machine::this(),
        targets: TARGETS.to_vec(),
        scenes: Vec::new(),
    };
    if !typed.quiet {
        tell(heading());
    }
    for loaded in loaded? {
        let Some(scene) = measure(typed, loaded, &interrupt)? else {
            return Ok(Exit::Interrupted);
        };
        if !typed.quiet {
            tell(row(&scene));
        }
        benchmark.scenes.push(scene);
    }
    benchmark.made = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
    save(&benchmark, typed.json.as_deref())?;
    match earlier {
        None => Ok(Exit::Done),
        Some(earlier) => judge(typed, &earlier, &benchmark),
    }
}

/// An earlier benchmark.
fn read(path: &Path) -> Result<Benchmark, Failure> {
    let refuse = |e: &dyn std::fmt::Display| {
        Failure::bad_input(format!(
            "cannot read {} as an earlier benchmark: {e}",
            path.display()
        ))
    };
    let text = fs::read_to_string(path).map_err(|e| refuse(&e))?;
    let found: Benchmark = serde_json::from_str(&text).map_err(|e| refuse(&e))?;
    if found.benchmark == BENCHMARK && found.targets == TARGETS {
        return Ok(found);
    }
    Err(refuse(&format_args!(
        "it is number {}, with other scenes or targets than number {BENCHMARK}, this version's",
        found.benchmark
    )))
}

fn load(typed: &BenchArgs, name: &str) -> Result<Loaded, Failure> {
    let path: PathBuf = typed.scenes.join(format!("{name}.ron"));
    let reference = typed.scenes.join("references").join(format!("{name}.exr"));
    if !path.is_file() || !reference.is_file() {
        return Err(Failure::bad_input(format!(
            "the benchmark needs {} and {}; run it where nephroid's scenes are, or name their \
             directory with --scenes",
            path.display(),
            reference.display()
        )));
    }
    let scene = progress::load(&path, true).map_err(|e| Failure::scene(&e))?;
    let cannot = |e| Failure::bad_input(format!("cannot read {}: {e}", reference.display()));
    let bytes = fs::read(&reference).map_err(cannot)?;
    let image = read_exr(&reference, "").map_err(Failure::bad_input)?;
    if [image.width(), image.height()] != scene.resolution {
        return Err(Failure::bad_input(format!(
            "{} has {} x {} pixels, and the scene {name} {} x {}",
            reference.display(),
            image.width(),
            image.height(),
            scene.resolution[0],
            scene.resolution[1]
        )));
    }
    Ok(Loaded {
        name: name.to_owned(),
        print: format!(
            "{} {}",
            scene::fingerprint(&scene.inputs),
            Digest::of(&bytes)
        ),
        scene,
        reference: image,
    })
}

/// All runs of a scene; `None` if they were interrupted.
fn measure(
    typed: &BenchArgs,
    loaded: Loaded,
    interrupt: &Interrupt,
) -> Result<Option<BenchmarkScene>, Failure> {
    let task = Task {
        scene: &loaded.scene,
        reference: &loaded.reference,
        targets: &TARGETS,
        passes: typed.passes,
    };
    let mut runs = Vec::new();
    for seed in 1..=u64::from(typed.seeds) {
        let done = task.run(seed, &mut |_| {
            if interrupt.is_requested() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        match done {
            Ok(run) => runs.push(run),
            Err(study::Fault::Interrupted) => return Ok(None),
            Err(fault) => return Err(fault.into()),
        }
    }
    Ok(Some(BenchmarkScene {
        name: loaded.name,
        print: loaded.print,
        runs,
    }))
}

fn save(benchmark: &Benchmark, json: Option<&Path>) -> Result<(), Failure> {
    let Some(path) = json else {
        return Ok(());
    };
    let text = serde_json::to_string_pretty(benchmark).map_err(Failure::fault)?;
    if path.as_os_str() == "-" {
        return deliver(text).map_err(Failure::fault);
    }
    atomic::write_whole(path, |file| writeln!(file, "{text}")).map_err(Failure::fault)
}

fn judge(typed: &BenchArgs, earlier: &Benchmark, now: &Benchmark) -> Result<Exit, Failure> {
    let (judged, left_out) = study::verdicts(earlier, now).map_err(Failure::bad_input)?;
    if !typed.quiet {
        tell(format_args!(
            "\nbeside {}, {}",
            earlier.software, earlier.made
        ));
        for judgement in &judged {
            tell(words(judgement));
        }
        for text in &left_out {
            tell(format_args!("{text}"));
        }
    }
    let slower = judged.iter().any(|j| j.verdict == Verdict::Slower);
    Ok(if slower {
        Exit::OutOfBounds
    } else {
        Exit::Done
    })
}

fn words(judgement: &Judgement) -> String {
    let [low, high] = judgement.interval;
    let verdict = match judgement.verdict {
        Verdict::Faster => "faster",
        Verdict::Slower => "slower",
        Verdict::Same => "no difference beyond noise",
    };
    format!(
        "{:<14} {:>6.3} times the time ({low:.3} to {high:.3}): {verdict}",
        judgement.name, judgement.ratio
    )
}

fn heading() -> String {
    let mut text = format!(
        "seconds of processor time to an error, and their spread\n{:14}",
        ""
    );
    for target in TARGETS {
        let target = format!("{} %", digits(100.0 * target));
        text.push_str(&format!("{target:>16}"));
    }
    text
}

fn row(scene: &BenchmarkScene) -> String {
    let mut text = format!("{:14}", scene.name);
    for target in 0..TARGETS.len() {
        let time = scene.time(target).map_or("-".to_owned(), |(time, factor)| {
            format!("{} +-{:.0} %", digits(time), 100.0 * (factor - 1.0))
        });
        text.push_str(&format!("{time:>16}"));
    }
    text
}

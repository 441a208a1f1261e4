//! What an effect costs where no scene calls for it, and where one does: the
//! instructions of a pass, counted by callgrind, or its time if there is no
//! valgrind.
//!
//! `cargo bench --bench effects`. Every number is a process of its own that
//! runs a number of passes on one thread; what a pass takes is the difference
//! between two such numbers, so that loading and pilots drop out.

#[path = "common/clock.rs"]
mod clock;

use std::{
    env,
    path::Path,
    process::{Command, Output},
};

use clock::Clock;
use nephroid::{
    render::Renderer,
    scene::{Choice, Effect, Settings, load_str},
};

/// What a child process is asked by.
const JOB: &str = "NEPHROID_EFFECTS_BENCH";

/// Passes of the shorter and the longer process: the rounds of both have the
/// same pilots.
const PASSES: [u32; 2] = [1, 5];

/// Picture and photon paths of a pass.
const SIZE: [u32; 2] = [64, 48];
const PHOTONS: u64 = 4096;

/// Scenes by what is in them, on a grey floor.
const BALL: &str =
    "(shape: Sphere(center: (0, 0, 1), radius: 0.8), material: Diffuse(reflectance: 0.5)),";
const GLASS: &str =
    "(shape: Sphere(center: (0, 0, 1), radius: 0.8), material: Dielectric(ior: 1.5)),";
const POINT: &str = "Point(position: (-2, -1, 5), power: 300)";
const LAMP: &str = "Sphere(center: (-2, -1, 5), radius: 0.3, power: 300)";
const BELOW: &str = "Point(position: (-2, -1, -5), power: 300)";

/// Effects that can be forced on, each in a scene that does not call for it:
/// what it holds beside the floor, and its lights.
const IN_VAIN: [(Effect, &str, &str); 5] = [
    (Effect::Caustics, BALL, POINT),
    (Effect::Indirect, "", POINT),
    (Effect::Panes, BALL, LAMP),
    (Effect::Nesting, GLASS, LAMP),
    (Effect::Glints, BALL, LAMP),
];

/// Effects that can be switched off, each in a scene that calls for it.
const CALLED_FOR: [(Effect, &str, &str); 3] = [
    (Effect::Caustics, GLASS, LAMP),
    (Effect::Indirect, BALL, LAMP),
    (Effect::Glints, GLASS, LAMP),
];

fn main() {
    if let Ok(job) = env::var(JOB) {
        return child(&job);
    }
    let unit = if has_valgrind() {
        "instructions"
    } else {
        "microseconds (no valgrind here)"
    };
    say(&format!("{unit} of a pass, in thousands\n"));
    say("proved away             as planned     forced on    share");
    for (i, (effect, ..)) in IN_VAIN.iter().enumerate() {
        let [plan, on] = ["auto", "on"].map(|said| pass(&format!("vain {i} {said}")));
        row(*effect, plan, on);
    }
    // A glass ball that no light reaches: the plan knows, the material does not.
    let [plan, on] = ["auto", "on"].map(|said| pass(&format!("dark 0 {said}")));
    row(Effect::Caustics, plan, on);
    say("\ncalled for            switched off    as planned    share");
    for (i, (effect, ..)) in CALLED_FOR.iter().enumerate() {
        let [off, plan] = ["off", "auto"].map(|said| pass(&format!("real {i} {said}")));
        row(*effect, off, plan);
    }
}

fn row(effect: Effect, without: f64, with: f64) {
    say(&format!(
        "{:20} {:13.0} {:13.0} {:+7.2} %",
        effect.title(),
        without / 1e3,
        with / 1e3,
        100.0 * (with / without - 1.0)
    ));
}

fn has_valgrind() -> bool {
    let found = Command::new("valgrind").arg("--version").output();
    found.is_ok_and(|o| o.status.success())
}

/// What a pass of a job takes.
fn pass(job: &str) -> f64 {
    let [few, many] = PASSES.map(|n| measure(&format!("{job} {n}")));
    (many - few) / f64::from(PASSES[1] - PASSES[0])
}

/// What a process takes: instructions, or microseconds.
fn measure(job: &str) -> f64 {
    let program = env::current_exe().unwrap_or_else(|e| panic!("{e}"));
    let run = |command: &mut Command| -> Output {
        let output = command.env(JOB, job).output();
        let output = output.unwrap_or_else(|e| panic!("{e}"));
        assert!(output.status.success(), "{job}: {output:?}");
        output
    };
    if has_valgrind() {
        let output = run(Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(&program));
        let text = String::from_utf8_lossy(&output.stderr);
        let count = text.lines().find_map(|l| l.split_once("Collected :"));
        let count = count.unwrap_or_else(|| panic!("{job}: {text}")).1;
        return count
            .trim()
            .parse()
            .unwrap_or_else(|e| panic!("{count}: {e}"));
    }
    let once = || -> f64 {
        let output = run(&mut Command::new(&program));
        let text = String::from_utf8_lossy(&output.stdout);
        text.trim()
            .parse()
            .unwrap_or_else(|e| panic!("{text}: {e}"))
    };
    (0..5).map(|_| once()).fold(f64::INFINITY, f64::min)
}

/// Runs passes; prints the CPU time in microseconds.
fn child(job: &str) {
    let words: Vec<&str> = job.split(' ').collect();
    let &[table, i, said, passes] = words.as_slice() else {
        panic!("malformed job {job}");
    };
    let i: usize = i.parse().unwrap_or_else(|e| panic!("{e}"));
    let passes: u32 = passes.parse().unwrap_or_else(|e| panic!("{e}"));
    let (effect, objects, lights) = match table {
        "vain" => IN_VAIN[i],
        "dark" => (Effect::Caustics, GLASS, BELOW),
        _ => CALLED_FOR[i],
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build_global().unwrap_or_else(|e| panic!("{e}"));
    let text = format!(
        "(camera: (eye: (0, -6, 4), look_at: (0, 0, 0.5), fov: 40), image: (width: 8, height: 8),
          objects: [
            (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
            {objects}
          ],
          lights: [{lights}])"
    );
    let scene = load_str(&text, "bench", Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    let mut settings = Settings {
        photons: Some(PHOTONS),
        ..scene.settings.clone()
    };
    settings.effects.set(
        effect,
        match said {
            "on" => Choice::On,
            "off" => Choice::Off,
            _ => Choice::Auto,
        },
    );
    let clock = Clock::start();
    let renderer = Renderer::new(&scene, &settings, SIZE, [0, 0, SIZE[0], SIZE[1]]);
    for pass in 0..passes {
        std::hint::black_box(renderer.pass(pass));
    }
    say(&format!("{}", clock.seconds() * 1e6));
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn say(line: &str) {
    println!("{line}");
}

//! How cost grows with the number of photons, pixels, triangles and lights:
//! seconds and peak memory, with one thread and with two, and the exponents of
//! the power laws that fit them.
//!
//! `cargo bench --bench scaling -- --full` goes on to a hundred million
//! photons, ten million pixels and ten million triangles; `--axis NAME` takes
//! one of the four. Every point is a process of its own, since a process
//! remembers only its highest peak; Linux tells it.

#[path = "common/clock.rs"]
mod clock;
#[path = "common/peak.rs"]
mod peak;

use std::{env, ops::ControlFlow, path::Path, process::Command, time::Instant};

use clock::Clock;
use nephroid::{
    metrics::fit_slope,
    render::{Job, Renderer, run},
    scene::load_str,
};
use peak::peak_mebibytes;

/// What a child process is asked by.
const JOB: &str = "NEPHROID_SCALING_BENCH";

/// Passes of a point, and of one with so many photons that two must do.
const PASSES: u32 = 4;
const PASSES_OF_MANY: u32 = 2;
const MANY: u64 = 10_000_000;

/// Photon paths of a pass where their number is not what varies.
const PHOTONS: u64 = 1 << 16;

/// Side of the picture in pixels where its size is not what varies.
const SIDE: u32 = 192;

/// What varies: its name, the sizes, and those that only `--full` adds.
const AXES: [(&str, &[u64], &[u64]); 4] = [
    ("photons", &[100_000, 1_000_000, 10_000_000], &[100_000_000]),
    (
        "pixels",
        &[100_000, 316_000, 1_000_000],
        &[3_160_000, 10_000_000],
    ),
    (
        "triangles",
        &[1_000, 10_000, 100_000, 1_000_000],
        &[10_000_000],
    ),
    ("lights", &[1, 10, 100, 1_000], &[]),
];

/// What a point cost.
#[derive(Clone, Copy, Debug)]
struct Cost {
    /// Seconds to read the scene and build its trees.
    load: f64,
    /// Seconds to aim the lights and look at a pilot.
    prepare: f64,
    /// Seconds of the fastest pass.
    pass: f64,
    /// CPU seconds of the cheapest pass, all threads together.
    cpu: f64,
    /// Peak memory of the process in MiB.
    mebibytes: f64,
}

fn main() {
    if let Ok(job) = env::var(JOB) {
        return child(&job);
    }
    let (mut full, mut wanted) = (false, None);
    let mut words = env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--full" => full = true,
            "--axis" => wanted = words.next(),
            // Cargo says so to every bench.
            "--bench" => {}
            _ => panic!("{word}? There are --full and --axis NAME"),
        }
    }
    for (axis, sizes, more) in AXES {
        if wanted.as_ref().is_none_or(|w| w == axis) {
            let sizes: Vec<u64> = sizes
                .iter()
                .chain(more.iter().filter(|_| full))
                .copied()
                .collect();
            along(axis, &sizes);
        }
    }
}

/// All points of an axis, and the fits.
fn along(axis: &str, sizes: &[u64]) {
    report(&format!(
        "\n{axis:>12}  threads  load s  prepare s   pass s   CPU s  peak MiB"
    ));
    for threads in [1, 2] {
        let cost = |&n: &u64| {
            let c = measure(axis, n, threads);
            report(&format!(
                "{n:12}  {threads:7}  {:6.2}  {:9.3}  {:7.3}  {:6.3}  {:8.0}",
                c.load, c.prepare, c.pass, c.cpu, c.mebibytes
            ));
            c
        };
        let costs: Vec<Cost> = sizes.iter().map(cost).collect();
        let exponent = |cost: fn(&Cost) -> f64| {
            let xs: Vec<f64> = sizes.iter().map(|&n| n as f64).collect();
            let ys: Vec<f64> = costs.iter().map(cost).collect();
            fit_slope(&xs, &ys).map_or_else(
                || "unknown".to_owned(),
                |fit| format!("{:.2} +- {:.2}", fit.slope, fit.standard_error),
            )
        };
        report(&format!(
            "{axis}, {threads} threads: exponent of load {}, prepare {}, CPU {}, memory {}",
            exponent(|c| c.load),
            exponent(|c| c.prepare),
            exponent(|c| c.cpu),
            exponent(|c| c.mebibytes)
        ));
    }
}

/// Sends a process for one point.
fn measure(axis: &str, size: u64, threads: usize) -> Cost {
    let program = env::current_exe().unwrap_or_else(|e| panic!("{e}"));
    let output = Command::new(&program)
        .env(JOB, format!("{axis} {size} {threads}"))
        .output()
        .unwrap_or_else(|e| panic!("{e}"));
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map_while(|w| w.parse().ok())
        .collect();
    let &[load, prepare, pass, cpu, mebibytes] = numbers.as_slice() else {
        panic!("{size} {axis}: {}", String::from_utf8_lossy(&output.stderr));
    };
    Cost {
        load,
        prepare,
        pass,
        cpu,
        mebibytes,
    }
}

/// One point: prints the numbers of its cost.
fn child(job: &str) {
    let mut words = job.split(' ');
    let mut word = || words.next().unwrap_or_else(|| panic!("malformed job"));
    let axis = word();
    let size: u64 = word().parse().unwrap_or_else(|e| panic!("{e}"));
    let threads: usize = word().parse().unwrap_or_else(|e| panic!("{e}"));
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .unwrap_or_else(|e| panic!("{e}"));

    let start = Instant::now();
    let scene = load_str(&text(axis, size), axis, Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    let load = start.elapsed();

    let mut job = Job::of(&scene);
    job.settings.photons = match axis {
        "photons" => Some(size),
        // The program's own choice follows the pixels.
        "pixels" => None,
        _ => Some(PHOTONS),
    };
    // What a point needs is what is asked; no budget may cut it.
    job.settings.memory = 1 << 44;
    job.settings.passes = match job.settings.photons {
        Some(MANY..) => PASSES_OF_MANY,
        _ => PASSES,
    };
    let start = Instant::now();
    let window = job.window();
    drop(Renderer::new(&scene, &job.settings, job.resolution, window));
    let prepare = start.elapsed().as_secs_f64();

    let (mut finished, mut spent) = (vec![0.0], vec![0.0]);
    let clock = Clock::start();
    let outcome = run(&scene, &job, &mut |progress| {
        finished.push(progress.elapsed.as_secs_f64());
        spent.push(clock.seconds());
        ControlFlow::Continue(())
    });
    assert!(
        axis != "photons" || outcome.report.photons_per_pass == size,
        "the photons were cut"
    );
    let least = |times: &[f64]| {
        let passes = times.windows(2).map(|w| w[1] - w[0]);
        passes.fold(f64::INFINITY, f64::min)
    };
    report(&format!(
        "{} {} {} {} {}",
        load.as_secs_f64(),
        prepare,
        least(&finished),
        least(&spent),
        peak_mebibytes()
    ));
}

/// The scene of a point: a glass ball on a floor under a lamp; for triangles a
/// sheet of water in the ball's place, for lights many small ones that share
/// the lamp's power.
fn text(axis: &str, size: u64) -> String {
    let side = match axis {
        "pixels" => (size as f64).sqrt().round() as u32,
        _ => SIDE,
    };
    let caster = match axis {
        "triangles" => format!(
            "(shape: Waves(x: (-1.5, 1.5), y: (-1.5, 1.5), level: 1, cells: {}, waves: [
                (amplitude: 0.028, k: (5.2, 2.1)),
                (amplitude: 0.022, k: (-3.1, 6.3), phase: 1.3),
                (amplitude: 0.014, k: (8.9, -4.7), phase: 2.1),
              ]), material: Dielectric(ior: 1.33), open: true)",
            (size as f64 / 2.0).sqrt().round()
        ),
        _ => "(shape: Sphere(center: (0, 0, 1.2), radius: 1), material: Dielectric(ior: 1.5))"
            .to_owned(),
    };
    let lights: String = if axis == "lights" {
        (0..size).map(|i| small_light(i, size)).collect()
    } else {
        "Sphere(center: (1, 1, 5), radius: 0.1, power: 100)".to_owned()
    };
    format!(
        "(camera: (eye: (0, -6, 4), look_at: (0, 0, 0.3), fov: 40),
          image: (width: {side}, height: {side}),
          objects: [
            (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
            {caster},
          ],
          lights: [{lights}])"
    )
}

/// Light `i` of `n`, on a spiral that fills a disc evenly (Vogel 1979).
fn small_light(i: u64, n: u64) -> String {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let radius = 2.0 * ((i as f64 + 0.5) / n as f64).sqrt();
    let (y, x) = (golden * i as f64).sin_cos();
    format!(
        "Sphere(center: ({}, {}, 5), radius: 0.02, power: {}),",
        radius * x,
        radius * y,
        100.0 / n as f64
    )
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn report(line: &str) {
    println!("{line}");
}

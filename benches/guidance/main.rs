//! What guidance buys: error against processor time in scenes where little of
//! the light that is sent out matters, for the program as it is, for the same
//! with photons and shadow rays by power alone (`guidance: Power`), and for
//! stochastic progressive photon mapping.
//!
//! `cargo bench --bench guidance -- stadium keyhole --seconds 60` takes those
//! scenes (all without) and lets each method go on for so much processor time
//! (30). `--seeds N` (2) averages over so many seeds, `--reference PASSES`
//! (1024) says how long the truth is rendered. That truth is a render of the
//! program itself, with another seed; it is set beside path tracing, which
//! shares none of the photons' code, in blocks of pixels, for `--check PASSES`
//! (256; 0 leaves it out).

#[path = "../common/clock.rs"]
mod clock;
mod scenes;

use std::env;

use clock::Clock;
use nephroid::{
    film::{Film, Image, Layer},
    metrics::{relmse, relmse_trimmed},
    plan::film_quantum,
    reference::{Memory, Method, Options as MethodOptions, Reference},
    render::{Job, REPLICATES, Renderer},
    scene::{Guidance, Scene},
    spectrum::Rgb,
};

/// Part of the pixels that are left out of the error.
const WORST: f64 = 0.001;

/// Side of the blocks in which the truth is checked, in pixels.
const BLOCK: u32 = 8;

/// Seed of the truth.
const SEED_OF_TRUTH: u64 = 1_000_003;

struct Options {
    names: Vec<String>,
    seconds: f64,
    seeds: u64,
    reference: u32,
    check: u32,
}

/// How a picture is made.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    AsItIs,
    ByPower,
    Sppm,
}

impl Way {
    const ALL: [Self; 3] = [Self::AsItIs, Self::ByPower, Self::Sppm];

    fn name(self) -> &'static str {
        match self {
            Self::AsItIs => "as it is",
            Self::ByPower => "by power",
            Self::Sppm => "sppm",
        }
    }
}

/// Errors of the whole picture and of its caustics after so many passes.
#[derive(Clone, Copy)]
struct Point {
    passes: u32,
    seconds: f64,
    errors: [f64; 2],
}

/// The whole picture and its caustics.
struct Truth {
    images: [Image; 2],
}

fn main() {
    let options = options();
    for name in &options.names {
        let scene = scenes::named(name).unwrap_or_else(|| panic!("no scene {name}"));
        say(&format!("\n{name}"));
        let truth = truth(&scene, &options);
        let curves = Way::ALL.map(|way| curve(&scene, way, &truth, &options));
        for (way, curve) in Way::ALL.iter().zip(&curves) {
            for point in curve {
                say(&format!(
                    "{:9} {:6} passes {:8.2} s   relMSE {:9.2e}   caustics {:9.2e}",
                    way.name(),
                    point.passes,
                    point.seconds,
                    point.errors[0],
                    point.errors[1]
                ));
            }
        }
        for (which, what) in ["picture", "caustics"].into_iter().enumerate() {
            ratios(&curves, which, what);
        }
    }
}

fn options() -> Options {
    let mut options = Options {
        names: Vec::new(),
        seconds: 30.0,
        seeds: 2,
        reference: 1024,
        check: 256,
    };
    let mut words = env::args().skip(1);
    while let Some(word) = words.next() {
        let mut number = || -> f64 {
            let value = words.next();
            let value = value.unwrap_or_else(|| panic!("{word} needs a value"));
            value.parse().unwrap_or_else(|e| panic!("{word}: {e}"))
        };
        match word.as_str() {
            // Cargo adds this one.
            "--bench" => {}
            "--seconds" => options.seconds = number(),
            "--seeds" => options.seeds = number() as u64,
            "--reference" => options.reference = number() as u32,
            "--check" => options.check = number() as u32,
            _ => options.names.push(word),
        }
    }
    if options.names.is_empty() {
        options.names = scenes::NAMES.map(str::to_owned).to_vec();
    }
    options
}

fn job(scene: &Scene, way: Way, seed: u64) -> Job {
    let mut job = Job::of(scene);
    job.settings.seed = seed;
    if way == Way::ByPower {
        job.settings.guidance = Guidance::Power;
    }
    job
}

fn film(scene: &Scene) -> Film {
    let [width, height] = scene.resolution;
    Film::new(width, height, film_quantum(scene))
}

fn images(film: &Film) -> [Image; 2] {
    [film.image(), film.layer_image(Layer::Caustic)]
}

fn renderer<'a>(scene: &'a Scene, job: &Job) -> Renderer<'a> {
    Renderer::new(scene, &job.settings, job.resolution, job.window())
}

/// A long render, and what is known of its error.
fn truth(scene: &Scene, options: &Options) -> Truth {
    let job = job(scene, Way::AsItIs, SEED_OF_TRUTH);
    let renderer = renderer(scene, &job);
    let mut long = film(scene);
    for pass in 0..options.reference {
        long.add_pass(pass, &renderer.pass(pass).samples);
    }
    let images = images(&long);
    let noise = long.noise().map_or(f64::NAN, |noise| {
        // The noise is a picture of standard errors.
        let apart = images[0].pixels().iter().zip(noise.pixels());
        let off = apart.map(|(&x, &n)| x + n).collect();
        let [width, height] = scene.resolution;
        relmse_trimmed(&Image::new(width, height, off), &images[0], WORST).unwrap_or(f64::NAN)
    });
    say(&format!(
        "truth: {} passes of {} photon paths, relMSE of its noise {noise:.1e}",
        options.reference,
        renderer.photons()
    ));
    if options.check > 0 {
        check(scene, &images[0], options.check);
    }
    Truth { images }
}

/// Sets the truth beside path tracing.
fn check(scene: &Scene, truth: &Image, passes: u32) {
    let mut job = Job::of(scene);
    job.settings.seed = SEED_OF_TRUTH + 1;
    let path = Reference::new(scene, &job, Method::Path, MethodOptions::default())
        .unwrap_or_else(|e| panic!("{e}"));
    let mut memory = Memory::default();
    let mut halves = [film(scene), film(scene)];
    for pass in 0..passes {
        halves[(pass % 2) as usize].add_pass(pass / 2, &path.pass(pass, &mut memory));
    }
    let [a, b] = halves.map(|half| blocks(&half.image()));
    let both = |f: fn(Rgb, Rgb) -> Rgb, a: &Image, b: &Image| {
        let pixels = a.pixels().iter().zip(b.pixels());
        let pixels = pixels.map(|(&a, &b)| f(a, b)).collect();
        Image::new(a.width(), a.height(), pixels)
    };
    let mean = both(|a, b| (a + b) * 0.5, &a, &b);
    let truth = blocks(truth);
    let error = |x: &Image| relmse(x, &truth).unwrap_or(f64::NAN).sqrt();
    // Half of the halves' difference is as noisy as their mean.
    let noise = both(|t, d| t + d * 0.5, &truth, &both(|a, b| a - b, &a, &b));
    say(&format!(
        "beside {passes} passes of path tracing: mean {:.4}, blocks of {BLOCK} x {BLOCK} differ by {:.2} %, noise of path tracing {:.2} %",
        truth.mean().mean() / mean.mean().mean(),
        100.0 * error(&mean),
        100.0 * error(&noise),
    ));
}

/// Means over blocks of pixels.
fn blocks(image: &Image) -> Image {
    let [width, height] = [image.width() / BLOCK, image.height() / BLOCK];
    Image::from_fn(width, height, |bx, by| {
        let mut sum = Rgb::BLACK;
        for y in 0..BLOCK {
            for x in 0..BLOCK {
                sum += image.pixel(bx * BLOCK + x, by * BLOCK + y);
            }
        }
        sum * (1.0 / f64::from(BLOCK * BLOCK))
    })
}

/// The mean of several seeds.
fn curve(scene: &Scene, way: Way, truth: &Truth, options: &Options) -> Vec<Point> {
    let mut runs = (0..options.seeds).map(|seed| {
        let job = job(scene, way, seed);
        let seconds = options.seconds / options.seeds as f64;
        if way == Way::Sppm {
            let mut memory = Memory::default();
            run(scene, truth, seconds, || {
                let sppm = Reference::new(scene, &job, Method::Sppm, MethodOptions::default());
                let sppm = sppm.unwrap_or_else(|e| panic!("{e}"));
                move |pass| sppm.pass(pass, &mut memory)
            })
        } else {
            run(scene, truth, seconds, || {
                let renderer = renderer(scene, &job);
                move |pass| renderer.pass(pass).samples
            })
        }
    });
    let first = runs.next().unwrap_or_default();
    runs.fold(first, |sum, run| {
        let pairs = sum.into_iter().zip(run);
        let add = |(a, b): (Point, Point)| Point {
            passes: a.passes,
            seconds: a.seconds + b.seconds,
            errors: [a.errors[0] + b.errors[0], a.errors[1] + b.errors[1]],
        };
        pairs.map(add).collect()
    })
    .into_iter()
    .map(|sum| Point {
        passes: sum.passes,
        seconds: sum.seconds / options.seeds as f64,
        errors: sum.errors.map(|e| e / options.seeds as f64),
    })
    .collect()
}

/// Renders until the time is up; what is left after every doubling of the
/// rounds.
fn run<P>(scene: &Scene, truth: &Truth, limit: f64, prepare: impl FnOnce() -> P) -> Vec<Point>
where
    P: FnMut(u32) -> Vec<nephroid::film::PixelSample>,
{
    let mut film = film(scene);
    let clock = Clock::start();
    let mut pass = prepare();
    let mut judging = 0.0;
    let (mut points, mut passes) = (Vec::new(), 0);
    while clock.seconds() - judging < limit {
        let samples = pass(passes);
        film.add_pass(passes, &samples);
        passes += 1;
        if passes.is_multiple_of(REPLICATES) && (passes / REPLICATES).is_power_of_two() {
            let seconds = clock.seconds();
            let found = images(&film);
            let error =
                |k: usize| relmse_trimmed(&found[k], &truth.images[k], WORST).unwrap_or(f64::NAN);
            points.push(Point {
                passes,
                seconds: seconds - judging,
                errors: [error(0), error(1)],
            });
            judging += clock.seconds() - seconds;
        }
    }
    points
}

/// How much longer the others take to the errors that the program as it is
/// reaches.
fn ratios([ours, others @ ..]: &[Vec<Point>; 3], which: usize, what: &str) {
    for (way, other) in Way::ALL[1..].iter().zip(others) {
        let (Some(last), Some(first)) = (other.last(), other.first()) else {
            continue;
        };
        // The first of our errors that the other method never reaches, or else
        // our last one: there its time is a lower bound.
        for point in ours {
            let target = point.errors[which];
            if target > first.errors[which] {
                continue;
            }
            let text = match time_to(other, which, target) {
                Some(seconds) => format!("{:.1} times as long", seconds / point.seconds),
                None => format!(
                    "more than {:.1} times as long (has {:.1e} then)",
                    last.seconds / point.seconds,
                    last.errors[which]
                ),
            };
            say(&format!(
                "{what} to relMSE {target:.1e} ({:.2} s): {} takes {text}",
                point.seconds,
                way.name()
            ));
        }
    }
}

/// Seconds to an error, between the points by a power law; `None` if it is
/// never reached.
fn time_to(curve: &[Point], which: usize, target: f64) -> Option<f64> {
    let pairs = curve.iter().zip(curve.iter().skip(1));
    let mut crossing =
        pairs.filter(|(a, b)| a.errors[which] >= target && b.errors[which] <= target);
    let (a, b) = crossing.next()?;
    let [x, y] = [a, b].map(|p| p.errors[which].ln());
    let part = if x > y {
        (x - target.ln()) / (x - y)
    } else {
        1.0
    };
    Some((a.seconds.ln() + part * (b.seconds.ln() - a.seconds.ln())).exp())
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn say(line: &str) {
    println!("{line}");
}

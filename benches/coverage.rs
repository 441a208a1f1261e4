//! Does the stated error hold? Renders scenes whose truth is known, several
//! seeds of each, and sets what every picture says of itself beside its true
//! error, after 1, 2, 4, 8, ... rounds.
//!
//! `cargo bench --bench coverage -- REFDIR` takes the references
//! `REFDIR/NAME.exr` of the scenes `scenes/NAME.ron`, as many as there are,
//! and the scenes whose caustics have a closed form; these alone without
//! REFDIR. `--rounds N` (8) and `--seeds N` (3) say how much, `--shrink N` (1)
//! averages references over N x N pixels, of scenes with box filters; `NAME` takes
//! that scene alone, and `NAME=NOISE` says of a reference what relMSE its own
//! noise has, without the worst 0.1 % of its pixels: it counts in quadrature,
//! and pictures whose error is not five times as large are not judged. Pixels are
//! judged with the noise of that pixel, where the reference has a layer
//! `error.noise`.

#[path = "estimators/exact/mod.rs"]
#[allow(
    dead_code,
    unused_imports,
    reason = "a module of a bench, of which this uses a part"
)]
mod exact;

use std::{env, fs, path::Path};

use exact::{CASES, Case};
use nephroid::{
    film::{Film, Image, read_exr},
    metrics::{Figures, Plane, Statement, relative_errors},
    plan::film_quantum,
    render::{REPLICATES, Renderer},
    scene::{Scene, load, load_str},
    spectrum::Rgb,
};

/// What is known of the truth of a scene.
struct Truth {
    name: String,
    scene: Scene,
    image: Image,
    /// relMSE of its noise.
    noise: f64,
    /// The same of every pixel.
    noises: Vec<f64>,
}

/// Pixels of both tails of a normal distribution beyond 90 %, squared.
const NORMAL_SQUARED: f64 = 2.705_543_454_095_404;

/// References judge errors whose square is so many times that of their own.
const JUDGES: f64 = 5.0;

/// Part of the pixels that are left out of the error.
const WORST: f64 = 0.001;

struct Options {
    directory: Option<String>,
    rounds: u32,
    seeds: u64,
    shrink: u32,
    names: Vec<(String, Option<f64>)>,
}

fn main() {
    let options = options();
    say(
        "scene          seed round | lit: pixels   true stated  bound  ratio  within | \
         caustics: pixels   true stated  ratio  within | noise alone within | all: true stated |",
    );
    let mut verdicts = Verdicts::default();
    for truth in truths(&options) {
        for seed in 1..=options.seeds {
            judge(&truth, seed, options.rounds, &mut verdicts);
        }
    }
    say(&format!("after whole rounds {}", verdicts.whole.words()));
    say(&format!("inside a round {}", verdicts.inside.words()));
}

fn options() -> Options {
    let mut options = Options {
        directory: None,
        rounds: 8,
        seeds: 3,
        shrink: 1,
        names: Vec::new(),
    };
    let mut words = env::args().skip(1);
    while let Some(word) = words.next() {
        let mut number = || words.next().and_then(|n| n.parse().ok());
        match word.as_str() {
            // Cargo adds this one.
            "--bench" => {}
            "--rounds" => options.rounds = number().unwrap_or(options.rounds),
            "--shrink" => options.shrink = number().unwrap_or(options.shrink).max(1),
            "--seeds" => options.seeds = number().map_or(options.seeds, u64::from),
            name if Path::new(name).is_dir() => options.directory = Some(name.to_owned()),
            name => {
                let (name, noise) = name
                    .split_once('=')
                    .map_or((name, None), |(name, noise)| (name, noise.parse().ok()));
                options.names.push((name.to_owned(), noise));
            }
        }
    }
    options
}

/// The scenes with a truth, made when they are asked for.
fn truths(options: &Options) -> impl Iterator<Item = Truth> {
    let directory = options.directory.clone().unwrap_or_default();
    let mut names: Vec<String> = fs::read_dir(&directory)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter_map(|name| Some(name.strip_suffix(".exr")?.to_owned()))
        .collect();
    names.sort();
    let wanted = |name: &str| {
        let alone = options.names.iter().all(|(_, noise)| noise.is_some());
        alone || options.names.iter().any(|(n, _)| n == name)
    };
    names.retain(|name| wanted(name));
    let noise_of = |name: &str| {
        let known = options.names.iter().find(|(n, _)| n == name);
        known.and_then(|(_, noise)| *noise).unwrap_or(0.0)
    };
    let rendered: Vec<(String, f64)> = names
        .into_iter()
        .map(|n| (noise_of(&n), n))
        .map(|(v, n)| (n, v))
        .collect();
    let exact: Vec<_> = CASES
        .into_iter()
        .filter(|name| wanted(name))
        .filter_map(Case::named)
        .collect();
    let factor = options.shrink;
    let rendered = rendered.into_iter().filter_map(move |(name, noise)| {
        let scene = load(Path::new(&format!("scenes/{name}.ron"))).ok()?;
        let path = format!("{directory}/{name}.exr");
        let image = read_exr(Path::new(&path), "").unwrap_or_else(|e| panic!("{path}: {e}"));
        let image = shrunk(&image, factor);
        let layer = read_exr(Path::new(&path), "error.noise").ok();
        let layer = layer.filter(|_| factor == 1);
        Some(Truth {
            name,
            scene,
            noises: layer.map_or_else(
                || vec![noise; image.pixels().len()],
                |layer| relative(&layer, &image),
            ),
            image,
            noise,
        })
    });
    let exact = exact.into_iter().map(|case| {
        let scene =
            load_str(&case.text(), case.name, Path::new("")).unwrap_or_else(|e| panic!("{e}"));
        let irradiance = case.reference().image;
        // The floor is white.
        let pixels = irradiance
            .pixels()
            .iter()
            .map(|&e| e / std::f64::consts::PI);
        let (width, height) = (irradiance.width(), irradiance.height());
        Truth {
            name: case.name.to_owned(),
            scene,
            image: Image::new(width, height, pixels.collect()),
            noise: 0.0,
            noises: vec![0.0; (width * height) as usize],
        }
    });
    rendered.chain(exact)
}

/// Squares of the `noise` of every pixel, relative to a truth as relMSE has it.
fn relative(noise: &Image, truth: &Image) -> Vec<f64> {
    let mean = truth.mean().mean();
    let pixels = noise.pixels().iter().zip(truth.pixels());
    let relative = pixels.map(|(n, t)| {
        let of = |c: usize| n[c] * n[c] / (t[c] * t[c] + 0.01 * mean * mean);
        (0..3).map(of).sum::<f64>() / 3.0
    });
    relative.collect()
}

/// The means over squares of so many pixels.
fn shrunk(image: &Image, factor: u32) -> Image {
    let [width, height] = [image.width() / factor, image.height() / factor];
    Image::from_fn(width, height, |x, y| {
        let square = (0..factor * factor).map(|i| [i % factor, i / factor]);
        let pixels = square.map(|[i, j]| image.pixel(factor * x + i, factor * y + j));
        pixels.fold(Rgb::BLACK, |sum, p| sum + p) / f64::from(factor * factor)
    })
}

/// Renders with one seed, and compares after every doubling of the rounds, and
/// in the middle of the second one.
fn judge(truth: &Truth, seed: u64, rounds: u32, verdicts: &mut Verdicts) {
    let mut settings = truth.scene.settings.clone();
    settings.seed = seed;
    let [width, height] = [truth.image.width(), truth.image.height()];
    let renderer = Renderer::new(
        &truth.scene,
        &settings,
        [width, height],
        [0, 0, width, height],
    );
    let mut film = Film::new(width, height, film_quantum(&truth.scene));
    for pass in 0..rounds * REPLICATES {
        film.add_pass(pass, &renderer.pass(pass).samples);
        let done = f64::from(pass + 1) / f64::from(REPLICATES);
        if done == 1.5 {
            compare(truth, seed, done, &film, &mut verdicts.inside);
        } else if done.fract() == 0.0 && (done as u32).is_power_of_two() {
            compare(truth, seed, done, &film, &mut verdicts.whole);
        }
    }
}

/// The true error of a region, and how much of it keeps what was stated.
struct Found {
    pixels: usize,
    error: f64,
    error_of_all: f64,
    within: f64,
    within_noise: f64,
}

impl Found {
    fn of(truth: &Truth, errors: &Plane, statement: &Statement, region: &[bool]) -> Self {
        let noise = relative(&statement.noise, &truth.image);
        let pixels = errors.values().iter().zip(statement.bound.values());
        let pixels = pixels.zip(noise.into_iter().zip(&truth.noises));
        let pixels = pixels.zip(region).filter(|(_, inside)| **inside);
        let (mut squares, mut within, mut within_noise) = (Vec::new(), 0, 0);
        for (((&error, bound), (noise, own)), _) in pixels {
            let own = NORMAL_SQUARED * own;
            squares.push(error);
            within += usize::from(error <= bound * bound + own);
            within_noise += usize::from(error <= NORMAL_SQUARED * noise + own);
        }
        let count = squares.len();
        let root = |s: &[f64]| (s.iter().sum::<f64>() / s.len().max(1) as f64).sqrt();
        let error_of_all = root(&squares);
        squares.sort_by(f64::total_cmp);
        squares.truncate((count as f64 * (1.0 - WORST)) as usize);
        Self {
            pixels: count,
            error: root(&squares),
            error_of_all,
            within: within as f64 / count.max(1) as f64,
            within_noise: within_noise as f64 / count.max(1) as f64,
        }
    }
}

fn compare(truth: &Truth, seed: u64, round: f64, film: &Film, verdict: &mut Verdict) {
    let errors = relative_errors(&film.image(), &truth.image).expect("of one size");
    let Some(statement) = Statement::of(film, None) else {
        say(&format!("{:<14} {seed:>4} {round:>5} | black", truth.name));
        return;
    };
    let lit = Found::of(truth, &errors, &statement, &statement.lit);
    let caustic = Found::of(truth, &errors, &statement, &statement.caustic);
    let ratio = |found: &Found, stated: &Figures| {
        (stated.error * stated.error + truth.noise).sqrt() / found.error
    };
    let whole = ratio(&lit, &statement.whole);
    let caustics = statement.caustics.as_ref().map(|c| ratio(&caustic, c));
    let judged = lit.error * lit.error >= JUDGES * truth.noise;
    let bounded =
        lit.error * lit.error <= statement.whole.bound * statement.whole.bound + truth.noise;
    if judged {
        verdict.add(&lit, &caustic, whole, bounded);
    }
    let percent = |x: f64| format!("{:6.2}", 100.0 * x);
    say(&format!(
        "{:<14} {seed:>4} {round:>5} | {:>11} {} {} {} {whole:>6.2}  {} | {:>16} {} {} {:>6.2}  {} | {} {} | {} {} |{}",
        truth.name,
        lit.pixels,
        percent(lit.error),
        percent(statement.whole.error),
        percent(statement.whole.bound),
        percent(lit.within),
        caustic.pixels,
        percent(caustic.error),
        percent(statement.caustics.map_or(0.0, |c| c.error)),
        caustics.unwrap_or(0.0),
        percent(caustic.within),
        percent(lit.within_noise),
        percent(caustic.within_noise),
        percent(lit.error_of_all),
        percent(statement.whole.error_of_all),
        if judged {
            ""
        } else {
            " below what the reference can judge"
        }
    ));
}

/// The verdicts after whole rounds and inside one.
#[derive(Default)]
struct Verdicts {
    whole: Verdict,
    inside: Verdict,
}

/// How often the statements held.
#[derive(Default)]
struct Verdict {
    pictures: usize,
    lit_covered: usize,
    caustics_covered: usize,
    close: usize,
    bounded: usize,
}

impl Verdict {
    fn add(&mut self, lit: &Found, caustic: &Found, ratio: f64, bounded: bool) {
        let covered = |found: &Found| usize::from((0.85..=0.97).contains(&found.within));
        self.pictures += 1;
        self.lit_covered += covered(lit);
        self.caustics_covered += covered(caustic);
        self.close += usize::from((0.75..=1.25).contains(&ratio));
        self.bounded += usize::from(bounded);
    }

    fn words(&self) -> String {
        let Self {
            pictures,
            lit_covered,
            caustics_covered,
            close,
            bounded,
        } = self;
        format!(
            "of {pictures} pictures: 85 to 97 % of the pixels within their bounds in {lit_covered}, \
             of the caustic region in {caustics_covered}; error within 25 % of the truth in {close}; \
             below its bound in {bounded}"
        )
    }
}

#[allow(clippy::print_stdout, reason = "a table for whoever called")]
fn say(line: &str) {
    println!("{line}");
}

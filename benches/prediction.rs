//! Is the price right? Renders scenes, predicts at 1 %, 2 % and 20 % of the
//! passes which error the picture will state at the end and how many passes and
//! how much processor time it takes to get there, and compares. At the end it
//! says how often the error was predicted at 20 % of shorter renders, too.
//!
//! `cargo bench --bench prediction` takes the scenes of `SCENES`; a name takes
//! `scenes/NAME.ron` alone. `--rounds N` (47) and `--width N` (96 pixels) say
//! how much. A directory with references `NAME.exr` compares the error at the
//! end with the true one, too: the picture then has the reference's size.
//! `--curves` prints what every picture has stated.

use std::{env, path::Path};

use nephroid::{
    film::{Film, Image, read_exr},
    metrics::{Figures, Statement, relative_errors},
    plan::film_quantum,
    render::{Forecast, Interval, Price, REPLICATES, Renderer, ends_asked_round},
    scene::{Scene, load},
    study::Stopwatch,
};

/// Scenes of all kinds that are not expensive.
const SCENES: [&str; 22] = [
    "ball_lens",
    "conics",
    "cornell_glass",
    "cup",
    "ellipsoids",
    "first",
    "freeform",
    "gem",
    "glass_sphere",
    "glasses",
    "hall_of_mirrors",
    "interfaces",
    "light_guide",
    "mesh_glass",
    "plano_convex_lens",
    "pool",
    "prism",
    "soft_shadow",
    "solids",
    "torus",
    "tumbler",
    "water_glass",
];

/// Parts of the passes at which is predicted, and the largest factor between
/// prediction and truth that is good then.
const LOOKS: [(f64, f64); 3] = [(0.01, 2.0), (0.02, 2.0), (0.2, 1.3)];

/// Where shorter renders end, in passes, for which is predicted at
/// 20 %, too.
const SHORTER: [u32; 4] = [88, 128, 184, 264];

/// Part of the pixels that are left out of the error.
const WORST: f64 = 0.001;

struct Options {
    rounds: u32,
    width: u32,
    references: Option<String>,
    curves: bool,
    names: Vec<String>,
}

fn options() -> Options {
    let mut options = Options {
        rounds: 47,
        width: 96,
        references: None,
        curves: false,
        names: Vec::new(),
    };
    let mut words = env::args().skip(1);
    while let Some(word) = words.next() {
        let mut number = || words.next().and_then(|n| n.parse().ok());
        match word.as_str() {
            // Cargo adds this one.
            "--bench" => {}
            "--curves" => options.curves = true,
            "--rounds" => options.rounds = number().unwrap_or(options.rounds),
            "--width" => options.width = number().unwrap_or(options.width),
            name if Path::new(name).is_dir() => options.references = Some(name.to_owned()),
            name => options.names.push(name.to_owned()),
        }
    }
    if options.names.is_empty() {
        options.names = SCENES.map(str::to_owned).to_vec();
    }
    options
}

/// What was known at a time.
#[derive(Clone)]
struct Look {
    passes: u32,
    cpu: f64,
    figures: Figures,
}

fn main() {
    let options = options();
    say(
        "scene            passes | error at the end: predicted (90 %)         found  ratio | \
         passes to it: predicted (90 %)      found  ratio | CPU s: predicted (90 %)    found  ratio",
    );
    let mut verdicts = LOOKS.map(|_| Verdict::default());
    let mut shorter = SHORTER.map(|_| Verdict::default());
    for name in &options.names {
        let scene =
            load(Path::new(&format!("scenes/{name}.ron"))).unwrap_or_else(|e| panic!("{e}"));
        judge(name, &scene, &options, &mut verdicts, &mut shorter);
    }
    for ((part, good), verdict) in LOOKS.iter().zip(verdicts) {
        say(&format!(
            "at {} % of the passes: {}",
            100.0 * part,
            verdict.words(*good)
        ));
    }
    for (passes, verdict) in SHORTER.iter().zip(shorter) {
        say(&format!(
            "at 20 % of {passes} passes: error within a factor of {} in {} of {}, its interval held in {}",
            LOOKS[2].1, verdict.errors, verdict.pictures, verdict.errors_held
        ));
    }
}

fn judge(
    name: &str,
    scene: &Scene,
    options: &Options,
    verdicts: &mut [Verdict; 3],
    shorter: &mut [Verdict; 4],
) {
    let reference = options.references.as_ref().and_then(|directory| {
        let path = format!("{directory}/{name}.exr");
        read_exr(Path::new(&path), "").ok()
    });
    let [width, height] = scene.resolution;
    let size = match &reference {
        Some(image) => [image.width(), image.height()],
        None => [options.width, (options.width * height / width).max(8)],
    };
    let (film, looks, clock) = render(scene, size, options.rounds);
    let Some(end) = looks.last().cloned() else {
        say(&format!("{name:<16} | black"));
        return;
    };
    if options.curves {
        for look in &looks {
            let f = &look.figures;
            say(&format!(
                "curve {name} {} {:.4} noise {:.6} {:.6} bias {:.6} {:.6} order {:.3} error {:.6} {:.6}",
                look.passes,
                look.cpu,
                f.noise,
                f.noise_bound,
                f.bias,
                f.bias_bound,
                f.bias_order,
                f.error,
                f.bound,
            ));
        }
    }
    for ((part, good), verdict) in LOOKS.iter().zip(verdicts) {
        let last = (part * f64::from(end.passes)).ceil() as u32;
        predict(name, (&looks, &clock), last, *good, verdict);
    }
    let [.., (part, good)] = LOOKS;
    for (passes, verdict) in SHORTER.iter().zip(shorter) {
        let last = (part * f64::from(*passes)).ceil() as u32;
        let (forecast, _) = forecast((&looks, &clock), last);
        let error = forecast.error_after(*passes);
        let end = looks.iter().find(|look| look.passes == *passes);
        if let (Some(error), Some(end)) = (error, end) {
            verdict.count(&error, end.figures.error, good);
        }
    }
    if let Some(reference) = reference {
        let found = true_error(&film, &reference);
        say(&format!(
            "{name:<16} {:>6} | stated {:.3} %, in truth {:.3} %",
            end.passes,
            100.0 * end.figures.error,
            100.0 * found
        ));
    }
}

/// The film after so many rounds, what it had to say on the way, and the
/// processor seconds after every pass.
fn render(scene: &Scene, size: [u32; 2], rounds: u32) -> (Film, Vec<Look>, Vec<f64>) {
    let mut watch = Stopwatch::default();
    let [width, height] = size;
    let window = [0, 0, width, height];
    let renderer = watch.time(|| Renderer::new(scene, &scene.settings, size, window));
    let mut film = Film::new(width, height, film_quantum(scene));
    let (mut looks, mut clock) = (Vec::new(), Vec::new());
    for pass in 0..rounds * REPLICATES {
        watch.time(|| film.add_pass(pass, &renderer.pass(pass).samples));
        let passes = pass + 1;
        clock.push(watch.cpu_seconds());
        let figures = if ends_asked_round(passes) {
            Statement::of(&film, None).map(|s| s.whole)
        } else if passes == REPLICATES / 2 {
            Statement::early(&film)
        } else {
            None
        };
        looks.extend(figures.map(|figures| Look {
            passes,
            cpu: watch.cpu_seconds(),
            figures,
        }));
    }
    (film, looks, clock)
}

/// Sets what is predicted from the looks up to pass `last` beside the end.
fn predict(
    name: &str,
    (looks, clock): (&[Look], &[f64]),
    last: u32,
    good: f64,
    verdict: &mut Verdict,
) {
    let Some(end) = looks.last() else {
        return;
    };
    let (forecast, passes) = forecast((looks, clock), last);
    let Some(error) = forecast.error_after(end.passes) else {
        return;
    };
    let mut line = format!("{name:<16} {passes:>6} |");
    let found = end.figures.error;
    line += &row(&error, found, 100.0);
    verdict.count(&error, found, good);
    // With room for rounding.
    match forecast.price(end.figures.bound * 1.000_001) {
        Some(Price::Passes { passes, seconds }) => {
            let first = looks
                .iter()
                .filter(|l| l.passes >= REPLICATES)
                .find(|l| l.figures.bound <= end.figures.bound * 1.000_001)
                .unwrap_or(end);
            let needed = f64::from(first.passes);
            line += &row(&passes, needed, 1.0);
            line += &row(&seconds, first.cpu, 1.0);
            verdict.times += close(&seconds, first.cpu, good * good);
            verdict.times_held += held(&seconds, first.cpu);
            verdict.passes_held += held(&passes, needed);
        }
        other => line += &format!(" {other:?}"),
    }
    say(&line);
}

/// What the looks up to pass `last` let expect, and the last of them.
fn forecast((looks, clock): (&[Look], &[f64]), last: u32) -> (Forecast, u32) {
    let mut forecast = Forecast::new();
    let mut passes = 0;
    for look in looks.iter().take_while(|look| look.passes <= last) {
        for pass in passes..look.passes {
            forecast.clock(pass + 1, clock[pass as usize]);
        }
        forecast.observe(look.passes, &look.figures);
        passes = look.passes;
    }
    (forecast, passes)
}

fn row(of: &Interval, found: f64, scale: f64) -> String {
    let high = of
        .high
        .map_or("...".to_owned(), |h| format!("{:.2}", scale * h));
    let range = format!("({:.2} to {high})", scale * of.low);
    format!(
        " {:>9.2} {range:<22} {:>9.2} {:>5.2} |",
        scale * of.middle,
        scale * found,
        of.middle / found
    )
}

fn close(of: &Interval, found: f64, factor: f64) -> u32 {
    u32::from((1.0 / factor..=factor).contains(&(of.middle / found)))
}

fn held(of: &Interval, found: f64) -> u32 {
    u32::from(found >= of.low && of.high.is_none_or(|high| found <= high))
}

/// Root of the relMSE of the lit pixels without the worst.
fn true_error(film: &Film, truth: &Image) -> f64 {
    let errors = relative_errors(&film.image(), truth).expect("of one size");
    let statement = Statement::of(film, None).expect("whole rounds");
    let pixels = errors.values().iter().zip(&statement.lit);
    let mut squares: Vec<f64> = pixels.filter(|(_, lit)| **lit).map(|(e, _)| *e).collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate((squares.len() as f64 * (1.0 - WORST)) as usize);
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// How often predictions were good.
#[derive(Default)]
struct Verdict {
    pictures: u32,
    errors: u32,
    errors_held: u32,
    times: u32,
    times_held: u32,
    passes_held: u32,
}

impl Verdict {
    fn count(&mut self, error: &Interval, found: f64, good: f64) {
        self.pictures += 1;
        self.errors += close(error, found, good);
        self.errors_held += held(error, found);
    }

    fn words(&self, good: f64) -> String {
        format!(
            "of {} scenes, error within a factor of {good} in {}, its interval held in {}; \
             time within a factor of {:.2} in {}, its interval held in {}, that of the passes in {}",
            self.pictures,
            self.errors,
            self.errors_held,
            good * good,
            self.times,
            self.times_held,
            self.passes_held
        )
    }
}

#[allow(clippy::print_stdout, reason = "a table for whoever called")]
fn say(line: &str) {
    println!("{line}");
}

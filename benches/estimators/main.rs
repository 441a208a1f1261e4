//! Error against photons and processor time, on scenes with exact solutions:
//! this renderer, photon mapping with the nearest photons, and stochastic
//! progressive photon mapping.
//!
//! `cargo bench --bench estimators -- --scene before --seconds 60` takes one
//! scene (all without; several may be named) and lets every method double its
//! photons until the next picture would take longer than that (5 without).
//! `--rendered` compares with SPPM as this renderer has it alone, whose photons
//! go through the scene as they do in any renderer. `--plateau` lets the renderer
//! alone go on until relMSE 1e-4, to see that no bias stops it. `--differences
//! FILE.ron` takes a scene without a known truth: how its pictures of two seeds come
//! nearer to each other, and what they state of themselves.

#[path = "../common/clock.rs"]
mod clock;
mod cost;
mod differences;
mod exact;
mod ours;
mod rivals;
mod table;

use std::env;

use exact::{CASES, Case, Reference};
use ours::ours;
use rivals::{knn, rendered, sppm};
use table::say;

/// First radii of SPPM, in pixels.
const RADII: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// Which of them is for those who do not tune: the renderer's own default.
const UNTUNED: usize = 1;

/// Photons that a query of the oldest method looks for.
const NEAREST: [usize; 3] = [10, 50, 200];

/// The error at which a plateau would have shown.
const PLATEAU: f64 = 1e-4;

/// What the command line asks for.
struct Options {
    cases: Vec<Case>,
    seconds: f64,
    plateau: bool,
    rendered: bool,
    files: Vec<String>,
}

fn main() {
    let options = options();
    for file in &options.files {
        differences::differences(file, options.seconds);
    }
    for case in &options.cases {
        let reference = case.reference();
        table::heading(case, &reference);
        if options.plateau {
            plateau(case, &reference, options.seconds);
        } else if options.rendered {
            compare_rendered(case, &reference, options.seconds);
        } else {
            compare(case, &reference, options.seconds);
        }
    }
}

fn options() -> Options {
    let mut options = Options {
        cases: Vec::new(),
        seconds: 5.0,
        plateau: false,
        rendered: false,
        files: Vec::new(),
    };
    let mut words = env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || {
            words
                .next()
                .unwrap_or_else(|| panic!("{word} needs a value"))
        };
        match word.as_str() {
            "--seconds" => {
                options.seconds = value().parse().unwrap_or_else(|e| panic!("{word}: {e}"));
            }
            "--scene" => {
                let name = value();
                let case = Case::named(&name);
                options
                    .cases
                    .push(case.unwrap_or_else(|| panic!("no scene {name}; there are {CASES:?}")));
            }
            "--plateau" => options.plateau = true,
            "--rendered" => options.rendered = true,
            "--differences" => options.files.push(value()),
            // Cargo says so to every bench.
            "--bench" => {}
            _ => panic!(
                "{word}? There are --seconds S, --scene NAME, --rendered, --plateau and --differences FILE"
            ),
        }
    }
    if options.cases.is_empty() && options.files.is_empty() {
        options.cases = CASES.iter().filter_map(|name| Case::named(name)).collect();
    }
    options
}

fn compare(case: &Case, reference: &Reference, seconds: f64) {
    let own = ours(case, reference, seconds, 0.0);
    table::rows(&own);
    let progressive = RADII.map(|radius| sppm(case, reference, radius, seconds));
    progressive.iter().for_each(table::rows);
    for k in NEAREST {
        table::rows(&knn(case, reference, k, seconds));
    }
    table::summary(&own, &progressive, UNTUNED);
}

fn compare_rendered(case: &Case, reference: &Reference, seconds: f64) {
    let own = ours(case, reference, seconds, 0.0);
    table::rows(&own);
    let progressive = RADII.map(|radius| rendered(case, reference, radius, seconds));
    progressive.iter().for_each(table::rows);
    table::summary(&own, &progressive, UNTUNED);
}

fn plateau(case: &Case, reference: &Reference, seconds: f64) {
    let own = ours(case, reference, seconds, PLATEAU);
    table::rows(&own);
    table::slopes(&own, "photons");
    match own.cost_to(PLATEAU) {
        Some([seconds, _]) => say(&format!("no plateau down to {PLATEAU:e}: {seconds:.2} s")),
        None => say(&format!("{PLATEAU:e} was not reached in {seconds} s")),
    }
}

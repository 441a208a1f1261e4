//! A long hunt for leaks: rays from inside closed meshes at their edges and
//! vertices, and rays that leave each analytic surface from its own points,
//! judged by polynomials in 32 digits. Says how many of each were shot and went
//! wrong; fails if any did.
//!
//! `cargo bench --bench leaks -- 1e9 1e8` shoots 1e9 rays in meshes and 1e8
//! from every kind of surface; a million in meshes and a hundred thousand from
//! every kind if nothing is said. `-- 0 1e8 torus lens` names the kinds, and
//! `seed=8` goes on where a hunt with lesser seeds has left off.

#[path = "../tests/geometry/along.rs"]
mod along;
#[path = "../tests/geometry/composed.rs"]
mod composed;
#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/exact.rs"]
mod exact;
#[path = "../tests/geometry/field.rs"]
mod field;
#[path = "../tests/geometry/kinds.rs"]
mod kinds;
#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/leaks.rs"]
mod leaks;
#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/quick.rs"]
mod quick;
#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/scenes.rs"]
mod scenes;
#[path = "../tests/geometry/truth.rs"]
mod truth;

use std::process::ExitCode;

use leaks::{Bag, hunt_meshes, hunt_surface, surfaces};
use rayon::prelude::*;

/// Rays of one job.
const JOB: u64 = 100_000;

fn main() -> ExitCode {
    let mut counts = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse::<f64>().ok())
        .map(|n| n as u64);
    let in_meshes = counts.next().unwrap_or(1_000_000);
    let per_surface = counts.next().unwrap_or(100_000);
    report("surface                        rays    in floats   undecided    missed  false hits");
    let seed: u64 = std::env::args()
        .find_map(|a| a.strip_prefix("seed=")?.parse().ok())
        .unwrap_or(0);
    let mut leaks = 0;
    let mut tell = |name: &str, bag: Bag| {
        leaks += bag.leaks();
        report(&format!(
            "{name:<20} {:>14} {:>12} {:>11} {:>9} {:>11}",
            bag.rays, bag.glances, bag.undecided, bag.missed, bag.false_hits
        ));
    };
    if in_meshes > 0 {
        tell(
            "mesh",
            jobs(seed, in_meshes, |seed| hunt_meshes(seed, JOB, 10_000)),
        );
    }
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a.parse::<f64>().is_err() && !a.starts_with('-') && !a.starts_with("seed="))
        .collect();
    for name in surfaces().filter(|&n| wanted.is_empty() || wanted.iter().any(|w| w == n)) {
        let bag = jobs(seed, per_surface, |seed| hunt_surface(name, seed, JOB));
        tell(name, bag);
    }
    if leaks == 0 {
        return ExitCode::SUCCESS;
    }
    report(&format!("{leaks} leaks"));
    ExitCode::FAILURE
}

/// Jobs enough for `rays`, each with a seed of its own, of which this many were
/// used before.
fn jobs(used: u64, rays: u64, job: impl Fn(u64) -> Bag + Sync) -> Bag {
    (used..used + rays.div_ceil(JOB))
        .into_par_iter()
        .map(|seed| job(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
        .reduce(Bag::default, Bag::plus)
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn report(line: &str) {
    println!("{line}");
}

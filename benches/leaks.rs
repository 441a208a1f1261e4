//! A long hunt for leaks: rays from inside closed meshes at their edges and
//! vertices, and rays that leave each analytic surface from its own points,
//! judged in 32 digits or, for shapes of which a formula tells what is inside,
//! by that. Says how many of each were shot and went wrong; fails if any did.
//!
//! `cargo bench --bench leaks -- 1e9 1e8` shoots 1e9 rays in meshes and 1e8
//! from every kind of surface; a million in meshes and a hundred thousand from
//! every kind if nothing is said.

#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/exact.rs"]
mod exact;
#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/hunt.rs"]
mod hunt;
#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/known.rs"]
mod known;
#[path = "../tests/geometry/leaks.rs"]
mod leaks;
#[allow(dead_code, reason = "a module of the tests, of which this uses a part")]
#[path = "../tests/geometry/scenes.rs"]
mod scenes;

use std::process::ExitCode;

use hunt::hunt_known;
use known::KIND_NAMES;
use leaks::{Bag, SURFACES, hunt_meshes, hunt_surface};
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
    report("surface                    rays   undecided    missed  false hits");
    let mut leaks = 0;
    let mut tell = |name: &str, bag: Bag| {
        leaks += bag.leaks();
        report(&format!(
            "{name:<16} {:>14} {:>11} {:>9} {:>11}",
            bag.rays, bag.undecided, bag.missed, bag.false_hits
        ));
    };
    tell(
        "mesh",
        jobs(in_meshes, |seed| hunt_meshes(seed, JOB, 10_000)),
    );
    for (kind, name) in SURFACES.iter().enumerate() {
        let bag = jobs(per_surface, |seed| hunt_surface(kind, seed, JOB));
        tell(name, bag);
    }
    for (kind, name) in (0..).zip(KIND_NAMES) {
        let bag = jobs(per_surface, |seed| hunt_known(kind, seed, JOB));
        tell(name, bag);
    }
    if leaks == 0 {
        return ExitCode::SUCCESS;
    }
    report(&format!("{leaks} leaks"));
    ExitCode::FAILURE
}

/// Jobs enough for `rays`, each with a seed of its own.
fn jobs(rays: u64, job: impl Fn(u64) -> Bag + Sync) -> Bag {
    (0..rays.div_ceil(JOB))
        .into_par_iter()
        .map(|seed| job(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
        .reduce(Bag::default, Bag::plus)
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn report(line: &str) {
    println!("{line}");
}

//! Peak memory of one pass at 1, 10 and 100 million photon paths asked for,
//! under the default budget and under a tight one. Each runs in a process of
//! its own; Linux tells the peak.

mod common;
#[path = "common/peak.rs"]
mod peak;

use std::{env, process::Command};

use nephroid::render::{Job, Renderer};
use peak::peak_mebibytes;

fn main() {
    if let Ok(job) = env::var("NEPHROID_MEMORY_BENCH") {
        let (photons, budget) = job
            .split_once(' ')
            .unwrap_or_else(|| panic!("malformed job"));
        return one(
            photons.parse().unwrap_or_else(|e| panic!("{e}")),
            budget.parse().unwrap_or_else(|e| panic!("{e}")),
        );
    }
    let program = env::current_exe().unwrap_or_else(|e| panic!("{e}"));
    report("photons asked  budget MiB  photons traced  peak MiB");
    for budget in [8u64 << 30, 512 << 20] {
        for photons in [1_000_000u64, 10_000_000, 100_000_000] {
            let child = Command::new(&program)
                .env("NEPHROID_MEMORY_BENCH", format!("{photons} {budget}"))
                .status();
            assert!(child.is_ok_and(|s| s.success()), "the pass failed");
        }
    }
}

fn one(photons: u64, budget: u64) {
    let scene = common::load(common::CANONICAL[2]);
    let mut settings = Job::of(&scene).settings;
    settings.photons = Some(photons);
    settings.memory = budget;
    let [w, h] = scene.resolution;
    let renderer = Renderer::new(&scene, &settings, scene.resolution, [0, 0, w, h]);
    let pass = renderer.pass(0);
    report(&format!(
        "{photons:13}  {:10}  {:14}  {:8.0}",
        budget >> 20,
        pass.emitted,
        peak_mebibytes()
    ));
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn report(line: &str) {
    println!("{line}");
}

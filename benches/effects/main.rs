//! What an effect costs where no scene calls for it, and what it costs and
//! brings where one does: the instructions of a pass, counted by callgrind, or
//! its time if there is no valgrind.
//!
//! `cargo bench --bench effects` sets effects that can be switched beside the
//! same scene without them. `-- --builds` builds the program again without what
//! scenes lack, and sets the builds side by side; `-- --builds mirrors panes`
//! does so for single effects, and `-- --builds all` for every one, which takes
//! a build of some minutes each. `-- --builds --pairs 31` times the builds in
//! turns, too; `--kept` takes the builds of the last time. `-- --price` says what
//! effects take and bring in scenes that call for them.
//!
//! Every number is a process of its own that runs a number of passes on one
//! thread; what a pass takes is the difference between two such numbers, so
//! that loading and pilots drop out.

mod builds;
#[path = "../common/clock.rs"]
mod clock;
mod job;
mod price;
mod scenes;

use std::{
    env,
    path::{Path, PathBuf},
};

use nephroid::scene::Effect;

use job::{Job, Said, has_valgrind};

/// Effects that can be forced on, each in a scene that does not call for it.
/// In the last one a glass ball is where no light reaches: the plan knows, the
/// material does not.
const IN_VAIN: [(Effect, &str); 6] = [
    (Effect::Caustics, "ball, point"),
    (Effect::Indirect, "floor, point"),
    (Effect::Panes, "ball, lamp"),
    (Effect::Nesting, "glass, lamp"),
    (Effect::Glints, "ball, lamp"),
    (Effect::Caustics, "glass, no light"),
];

/// Effects that can be switched off, each in a scene that calls for it.
const CALLED_FOR: [(Effect, &str); 3] = [
    (Effect::Caustics, "glass, lamp"),
    (Effect::Indirect, "ball, lamp"),
    (Effect::Glints, "glass, lamp"),
];

fn main() {
    if let Some(job) = Job::of_this_process() {
        return job.run();
    }
    let unit = if has_valgrind() {
        "instructions"
    } else {
        "microseconds (no valgrind here)"
    };
    say(&format!("{unit} of a pass, in thousands"));
    let words: Vec<String> = env::args().skip(1).filter(|w| w != "--bench").collect();
    match words.split_first() {
        None => switched(),
        Some((first, names)) if first == "--builds" => builds::compare(names),
        Some((first, [])) if first == "--price" => price::table(&[]),
        Some((word, _)) => panic!("{word}: there are --builds and --price"),
    }
}

/// As planned beside forced on, and switched off beside as planned.
fn switched() {
    let program = this_program();
    let cost = |job: Job| job.cost(&program);
    say("\nproved away             as planned     forced on    share");
    for (effect, scene) in IN_VAIN {
        let job = Job::new(scene);
        let [plan, on] = [job.clone(), job.said(effect, Said::On)].map(cost);
        row(effect.title(), scene, plan, on);
    }
    say("\ncalled for            switched off    as planned    share");
    for (effect, scene) in CALLED_FOR {
        let job = Job::new(scene);
        let [plan, off] = [job.clone(), job.said(effect, Said::Gone)].map(cost);
        row(effect.title(), scene, off, plan);
    }
}

/// A line of a table of costs.
fn row(what: &str, scene: &str, without: f64, with: f64) {
    say(&format!(
        "{what:20} {:13.0} {:13.0} {:+8.2} %  {scene}",
        without / 1e3,
        with / 1e3,
        100.0 * (with / without - 1.0)
    ));
}

/// This program's file.
fn this_program() -> PathBuf {
    let path = env::current_exe().unwrap_or_else(|e| panic!("{e}"));
    assert!(Path::new(&path).exists(), "{}", path.display());
    path
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn say(line: &str) {
    println!("{line}");
}

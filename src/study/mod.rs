//! Studies: what accuracy costs in time, by every method and setting.
//!
//! Contract: [`study`] renders each scene by several methods with several
//! seeds, looks at the pictures after 1, 2, 4, 8, ... passes, and measures them
//! against a truth: a formula, a picture that was given, or a long run of
//! another method. Errors are roots of relMSE, times seconds of all threads
//! together ([`record`](Study) has the definitions). The pictures depend on
//! scenes, settings and seeds alone; times, and where a time is the limit the
//! numbers of passes, on the machine. Every finished run is on disk before the
//! next begins, so that a study goes on where it was.
//!
//! `request` says what is asked for, `sight` who sees which light, `curves`
//! which renders that takes; `run` renders, `store` keeps; `truth` is what the
//! pictures are judged by (`pilot` finds who makes it, `making` makes it), `judge` measures them, `split`, `fit` and `pictures`
//! make of it what the reader sees.

mod benchmark;
mod clock;
mod curves;
mod effects;
mod engine;
mod fault;
mod fit;
mod judge;
mod machine;
mod making;
mod pictures;
mod pilot;
mod record;
pub mod report;
mod request;
mod run;
mod sight;
mod split;
mod store;
mod truth;

pub use benchmark::{
    BENCHMARK, Benchmark, BenchmarkRun, BenchmarkScene, Judgement, STANDARD_SCENES, TARGETS, Task,
    Verdict, verdicts,
};
pub use clock::Stopwatch;
pub use curves::{Outline, outline};
pub use engine::study;
pub use fault::Fault;
pub use fit::{fit, time_to};
pub use pictures::MAP_TOP;
pub use record::{
    Absent, Effect, FORMAT, Fit, Machine, Picture, Point, Run, SceneStudy, Series, Setting, Split,
    Study, TimeTo, Truth, TruthKind,
};
pub use request::{Event, Request, Source, Subject, Sweep, Watch, Way};
pub use split::split;

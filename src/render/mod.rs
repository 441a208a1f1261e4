//! From a scene to a picture: the schedule, one pass, the driver.
//!
//! A pass is a pure function of (scene, settings, seed, pass index): nothing
//! of it depends on threads, on the clock or on earlier passes. A round is
//! eight passes, one for each replicate of the sample sequences. The clock
//! decides only how many passes run.

mod asking;
mod bounce;
mod camera_pass;
mod camera_walk;
mod checkpoint;
mod coordinates;
mod driver;
mod forecast;
mod glints;
mod importance;
mod indirect;
mod inspect;
mod lamps;
mod learn;
mod memory;
mod part;
mod pass;
mod pilot;
mod refine;
mod report;
mod schedule;
mod share;
mod subject;
mod tally;
mod view;

pub use asking::ends_asked_round;
pub use checkpoint::{CheckpointFault, SaveError};
pub use driver::{Job, Outcome, Progress, go_on, run};
pub use forecast::{Forecast, Interval, Price};
pub(crate) use inspect::{Effort, Sight};
pub use memory::TooLarge;
pub(crate) use memory::{film_bytes, mebibytes};
pub use part::{MergeFault, Part};
pub use pass::{PassOutput, Renderer};
pub use report::{ErrorReport, LightReport, Report, RoundReport};
pub use schedule::{REPLICATES, Schedule};
pub use subject::{LightFacts, Subject};

//! The command line: what was typed, what it means, and the calls it leads to.
//!
//! `args` (a file for each group of commands), `values`, `target` and `effects` hold what was typed; `render`, `merge`, `check`,
//! `plan`, `price`, `compare`, `study`, `bench` and `lens` resolve it and call the library. Words for people go to standard
//! error, so that standard output carries only data that was asked for
//! (`--json -`, the verdict of `check`, the tables of `plan`, `price` and `compare`, the
//! object of `lens`). This is the only room that prints; it
//! never panics because a reader went away.

mod args;
mod bench;
mod check;
mod checkpoint;
mod compare;
mod effects;
mod interrupt;
mod lens;
mod media;
mod merge;
mod outlook;
mod outputs;
mod parts;
mod plan;
mod price;
mod progress;
mod render;
mod study;
mod target;
mod values;

use std::{
    fmt::Display,
    io::{self, IsTerminal, Write},
    process::ExitCode,
};

use clap::Parser;

/// How the program ends; the numbers are part of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// All that was asked for was done.
    Done = 0,
    /// The render or the writing of a file failed.
    Fault = 1,
    /// The command line or the scene makes no sense.
    BadInput = 2,
    /// Interrupted; what was reached is saved.
    Interrupted = 3,
    /// Time or passes ran out before the error that was asked for was reached;
    /// the picture is saved.
    ShortOfError = 4,
    /// Pictures were compared, and a bound that was demanded does not hold. A
    /// code of its own, so that a script can tell it from a failure.
    OutOfBounds = 5,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// A reason to end early, as told to the user.
#[derive(Debug)]
pub(crate) struct Failure {
    exit: Exit,
    message: String,
}

impl Failure {
    fn bad_input(message: impl Display) -> Self {
        Self {
            exit: Exit::BadInput,
            message: format!("error: {message}"),
        }
    }

    fn fault(message: impl Display) -> Self {
        Self {
            exit: Exit::Fault,
            message: format!("error: {message}"),
        }
    }

    /// The mistakes in a scene file, which bring their own headings.
    fn scene(mistakes: &nephroid::scene::Diagnostics) -> Self {
        let shown = mistakes.render(colour());
        Self {
            exit: Exit::BadInput,
            message: match mistakes.len() {
                1 => shown,
                n => format!("{shown}\n\n{n} mistakes"),
            },
        }
    }
}

/// Does what the command line says.
pub(crate) fn main() -> Exit {
    let typed = match args::Typed::try_parse() {
        Ok(typed) => typed,
        Err(answer) => {
            // Help and version go to standard output, mistakes to standard
            // error; a reader who went away needs neither.
            let _ = answer.print();
            return if answer.use_stderr() {
                Exit::BadInput
            } else {
                Exit::Done
            };
        }
    };
    let done = match &typed.command {
        args::Command::Render(typed) => render::run(typed),
        args::Command::Merge(typed) => merge::run(typed),
        args::Command::Check(typed) => check::run(typed),
        args::Command::Plan(typed) => plan::run(typed),
        args::Command::Price(typed) => price::run(typed),
        args::Command::Compare(typed) => compare::run(typed),
        args::Command::Lens(typed) => lens::run(typed),
        args::Command::Bench(typed) => bench::run(typed),
        args::Command::Study(typed) => study::run(typed),
    };
    done.unwrap_or_else(|failure| {
        tell(failure.message.trim_end());
        failure.exit
    })
}

/// Uses so many threads from now on, if it is told; to be called before
/// anything is done in parallel.
fn use_threads(threads: Option<u16>) -> Result<(), Failure> {
    let Some(threads) = threads else {
        return Ok(());
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .build_global()
        .map_err(|e| Failure::fault(format!("cannot start {threads} threads: {e}")))
}

/// Says something to a person, on standard error.
fn tell(text: impl Display) {
    // Nobody may be listening, which is no reason to stop working.
    let _ = writeln!(io::stderr(), "{text}");
}

/// Puts data that was asked for on standard output.
fn deliver(text: impl Display) -> Result<(), String> {
    writeln!(io::stdout(), "{text}").map_err(|e| format!("cannot write to standard output: {e}"))
}

/// Whether words for people may be coloured (see no-color.org).
fn colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

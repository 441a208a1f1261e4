//! What was typed, a file for each group of commands. The doc comments are the
//! help texts.

mod compare;
mod lens;
mod look;
mod price;
mod render;
mod study;

use clap::{Parser, Subcommand};

pub(crate) use self::{
    compare::CompareArgs,
    lens::LensArgs,
    look::{CheckArgs, PlanArgs},
    price::PriceArgs,
    render::{MergeArgs, RenderArgs},
    study::{BenchArgs, StudyArgs},
};

const AFTER_HELP: &str = "\
Exit codes:
  0  done
  1  the render or the writing of a file failed; a checkpoint counts
     if the last attempt to write it failed
  2  bad input: the command line, the scene, a picture or a checkpoint
  3  interrupted; what was reached is saved
  4  time or passes ran out before the error of --error was reached;
     the picture is saved
  5  pictures compared, but a bound does not hold

Ctrl-C (and SIGTERM, SIGHUP) finishes the pass under way and saves pictures and
checkpoint; a second one stops at once and saves nothing.";

/// Renders caustics: light that glass, water and mirrors throw onto things.
#[derive(Debug, Parser)]
#[command(name = "nephroid", version, about, after_help = AFTER_HELP)]
pub(crate) struct Typed {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to EXR and PNG files
    Render(RenderArgs),
    /// Put parts of a picture together that were rendered apart
    Merge(MergeArgs),
    /// Check a scene file without rendering it
    Check(CheckArgs),
    /// Tell what a scene calls for, what is left out, and why
    Plan(PlanArgs),
    /// Tell what an error costs, without rendering the picture
    Price(PriceArgs),
    /// Measure how far pictures are from each other or from a reference
    Compare(CompareArgs),
    /// Measure what accuracy costs in time, by every method
    Study(StudyArgs),
    /// Time the renderer to fixed errors on fixed scenes
    Bench(BenchArgs),
    /// Design a lens whose caustic is a picture
    Lens(LensArgs),
}

//! What was typed. The doc comments are the help texts.

use std::{path::PathBuf, time::Duration};

use clap::{Args, Parser, Subcommand};

use super::values::{Crop, Output, crop, duration, output, resolution};

const AFTER_HELP: &str = "\
Exit codes:
  0  done
  1  the render or the writing of a file failed
  2  bad input: the command line or the scene
  3  interrupted; what was reached is saved

Ctrl-C finishes the pass under way and saves; a second one stops at once and
saves nothing.";

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
    /// Check a scene file without rendering it
    Check(CheckArgs),
}

/// What `render` was told.
#[derive(Args, Debug)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct RenderArgs {
    /// The scene file (RON)
    pub(crate) scene: PathBuf,

    /// File to write: .exr (linear, with layers) or .png (for the eye).
    /// May be given several times
    /// [default: the scene's name with .exr and .png, here]
    #[arg(short, long = "output", value_name = "FILE", value_parser = output, verbatim_doc_comment)]
    pub(crate) output: Vec<Output>,

    /// Number of passes [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) passes: Option<u32>,

    /// Render for a time such as 30s, 2m, 1h30m or 500ms instead of
    /// the scene's number of passes; the pass under way is finished.
    /// With --passes, whichever comes first
    #[arg(long, value_name = "TIME", value_parser = duration, verbatim_doc_comment)]
    pub(crate) time: Option<Duration>,

    /// Seed of the random numbers [default: the scene's]
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,

    /// Threads to use; the picture does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Size of the picture in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub(crate) resolution: Option<[u32; 2]>,

    /// Render only a rectangle of the picture:
    /// column and row of its top left pixel, then its size
    #[arg(long, value_name = "X,Y,WxH", value_parser = crop, verbatim_doc_comment)]
    pub(crate) crop: Option<Crop>,

    /// Photon paths per pass [default: the scene's, or chosen by the program]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) photons: Option<u64>,

    /// Say nothing unless something goes wrong
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Write the report as JSON to a file, or to standard output with -
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}

/// What `check` was told.
#[derive(Args, Debug)]
#[command(after_help = "Exit codes: 0 if the scene is in order, 2 if it is not.")]
pub(crate) struct CheckArgs {
    /// The scene file (RON)
    pub(crate) scene: PathBuf,

    /// Give the verdict as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_consistent() {
        super::Typed::command().debug_assert();
    }
}

//! Pictures: what `render` and `merge` were told.

use std::{num::NonZero, path::PathBuf, time::Duration};

use clap::Args;

use crate::cli::{
    effects::{EffectChoice, effect},
    parts::{Merged, Passes, merged, passes},
    target::target,
    values::{Crop, Method, Output, crop, duration, method, output, resolution},
};

use super::AFTER_HELP;

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

    /// Number of passes, or a range such as 64..128 (without 128):
    /// a part, to be merged with others [default: the scene's]
    #[arg(long, value_name = "N", value_parser = passes, verbatim_doc_comment)]
    pub(crate) passes: Option<Passes>,

    /// Render for a time such as 30s, 2m, 1h30m or 500ms instead of
    /// the scene's number of passes; the pass under way is finished.
    /// With --passes, whichever comes first
    #[arg(long, value_name = "TIME", value_parser = duration, verbatim_doc_comment)]
    pub(crate) time: Option<Duration>,

    /// Render until the picture states that its relative error is at most
    /// this, such as 5% or 0.05, instead of the scene's number of passes.
    /// With --time or --passes, whichever comes first
    #[arg(long, value_name = "ERROR", value_parser = target, verbatim_doc_comment)]
    pub(crate) error: Option<f64>,

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

    /// Switch effects: a list such as caustics=off,indirect=auto, or `all`, which
    /// works out even what is proved to be in vain
    #[arg(long, value_name = "LIST", value_parser = effect, value_delimiter = ',', verbatim_doc_comment)]
    pub(crate) effects: Vec<EffectChoice>,

    /// Paths per pass that start at the lights, of methods that choose their number
    /// [default: the scene's, or chosen by the program]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 31), verbatim_doc_comment)]
    pub(crate) photons: Option<u64>,

    /// Make the picture by another method, for comparison
    #[arg(long, value_name = "NAME", value_parser = method(), default_value = "photons")]
    pub(crate) method: Method,

    /// Photons of an estimate, of method photon-map [default: 64]
    #[arg(long, value_name = "N")]
    pub(crate) nearest: Option<NonZero<u32>>,

    /// Elements along the scene, of method radiosity [default: 32]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) patches: Option<u32>,

    /// Keep the passes in this file, now and then and at the end. If it is
    /// there and of this render, go on from it: the same command finishes
    /// what was killed. The file of another render is left alone
    #[arg(long, value_name = "FILE", verbatim_doc_comment)]
    pub(crate) checkpoint: Option<PathBuf>,

    /// Time between checkpoints [default: 60s]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub(crate) checkpoint_every: Option<Duration>,

    /// Go on from this checkpoint, also towards more passes than it was
    /// made for; keeps it up to date unless --checkpoint names another
    #[arg(long, value_name = "FILE", verbatim_doc_comment)]
    pub(crate) resume: Option<PathBuf>,

    /// Say nothing unless something goes wrong
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Write the report as JSON to a file, or to standard output with -
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}

/// What `merge` was told.
#[derive(Args, Debug)]
#[command(after_help = "\
Exit codes:
  0  merged
  1  the writing of a file failed
  2  bad input: the command line, or parts that do not go together")]
pub(crate) struct MergeArgs {
    /// Checkpoints of parts of one picture (render --passes A..B --checkpoint),
    /// in any order; together they must have no gap
    #[arg(required = true, value_name = "PART", verbatim_doc_comment)]
    pub(crate) parts: Vec<PathBuf>,

    /// File to write: .exr, .png, or .ckpt (a part to merge or to go on
    /// from). May be given several times
    #[arg(short, long = "output", value_name = "FILE", required = true, value_parser = merged, verbatim_doc_comment)]
    pub(crate) output: Vec<Merged>,

    /// Say nothing unless something goes wrong
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Write the report as JSON to a file, or to standard output with -
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}

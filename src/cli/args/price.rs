//! What `price` was told.

use std::{path::PathBuf, time::Duration};

use clap::Args;

use crate::cli::{
    effects::{EffectChoice, effect},
    target::target,
    values::{duration, resolution},
};

/// What `price` was told.
#[derive(Args, Debug)]
#[command(after_help = "\
Renders a few rounds, which are thrown away, and tells from them how many passes
and how much time `render --error` takes to each error: the most likely number,
and between which two it lies with a probability of 90 %. docs/accuracy.md
explains the law behind it.

Exit codes: 0 if prices were told, 1 if nothing can be told of the picture, 2 for
bad input.")]
pub(crate) struct PriceArgs {
    /// The scene file (RON)
    pub(crate) scene: PathBuf,

    /// Errors to price, such as 5%,0.02
    /// [default: 20%,10%,5%,2%,1%,0.5%]
    #[arg(long, value_name = "LIST", value_parser = target, value_delimiter = ',', verbatim_doc_comment)]
    pub(crate) error: Vec<f64>,

    /// Time to look at the scene; one round is rendered at least, and eight
    /// at most
    #[arg(long, value_name = "TIME", value_parser = duration, default_value = "10s", verbatim_doc_comment)]
    pub(crate) pilot: Duration,

    /// Seed of the random numbers [default: the scene's]
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,

    /// Threads to use, which the times are for [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Size of the picture in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub(crate) resolution: Option<[u32; 2]>,

    /// Switch effects, as `render` does
    #[arg(long, value_name = "LIST", value_parser = effect, value_delimiter = ',')]
    pub(crate) effects: Vec<EffectChoice>,

    /// Photon paths of a pass [default: the scene's, or chosen by the program]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 31))]
    pub(crate) photons: Option<u64>,

    /// Say nothing while it looks
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Give the prices as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

//! Looking at a scene: what `check` and `plan` were told.

use std::path::PathBuf;

use clap::Args;

use crate::cli::{
    effects::{EffectChoice, effect},
    values::resolution,
};

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

/// What `plan` was told.
#[derive(Args, Debug)]
#[command(after_help = "\
Tells of every effect whether it is simulated, why, and its share of the light
and of the work of a pass; then where the photons of each light end, with a
reason for every caustic that is missing. docs/effects.md explains the table.

Exit codes: 0 if the scene is in order, 2 if it is not.")]
pub(crate) struct PlanArgs {
    /// The scene file (RON)
    pub(crate) scene: PathBuf,

    /// Size of the picture in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub(crate) resolution: Option<[u32; 2]>,

    /// Switch effects, as `render` does
    #[arg(long, value_name = "LIST", value_parser = effect, value_delimiter = ',')]
    pub(crate) effects: Vec<EffectChoice>,

    /// Seed of the random numbers [default: the scene's]
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,

    /// Give the plan as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

//! Measuring: what `study` and `bench` were told.

use std::{path::PathBuf, time::Duration};

use clap::Args;

use nephroid::study::{STANDARD_SCENES, Sweep};

use crate::cli::{
    study::values::{Percent, percent, sweep},
    values::{Method, duration, method, resolution},
};

const AFTER_STUDY: &str = "\
Each method renders each scene with several seeds; its pictures after 1, 2, 4,
8, ... passes are measured against a reference, which an independent method
makes unless one is given. docs/study.md says how, and what the figures mean.

An interrupted study goes on where it was when it is called again in the same
way: its finished runs are in DIR/runs.

Exit codes:
  0  done
  1  a file could not be written
  2  bad input: the command line, a scene, a reference or the directory
  3  interrupted; the finished runs are kept";

/// What `study` was told.
#[derive(Args, Debug)]
#[command(after_help = AFTER_STUDY)]
pub(crate) struct StudyArgs {
    /// The scene files (RON)
    #[arg(required = true, value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,

    /// Directory for the report: new, empty, or that of a study
    #[arg(short, long = "output", value_name = "DIR")]
    pub(crate) output: PathBuf,

    /// Methods to judge, such as photons,path
    /// [default: photons and every method that sees the whole scene]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = method(), verbatim_doc_comment)]
    pub(crate) methods: Vec<Method>,

    /// Seeds of each curve: those that follow the scene's
    #[arg(long, value_name = "N", default_value_t = 4)]
    pub(crate) seeds: u32,

    /// Wall time of each curve, all its seeds together [default: 1m,
    /// or none with --passes]. Passes double as long as they fit
    #[arg(long, value_name = "TIME", value_parser = duration, verbatim_doc_comment)]
    pub(crate) time: Option<Duration>,

    /// Most passes of each run; with --time, whichever comes first
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) passes: Option<u32>,

    /// Errors whose price is asked for
    #[arg(long, value_name = "ERRORS", value_delimiter = ',', value_parser = percent,
          default_value = "10%,3%,1%,0.3%")]
    pub(crate) targets: Vec<Percent>,

    /// Size of the pictures in pixels [default: each scene's]
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub(crate) resolution: Option<[u32; 2]>,

    /// The truth: an EXR file of the pictures' size, or a directory with a
    /// file SCENE.exr for each scene [default: the study makes it]
    #[arg(long, value_name = "PATH", verbatim_doc_comment,
          conflicts_with_all = ["reference_method", "reference_time"])]
    pub(crate) reference: Option<PathBuf>,

    /// The method that makes references; it has no curve itself
    /// [default: by what each scene needs]
    #[arg(long, value_name = "NAME", value_parser = method(), verbatim_doc_comment)]
    pub(crate) reference_method: Option<Method>,

    /// Wall time that the reference of each scene may take
    /// [default: eight times --time, or 10m]
    #[arg(long, value_name = "TIME", value_parser = duration, verbatim_doc_comment)]
    pub(crate) reference_time: Option<Duration>,

    /// Give the renderer a further curve for each value of a setting:
    /// photons, radius, sampler, kernel, depth or indirect,
    /// such as radius=1,2,4 or kernel=Footprint,Circle.
    /// May be given several times
    #[arg(long, value_name = "SETTING=VALUES", value_parser = sweep, verbatim_doc_comment)]
    pub(crate) sweep: Vec<Sweep>,

    /// Threads to use [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Say what would be done, and do nothing
    #[arg(long)]
    pub(crate) list: bool,

    /// Say nothing unless something goes wrong
    #[arg(short, long)]
    pub(crate) quiet: bool,

    /// Write the study as JSON to standard output, too
    #[arg(long)]
    pub(crate) json: bool,
}

const AFTER_BENCH: &str = "\
Renders five scenes with several seeds until the error (root of relMSE without
the worst 0.1 % of the pixels, against references that come with the scenes)
is 20, 10 and 5 %, and says how much processor time that took.
docs/study.md says more.

With --against, every scene is judged beside the earlier benchmark, seed by
seed: faster or slower only where chance and the machine do not explain it.

Exit codes:
  0  done; nothing has become slower
  1  a file could not be written
  2  bad input: the command line, a scene, a reference or the earlier benchmark
  3  interrupted; nothing is kept
  5  a scene has become slower than in the earlier benchmark";

/// What `bench` was told.
#[derive(Args, Debug)]
#[command(after_help = AFTER_BENCH)]
pub(crate) struct BenchArgs {
    /// Scenes of the benchmark to render [default: all]
    #[arg(value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(STANDARD_SCENES))]
    pub(crate) names: Vec<String>,

    /// Directory with the scenes, and their references in references/
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    pub(crate) scenes: PathBuf,

    /// Seeds of each scene, from 1 on
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) seeds: u32,

    /// Most passes of each render
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) passes: u32,

    /// Threads to use [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Write the benchmark as JSON to a file, or to standard output with -
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,

    /// Compare with the JSON file of an earlier benchmark
    #[arg(long, value_name = "FILE")]
    pub(crate) against: Option<PathBuf>,

    /// Say nothing unless something goes wrong
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

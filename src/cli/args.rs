//! What was typed. The doc comments are the help texts.

use std::{num::NonZero, path::PathBuf, time::Duration};

use clap::{Args, Parser, Subcommand, builder::TypedValueParser as _};

use nephroid::{
    metrics::Metric,
    study::{STANDARD_SCENES, Sweep},
};

use super::effects::{EffectChoice, effect};
use super::parts::{Merged, Passes, merged, passes};
use super::study::values::{Percent, percent, sweep};
use super::target::target;
use super::values::{
    Bound, Crop, MapKind, Method, Output, bound, crop, darkest, duration, finite, index, length,
    magnification, method, metric, output, positive, region, resolution,
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
    Price(super::price::PriceArgs),
    /// Measure how far pictures are from each other or from a reference
    Compare(CompareArgs),
    /// Measure what accuracy costs in time, by every method
    Study(StudyArgs),
    /// Time the renderer to fixed errors on fixed scenes
    Bench(BenchArgs),
    /// Design a lens whose caustic is a picture
    Lens(LensArgs),
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

const AFTER_COMPARE: &str = "\
Metrics: rmse, mae, relmse, relmse-trimmed (without the worst 0.1 % of pixels),
mean-ratio, ssim, flip, hdr-flip. docs/comparing.md says what they mean.

Exit codes:
  0  compared, and every --max and --min holds
  1  the writing of a file failed
  2  bad input: the command line or the pictures
  5  compared, but a --max or --min does not hold";

/// What `compare` was told.
#[derive(Args, Debug)]
#[command(after_help = AFTER_COMPARE)]
pub(crate) struct CompareArgs {
    /// The picture to judge (.exr or .png)
    pub(crate) a: PathBuf,

    /// What it is compared with; with --reference a second picture to judge
    pub(crate) b: PathBuf,

    /// Compare A and B with this picture, each for itself
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,

    /// Score this rectangle instead of the whole: column and row of its top
    /// left pixel, then its size. May be given several times
    #[arg(long, value_name = "X,Y,WxH", value_parser = region, verbatim_doc_comment)]
    pub(crate) region: Vec<Crop>,

    /// Compare this layer of EXR files, such as caustic, instead of the
    /// picture. May be given several times
    #[arg(long, value_name = "NAME", verbatim_doc_comment)]
    pub(crate) layer: Vec<String>,

    /// Compare the picture and every layer that all files have
    #[arg(long, conflicts_with = "layer")]
    pub(crate) layers: bool,

    /// Compute this metric only. May be given several times
    #[arg(long, value_name = "METRIC", value_parser = metric)]
    pub(crate) metric: Vec<Metric>,

    /// Demand that a metric is at most a value, such as relmse=0.0025, in all
    /// that is compared. May be given several times
    #[arg(long, value_name = "METRIC=VALUE", value_parser = bound, verbatim_doc_comment)]
    pub(crate) max: Vec<Bound>,

    /// Demand that a metric is at least a value, such as ssim=0.98
    #[arg(long, value_name = "METRIC=VALUE", value_parser = bound)]
    pub(crate) min: Vec<Bound>,

    /// Draw the errors of every pixel: .png (in colours) or .exr (the numbers);
    /// of two pictures side by side
    #[arg(short, long = "output", value_name = "FILE", value_parser = output, verbatim_doc_comment)]
    pub(crate) output: Option<Output>,

    /// Which errors to draw [default: hdr-flip for EXR, flip for PNG]
    #[arg(long, value_name = "KIND", value_enum, requires = "output")]
    pub(crate) map: Option<MapKind>,

    /// The error that gets the brightest colour
    /// [default: 1 for FLIP, else the largest there is]
    #[arg(long, value_name = "VALUE", value_parser = positive, requires = "output", verbatim_doc_comment)]
    pub(crate) map_top: Option<f64>,

    /// Expose EXR files by this many stops for SSIM and FLIP
    /// [default: takes the mean of the reference to middle grey]
    #[arg(long, value_name = "STOPS", value_parser = finite, allow_negative_numbers = true, verbatim_doc_comment)]
    pub(crate) exposure: Option<f64>,

    /// Give the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What `lens` was told.
#[derive(Args, Debug)]
#[command(after_help = "\
Writes the heights of the lens's face as an EXR image, and to standard output
the object of a scene that uses it: it takes light that comes straight down and
puts the picture on the plane z = 0 below it.

Exit codes: 0 if the lens was written, 1 if it could not be, 2 for bad input or
a lens that cannot be made.")]
pub(crate) struct LensArgs {
    /// The picture (PNG); what is bright gets the light
    pub(crate) picture: PathBuf,

    /// File for the heights, with the ending .exr
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,

    /// Distance from the lens to the screen in metres
    #[arg(long, value_name = "METRES", value_parser = length)]
    pub(crate) distance: f64,

    /// Width of the lens in metres; its height follows from the picture
    #[arg(long, value_name = "METRES", value_parser = length)]
    pub(crate) width: f64,

    /// Size of the picture on the screen, in sizes of the lens
    #[arg(long, value_name = "FACTOR", value_parser = magnification, default_value_t = 1.0)]
    pub(crate) magnification: f64,

    /// Index of refraction of the glass
    #[arg(long, value_name = "N", value_parser = index, default_value_t = 1.5)]
    pub(crate) ior: f64,

    /// Heights along the lens's longer side
    #[arg(long, value_name = "N", default_value_t = 256,
          value_parser = clap::builder::PossibleValuesParser::new(["64", "128", "256", "512", "1024"])
              .map(|text| text.parse::<usize>().unwrap_or(256)))]
    pub(crate) resolution: usize,

    /// Least brightness in the picture, as a part of the greatest:
    /// all light goes into the picture, and less of it makes creases
    #[arg(long, value_name = "PART", value_parser = darkest, default_value_t = 0.05, verbatim_doc_comment)]
    pub(crate) darkest: f64,
}

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

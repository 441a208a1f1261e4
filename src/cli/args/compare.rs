//! What `compare` was told.

use std::path::PathBuf;

use clap::Args;

use nephroid::metrics::Metric;

use crate::cli::values::{
    Bound, Crop, MapKind, Output, bound, finite, metric, output, positive, region,
};

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

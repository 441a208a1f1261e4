//! What `lens` was told.

use std::path::PathBuf;

use clap::{Args, builder::TypedValueParser as _};

use crate::cli::values::{darkest, index, length, magnification};

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

//! `nephroid compare`: how far pictures are from each other or from a
//! reference. The result goes to standard output.

mod pictures;
mod verdict;

use nephroid::{
    film::{Image, OutputError, Window, atomic, exposure_factor, write_exr, write_png},
    metrics::{Comparison, Light, Map, Metric, Plane, Region, magma},
    spectrum::Rgb,
};

use self::{
    pictures::{Kind, Pictures},
    verdict::{Entry, as_json, table, violations},
};
use super::{
    Exit, Failure,
    args::CompareArgs,
    deliver, tell,
    values::{Crop, Format, Output},
};

/// Compares the pictures, draws the errors if asked to, and says what it found.
pub(super) fn run(typed: &CompareArgs) -> Result<Exit, Failure> {
    if let Some(output) = &typed.output {
        probe(typed, output)?;
    }
    let pictures = Pictures::load(typed)?;
    check(typed, &pictures)?;
    let names: Vec<String> = pictures
        .judged
        .iter()
        .map(|p| p.path.display().to_string())
        .collect();
    let map = typed
        .output
        .as_ref()
        .map(|output| (output, map_kind(typed, &pictures)));
    let mut entries = Vec::new();
    for (i, layer) in pictures.layers.iter().enumerate() {
        // Only the first layer is drawn.
        let map = map.filter(|_| i == 0);
        let compared = compare(typed, &pictures, layer, map.map(|(_, kind)| kind))?;
        entries.extend(scores(typed, &pictures, layer, &compared));
        if let Some((output, kind)) = map {
            draw(typed, output, kind, &compared)?;
        }
    }
    let violations = violations(typed, &names, &entries);
    let text = if typed.json {
        as_json(&pictures, &names, &entries, &violations).to_string()
    } else {
        table(&pictures, &names, &entries)
    };
    deliver(text).map_err(Failure::fault)?;
    if violations.is_empty() {
        return Ok(Exit::Done);
    }
    for violation in &violations {
        tell(violation);
    }
    Ok(Exit::OutOfBounds)
}

/// Finds out whether the file can be written and is none of the pictures.
fn probe(typed: &CompareArgs, output: &Output) -> Result<(), Failure> {
    let read = [Some(&typed.a), Some(&typed.b), typed.reference.as_ref()];
    if read.contains(&Some(&output.path)) {
        return Err(Failure::bad_input(format!(
            "{} would be overwritten by the errors",
            output.path.display()
        )));
    }
    atomic::probe(&output.path).map_err(|e| match e {
        OutputError::Io { .. } | OutputError::Encode { .. } => Failure::fault(e),
        _ => Failure::bad_input(e),
    })
}

/// Whether what was typed suits the pictures.
fn check(typed: &CompareArgs, pictures: &Pictures) -> Result<(), Failure> {
    let size = pictures.size();
    for &crop in &typed.region {
        if !region(crop).lies_inside(size) {
            let ([x, y], [w, h], [width, height]) = (crop.origin, crop.size, size);
            return Err(Failure::bad_input(format!(
                "the region {x},{y},{w}x{h} does not lie inside the picture of {width} x {height} pixels"
            )));
        }
    }
    if pictures.kind() == Kind::Png && typed.exposure.is_some() {
        let message = "PNG files are exposed already; --exposure is for EXR files";
        return Err(Failure::bad_input(message));
    }
    if pictures.kind() == Kind::Png && map_kind(typed, pictures) == Map::HdrFlip {
        let message = "PNG files have no high range; draw --map flip instead of hdr-flip";
        return Err(Failure::bad_input(message));
    }
    Ok(())
}

fn map_kind(typed: &CompareArgs, pictures: &Pictures) -> Map {
    typed.map.map_or_else(
        || match pictures.kind() {
            Kind::Exr => Map::HdrFlip,
            Kind::Png => Map::Flip,
        },
        Map::from,
    )
}

fn region(crop: Crop) -> Region {
    Region {
        origin: crop.origin,
        size: crop.size,
    }
}

/// The metrics that were asked for: by name, by a bound, or all.
fn metrics(typed: &CompareArgs) -> Vec<Metric> {
    let bounds = typed.max.iter().chain(&typed.min);
    let bounded: Vec<Metric> = bounds.map(|bound| bound.metric).collect();
    let wanted = |metric: &Metric| {
        typed.metric.is_empty() || typed.metric.contains(metric) || bounded.contains(metric)
    };
    Metric::ALL.into_iter().filter(wanted).collect()
}

/// Each judged picture's layer against the reference's.
fn compare(
    typed: &CompareArgs,
    pictures: &Pictures,
    layer: &str,
    map: Option<Map>,
) -> Result<Vec<Comparison>, Failure> {
    let light = match pictures.kind() {
        Kind::Png => Light::Display,
        // Layers are seen as they are in their picture.
        Kind::Exr => Light::Radiance {
            exposure: exposure_factor(pictures.reference.itself_or(layer), typed.exposure),
        },
    };
    let reference = pictures.reference.layer(layer);
    let metrics = metrics(typed);
    let judged = pictures.judged.iter().map(|picture| {
        Comparison::new(picture.layer(layer), reference, light, &metrics, map)
            .map_err(Failure::bad_input)
    });
    judged.collect()
}

/// The scores over the regions that were named, or over the whole.
fn scores(
    typed: &CompareArgs,
    pictures: &Pictures,
    layer: &str,
    compared: &[Comparison],
) -> Vec<Entry> {
    let whole = Region {
        origin: [0, 0],
        size: pictures.size(),
    };
    let regions: Vec<Option<Crop>> = if typed.region.is_empty() {
        vec![None]
    } else {
        typed.region.iter().copied().map(Some).collect()
    };
    let entry = |crop: Option<Crop>| Entry {
        layer: layer.to_owned(),
        region: crop,
        scores: compared
            .iter()
            .map(|c| c.scores(crop.map_or(whole, region)))
            .collect(),
    };
    regions.into_iter().map(entry).collect()
}

/// Writes the errors of the pictures side by side, in one scale.
fn draw(
    typed: &CompareArgs,
    output: &Output,
    kind: Map,
    compared: &[Comparison],
) -> Result<(), Failure> {
    let planes: Option<Vec<Plane>> = compared.iter().map(|c| c.map(kind)).collect();
    let planes = planes.ok_or_else(|| {
        Failure::bad_input(
            "the reference has no light to find exposures for; draw --map abs instead",
        )
    })?;
    let written = match output.format {
        Format::Exr => {
            let image = side_by_side(&planes, Rgb::grey);
            let window = Window::whole(image.width(), image.height());
            write_exr(&output.path, &[("", &image)], window, &[])
        }
        Format::Png => {
            let top = typed.map_top.unwrap_or_else(|| match kind {
                Map::Flip | Map::HdrFlip => 1.0,
                Map::Abs | Map::RelMse => largest(&planes),
            });
            tell(format_args!("the brightest colour is an error of {top}"));
            let image = side_by_side(&planes, |error| magma(error / top));
            write_png(&output.path, &image, Some(0.0))
        }
    };
    written.map_err(Failure::fault)?;
    tell(format_args!("wrote {}", output.path.display()));
    Ok(())
}

/// The largest finite error, or one if there is none above zero.
fn largest(planes: &[Plane]) -> f64 {
    let errors = planes.iter().flat_map(Plane::values).copied();
    let top = errors.filter(|e| e.is_finite()).fold(0.0, f64::max);
    if top > 0.0 { top } else { 1.0 }
}

fn side_by_side(planes: &[Plane], colour: impl Fn(f64) -> Rgb) -> Image {
    let (width, height) = (planes[0].width() as u32, planes[0].height() as u32);
    Image::from_fn(width * planes.len() as u32, height, |x, y| {
        let plane = &planes[(x / width) as usize];
        colour(plane.row(y as usize)[(x % width) as usize])
    })
}

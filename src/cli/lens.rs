//! `nephroid lens`: from a picture to the lens that throws it.

use std::{ffi::OsStr, path::Path};

use nephroid::{
    design::{self, Lens, Picture, Task},
    film::{self, Attribute, OutputError, atomic},
};

use super::{Exit, Failure, args::LensArgs, deliver, tell};

/// A picture may be this many times longer than wide, or wider than long.
const SLENDEREST: f64 = 8.0;

/// Designs the lens, writes its heights and says how to use them.
pub(super) fn run(typed: &LensArgs) -> Result<Exit, Failure> {
    check_output(&typed.output)?;
    let drawn = film::read_png(&typed.picture).map_err(Failure::bad_input)?;
    let size = [drawn.width() as usize, drawn.height() as usize];
    let values = drawn.pixels().iter().map(|p| p.luminance()).collect();
    let picture = Picture { size, values };
    let task = task(typed, size)?;
    let lens = design::design(&task, &picture).map_err(Failure::bad_input)?;
    let attributes = attributes(typed, &task);
    film::write_heights(
        &typed.output,
        task.resolution,
        &lens.rows_from_the_top(),
        &attributes,
    )
    .map_err(Failure::fault)?;
    tell(report(&task, &lens));
    tell(format_args!("wrote {}", typed.output.display()));
    deliver(object(&typed.output, &task)).map_err(Failure::fault)?;
    Ok(Exit::Done)
}

fn check_output(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().and_then(OsStr::to_str);
    if !extension.is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        let message = "the file for the heights must end in .exr: other formats store them in \
                       steps, which are facets to light";
        return Err(Failure::bad_input(message));
    }
    atomic::probe(path).map_err(|e| match e {
        OutputError::Io { .. } | OutputError::Encode { .. } => Failure::fault(e),
        _ => Failure::bad_input(e),
    })
}

fn task(typed: &LensArgs, size: [usize; 2]) -> Result<Task, Failure> {
    let aspect = size[1] as f64 / size[0] as f64;
    if !(1.0 / SLENDEREST..=SLENDEREST).contains(&aspect) {
        let message = format!(
            "a picture of {} x {} pixels is too slender for a lens; its sides may differ by a \
             factor of {SLENDEREST}",
            size[0], size[1]
        );
        return Err(Failure::bad_input(message));
    }
    // The nearest power of two, at least an eighth.
    let shorter = |part: f64| {
        let halvings = (0..3).filter(|k| part < 0.75 / f64::from(1 << k)).count();
        typed.resolution >> halvings
    };
    let resolution = if aspect <= 1.0 {
        [typed.resolution, shorter(aspect)]
    } else {
        [shorter(1.0 / aspect), typed.resolution]
    };
    Ok(Task {
        lens: [typed.width, typed.width * aspect],
        magnification: typed.magnification,
        distance: typed.distance,
        ior: typed.ior,
        resolution,
        darkest: typed.darkest,
    })
}

/// What the file says of its making.
fn attributes(typed: &LensArgs, task: &Task) -> Vec<(String, Attribute)> {
    let name = typed.picture.file_name().unwrap_or_default();
    let numbers = [
        ("distance", task.distance),
        ("lensWidth", task.lens[0]),
        ("lensHeight", task.lens[1]),
        ("magnification", task.magnification),
        ("ior", task.ior),
        ("darkest", task.darkest),
    ];
    let picture = Attribute::Text(name.to_string_lossy().into_owned());
    std::iter::once(("picture".to_owned(), picture))
        .chain(numbers.map(|(name, value)| (name.to_owned(), Attribute::Number(value))))
        .collect()
}

fn report(task: &Task, lens: &Lens) -> String {
    let highest = lens.heights.iter().copied().fold(0.0, f64::max);
    let quality = &lens.quality;
    format!(
        "a face of {} x {} heights, {:.3} mm from the lowest to the highest\n\
         transport: {} steps, densities within {:.2} %\n\
         light traced through it: correlation with the picture {:.4}, rms difference {:.1} % of \
         the mean, {:.3} % outside, {:.1} % reflected at the face",
        task.resolution[0],
        task.resolution[1],
        1e3 * highest,
        lens.steps,
        100.0 * lens.residual,
        quality.correlation,
        100.0 * quality.rms,
        100.0 * quality.outside,
        100.0 * quality.reflected,
    )
}

/// The lens as an object of a scene: turned over, so that light that comes
/// down enters by its flat side.
fn object(output: &Path, task: &Task) -> String {
    let name = output.file_name().unwrap_or_default().to_string_lossy();
    // To the nanometre, which keeps the text short.
    let tidy = |metres: f64| (metres * 1e9).round() / 1e9;
    let [x, y] = task.lens.map(|side| tidy(0.5 * side));
    format!(
        "(\n    \
             name: \"lens\",\n    \
             shape: HeightField(heights: {name:?}, x: ({}, {x}), y: ({}, {y}), depth: {}),\n    \
             material: Dielectric(ior: {}),\n    \
             at: (rotate: (axis: (1, 0, 0), degrees: 180), translate: (0, 0, {})),\n)",
        -x,
        -y,
        tidy(0.1 * x),
        task.ior,
        task.distance,
    )
}

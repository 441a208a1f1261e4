//! The renderer itself, with its default settings but for the passes.

use std::{f64::consts::PI, ops::ControlFlow, path::Path};

use nephroid::{
    film::{Image, Layer},
    render::{Job, run},
    scene::{Scene, load_str},
};

use crate::{
    clock::Clock,
    cost::{Row, Series, doublings},
    exact::{Case, Reference},
};

/// Renders anew for every budget, from one pass on, until the time
/// is up or the error is at most `enough`. A render is timed whole, from its
/// preparation to the finished film; reading the scene is not.
pub(crate) fn ours(case: &Case, reference: &Reference, seconds: f64, enough: f64) -> Series {
    let scene = load_str(&case.text(), case.name, Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    let mut rows = Vec::new();
    for passes in doublings(1) {
        let clock = Clock::start();
        let (image, photons) = render(&scene, passes as u32);
        let spent = clock.seconds();
        let row = Row::of(&image, reference, photons, spent);
        rows.push(row);
        if 2.0 * spent > seconds || row.error <= enough {
            break;
        }
    }
    Series::new("nephroid".to_owned(), rows)
}

/// Irradiance on the floor, and the photon paths that it took.
fn render(scene: &Scene, passes: u32) -> (Image, u64) {
    let mut job = Job::of(scene);
    job.settings.passes = passes;
    let outcome = run(scene, &job, &mut |_| ControlFlow::Continue(()));
    let radiance = outcome.film.layer_image(Layer::Caustic);
    let irradiance = Image::from_fn(radiance.width(), radiance.height(), |x, y| {
        // The floor is white.
        radiance.pixel(x, y) * PI
    });
    (irradiance, outcome.report.photons_emitted)
}

//! Stochastic progressive photon mapping as this renderer has it
//! (`--method sppm`): photons go through the scene as they do in any renderer,
//! hit points are camera rays, and every replicate has radii of its own.

use std::{f64::consts::PI, ops::ControlFlow, path::Path};

use nephroid::{
    film::{Image, Layer},
    reference::{Method, Options, render},
    render::{Job, REPLICATES},
    scene::load_str,
};

use crate::{
    clock::Clock,
    cost::{Row, Series, doublings},
    exact::{Case, Reference},
};

/// Renders anew for every budget, from a radius of `first` pixels.
pub(crate) fn rendered(case: &Case, reference: &Reference, first: f64, seconds: f64) -> Series {
    let scene = load_str(&case.text(), case.name, Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    let mut job = Job::of(&scene);
    job.settings.radius = first;
    let mut rows = Vec::new();
    for passes in doublings(u64::from(REPLICATES)) {
        job.settings.passes = passes as u32;
        let clock = Clock::start();
        let outcome = render(&scene, &job, Method::Sppm, Options::default(), &mut |_| {
            ControlFlow::Continue(())
        })
        .unwrap_or_else(|e| panic!("{e}"));
        let spent = clock.seconds();
        let radiance = outcome.film.layer_image(Layer::Caustic);
        let irradiance = Image::from_fn(radiance.width(), radiance.height(), |x, y| {
            // The floor is white.
            radiance.pixel(x, y) * PI
        });
        let paths = outcome.report.light_paths;
        rows.push(Row::of(&irradiance, reference, paths, spent));
        if 2.0 * spent > seconds {
            break;
        }
    }
    Series::new(format!("SPPM, rendered, {first} px"), rows)
}

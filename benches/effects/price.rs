//! What an effect brings to a scene that calls for it, and what it takes: the
//! scene as it is, and without the effect.

use std::{collections::HashMap, path::PathBuf};

use nephroid::{film::Image, metrics::relmse, scene::Effect};

use crate::{
    job::{Job, SIZE, Said},
    say,
    scenes::can_take_out,
    this_program,
};

/// Passes of the pictures that are judged, and of what judges them.
const PASSES: u32 = 8;
const TRUTH: u32 = 256;

/// Scenes that call for an effect.
fn calling(effect: Effect) -> &'static [&'static str] {
    match effect {
        Effect::Sources => &["hall_of_mirrors", "cornell_glass"],
        Effect::HardShadows => &["soft_shadow", "prism"],
        Effect::SoftShadows => &["soft_shadow"],
        Effect::Caustics => &["glass_sphere", "pool", "cup"],
        Effect::Indirect => &["cornell_glass", "gem"],
        Effect::Mirrors => &["cup", "hall_of_mirrors"],
        Effect::Refraction => &["glass_sphere", "pool"],
        Effect::TotalReflection => &["light_guide", "gem"],
        Effect::Panes => &["pane, lamp", "water_glass"],
        Effect::Nesting => &["water_glass"],
        Effect::ShadingNormals => &["tumbler", "pool"],
        Effect::Glints => &["hall_of_mirrors", "water_glass"],
    }
}

/// A line for each scene that calls for one of the effects. Where there are
/// programs without an effect, they show what is missing; where there are none,
/// the scene is changed, as far as that can be done.
pub(crate) fn table(programs: &[(Effect, PathBuf)]) {
    let [w, h] = SIZE;
    say(&format!(
        "\ncalled for         scene               without          with    share    light   \
         error without   with ({PASSES} passes of {w} x {h} pixels)"
    ));
    let mut truths = HashMap::new();
    let built = |effect: &Effect| programs.iter().find(|(e, _)| e == effect);
    for effect in Effect::ALL {
        let program = built(&effect).map(|(_, program)| program.clone());
        if program.is_none() && (!programs.is_empty() || !can_take_out(effect)) {
            continue;
        }
        for scene in calling(effect) {
            let truth = truths.entry(*scene).or_insert_with(|| {
                let job = Job::new(scene).passes(TRUTH);
                job.by(&this_program()).picture
            });
            line(effect, scene, program.clone(), truth);
        }
    }
}

/// What the effect takes of a pass, the part of the light that is missing
/// without it, and the errors of pictures without and with it, as the root of
/// relMSE.
fn line(effect: Effect, scene: &str, less: Option<PathBuf>, truth: &Image) {
    let whole = this_program();
    let job = Job::new(scene);
    let (poor, less) = match less {
        Some(program) => (job.clone(), program),
        None => (job.clone().said(effect, Said::Gone), whole.clone()),
    };
    let (without, with) = (poor.cost(&less), job.cost(&whole));
    let off = poor.passes(PASSES).by(&less).picture;
    let full = job.passes(PASSES).by(&whole).picture;
    let light = 1.0 - off.mean().mean() / full.mean().mean();
    let error = |x: &Image| 100.0 * relmse(x, truth).unwrap_or(f64::NAN).sqrt();
    say(&format!(
        "{:18} {scene:16} {:10.0} {:13.0} {:+8.1} % {:+7.2} % {:9.1} % {:6.1} %",
        effect.title(),
        without / 1e3,
        with / 1e3,
        100.0 * (with / without - 1.0),
        100.0 * light,
        error(&off),
        error(&full)
    ));
}

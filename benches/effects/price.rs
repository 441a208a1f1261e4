//! What an effect brings to a scene that calls for it, and what it takes: the
//! whole program beside the build without it.

use std::path::{Path, PathBuf};

use nephroid::{metrics::relmse, scene::Effect};

use crate::{
    job::{Job, SIZE},
    say, this_program,
};

/// Passes of the pictures that are compared.
const PASSES: u32 = 64;

/// Scenes that call for an effect.
fn calling(effect: Effect) -> &'static [&'static str] {
    match effect {
        Effect::Sources => &["ball_lens", "hall_of_mirrors"],
        Effect::HardShadows => &["soft_shadow", "prism"],
        Effect::SoftShadows => &["soft_shadow", "glass_sphere"],
        Effect::Caustics => &["glass_sphere", "pool", "cup"],
        Effect::Indirect => &["cornell_glass", "cup", "glass_sphere"],
        Effect::Mirrors => &["cup", "hall_of_mirrors"],
        Effect::Refraction => &["glass_sphere", "pool"],
        Effect::TotalReflection => &["light_guide", "prism"],
        Effect::Panes => &["pane, lamp"],
        Effect::Nesting => &["water_glass", "glasses"],
        Effect::ShadingNormals => &["tumbler", "plano_convex_lens"],
        Effect::Glints => &["cup", "gem"],
    }
}

/// A line for each scene that calls for one of the effects.
pub(crate) fn table(programs: &[(Effect, PathBuf)]) {
    let [w, h] = SIZE;
    say(&format!(
        "\ncalled for              left out         whole    share       light    error   \
         ({PASSES} passes of {w} x {h} pixels)"
    ));
    for (effect, program) in programs {
        for scene in calling(*effect) {
            line(*effect, scene, program);
        }
    }
}

/// What the effect takes of a pass, the part of the light that is missing
/// without it, and by how much the picture without it is off, as
/// the root of relMSE.
fn line(effect: Effect, scene: &str, less: &Path) {
    let whole = this_program();
    let job = Job::new(scene);
    let [without, with] = [less, &whole].map(|program| job.cost(program));
    let job = job.passes(PASSES);
    let [off, full] = [less, &whole].map(|program| job.by(program).picture);
    let light = 1.0 - off.mean().mean() / full.mean().mean();
    let error = relmse(&off, &full).unwrap_or(f64::NAN).sqrt();
    say(&format!(
        "{:20} {:13.0} {:13.0} {:+8.2} %  {:+8.3} % {:7.1} %  {scene}",
        effect.title(),
        without / 1e3,
        with / 1e3,
        100.0 * (with / without - 1.0),
        100.0 * light,
        100.0 * error
    ));
}

//! The errors that the methods with photons make on purpose: what stays of
//! them, and what makes them smaller.

use nephroid::{
    film::{Film, Layer},
    metrics::{mean_ratio, relmse},
    reference::{Method, Options},
    scene::Scene,
};

use super::{
    by_method,
    common::{ball, scene},
    job,
};

const PLANE: f64 = 1.3;
const BEAM: f64 = 0.95;
const WINDOW: f64 = 1.4;
const PIXELS: u32 = 48;

/// The film of the ball lens by a method.
fn lens(scene: &Scene, method: Method, rounds: u32, paths: u64) -> Film {
    let mut job = job(scene, rounds);
    job.settings.photons = Some(paths);
    // These methods count the surface on which light lands, too.
    job.settings.max_depth += 1;
    by_method(scene, &job, method, Options::default())
}

/// The caustic of a ball lens, which is known: errors of the first photon map
/// do not depend on how often it is looked at, but on its photons; those of
/// progressive photon mapping fall from pass to pass.
#[test]
fn blur_of_a_ball_lens() {
    let exact = ball::irradiance(PLANE, BEAM, WINDOW, PIXELS);
    let scene = scene(&ball::scene_text(PLANE, BEAM, WINDOW, PIXELS, ""));
    let error = |film: &Film| {
        let caustic = film.layer_image(Layer::Caustic);
        // Where the blur puts light is wrong, how much there is is not.
        let ratio = mean_ratio(&caustic, &exact).expect("same size");
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
        relmse(&caustic, &exact).expect("same size")
    };
    let map = |rounds, paths| error(&lens(&scene, Method::PhotonMap, rounds, paths));
    let few = map(1, 1 << 14);
    let looked_at_often = map(8, 1 << 11);
    let many = map(1, 1 << 18);
    assert!(
        (0.7..1.1).contains(&(looked_at_often / few)),
        "the same photons: {few} {looked_at_often}"
    );
    assert!(many < 0.5 * few, "sixteen times the photons: {few} {many}");
    let sppm = |rounds| error(&lens(&scene, Method::Sppm, rounds, 1 << 12));
    let (first, later) = (sppm(1), sppm(16));
    assert!(
        later < 0.4 * first,
        "sixteen times the passes: {first} {later}"
    );
}

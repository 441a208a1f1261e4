//! Where light turns back: photons know how far the fold of their caustic is.

mod common;

#[path = "../benches/estimators/exact/mod.rs"]
#[allow(
    dead_code,
    unused_imports,
    reason = "few of the closed forms are needed"
)]
mod exact;

use common::{renderer, scene};
use exact::{Case, Incidence, Optics, Source, frame, landing};
use glam::DVec3;
use nephroid::{
    photon::{Photon, shoot},
    sampling::{Purpose, Sequence},
};

const PATHS: u64 = 1 << 16;

/// Photons of a scene without any guide.
fn photons(case: &Case) -> Vec<Photon> {
    let mut scene = scene(&case.text());
    scene.settings.photons = Some(PATHS);
    let renderer = renderer(&scene);
    let emitter = renderer.emitter().expect("a caster");
    let sequence = Sequence::new(scene.settings.seed, Purpose::Photon, 0, 0);
    shoot(&renderer.context(), emitter, sequence, 0, PATHS).photons
}

/// The largest distance from the axis at which light lands that goes straight
/// through the ball and has not crossed the axis: the closed form's extremum.
fn fold_radius(case: &Case) -> f64 {
    let Optics::Ball(ball) = &case.optics else {
        panic!("a ball is asked for");
    };
    let landed = |h: f64| {
        let (dir, side) = match ball.source {
            Source::Parallel => {
                let [dir, side, _] = frame(1.0);
                (dir, side)
            }
            Source::Point(above) => {
                // The ray that passes the centre at distance h.
                let sin = h / above;
                let cos = (1.0 - sin * sin).sqrt();
                (DVec3::new(sin, 0.0, -cos), DVec3::new(cos, 0.0, sin))
            }
            Source::Cone(_) => panic!("no sharp fold"),
        };
        let turn = Incidence::new(h).transmitted(0);
        landing(dir, side, h, turn, ball.height).map_or(0.0, |p| p.x)
    };
    let steps = 100_000;
    (1..steps)
        .map(|i| landed(f64::from(i) / f64::from(steps)))
        .fold(0.0, f64::max)
}

/// Within a kernel of the fold, photons place it where the closed form has it:
/// to a tenth of their distance from it, and on the right side.
#[test]
fn photons_see_the_fold_ahead() {
    for name in ["before", "point"] {
        let case = Case::named(name).expect("a scene");
        let radius = fold_radius(&case);
        let photons = photons(&case);
        let brightest = photons.iter().map(|p| p.flux[1]).fold(0.0, f64::max);
        let (mut near, mut right) = (0u32, 0u32);
        for photon in photons {
            let Some(f) = photon.footprint else { continue };
            let at = photon.position.truncate();
            let before = radius - at.length();
            // Light that was reflected within the ball has other folds.
            if photon.flux[1] < 0.8 * brightest || before < 0.0 || before > f.minor {
                continue;
            }
            near += 1;
            let lit = photon.normal.cross(f.major.normalize());
            let seen = (photon.position - lit * f.fold).truncate().length();
            right += u32::from((seen - radius).abs() < 0.1 * before + 1e-6);
        }
        assert!(near > 500, "{name}: only {near} photons near the fold");
        assert!(
            f64::from(right) > 0.9 * f64::from(near),
            "{name}: {right} of {near} see the fold at {radius}"
        );
    }
}

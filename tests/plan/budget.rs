//! Where photons go when little of the light matters: errors of pictures
//! against long runs.

use nephroid::{
    photon::{Emitter, shoot},
    render::REPLICATES,
    sampling::{Purpose, Sequence},
    scene::Scene,
};

use crate::common::{renderer, scene_of};

/// A ball of glass of 5 cm on a ground of 100 m, four floodlights on masts and
/// a strong lamp behind a wall, with a glass of its own that nobody sees.
fn stadium(irrelevant: f64) -> Scene {
    let masts: String = [(-50, -50), (-50, 50), (50, -50), (50, 50)]
        .map(|(x, y)| format!("Sphere(center: ({x}, {y}, 30), radius: 0.5, power: 5000),"))
        .concat();
    scene_of(
        "eye: (0.2, -0.6, 0.4), look_at: (0, 0, 0.02), fov: 30",
        [24, 18],
        "(shape: Quad(corner: (-50, -50, 0), u: (100, 0, 0), v: (0, 100, 0)), material: \"grey\"),
         (shape: Sphere(center: (0, 0, 0.03), radius: 0.025), material: \"glass\"),
         (shape: Quad(corner: (-50, 40, 0), u: (100, 0, 0), v: (0, 0, 20)), material: \"grey\"),
         (shape: Sphere(center: (0, 45, 2), radius: 1.5), material: \"glass\")",
        &format!("{masts} Sphere(center: (0, 45, 6), radius: 0.3, power: {irrelevant})"),
        "photons: 16384, indirect: false",
    )
}

/// Relative squared error of the caustic in the mean of one round, and the part
/// of the photons that was stored within the picture's few square metres.
fn noise(scene: &Scene) -> f64 {
    let renderer = renderer(scene);
    let mut sums = Vec::new();
    for pass in 0..REPLICATES {
        let output = renderer.pass(pass);
        let caustic: Vec<f64> = output.samples.iter().map(|s| s.layers[1].mean()).collect();
        sums.push(caustic);
    }
    let n = sums.len() as f64;
    let (mut error, mut light) = (0.0, 0.0);
    for i in 0..sums[0].len() {
        let mean = sums.iter().map(|s| s[i]).sum::<f64>() / n;
        let spread: f64 = sums.iter().map(|s| (s[i] - mean).powi(2)).sum();
        error += spread / (n * (n - 1.0));
        light += mean * mean;
    }
    assert!(light > 0.0, "no caustic at all");
    error / light
}

/// A lamp that is a hundred times as strong takes no photons from a caustic
/// that is seen: the noise grows by little.
#[test]
fn an_irrelevant_lamp_starves_nobody() {
    let (alone, beside) = (noise(&stadium(1.0)), noise(&stadium(500_000.0)));
    assert!(
        beside < 2.0 * alone,
        "relative squared error {alone} alone, {beside} beside the strong lamp"
    );
}

/// What a pilot finds small keeps its floor.
#[test]
fn every_pair_keeps_a_part_of_the_photons() {
    let scene = stadium(500_000.0);
    let renderer = renderer(&scene);
    let ctx = renderer.context();
    let count = |emitter: &Emitter| {
        let sequence = Sequence::new(1, Purpose::Pilot, 0, 0);
        let tally = shoot(&ctx, emitter, sequence, 0, 1 << 15).tally;
        let part = |paths: u64| paths as f64 / f64::from(1 << 15);
        tally
            .lights
            .iter()
            .map(|l| part(l.paths))
            .collect::<Vec<_>>()
    };
    for emitter in [
        renderer.emitter(),
        renderer.emitter_of(0),
        renderer.emitter_of(4),
    ] {
        let parts = count(emitter.expect("casters"));
        assert_eq!(parts.len(), 5);
        for part in parts {
            // Two targets of each light, a hundredth each.
            assert!(part > 0.018, "{part}");
        }
    }
}

//! Photons that are guided to where the picture needs them: many more arrive
//! there, and they carry the same light.

mod common;

use common::{Estimate, renderer, scene, scene_of};
use glam::DVec3;
use nephroid::{
    photon::{Emitter, Photon, Rehearsal, shoot},
    render::{REPLICATES, Renderer},
    sampling::{Purpose, Sequence},
    scene::{Guidance, Scene},
};

/// Paths of a pass in these scenes.
const PATHS: u64 = 1 << 15;

/// Photons that arrive where `seen` says, and their power: over independent
/// replicates of a pass.
fn arriving(
    renderer: &Renderer<'_>,
    emitter: &Emitter,
    seen: impl Fn(&Photon) -> bool,
) -> (u64, Estimate) {
    let ctx = renderer.context();
    let mut count = 0;
    let powers: Vec<f64> = (0..2 * REPLICATES)
        .map(|replicate| {
            let sequence = Sequence::new(99, Purpose::Photon, replicate, 0);
            let shot = shoot(&ctx, emitter, sequence, 0, PATHS);
            let there = shot.photons.iter().filter(|p| seen(p));
            count += there.clone().count() as u64;
            there.map(|p| p.flux.mean()).sum::<f64>() / PATHS as f64
        })
        .collect();
    (count, Estimate::of(&powers))
}

/// Asserts that at least `times` as many photons arrive where they are seen
/// once the emitter was taught, that their power is the same within four
/// standard errors, and that it is known four times better.
fn assert_guided(scene: &Scene, times: u64, what: &str, seen: impl Fn(&Photon) -> bool) {
    let renderer = renderer(scene);
    let plain = renderer.emitter().expect("casters");
    let guided = renderer.emitter_of(0).expect("casters");
    let (few, rough) = arriving(&renderer, plain, &seen);
    let (many, fine) = arriving(&renderer, guided, &seen);
    assert!(
        many >= times * few,
        "{what}: {few} photons unguided, {many} guided"
    );
    // What the next epoch has learned is another distribution: a bias would
    // differ, and here both errors are small.
    let next = renderer.emitter_of(2).expect("casters");
    let (_, other) = arriving(&renderer, next, &seen);
    for e in [rough, other] {
        assert!(
            (e.mean - fine.mean).abs() < 4.0 * e.error.hypot(fine.error),
            "{what}: {fine:?} W guided, {e:?} otherwise"
        );
    }
    assert!(
        fine.error < 0.25 * rough.error,
        "{what}: {rough:?} W unguided, {fine:?} guided: no better"
    );
}

fn near(photon: &Photon, center: DVec3, radius: f64) -> bool {
    photon.position.distance(center) < radius
}

/// A glass ball of 10 cm on the ground of a stadium, among polished steel
/// balls that take nearly all the light that is aimed.
fn stadium() -> Scene {
    let steel: Vec<String> = (0..12)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 12.0).sin_cos();
            format!(
                "(shape: Sphere(center: ({}, {}, 4), radius: 3), material: \"mirror\"),",
                40.0 * cos,
                40.0 * sin
            )
        })
        .collect();
    let steel = steel.concat();
    scene_of(
        "eye: (0.5, -1.5, 1), look_at: (0, 0, 0), up: (0, 0, 1), fov: 30",
        [128, 128],
        &format!(
            "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
             (shape: Sphere(center: (0, 0, 0.15), radius: 0.1), material: \"glass\"), {steel}"
        ),
        "Sphere(center: (10, 10, 30), radius: 0.3, power: 10000)",
        &format!("photons: {PATHS}, indirect: false"),
    )
}

#[test]
fn a_small_glass_in_a_stadium() {
    let seen = |p: &Photon| near(p, DVec3::new(-0.05, -0.05, 0.0), 0.09);
    // Without guides the small glass has its floor, a hundredth of the paths.
    assert_guided(&stadium(), 80, "stadium", seen);
}

/// Fifty rooms in a row, each with a lamp and a glass ball; the camera sees
/// one of them, into which a second lamp shines through the missing wall.
fn rooms() -> Scene {
    let (mut objects, mut lights) = (String::new(), String::new());
    for i in 0..50 {
        let x = 4.0 * f64::from(i);
        objects +=
            &format!("(shape: Sphere(center: ({x}, 0, 1), radius: 0.5), material: \"glass\"),");
        if i != 25 {
            objects += &format!(
                "(shape: Quad(corner: ({}, -5, 0), u: (0, 10, 0), v: (0, 0, 5)), material: \"grey\"),",
                x + 2.0
            );
        }
        lights += &format!("Point(position: ({x}, 1, 4), power: 100),");
    }
    scene_of(
        "eye: (100, -1.9, 1.5), look_at: (100, 0, 0.5), up: (0, 0, 1), fov: 60",
        [128, 128],
        &format!(
            "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"), {objects}"
        ),
        &lights,
        &format!("photons: {PATHS}, indirect: false"),
    )
}

#[test]
fn two_lamps_of_fifty() {
    let seen = |p: &Photon| near(p, DVec3::new(100.0, 0.0, 0.0), 1.5);
    assert_guided(&rooms(), 100, "rooms", seen);
}

/// The sun through a hole of 5 cm in a board, onto a ball of glass a metre
/// across.
fn keyhole() -> Scene {
    let board: Vec<String> = [
        "corner: (-3, -3, 3), u: (2.975, 0, 0), v: (0, 6, 0)",
        "corner: (0.025, -3, 3), u: (2.975, 0, 0), v: (0, 6, 0)",
        "corner: (-0.025, -3, 3), u: (0.05, 0, 0), v: (0, 2.975, 0)",
        "corner: (-0.025, 0.025, 3), u: (0.05, 0, 0), v: (0, 2.975, 0)",
    ]
    .iter()
    .map(|quad| format!("(shape: Quad({quad}), material: \"grey\"),"))
    .collect();
    let board = board.concat();
    scene_of(
        "eye: (0, -2.5, 1.5), look_at: (0, 0, 0), up: (0, 0, 1), fov: 60",
        [128, 128],
        &format!(
            "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
             (shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\"), {board}"
        ),
        "Directional(direction: (0.05, 0.02, -1), irradiance: 1000, angular_diameter: 0.5)",
        &format!("photons: {PATHS}, indirect: false"),
    )
}

#[test]
fn the_sun_through_a_keyhole() {
    let seen = |p: &Photon| near(p, DVec3::ZERO, 0.45);
    assert_guided(&keyhole(), 40, "keyhole", seen);
}

/// Paths go where the score was, but for a tenth that goes by power: here all
/// the score is with the weaker of two lamps.
#[test]
fn lessons_move_paths() {
    let scene = scene_of(
        "eye: (0, -3, 2), look_at: (0, 0, 0), up: (0, 0, 1), fov: 60",
        [8, 8],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
         (shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\"),",
        "Point(position: (0, 1, 4), intensity: 3), Point(position: (0, -1, 4), intensity: 1)",
        "photons: 1",
    );
    let renderer = renderer(&scene);
    let ctx = renderer.context();
    let plain = renderer.emitter().expect("casters");
    let sequence = Sequence::new(1, Purpose::Pilot, 0, 0);
    let rehearsal = Rehearsal::new(&ctx, plain, sequence, 4096);
    let mut lessons = rehearsal.lessons(|_| 1.0);
    assert_eq!((lessons.len(), rehearsal.paths()), (4096, 4096));
    for lesson in &mut lessons {
        if lesson.origin.light == 0 {
            lesson.score = 0.0;
        }
    }
    let taught = plain.taught(&lessons, PATHS).expect("scores");
    let share = |emitter: &Emitter| {
        let tally = shoot(&ctx, emitter, sequence, 0, 1 << 14).tally;
        tally.lights[1].paths as f64 / f64::from(1 << 14)
    };
    // By power a quarter, within the pilot's few per cent.
    let by_power = share(plain);
    assert!((by_power - 0.25).abs() < 0.02, "{by_power} by power");
    let expected = 0.9 + 0.1 * by_power;
    let by_score = share(&taught);
    assert!((by_score - expected).abs() < 1e-3, "{by_score}, {expected}");
    for lesson in &mut lessons {
        lesson.score = if lesson.origin.light == 0 {
            0.0
        } else {
            f64::NAN
        };
    }
    assert!(
        plain.taught(&lessons, PATHS).is_none(),
        "nothing was worth anything"
    );
}

/// What a render learns depends on scene, settings, seed and epoch, not on
/// which pass was asked for first.
#[test]
fn passes_may_be_asked_for_in_any_order() {
    // With a number of photons and without: then it is learned, too.
    for scene in [keyhole(), two_halls(Guidance::Learned)] {
        let (forth, back) = (renderer(&scene), renderer(&scene));
        let passes = [0, 15, 16, 33];
        let samples = |r: &Renderer<'_>, pass| r.pass(pass).samples;
        let first: Vec<_> = passes.iter().map(|&p| samples(&forth, p)).collect();
        let last: Vec<_> = passes.iter().rev().map(|&p| samples(&back, p)).collect();
        for (i, pass) in passes.iter().enumerate() {
            assert!(
                first[i] == last[passes.len() - 1 - i],
                "pass {pass} depends on those before it"
            );
        }
    }
}

/// Guides leave the footprint of a photon true: the image of its cell of the
/// sample space, over its probability, carries its flux at the light's own
/// brightness. For a point lamp: flux = intensity times solid angle.
#[test]
fn a_guided_photon_knows_its_cell() {
    let scene = scene(
        "(camera: (eye: (0, -3, 1), look_at: (0, 0, 0), up: (0, 0, 1), fov: 40),
          image: (width: 128, height: 128),
          materials: {\"grey\": Diffuse(reflectance: 0.5), \"glass\": Dielectric(ior: 1.5)},
          objects: [
            (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
            (shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\"),
            (shape: Sphere(center: (9, 0, 1), radius: 0.5), material: \"glass\"),
          ],
          lights: [Point(position: (1, 0, 5), intensity: 3)],
          render: (photons: 32768, indirect: false))",
    );
    let renderer = renderer(&scene);
    let emitter = renderer.emitter_of(0).expect("casters");
    let sequence = Sequence::new(1, Purpose::Photon, 0, 0);
    let mut fluxes = Vec::new();
    for i in 0..4096 {
        let e = emitter.emit(&renderer.context(), &mut sequence.at(i));
        let [a, b] = e.differential.pairs()[0].dd.to_array();
        let solid_angle = a.cross(b).length() / e.differential.chance;
        let expected = 3.0 * solid_angle;
        assert!(
            (e.flux[1] / expected - 1.0).abs() < 1e-9,
            "{} W, {expected} expected",
            e.flux[1]
        );
        fluxes.push(e.flux[1]);
    }
    let [least, most] = [f64::min, f64::max].map(|f| fluxes.iter().copied().reduce(f));
    let ratio = most.expect("photons") / least.expect("photons");
    assert!(ratio > 4.0, "guides at work: fluxes differ by {ratio}");
}

/// Two halls with a ball of glass each. The camera sees one, lit by a weak
/// lamp, and ten lamps a hundred times as strong are in the other; the program
/// chooses the photons.
fn two_halls(guidance: Guidance) -> Scene {
    let strong = [-5, -4, -3, -2, -1, 0, 1, 2, 3, 4]
        .map(|x| format!("Sphere(center: ({x}, 8, 4), radius: 0.1, power: 1000),"))
        .concat();
    scene_of(
        "eye: (0, -4, 2.5), look_at: (0, 0, 0.3), up: (0, 0, 1), fov: 40",
        [144, 96],
        "(shape: Quad(corner: (-20, -20, 0), u: (40, 0, 0), v: (0, 40, 0)), material: \"grey\"),
         (shape: Quad(corner: (-20, 4, -1), u: (40, 0, 0), v: (0, 0, 9)), material: \"grey\"),
         (shape: Sphere(center: (0, 0, 0.8), radius: 0.5), material: \"glass\"),
         (shape: Sphere(center: (0, 8, 1), radius: 0.8), material: \"glass\")",
        &format!("Sphere(center: (-1, 0.5, 4), radius: 0.1, power: 10), {strong}"),
        &format!("guidance: {guidance:?}, indirect: false"),
    )
}

/// From the first round on a weak lamp whose caustic is seen gets most photons,
/// and the number of photons is chosen for what is seen; by power it would get
/// one in a thousand.
#[test]
fn the_first_round_is_guided() {
    for (guidance, bounds) in [
        (Guidance::Learned, 0.6..0.95),
        (Guidance::Power, 1e-4..1e-2),
    ] {
        let scene = two_halls(guidance);
        let renderer = renderer(&scene);
        let tally = renderer.shoot(0, 0).tally;
        let all: u64 = tally.lights.iter().map(|l| l.paths).sum();
        assert_eq!(all, renderer.photons());
        let part = tally.lights[0].paths as f64 / all as f64;
        assert!(bounds.contains(&part), "{guidance:?}: {part}");
    }
}

/// Mean radiance of a layer over the whole picture in each of the replicates
/// of some rounds.
fn means(scene: &Scene, layer: usize, rounds: [u32; 2]) -> Estimate {
    let renderer = renderer(scene);
    let passes = rounds.map(|round| round * REPLICATES..(round + 1) * REPLICATES);
    let means: Vec<f64> = passes
        .into_iter()
        .flatten()
        .map(|pass| {
            let samples = renderer.pass(pass).samples;
            let sum: f64 = samples.iter().map(|s| s.layers[layer].mean()).sum();
            sum / samples.len() as f64
        })
        .collect();
    Estimate::of(&means)
}

/// What is learned about lights, photons and their number changes the noise and
/// not the mean: direct light and caustics of rounds of different epochs are the
/// same as by power, and less noisy.
#[test]
fn learning_keeps_the_mean() {
    let [learned, power] = [Guidance::Learned, Guidance::Power].map(two_halls);
    for (layer, what) in [(0, "direct"), (1, "caustic")] {
        let [fine, rough] = [&learned, &power].map(|scene| means(scene, layer, [0, 2]));
        assert!(
            (fine.mean - rough.mean).abs() < 4.0 * fine.error.hypot(rough.error),
            "{what}: {fine:?} learned, {rough:?} by power"
        );
        assert!(
            fine.error < 0.5 * rough.error,
            "{what}: {fine:?} learned, {rough:?} by power: no better"
        );
    }
}

//! Every launched watt is accounted for, per light.

mod common;

use common::{Estimate, independent, photon_paths, render, renderer, scene, scene_of};
use glam::DVec3;
use nephroid::{sampling::warp, scene::Scene};

const TOP: &str = "eye: (0, 0, 2.5), look_at: (0, 0, 0), up: (0, 1, 0), height: 4";
const FLOOR: &str =
    "(shape: Quad(corner: (-3, -3, 0), u: (6, 0, 0), v: (0, 6, 0)), material: \"grey\"),";
/// 8 passes of 8192 paths.
const RENDER: &str = "passes: 8, photons: 8192";

fn glass_ball() -> Scene {
    scene_of(
        TOP,
        [16, 16],
        &format!("{FLOOR} (shape: Sphere(center: (0, 0, 1.2), radius: 1), material: \"glass\")"),
        "Point(position: (0, 1, 4), power: (10, 20, 5)),
         Sphere(center: (-2, 1, 3), radius: 0.3, radiance: (3, 2, 1))",
        RENDER,
    )
}

fn mirror_ring() -> Scene {
    scene_of(
        TOP,
        [16, 16],
        &format!(
            "{FLOOR} (shape: Cylinder(base: (0, 0, -0.1), end: (0, 0, 0.6), radius: 0.7),
               material: Mirror(reflectance: (0.9, 0.7, 0.5)))"
        ),
        "Quad(center: (-1.5, 0.3, 1.9), size: (0.4, 0.2), facing: (0, 0, 0), power: 30)",
        RENDER,
    )
}

/// Open water with smooth normals, so that shading normals change the flux.
fn water() -> Scene {
    scene_of(
        TOP,
        [16, 16],
        &format!(
            "{FLOOR} (shape: Waves(x: (-1, 1), y: (-1, 1), level: 0.6, cells: 24, waves: [
                 (amplitude: 0.05, k: (5.2, 2.1)), (amplitude: 0.03, k: (-3.1, 6.3), phase: 1.3)]),
               material: Dielectric(ior: 1.33), open: true)"
        ),
        "Disc(center: (0.5, 0.2, 3), facing: (0, 0, 0), radius: 0.4, radiance: 5)",
        RENDER,
    )
}

fn thin_pane() -> Scene {
    scene_of(
        TOP,
        [16, 16],
        &format!(
            "{FLOOR} (shape: Quad(corner: (-1, -1, 1), u: (2, 0, 0), v: (0, 2, 0)),
               material: Dielectric(ior: 1.5, thin: true))"
        ),
        "Spot(position: (0.5, 0, 3), look_at: (0, 0, 0), inner: 20, outer: 40, power: 7)",
        RENDER,
    )
}

/// All kinds of light, several casters of different kinds.
fn many_lights() -> Scene {
    scene_of(
        TOP,
        [16, 16],
        &format!(
            "{FLOOR} (shape: Sphere(center: (0.8, 0, 0.6), radius: 0.5), material: \"glass\"),
             (shape: Sphere(center: (-0.8, 0, 0.6), radius: 0.5), material: \"mirror\"),
             (shape: Cylinder(base: (0, 1, 0.2), end: (0, 1, 0.9), radius: 0.3, capped: true),
              material: \"glass\")"
        ),
        "Point(position: (0, 0, 3), intensity: (1, 2, 3)),
         Spot(position: (2, 0, 3), look_at: (0.8, 0, 0.6), inner: 2, outer: 25, intensity: 9),
         Directional(direction: (0.2, 0, -1), irradiance: 4, beam: (center: (-0.8, 0, 3), radius: 0.7)),
         Directional(direction: (-0.3, 0.1, -1), irradiance: (1, 0.5, 0.2), angular_diameter: 2),
         Sphere(center: (0, -2, 2), radius: 0.4, radiance: 2),
         Quad(center: (1, 2, 2), size: (0.5, 0.3), facing: (0, 0, 0), radiance: 3),
         Disc(center: (-1, 2, 2), facing: (0, 0, 0), radius: 0.3, radiance: 4)",
        RENDER,
    )
}

/// Unbounded: the whole domain of the light is used.
fn mirror_plane() -> Scene {
    scene_of(
        "eye: (0, 0, 1), look_at: (1, 0, 3), fov: 40",
        [16, 16],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Mirror(reflectance: 0.8)),
         (shape: Plane(point: (0, 0, 4), normal: (0, 0, -1)), material: \"grey\")",
        "Point(position: (0.3, 0, 2), power: 12), Sphere(center: (2, 0, 2), radius: 0.2, power: 3)",
        RENDER,
    )
}

/// Three concentric shells and a limit of two steps.
fn low_depth_limit() -> Scene {
    let shell =
        |r: f64| format!("(shape: Sphere(center: (0, 0, 1.3), radius: {r}), material: \"glass\"),");
    scene_of(
        TOP,
        [16, 16],
        &format!("{FLOOR} {} {} {}", shell(1.0), shell(0.8), shell(0.5)),
        "Sphere(center: (1, 0, 4), radius: 0.3, radiance: 10)",
        "passes: 8, photons: 8192, max_depth: 2",
    )
}

/// A box of poor mirrors with a hole above a small diffuse plate: the
/// roulette ends most paths.
fn mirror_box() -> Scene {
    let wall = |at: &str| format!("(shape: Quad({at}), material: Mirror(reflectance: 0.7)),");
    let walls = [
        "corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0)",
        "corner: (-1, -1, 2), u: (1.5, 0, 0), v: (0, 2, 0)",
        "corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 0, 2)",
        "corner: (-1, 1, 0), u: (2, 0, 0), v: (0, 0, 2)",
        "corner: (-1, -1, 0), u: (0, 2, 0), v: (0, 0, 2)",
        "corner: (1, -1, 0), u: (0, 2, 0), v: (0, 0, 2)",
    ];
    scene_of(
        TOP,
        [16, 16],
        &format!(
            "{} (shape: Disc(center: (0, 0, 0.5), normal: (0, 0, 1), radius: 0.4), material: \"grey\")",
            walls.map(wall).concat()
        ),
        "Point(position: (0.2, 0.1, 1.5), power: 5), Quad(center: (0, 0, 1.9), size: (0.2, 0.2), normal: (0, 0, -1), power: 8)",
        RENDER,
    )
}

fn all() -> [(&'static str, Scene); 8] {
    [
        ("glass ball", glass_ball()),
        ("mirror ring", mirror_ring()),
        ("water", water()),
        ("thin pane", thin_pane()),
        ("many lights", many_lights()),
        ("mirror plane", mirror_plane()),
        ("low depth limit", low_depth_limit()),
        ("mirror box", mirror_box()),
    ]
}

/// Launched + reflected + roulette gain + shading change = stored + direct +
/// absorbed + escaped + roulette loss + truncated. The sums have 65,536 addends, each
/// rounded a few times: 1e-9 is a thousand times what that explains.
#[test]
fn the_ledger_of_every_light_balances() {
    for (name, scene) in all() {
        let report = render(&scene).report;
        for light in &report.lights {
            let ledger = &light.ledger;
            assert!(ledger.launched > 0.0, "{name}, {}: no light", light.name);
            assert!(
                ledger.imbalance().abs() <= 1e-9 * ledger.launched,
                "{name}, {}: {} of {} W unaccounted for",
                light.name,
                ledger.imbalance(),
                ledger.launched
            );
        }
    }
}

/// What is launched towards casters and what is not aimed at any make up the
/// light's power, within four standard errors: of independent launches (the
/// low-discrepancy ones of a render do better) and of the pilot that finds
/// what is not aimed.
#[test]
fn launched_and_not_aimed_make_up_the_power() {
    let mut kinds = 0;
    for (name, scene) in all() {
        let renderer = renderer(&scene);
        let emitter = renderer.emitter().expect("casters and lights");
        let ctx = renderer.context();
        let report = render(&scene).report;
        let paths = report.photons_emitted as f64;
        // Standard deviation of a path's flux, as seen by each light.
        let mut flux = vec![Vec::new(); scene.lights.len()];
        for i in 0..4096 {
            let emission = emitter.emit(&ctx, &mut independent(1, i));
            for (light, list) in flux.iter_mut().enumerate() {
                let own = light == emission.light as usize;
                list.push(if own { emission.flux.mean() } else { 0.0 });
            }
        }
        for (light, flux) in report.lights.iter().zip(&flux) {
            let (Some(power), Some((not_aimed, pilot_error))) = (light.power, light.not_aimed)
            else {
                assert!(light.power.is_none(), "{name}: only suns have no power");
                continue;
            };
            kinds += 1;
            let launch_error = Estimate::of(flux).error * (flux.len() as f64 / paths).sqrt();
            let error = launch_error.hypot(pilot_error);
            let sum = light.launched + not_aimed;
            assert!(
                (sum - power).abs() <= 4.0 * error + 1e-12 * power,
                "{name}, {}: {} launched + {not_aimed} not aimed of {power} W, error {error}",
                light.name,
                light.launched
            );
            assert!(error < 0.03 * power, "{name}: {error} of {power} W");
        }
    }
    assert_eq!(kinds, 16, "every light but the sun was looked at");
}

/// The scenes exercise what they are there for.
#[test]
fn every_entry_of_the_ledger_is_used() {
    let ledger = |scene: &Scene| render(scene).report.lights[0].ledger;
    let water = ledger(&water());
    assert!(water.shading_change != 0.0 && water.stored > 0.0 && water.escaped > 0.0);
    let low = render(&low_depth_limit()).report;
    assert!(low.lights[0].ledger.truncated > 0.0 && low.lights[0].ledger.truncated_paths > 0);
    assert!(
        low.flux_truncated > 0.1 && low.to_string().contains("raise render.max_depth"),
        "the report says what the limit cost"
    );
    let mirrors = ledger(&mirror_box());
    assert!(mirrors.absorbed > 0.0 && mirrors.roulette_gain > 0.0 && mirrors.roulette_loss > 0.0);
    let pane = ledger(&thin_pane());
    assert!(
        pane.direct > 0.0,
        "light that passes the pane is the shadow ray's"
    );
}

/// The roulette gives to survivors what it takes from the others: gain less
/// loss is zero on average, within five standard errors of independent paths.
#[test]
fn the_roulette_is_fair() {
    let scene = mirror_box();
    let paths = photon_paths(&scene, 40_000);
    let differences: Vec<f64> = paths
        .iter()
        .map(|p| p.tally.roulette_gain - p.tally.roulette_loss)
        .collect();
    let estimate = Estimate::of(&differences);
    let turnover: f64 = paths.iter().map(|p| p.tally.roulette_loss).sum();
    assert!(
        estimate.mean.abs() <= 5.0 * estimate.error,
        "the roulette makes light: {estimate:?}"
    );
    assert!(
        estimate.error * 40_000.0 < 0.05 * turnover,
        "too noisy to see anything: {estimate:?} of {turnover}"
    );
}

/// A caster that only just reaches into a spot's cone gets its light: the
/// sliver is a small part of what is aimed at, and a pilot may miss it.
#[test]
fn slivers_of_light_are_not_lost() {
    // The spot looks along x with a hard edge at 10 degrees; the ball covers
    // 5 degrees around a direction 14.95 degrees away.
    let scene = scene(
        "(camera: (eye: (0, 0, 9), look_at: (0, 0, 0), up: (0, 1, 0), fov: 40),
          image: (width: 4, height: 4),
          objects: [
            (shape: Sphere(center: (9.661521, 2.579833, 0), radius: 0.8715574), material: Mirror()),
            (shape: Plane(point: (0, 0, -9), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
          ],
          lights: [Spot(position: (0, 0, 0), direction: (1, 0, 0), inner: 10, outer: 10, power: 1)])",
    );
    let renderer = renderer(&scene);
    let emitter = renderer.emitter().expect("the spot reaches the ball");
    let ctx = renderer.context();
    let n = 1_000_000;
    let launched: Vec<f64> = (0..n)
        .map(|i| emitter.emit(&ctx, &mut independent(3, i)).flux.mean())
        .collect();
    // The part of the spot's directions that lies in the ball's cone.
    let (away, half) = (14.95f64.to_radians(), 5f64.to_radians());
    let axis = DVec3::new(away.cos(), away.sin(), 0.0);
    let q = 1.0 - 10f64.to_radians().cos();
    let inside = |i: u64| {
        let d = warp::cone(independent(4, i).next_2d(), q);
        DVec3::new(d.z, d.x, d.y).dot(axis) >= half.cos()
    };
    let count = (0..n).filter(|&i| inside(i)).count() as f64;
    let (expected, error) = (count / n as f64, count.sqrt() / n as f64);
    let estimate = Estimate::of(&launched);
    assert!(count > 50.0, "the sliver is there");
    assert!(
        (estimate.mean - expected).abs() <= 5.0 * estimate.error.hypot(error),
        "{estimate:?} launched of {expected} W"
    );
}

//! What is left out by proof leaves no trace: the same bits with everything
//! forced on.

use std::{fs, path::Path};

use nephroid::{
    render::Renderer,
    scene::{self, Choices, Scene},
};

use crate::{common::scene_of, reasons};

/// The scenes that ship.
fn shipped() -> Vec<(String, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<_> = fs::read_dir(folder)
        .expect("the scenes")
        .map(|entry| entry.expect("a file").path())
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .collect();
    files.sort();
    files
        .into_iter()
        .map(|path| {
            let scene = scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
            (path.display().to_string(), scene)
        })
        .collect()
}

/// Pixels of a pass of the second round, and its photon paths.
fn pixels(scene: &Scene, all_on: bool, photons: Option<u64>) -> (Vec<[u64; 12]>, u64) {
    let mut settings = scene.settings.clone();
    settings.photons = photons;
    if all_on {
        settings.effects = Choices::all_on();
    }
    let renderer = Renderer::new(scene, &settings, [20, 15], [0, 0, 20, 15]);
    let output = renderer.pass(9);
    let bits = output.samples.iter().map(|sample| {
        let values = sample.layers.map(|l| [l[0], l[1], l[2]]);
        // The sign of a zero is none of a picture.
        let flat = values.as_flattened().iter().map(|v| (v + 0.0).to_bits());
        let flat: Vec<u64> = flat.collect();
        flat.try_into().expect("four layers")
    });
    (bits.collect(), output.emitted)
}

fn assert_same(name: &str, scene: &Scene, photons: Option<u64>) {
    let ((plan, _), (all, _)) = (pixels(scene, false, photons), pixels(scene, true, photons));
    let differ = plan.iter().zip(&all).filter(|(a, b)| a != b).count();
    assert_eq!(differ, 0, "{name}: so many of {} pixels", plan.len());
    assert!(
        plan.iter().flatten().any(|&v| v != 0),
        "{name}: a black picture proves little"
    );
}

#[test]
fn shipped_scenes_keep_every_bit() {
    let scenes = shipped();
    assert!(scenes.len() >= 20);
    for (name, scene) in &scenes {
        assert_same(name, scene, Some(4096));
    }
}

#[test]
fn scenes_without_caustics_keep_every_bit() {
    for (i, missing) in reasons::ALL.iter().enumerate() {
        let mut scene = missing.scene();
        // What the user says is no proof.
        scene.settings.effects = Choices::default();
        let black = missing.name == "the sun below the floor" || missing.name.contains("bulb");
        if !black && missing.name != "a mirror that shows the lamp itself" {
            let name = missing.name;
            // Every third chooses for itself.
            let photons = (i % 3 > 0).then_some(4096);
            let ((plan, few), (all, many)) = (
                pixels(&scene, false, photons),
                pixels(&scene, true, photons),
            );
            assert_eq!(plan, all, "{name}");
            assert!(many >= few, "{name}");
        }
    }
}

/// Lights and objects of which some pairs are in vain: those that are not get
/// the same photons, and the others some in vain.
#[test]
fn pairs_in_vain_are_traced_on_demand() {
    let scene = scene_of(
        "eye: (0, -6, 3), look_at: (0, 0, 0.5), fov: 40",
        [20, 15],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
         (shape: Sphere(center: (-1, 0, 1), radius: 0.5), material: \"glass\"),
         (shape: Sphere(center: (1, 0, 1), radius: 0.5), material: \"mirror\"),
         (shape: Sphere(center: (0, 1, -2), radius: 0.5), material: \"glass\")",
        "Spot(position: (-1, 0, 4), look_at: (-1, 0, 0), inner: 0, outer: 8, power: 10),
         Sphere(center: (0, 0, 5), radius: 0.2, power: 10),
         Disc(center: (0, 0, 0.5), radius: 0.1, normal: (1, 0, 0.1), power: 5)",
        "",
    );
    let ((plan, few), (all, many)) = (pixels(&scene, false, None), pixels(&scene, true, None));
    assert_eq!(plan, all);
    assert_eq!(few, many, "photons in vain count as theirs, not as more");
    let settings = scene::Settings {
        effects: Choices::all_on(),
        ..scene.settings.clone()
    };
    let renderer = Renderer::new(&scene, &settings, [20, 15], [0, 0, 20, 15]);
    let traced: u64 = renderer.pass(0).tally.lights.iter().map(|l| l.paths).sum();
    assert!(traced > renderer.photons(), "{traced} paths traced");
}

//! The scenes that ship: each loads, says what to look for, and keeps the
//! number that its header gives as known.

mod focus;
mod ways;

use std::{
    fs,
    path::{Path, PathBuf},
};

use nephroid::{
    geometry::{Ray, SurfacePoint},
    render::{self, Job},
    scene::{self, Scene, Summary},
    transport::{Carried, Lobe, Lobes, lobes},
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

fn load(name: &str) -> Scene {
    let path = folder().join(name);
    scene::load(&path).unwrap_or_else(|mistakes| panic!("{}", mistakes.render(false)))
}

fn scene_files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_scene_loads_and_has_a_header() {
    let files = scene_files();
    assert!(files.len() >= 17, "only {} scenes", files.len());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let header: Vec<&str> = text.lines().take_while(|l| l.starts_with("//")).collect();
        for word in ["// Look for: ", "// Known: "] {
            let found = header.iter().any(|line| line.starts_with(word));
            assert!(found, "{}: no line with {word:?}", file.display());
        }
        if let Err(mistakes) = scene::load(&file) {
            panic!("{}", mistakes.render(false));
        }
    }
}

/// The next surface along a ray: the object's name, the point, and how light
/// goes on there.
fn step(scene: &Scene, ray: &Ray) -> Option<(String, SurfacePoint, Option<Lobes>)> {
    let hit = scene.world.closest(ray, f64::INFINITY)?;
    let point = scene.world.surface(ray, &hit);
    let object = scene.object(hit.surface);
    let lobes = lobes(&object.material, &point, ray.dir, Carried::Flux);
    Some((object.name.clone(), point, lobes))
}

/// Of two ways the refracted one; the only one of a mirror.
fn onward(lobes: Lobes) -> Lobe {
    match lobes {
        Lobes::One(lobe) | Lobes::Two(_, lobe) => lobe,
    }
}

/// The ray that leaves after `steps` specular steps.
fn after(scene: &Scene, mut ray: Ray, steps: usize) -> Ray {
    for i in 0..steps {
        let (name, point, lobes) =
            step(scene, &ray).unwrap_or_else(|| panic!("nothing met at step {i}"));
        let lobes = lobes.unwrap_or_else(|| panic!("{name} is not specular"));
        ray = point.spawn(onward(lobes).dir);
    }
    ray
}

#[test]
fn lamps_and_meshes_are_as_the_headers_say() {
    for (file, powers, within) in [
        ("glass_sphere.ron", [790.0, 711.0, 632.0], 0.5),
        ("cornell_glass.ron", [15.8, 13.6, 11.3], 0.05),
        ("glasses.ron", [284.0, 245.0, 197.0], 0.6),
    ] {
        let power = load(file).lights[0].light.power().unwrap();
        for (c, known) in powers.into_iter().enumerate() {
            assert!(
                (power[c] - known).abs() < within,
                "{file}: {} W instead of {known}",
                power[c]
            );
        }
    }
    for file in ["pool.ron", "mesh_glass.ron"] {
        assert_eq!(Summary::of(&load(file)).triangles, 131_072, "{file}");
    }
}

/// One small pass, with so many threads.
fn small_pass(scene: &Scene, threads: usize) -> render::PassOutput {
    let mut job = Job::of(scene);
    job.settings.photons = Some(6000);
    let window = [0, 0, 24, 18];
    let renderer = render::Renderer::new(scene, &job.settings, [24, 18], window);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(|| renderer.pass(9))
}

/// In every scene each light's watts are accounted for, the same ones by any
/// number of threads, and so is each pixel.
#[test]
fn every_scene_balances_and_ignores_threads() {
    for file in scene_files() {
        let name = file.display();
        let scene = load(file.file_name().unwrap().to_str().unwrap());
        let one = small_pass(&scene, 1);
        for light in &one.tally.lights {
            let off = light.imbalance().abs();
            assert!(off <= 1e-9 * light.launched, "{name}: {off} of {light:?}");
        }
        let five = small_pass(&scene, 5);
        assert_eq!(one.tally, five.tally, "{name}: watts");
        assert!(one.samples == five.samples, "{name}: pixels");
    }
}

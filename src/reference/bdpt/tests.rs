//! Densities against the geometry of the path, and every strategy by itself.

use std::{collections::HashMap, f64::consts::PI, path::Path};

use glam::{DVec2, DVec3};

use super::{
    join::Join,
    subpath::{Vertex, What, from_camera, from_light},
    weight::{possible, weight},
};
use crate::{
    light::Light,
    reference::{
        Method,
        setup::Setup,
        sources::{Seat, Sources},
    },
    sampling::Stream,
    scene::{Scene, load_str},
};

const SIZE: u32 = 8;

fn scene(objects: &str, lights: &str) -> Scene {
    let text = format!(
        "(camera: (eye: (0, -2.9, 1.4), look_at: (0, 0, 0.9), fov: 50),
          image: (width: {SIZE}, height: {SIZE}),
          materials: {{
            \"grey\": Diffuse(reflectance: 0.6),
            \"mirror\": Mirror(reflectance: 0.9),
            \"glass\": Dielectric(ior: 1.5),
          }},
          objects: [
            (shape: Quad(center: (0, 0, 0), size: (6, 6), normal: (0, 0, 1)), material: \"grey\"),
            (shape: Quad(center: (0, 1.5, 1.5), size: (6, 6), normal: (0, -1, 0)), material: \"grey\"),
            {objects}
          ], lights: [{lights}])"
    );
    load_str(&text, "test.ron", Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

fn setup(scene: &Scene) -> Setup<'_> {
    let window = [0, 0, SIZE, SIZE];
    Setup::new(scene, &scene.settings, Method::Bdpt, [SIZE; 2], window, 1)
}

/// Numbers of the two ends of sample `i`, independent of all others.
fn streams(setup: &Setup<'_>, i: u64) -> [Stream; 2] {
    [2 * i, 2 * i + 1].map(|item| setup.sequence(0, item).at(0))
}

/// Index ahead over index behind where a path turns at glass, by Snell's law;
/// `None` at a mirror.
fn index_ratio(before: DVec3, at: &Vertex, after: DVec3) -> Option<f64> {
    let (i, o) = ((at.p - before).normalize(), (after - at.p).normalize());
    (i.dot(at.ng) * o.dot(at.ng) > 0.0).then(|| i.cross(at.ng).length() / o.cross(at.ng).length())
}

/// Density per area at place `i` of a path that comes from place `i - 1`, from
/// positions and normals alone.
fn density(setup: &Setup<'_>, sources: &Sources<'_>, path: &[Vertex], i: usize) -> f64 {
    let (from, to) = (&path[i - 1], &path[i]);
    let d = to.p - from.p;
    let r2 = d.length_squared();
    let w = d / r2.sqrt();
    let area = if to.ng == DVec3::ZERO {
        1.0
    } else {
        w.dot(to.ng).abs() / r2
    };
    let directions = match from.what {
        What::Eye => {
            let cos = w.dot(setup.camera.forward());
            let pixel = setup.camera.pixel_footprint().spread;
            1.0 / (pixel * pixel * cos * cos * cos)
        }
        What::Diffuse(_) => w.dot(from.ng).abs() / PI,
        What::Bent => match index_ratio(path[i - 2].p, from, to.p) {
            Some(eta) => eta * w.dot(from.ng).abs(),
            None => 1.0,
        },
        What::Source { light, .. } => match sources.light(light) {
            Light::Point(_) => 1.0 / (4.0 * PI),
            _ => w.dot(from.ng).max(0.0) / PI,
        },
        What::Sky(_) => unreachable!("no path goes on from the sky"),
    };
    directions * area
}

/// The densities of every place are those of the geometry, whichever strategy
/// made the path: then the weights of its strategies are those of one set of
/// numbers, and sum to one.
#[test]
fn weights_of_all_strategies_sum_to_one() {
    let scene = scene(
        "(shape: Sphere(center: (-0.6, 0.2, 0.6), radius: 0.5), material: \"glass\"),
         (shape: Sphere(center: (0.7, 0.3, 0.5), radius: 0.45), material: \"mirror\"),",
        "Quad(corner: (-0.7, -0.7, 2.8), u: (0, 1.4, 0), v: (1.4, 0, 0), radiance: 5),
         Sphere(center: (1.5, -0.5, 1.5), radius: 0.3, radiance: 3),
         Point(position: (-1.2, -1, 2), power: 9)",
    );
    let setup = setup(&scene);
    let sources = setup.sources();
    let mut seen: HashMap<(bool, bool), u32> = HashMap::new();
    for i in 0..6000 {
        let [mut camera, mut light] = streams(&setup, i);
        let film = DVec2::from_array(camera.next_2d()) * f64::from(SIZE);
        let eye = from_camera(&setup, film, &mut camera);
        let lamp = from_light(&setup, &mut light);
        let join = Join::new(&setup, film, 64, &eye, &lamp);
        join.all(&mut camera, &mut |joined| {
            let n = joined.places.len();
            let all: f64 = (1..=n)
                .filter(|&t| possible(&joined.places, &joined.ends, t))
                .map(|t| weight(&joined.places, &joined.ends, t))
                .sum();
            assert!((all - 1.0).abs() < 1e-9, "{all} of {n} places");
            let s = n - joined.t;
            if s == 1 {
                // Where the light was sampled is not kept.
                return;
            }
            let path: Vec<Vertex> = eye[..joined.t]
                .iter()
                .chain(lamp[..s].iter().rev())
                .copied()
                .collect();
            let back: Vec<Vertex> = path.iter().rev().copied().collect();
            let bent = path.iter().any(|v| matches!(v.what, What::Bent));
            *seen.entry((s == 0, bent)).or_default() += 1;
            for k in 1..n {
                let place = &joined.places[k];
                // A light that can't be hit has no density from the eye.
                if k < n - 1 || joined.ends.hittable {
                    let expected = density(&setup, &sources, &path, k);
                    let off = place.camera / expected - 1.0;
                    assert!(
                        off.abs() < 1e-6,
                        "place {k} of {n}, s {s}, from the eye: {off:e}"
                    );
                }
                if k < n - 1 {
                    let expected = density(&setup, &sources, &back, n - 1 - k);
                    let off = place.light / expected - 1.0;
                    assert!(
                        off.abs() < 1e-6,
                        "place {k} of {n}, s {s}, from the light: {off:e}"
                    );
                }
            }
        });
    }
    for case in [(true, true), (true, false), (false, true), (false, false)] {
        assert!(seen.get(&case).is_some_and(|&n| n > 50), "{seen:?}");
    }
}

/// A seat of a sphere sampled from a point, against the cone's solid angle.
#[test]
fn direct_densities_are_per_area() {
    let scene = scene("", "Sphere(center: (0, 0, 2), radius: 0.5, radiance: 3)");
    let setup = setup(&scene);
    let sources = setup.sources();
    let p = DVec3::new(0.3, 0.2, 0.1);
    for u in [[0.1, 0.2], [0.5, 0.5], [0.7, 0.9]] {
        let c = sources.connect(p, 0.5, u).expect("in sight");
        let Seat::At { p: q, ng: Some(ng) } = c.seat else {
            panic!("{c:?}");
        };
        // weight = radiance / density per solid angle.
        let per_angle = 3.0 / c.weight[0];
        let to = p - q;
        let expected = per_angle * to.normalize().dot(ng) / to.length_squared();
        let found = sources.direct(0, &c.seat, p);
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}

/// Blocks of samples whose spread is the error.
const BLOCKS: usize = 20;

/// Veach's own check (1997, section 10.3.1): every strategy that can make all
/// paths of some length finds the same light by itself.
#[test]
fn every_strategy_alone_finds_the_same_light() {
    let scene = scene(
        "(shape: Quad(center: (-1.5, 0, 1.5), size: (6, 6), normal: (1, 0, 0)), material: \"grey\"),",
        "Quad(corner: (-0.9, -0.9, 2.6), u: (0, 1.8, 0), v: (1.8, 0, 0), radiance: 5)",
    );
    let setup = setup(&scene);
    let mut sums: HashMap<(usize, usize), [f64; BLOCKS]> = HashMap::new();
    let samples = 48_000;
    for i in 0..samples {
        let [mut camera, mut light] = streams(&setup, i);
        let film = DVec2::from_array(camera.next_2d()) * f64::from(SIZE);
        let eye = from_camera(&setup, film, &mut camera);
        let lamp = from_light(&setup, &mut light);
        let paths = u64::from(SIZE * SIZE);
        let join = Join::new(&setup, film, paths, &eye, &lamp);
        join.all(&mut camera, &mut |joined| {
            let c = joined.contribution;
            let inside = c.film.min_element() >= 0.0 && c.film.max_element() < f64::from(SIZE);
            if inside {
                let key = (joined.places.len(), joined.t);
                let sum = sums.entry(key).or_insert([0.0; BLOCKS]);
                sum[i as usize % BLOCKS] += c.value[1];
            }
        });
    }
    let per_block = samples as f64 / BLOCKS as f64;
    let estimate = |n, t| {
        let blocks = sums
            .get(&(n, t))
            .map_or([0.0; BLOCKS], |s| s.map(|v| v / per_block));
        let mean = blocks.iter().sum::<f64>() / BLOCKS as f64;
        let squares: f64 = blocks.iter().map(|b| (b - mean) * (b - mean)).sum();
        let error = (squares / (BLOCKS * (BLOCKS - 1)) as f64).sqrt();
        (mean, error)
    };
    for n in 3..=5 {
        // A light sampled for the last place of the eye's path serves best.
        let (truth, error) = estimate(n, n - 1);
        assert!(error < 0.02 * truth, "{n} places: {truth} +- {error}");
        for t in 1..=n {
            let (mean, own) = estimate(n, t);
            let off = (mean - truth) / (error * error + own * own).sqrt();
            // Student's t with 38 degrees of freedom: 5 in 1e5 tests.
            assert!(
                off.abs() < 5.0,
                "{n} places, t = {t}: {mean} +- {own}, expected {truth}"
            );
            assert!(
                own < 0.15 * truth,
                "{n} places, t = {t}: {mean} +- {own} proves little"
            );
        }
    }
}

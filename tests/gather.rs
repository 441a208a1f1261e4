//! Gathering beside a thin wall: nothing leaks through it, nothing is lost
//! along it.

use std::path::Path;

use glam::DVec3;
use nephroid::{
    geometry::Ray,
    photon::{Footprint, Kernels, Photon, PhotonMap, Vicinity, gather},
    plan::Media,
    render::Renderer,
    sampling::{Purpose, Sequence},
    scene::{Scene, load_str},
    spectrum::Rgb,
    transport::DiffusePoint,
};

const KERNELS: Kernels = Kernels {
    least: 0.0,
    most: 0.2,
    most_bounced: 0.2,
    blind: 0.1,
    caustics: true,
    spacing: 0.0,
};
const PATHS: u64 = 1 << 17;

/// A floor, and on it a wall along the y axis unless there is none.
fn scene(wall: &str) -> Scene {
    let text = format!(
        "(camera: (eye: (0, -3, 3), look_at: (0, 0, 0), fov: 40), image: (width: 8, height: 8),
          objects: [
            (shape: Quad(corner: (-2, -2, 0), u: (4, 0, 0), v: (0, 4, 0)), material: Diffuse(reflectance: 0.5)),
            {wall}
          ],
          lights: [Point(position: (1, 0, 2), power: 1)])"
    );
    load_str(&text, "gather.ron", Path::new("")).expect("a sound scene")
}

/// One watt a square metre on the floor, on the side of positive x only, by
/// round and by long kernels.
fn half_lit() -> PhotonMap {
    let sequence = Sequence::new(11, Purpose::Pilot, 0, 0);
    let photons: Vec<Photon> = (0..PATHS)
        .map(|i| {
            let mut s = sequence.at(i);
            let [x, y] = s.next_2d();
            let kind = (5.0 * s.next_1d()) as usize;
            Photon {
                // Off the wall by more than the rounding of stored places.
                position: DVec3::new(x.max(1e-6), 2.0 * y - 1.0, 0.0),
                normal: DVec3::Z,
                flux: Rgb::grey(2.0),
                footprint: [None, Some(0.0), Some(0.8), Some(1.6), Some(2.4)][kind].map(long),
                // A whole block of the sequence: as even as all of it.
                bounced: i < PATHS / 4,
                sheet: 0.0,
            }
        })
        .collect();
    PhotonMap::new(&photons, PATHS, 1.0)
}

/// A kernel four times longer than wide.
fn long(angle: f64) -> Footprint {
    let (sin, cos) = angle.sin_cos();
    Footprint {
        major: DVec3::new(cos, sin, 0.0) * 0.16,
        minor: 0.04,
        fold: f64::INFINITY,
    }
}

/// Mean irradiance gathered along a line beside the wall: straight from the
/// light, and bounced.
fn beside(scene: &Scene, x: f64) -> [f64; 2] {
    let renderer = Renderer::new(scene, &scene.settings, [8, 8], [0, 0, 8, 8]);
    let ctx = renderer.context();
    let map = half_lit();
    let mut sums = [0.0; 2];
    let count = 200;
    for i in 0..count {
        let u = (f64::from(i) + 0.5) / f64::from(count);
        let ray = Ray::new(DVec3::new(x, u - 0.5, 1.0), DVec3::NEG_Z);
        let hit = scene.world.closest(&ray, f64::INFINITY).expect("the floor");
        let point = scene.world.surface(&ray, &hit);
        let at = DiffusePoint::new(point, ray.dir, Rgb::WHITE, Media::NONE);
        let found = gather(
            &ctx,
            &mut Vicinity::new(&map),
            &at,
            &KERNELS,
            (u * 97.0).fract(),
        );
        sums[0] += found.irradiance[0] / f64::from(count);
        sums[1] += found.bounced[0] / f64::from(count);
    }
    sums
}

#[test]
fn a_wall_neither_leaks_nor_darkens() {
    let wall = "(shape: Quad(corner: (0, -2, -0.1), u: (0, 4, 0), v: (0, 0, 1)), material: Diffuse(reflectance: 0)),";
    let (walled, open) = (scene(wall), scene(""));
    for x in [0.003, 0.02, 0.05, 0.09] {
        // Thirty-two directions know the lost share to a few per cent.
        let [straight, bounced] = beside(&walled, x);
        assert!(
            (straight - 0.75).abs() < 0.75 * 0.04,
            "{straight} of 0.75 W/m2 at {x}"
        );
        assert!(
            (bounced - 0.25).abs() < 0.25 * 0.04,
            "{bounced} of 0.25 W/m2 at {x}"
        );
        assert_eq!(beside(&walled, -x), [0.0; 2], "behind the wall at {x}");
    }
    // Without the wall the kernel blurs the border, as it must.
    let ([inside, _], [outside, _]) = (beside(&open, 0.02), beside(&open, -0.02));
    assert!(inside < 0.6 && outside > 0.15, "{inside} {outside}");
    assert!((inside + outside - 0.75).abs() < 0.01, "the kernel is even");
}

#[test]
fn what_lets_light_through_straight_is_no_wall() {
    for material in ["Dielectric(ior: 1)", "Dielectric(ior: 1.5, thin: true)"] {
        let pane = format!(
            "(shape: Quad(corner: (0, -2, -0.1), u: (0, 4, 0), v: (0, 0, 1)), material: {material}, open: true),"
        );
        assert_eq!(
            beside(&scene(&pane), -0.02),
            beside(&scene(""), -0.02),
            "{material}"
        );
    }
}

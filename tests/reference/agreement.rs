//! All methods show the same, where each owns the paths.

use nephroid::{
    film::PixelSample,
    reference::{Method, Options, Reference},
};

use super::{
    BDPT, LIGHT, METROPOLIS, PATH, PHOTON_MAP, Photons, RADIOSITY, ROOM, SPPM, VIEW, common,
    common::scene_of,
    job,
    judgement::{assert_agree, assert_part_agrees},
};

/// A room of diffuse walls: all methods own all its paths.
#[test]
fn diffuse_room() {
    let scene = scene_of(
        VIEW,
        [24, 24],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.3, 0.2, 0.4), radius: 0.4), material: \"grey\"),"
        ),
        "Quad(corner: (-0.4, -0.4, 1.9), u: (0, 0.8, 0), v: (0.8, 0, 0), radiance: 6)",
        "",
    );
    let all = [
        (BDPT, 12),
        (PATH, 6),
        (METROPOLIS, 6),
        (Photons, 3),
        (PHOTON_MAP, 3),
        (SPPM, 3),
        (RADIOSITY, 3),
    ];
    assert_agree(&scene, &all, 0.05, "room");
    // What light tracing sees is everything but the lamp, at the top.
    let below = Some([0, 6, 24, 18]);
    let all = [(PATH, 3), (LIGHT, 3), (BDPT, 3)];
    assert_part_agrees(&scene, &all, 0.02, below, "room below the lamp");
}

/// Every kind of light: what leaves it for the floor and the ball is what they
/// receive.
#[test]
fn every_light() {
    for light in [
        "Point(position: (0.4, -0.5, 2), power: 30)",
        "Spot(position: (0.4, -0.5, 2), look_at: (0, 0, 0), inner: 20, outer: 40, power: 30)",
        "Directional(direction: (-0.2, 0.2, -1), irradiance: 9, beam: (center: (0.4, -0.5, 2), radius: 0.6))",
        "Directional(direction: (-0.2, 0.2, -1), irradiance: 9, angular_diameter: 0)",
        "Directional(direction: (-0.2, 0.2, -1), irradiance: 9, angular_diameter: 30)",
        "Sphere(center: (0.4, -0.5, 2), radius: 0.4, radiance: 9)",
        "Disc(center: (0.4, -0.5, 2), normal: (0, 0, -1), radius: 0.5, radiance: 9)",
        "Quad(corner: (0, -0.7, 2), u: (0, 0.8, 0), v: (0.8, 0, 0), radiance: 9)",
    ] {
        let scene = scene_of(
            "eye: (0, -2, 1.6), look_at: (0, 0, 0.1), fov: 35",
            [16, 16],
            "(shape: Quad(center: (0, 0, 0), size: (6, 6), normal: (0, 0, 1)), material: \"grey\"),
             (shape: Sphere(center: (0, 0, 0.4), radius: 0.3), material: \"white\"),",
            light,
            "",
        );
        let all = [
            (PATH, 4),
            (LIGHT, 3),
            (BDPT, 4),
            (METROPOLIS, 8),
            (PHOTON_MAP, 2),
            (SPPM, 3),
            (RADIOSITY, 3),
        ];
        assert_agree(&scene, &all, 0.06, light);
    }
}

/// Panes and index-matched balls are crossed in straight lines, by all
/// methods; a wide filter weighs what is splatted as what is gathered; a crop
/// is a part of the picture.
#[test]
fn straight_lines_filters_and_crops() {
    let text = "(camera: (eye: (0, -2, 1.2), look_at: (0, 0, 0.3), fov: 40),
        image: (width: 16, height: 16, filter: Gaussian),
        materials: {\"grey\": Diffuse(reflectance: 0.5)},
        objects: [
            (shape: Quad(center: (0, 0, 0), size: (4, 4), normal: (0, 0, 1)), material: \"grey\"),
            (shape: Sphere(center: (0.3, 0, 0.3), radius: 0.3), material: Dielectric(ior: 1)),
            (shape: Quad(center: (0, -0.8, 0.6), size: (3, 3), normal: (0, 1, 0)), material: Dielectric(ior: 1.5, thin: true)),
            (shape: Sphere(center: (-0.3, 0.2, 0.25), radius: 0.25), material: \"grey\"),
        ],
        lights: [Disc(center: (0.5, 0, 2), normal: (0, 0, -1), radius: 0.4, radiance: 9)])";
    let scene = common::scene(text);
    let all = [
        (METROPOLIS, 8),
        (PATH, 12),
        (BDPT, 6),
        (Photons, 1),
        (PHOTON_MAP, 3),
        (SPPM, 3),
    ];
    assert_agree(&scene, &all, 0.045, "panes");
    let all = [
        (METROPOLIS, 8),
        (PATH, 12),
        (BDPT, 6),
        (Photons, 1),
        (PHOTON_MAP, 3),
        (SPPM, 3),
    ];
    let crop = Some([3, 2, 8, 8]);
    assert_part_agrees(&scene, &all, 0.13, crop, "a part of the panes");
}

/// The same bytes for any number of threads.
#[test]
fn threads_change_nothing() {
    let scene = scene_of(
        VIEW,
        [20, 12],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"glass\"),"
        ),
        "Quad(corner: (-0.4, -0.4, 1.9), u: (0, 0.8, 0), v: (0.8, 0, 0), radiance: 6)",
        "",
    );
    for method in Method::ALL {
        let job = job(&scene, 2);
        let reference = Reference::new(&scene, &job, method, Options::default()).expect("fits");
        // The second pass of a replicate: also what is kept in between.
        let pass = |threads| -> Vec<PixelSample> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pass = pool.expect("threads").install(|| reference.passes().nth(9));
            pass.expect("passes have no end")
        };
        let one = pass(1);
        assert!(one.iter().any(|p| !p.total().is_black()) || method == Method::LightNaive);
        assert_eq!(one, pass(3), "{method:?}");
    }
}

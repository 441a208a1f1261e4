//! Scenes whose picture is a formula.

use std::{f64::consts::PI, num::NonZero};

use nephroid::{
    film::Layer,
    reference::{Method, Options, Pinhole, Reference},
    render::REPLICATES,
};

use super::{
    BDPT, By, LIGHT, METROPOLIS, PATH, RADIOSITY, ROOM, SPPM, VIEW, by_method,
    common::{Estimate, scene_of},
    film_of, job, whole,
};

/// An integrating sphere: the wall is equally bright everywhere,
/// E = P / (4 pi R^2 (1 - a)), and every method that sees light between
/// diffuse surfaces must find it; with elements of any size, since their light
/// is constant.
#[test]
fn furnace() {
    let albedo = 0.7;
    let scene = scene_of(
        "eye: (0.3, 0.1, -0.2), look_at: (1, 0.4, 0.3), fov: 80",
        [16, 16],
        &format!(
            "(shape: Sphere(center: (0, 0, 0), radius: 2), material: Diffuse(reflectance: {albedo}))"
        ),
        "Point(position: (0, 0, 0), power: 20)",
        "max_depth: 200",
    );
    let direct = 20.0 / (4.0 * PI * 4.0) * albedo / PI;
    let exact = direct / (1.0 - albedo);
    for (by, rounds, precision) in [
        (PATH, 4, 0.01),
        (BDPT, 4, 0.01),
        (METROPOLIS, 8, 0.03),
        (LIGHT, 4, 0.02),
        (SPPM, 4, 0.02),
        (RADIOSITY, 4, 0.02),
    ] {
        whole(&film_of(&scene, by, rounds)).assert_is(exact, precision, &format!("{by:?}"));
    }
    // Whitted's light does not bounce.
    let whitted = film_of(&scene, By::Method(Method::Whitted), 1).image();
    assert!(
        whitted
            .pixels()
            .iter()
            .all(|p| (p[1] / direct - 1.0).abs() < 1e-12)
    );
    // The hole may be wide, for the wall looks the same from everywhere.
    let pinhole = Pinhole {
        radius: 0.4,
        depth: 1.0,
    };
    let rounds = 24;
    let job = job(&scene, rounds);
    let naive = Reference::new(&scene, &job, Method::LightNaive, Options::default())
        .expect("fits")
        .with_pinhole(pinhole);
    let mut sums = [0.0; REPLICATES as usize];
    for (pass, samples) in naive
        .passes()
        .take((rounds * REPLICATES) as usize)
        .enumerate()
    {
        sums[pass % sums.len()] += samples.iter().map(|p| p.total()[1]).sum::<f64>();
    }
    let means = sums.map(|sum| sum / (256.0 * f64::from(rounds)));
    Estimate::of(&means).assert_is(exact, 0.06, "through a pinhole");
}

/// A closed box that is lit by a point in its middle is no furnace: its faces
/// are darkest at the corners. But all light ends on it, so the mean of its
/// irradiance over all faces is P / (A (1 - a)), and a camera that looks at
/// each of the six equal faces from the middle finds the same.
#[test]
fn a_closed_box_keeps_its_light() {
    let albedo = 0.5;
    let scene = scene_of(
        "eye: (0, 0, 0), look_at: (1, 0, 0), fov: 90",
        [16, 16],
        &format!(
            "(shape: Box(min: (-1, -1, -1), max: (1, 1, 1)), material: Diffuse(reflectance: {albedo}))"
        ),
        "Point(position: (0, 0, 0), power: 24)",
        "max_depth: 200",
    );
    // Pixels of this camera are of equal size on the face: their mean is that
    // of the radiance over the face.
    let exact = 24.0 / (24.0 * (1.0 - albedo)) * albedo / PI;
    for (by, rounds, precision) in [(PATH, 4, 0.01), (RADIOSITY, 4, 0.02), (SPPM, 4, 0.02)] {
        let found = whole(&film_of(&scene, by, rounds));
        found.assert_is(exact, precision, &format!("{by:?}"));
    }
}

/// An even caustic: a wide beam through a plate of glass, T = (1 - R) / (1 + R)
/// with R = 0.04. Where light is even, circles of any size find it, those that
/// end at the farthest of the nearest photons and those that have shrunk.
#[test]
fn an_even_caustic() {
    let scene = scene_of(
        "eye: (0, 0, 0.3), look_at: (0, 0, 0), up: (0, 1, 0), height: 0.8",
        [16, 16],
        "(shape: Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: 4), material: \"white\"),
         (shape: Quad(corner: (-2, -2, 0.5), u: (4, 0, 0), v: (0, 4, 0)), material: \"glass\", open: true),
         (shape: Quad(corner: (-2, 2, 0.4), u: (4, 0, 0), v: (0, -4, 0)), material: \"glass\", open: true)",
        "Directional(direction: (0, 0, -1), irradiance: 1, beam: (center: (0, 0, 2), radius: 1))",
        "photons: 1024, indirect: false",
    );
    let exact = 0.96 / 1.04 / PI;
    let sppm = by_method(&scene, &job(&scene, 16), Method::Sppm, Options::default());
    whole(&sppm).assert_is(exact, 0.01, "sppm");
    for nearest in [16, 64] {
        let options = Options {
            nearest: NonZero::new(nearest).expect("not zero"),
            ..Options::default()
        };
        let map = by_method(&scene, &job(&scene, 8), Method::PhotonMap, options);
        let found = whole(&map);
        // Photons of a low-discrepancy sequence lie more evenly than those for
        // which the estimate has no bias: it depends on half a photon.
        let ratio = found.mean / exact;
        assert!(
            (ratio - 1.0).abs() < 0.5 / f64::from(nearest),
            "{nearest} nearest: {ratio}"
        );
    }
}

/// One point light and nothing that divides light: Whitted's picture is the
/// direct layer of path tracing, pixel by pixel.
#[test]
fn whitted_is_the_direct_light_of_points() {
    let scene = scene_of(
        VIEW,
        [12, 12],
        &format!(
            "{ROOM} (shape: Sphere(center: (0.4, 0, 0.5), radius: 0.4), material: \"mirror\"),"
        ),
        "Point(position: (0.1, -0.3, 1.7), power: 30)",
        "",
    );
    let direct = |by| film_of(&scene, by, 1).layer_image(Layer::Direct);
    let (whitted, path) = (direct(By::Method(Method::Whitted)), direct(PATH));
    assert!(whitted.mean()[1] > 0.1);
    for (a, b) in whitted.pixels().iter().zip(path.pixels()) {
        assert!((a[1] - b[1]).abs() <= 1e-12 * b[1].abs(), "{a:?} {b:?}");
    }
}

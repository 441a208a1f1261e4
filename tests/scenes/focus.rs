//! Foci and cusps that the headers know.

use std::ops::ControlFlow;

use glam::DVec3;
use nephroid::{
    film::Layer,
    geometry::Ray,
    render::{self, Job},
    scene::Scene,
};

use crate::{after, load, step};

/// How far beyond `center` along the unit vector `axis` rays meet that ran
/// parallel to it, `height` from it, and came from `before` the centre.
fn focus(scene: &Scene, center: DVec3, axis: DVec3, before: f64, height: f64) -> f64 {
    let side = axis.any_orthonormal_vector();
    let start = center - axis * before + side * height;
    let out = after(scene, Ray::new(start, axis), 2);
    let t = -(out.origin - center).dot(side) / out.dir.dot(side);
    (out.origin + out.dir * t - center).dot(axis)
}

#[test]
fn ball_lenses_focus_at_their_focal_length() {
    let beam = DVec3::new(0.7453559925, 0.0, -0.6666666667).normalize();
    let down = DVec3::new(1.0, 0.3, -0.7).normalize();
    for (file, center, axis, known) in [
        ("ball_lens.ron", DVec3::new(0.0, 0.0, 0.40001), beam, 0.6),
        ("first.ron", DVec3::new(-0.75, 0.1, 0.42), down, 0.6),
        ("glass_sphere.ron", DVec3::new(0.0, 0.0, 1.2), down, 1.5),
    ] {
        let scene = load(file);
        let found = focus(&scene, center, axis, 1.5 * known, 1e-4);
        // The aberration at height h is of the order h^2.
        assert!(
            (found - known).abs() < 1e-6,
            "{file}: {found} instead of {known}"
        );
    }
    // The beam's focus lies on the table where the header says.
    let scene = load("ball_lens.ron");
    let f = focus(&scene, DVec3::new(0.0, 0.0, 0.40001), beam, 0.9, 1e-4);
    let on_table = DVec3::new(0.0, 0.0, 0.40001) + beam * f;
    assert!(on_table.z.abs() < 2e-5 && (on_table.x - 0.2f64.sqrt()).abs() < 1e-5);
}

/// From focus to focus, by ways of one length.
#[test]
fn the_ellipsoid_of_the_lamp_has_another_focus() {
    let scene = load("ellipsoids.ron");
    let [from, to] = [-0.6, 0.6].map(|x| DVec3::new(x, 0.0, 0.9));
    for (y, z) in [(0.1, 0.0), (1.7, -0.3), (-1.5, 1.9)] {
        let dir = DVec3::new(-1.0, y, z).normalize();
        // Outside of the lamp, whose body is no mirror.
        let out = after(&scene, Ray::new(from + dir * 0.04, dir), 1);
        let past = (to - out.origin).dot(out.dir);
        assert!((out.origin + out.dir * past - to).length() < 1e-14);
        let way = from.distance(out.origin) + past;
        assert!((way - 2.0).abs() < 1e-14, "{way}");
    }
}

#[test]
fn the_searchlight_and_its_cone_are_as_the_header_says() {
    let scene = load("conics.ron");
    // Every ray from the focus leaves the mirror along the axis.
    let focus = DVec3::new(-1.0, 0.0, 0.75);
    for (y, z) in [(0.1, 0.0), (0.7, -0.3), (-1.5, 1.0)] {
        let ray = Ray::new(focus, DVec3::new(-1.0, y, z).normalize());
        let out = after(&scene, ray, 1);
        assert!((out.dir - DVec3::X).length() < 1e-14, "{}", out.dir);
    }
    // Not through the tip, where the cone has no normal.
    let ray = Ray::new(DVec3::new(0.0, 0.12, 0.9), DVec3::X);
    let out = after(&scene, ray, 2);
    let turned = out.dir.x.acos().to_degrees();
    let a = (0.05f64 / 0.15).atan();
    let known = (1.5 * a.sin()).asin() - a;
    assert!(
        (known.to_degrees() - 9.88).abs() < 0.005,
        "{}",
        known.to_degrees()
    );
    assert!((turned - known.to_degrees()).abs() < 1e-9, "{turned}");
}

#[test]
fn the_glass_ring_focuses_on_the_table() {
    let scene = load("torus.ron");
    let center = DVec3::new(-0.25, 0.0, 0.18);
    for degrees in [0.0f64, 77.0, 200.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let side = DVec3::new(cos, sin, 0.0);
        let start = center + side * (0.4 + 1e-4) + DVec3::Z;
        let out = after(&scene, Ray::new(start, DVec3::NEG_Z), 2);
        let t = (0.4 - (out.origin - center).dot(side)) / out.dir.dot(side);
        let height = (out.origin + out.dir * t).z;
        assert!(height.abs() < 1e-6, "{height}");
    }
}

#[test]
fn the_burning_glass_focuses_on_the_table() {
    let scene = load("solids.ron");
    let power: f64 = 0.5 * (4.0 - 0.05 / (1.5 * 0.25));
    let known = (1.0 - 0.05 / (1.5 * 0.5)) / power;
    assert!((1.0 / power - 0.5172).abs() < 5e-5 && (known - 0.4828).abs() < 5e-5);
    let center = DVec3::new(-0.3, 0.0, 0.5327586207);
    let found = focus(&scene, center, DVec3::NEG_Z, 1.0, 1e-4);
    assert!((found - 0.05 - known).abs() < 1e-6, "{found}");
    assert!((center.z - found).abs() < 1e-6, "on the table");
}

/// The brightest caustic of a small render lies at the focus.
#[test]
fn the_ball_lens_picture_is_brightest_at_the_focus() {
    let scene = load("ball_lens.ron");
    let mut job = Job::of(&scene);
    job.resolution = [90, 68];
    job.settings.passes = 8;
    job.settings.photons = Some(1 << 15);
    let outcome = render::run(&scene, &job, &mut |_| ControlFlow::Continue(()));
    let image = outcome.film.layer_image(Layer::Caustic);
    let brightest = (0..image.pixels().len())
        .max_by(|&a, &b| {
            let mean = |i: usize| image.pixels()[i].mean();
            mean(a).total_cmp(&mean(b))
        })
        .unwrap();
    let film = glam::DVec2::new((brightest % 90) as f64 + 0.5, (brightest / 90) as f64 + 0.5);
    let ray = scene.camera.with_resolution(job.resolution).ray(film);
    let (name, point, _) = step(&scene, &ray).unwrap();
    assert_eq!(name, "table");
    let away = point.p.distance(DVec3::new(0.2f64.sqrt(), 0.0, 0.0));
    // Pixels are 1.9 cm wide there.
    assert!(away < 0.05, "brightest at {}, {away} m away", point.p);
}

#[test]
fn mirror_rings_have_their_cusp_half_way() {
    for (file, center, radius) in [
        ("cup.ron", DVec3::new(0.0, 0.0, 0.1), 0.5),
        ("first.ron", DVec3::new(0.65, -0.1, 0.1), 0.45),
    ] {
        let scene = load(file);
        let ray = Ray::new(center + DVec3::new(0.0, 1e-4, 0.0), DVec3::X);
        let out = after(&scene, ray, 1);
        let t = (center.y - out.origin.y) / out.dir.y;
        let cusp = (out.origin + out.dir * t - center).x;
        assert!(
            (cusp - 0.5 * radius).abs() < 1e-6,
            "{file}: cusp at {cusp} of {radius}"
        );
    }
}

#[test]
fn plano_convex_lenses_focus_on_the_axis() {
    let scene = load("plano_convex_lens.ron");
    for center in [
        DVec3::new(-0.6, 0.0, 0.438),
        DVec3::new(0.0, 0.0, 0.876),
        DVec3::new(0.6, 0.0, 1.314),
    ] {
        // t / n less than the focal length, in the mesh's own numbers.
        let thickness = 0.5 * (0.9 + 0.02 - (0.9f64 * 0.9 - 0.09).sqrt());
        let known = 0.9 - thickness / 1.5;
        assert!((known - 0.876).abs() < 5e-4 && (thickness - 0.0357).abs() < 5e-5);
        let near = focus(&scene, center, DVec3::NEG_Z, 0.9, 1e-3);
        // The mesh has single precision: 3e-8 of error in a normal, seen from
        // a height of 1e-3, moves the focus by 3e-5 of the focal length.
        assert!((near - known).abs() < 1e-4, "{near} instead of {known}");
        let rim = focus(&scene, center, DVec3::NEG_Z, 0.9, 0.149);
        assert!(
            (known - rim - 0.03).abs() < 0.005,
            "aberration {}",
            known - rim
        );
    }
}

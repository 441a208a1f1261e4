//! Direct light in closed form, for every kind of light.
//!
//! The camera looks at a patch of a micrometre, so that a pixel is a point:
//! over it the irradiance changes by less than 1e-6.

mod common;

use std::f64::consts::PI;

use common::{Estimate, assert_close, greens, render, scene_of};
use glam::DVec3;
use nephroid::film::Layer;

/// Looks straight down at the origin of a grey floor.
const AT_ORIGIN: &str = "eye: (0, 0, 0.001), look_at: (0, 0, 0), up: (0, 1, 0), height: 1e-6";
const FLOOR: &str = "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),";
/// Reflected radiance over irradiance.
const GREY: f64 = 0.5 / PI;

/// Irradiance at the origin by 64 pixels, each with a sample sequence of its
/// own, and 256 passes.
fn irradiance(objects: &str, lights: &str) -> Estimate {
    let scene = scene_of(
        AT_ORIGIN,
        [8, 8],
        &format!("{FLOOR}{objects}"),
        lights,
        "passes: 256, indirect: false",
    );
    let image = render(&scene).film.layer_image(Layer::Direct);
    Estimate::of(&greens(&image).map(|v| v / GREY).collect::<Vec<_>>())
}

/// The same where nothing is left to chance.
fn exact_irradiance(objects: &str, lights: &str) -> f64 {
    let estimate = irradiance(objects, lights);
    assert!(estimate.error <= 1e-5 * estimate.mean, "{estimate:?}");
    estimate.mean
}

#[test]
fn point_light() {
    for (x, z) in [(0.0, 2.0), (1.5, 0.7), (-3.0, 0.01)] {
        let d2: f64 = x * x + z * z;
        let expected = 3.0 * (z / d2.sqrt()) / d2;
        let light = format!("Point(position: ({x}, 0, {z}), intensity: (1, 3, 2))");
        assert_close(exact_irradiance("", &light), expected, 1e-4, "intensity");
        let power = 12.0 * PI;
        let light = format!("Point(position: ({x}, 0, {z}), power: {power})");
        assert_close(exact_irradiance("", &light), expected, 1e-4, "power");
    }
    // Well above the floor a micrometre changes nothing.
    let light = "Point(position: (0.3, 0.4, 2), intensity: 3)";
    let d2 = 0.25f64 + 4.0;
    let expected = 3.0 * 2.0 / (d2 * d2.sqrt());
    assert_close(exact_irradiance("", light), expected, 1e-6, "high");
}

/// Nothing arrives from below the floor, or behind a wall.
#[test]
fn hard_shadows() {
    let light = "Point(position: (0.3, 0, -1), intensity: 3)";
    assert_eq!(irradiance("", light).mean, 0.0, "from below");
    let light = "Point(position: (0, 0, 2), intensity: 3)";
    let wall = "(shape: Quad(corner: (-1, -1, 1), u: (2, 0, 0), v: (0, 2, 0)), material: \"grey\")";
    assert_eq!(irradiance(wall, light).mean, 0.0, "behind a wall");
    let beside =
        "(shape: Quad(corner: (1e-6, -1, 1), u: (2, 0, 0), v: (0, 2, 0)), material: \"grey\")";
    assert_close(exact_irradiance(beside, light), 0.75, 1e-6, "beside it");
}

/// Full intensity inside, the cubic ramp between the angles, nothing outside;
/// `power` is what all directions sum to.
#[test]
fn spot_light() {
    let (inner, outer) = (10f64.to_radians().cos(), 30f64.to_radians().cos());
    let falloff = |cos: f64| {
        let x = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    for degrees in [0.0f64, 9.0, 12.0, 20.0, 29.0, 31.0] {
        // The axis is tilted by `degrees` against the way to the origin.
        let (s, c) = degrees.to_radians().sin_cos();
        let light = format!(
            "Spot(position: (0, 0, 2), direction: ({s}, 0, {}), inner: 10, outer: 30, intensity: 4)",
            -c
        );
        let expected = falloff(c);
        let value = exact_irradiance("", &light);
        assert!(
            (value - expected).abs() <= 1e-5,
            "{degrees} degrees: {value}, expected {expected}"
        );
    }
    // The ramp's integral by the midpoint rule over the cosine.
    let n = 100_000;
    let step = (inner - outer) / f64::from(n);
    let ramp: f64 = (0..n)
        .map(|i| falloff(outer + (f64::from(i) + 0.5) * step) * step)
        .sum();
    let solid_angle = 2.0 * PI * (1.0 - inner + ramp);
    let light = "Spot(position: (0, 0, 2), look_at: (0, 0, 0), inner: 10, outer: 30, power: 5)";
    let expected = 5.0 / solid_angle / 4.0;
    assert_close(exact_irradiance("", light), expected, 1e-6, "power");
}

#[test]
fn beam_and_sun() {
    let (s, c) = 35f64.to_radians().sin_cos();
    // A beam whose axis passes at a distance of 0.5 m from the origin.
    let beam = |radius: f64| {
        let (x, z) = (-2.0 * s + 0.5 * c, 2.0 * c + 0.5 * s);
        format!(
            "Directional(direction: ({s}, 0, {}), irradiance: 7, beam: (center: ({x}, 0, {z}), radius: {radius}))",
            -c
        )
    };
    assert_close(
        exact_irradiance("", &beam(0.51)),
        7.0 * c,
        1e-12,
        "in the beam",
    );
    assert_eq!(irradiance("", &beam(0.49)).mean, 0.0, "beside the beam");
    let sun = |diameter: f64| {
        format!(
            "Directional(direction: ({s}, 0, {}), irradiance: 7, angular_diameter: {diameter})",
            -c
        )
    };
    assert_close(
        exact_irradiance("", &sun(0.0)),
        7.0 * c,
        1e-12,
        "parallel light",
    );
    // A cone of constant radiance sends the same vector of irradiance as its
    // axis, as long as it is above the horizon.
    irradiance("", &sun(0.5)).assert_is(7.0 * c, 1e-3, "sun of half a degree");
    irradiance("", &sun(60.0)).assert_is(7.0 * c, 1e-3, "sun of 60 degrees");
}

/// E = pi L (r / d)^2 cos for a sphere that is clear of the horizon.
#[test]
fn sphere_light() {
    for (x, z, r) in [
        (0.0, 2.0, 0.5),
        (1.5, 1.2, 0.3),
        (0.0, 1.0, 0.99),
        (1.0, 3.0, 1e-5),
    ] {
        let d2: f64 = x * x + z * z;
        let expected = PI * 5.0 * (r * r / d2) * (z / d2.sqrt());
        let light = format!("Sphere(center: ({x}, 0, {z}), radius: {r}, radiance: 5)");
        irradiance("", &light).assert_is(expected, 2e-3, &light);
    }
    // Power 4 pi^2 r^2 L.
    let power = 4.0 * PI * PI * 0.25 * 5.0;
    let light = format!("Sphere(center: (0, 0, 2), radius: 0.5, power: {power})");
    irradiance("", &light).assert_is(PI * 5.0 / 16.0, 2e-3, "power");
}

/// On the axis of a disc that faces the floor, E = pi L r^2 / (r^2 + d^2).
#[test]
fn disc_light() {
    for (r, d) in [(0.5f64, 2.0f64), (2.0, 0.5), (1e-4, 1.0)] {
        let expected = PI * 5.0 * r * r / (r * r + d * d);
        let light =
            format!("Disc(center: (0, 0, {d}), facing: (0, 0, 0), radius: {r}, radiance: 5)");
        irradiance("", &light).assert_is(expected, 2e-2, &light);
    }
    let power = PI * PI * 0.25 * 5.0;
    let light = format!("Disc(center: (0, 0, 2), facing: (0, 0, 0), radius: 0.5, power: {power})");
    irradiance("", &light).assert_is(PI * 5.0 * 0.25 / 4.25, 2e-3, "power");
    let away = "Disc(center: (0, 0, 2), normal: (0, 0, 1), radius: 0.5, radiance: 5)";
    assert_eq!(irradiance("", away).mean, 0.0, "the dark side");
}

/// Irradiance on the upward side at the origin from a polygon of radiance 1
/// above the horizon: Lambert's sum over the edges of angle times the z part
/// of the edge plane's normal, over two.
fn lambert(polygon: &[DVec3]) -> f64 {
    let n = polygon.len();
    let sum: f64 = (0..n)
        .map(|i| {
            let (a, b) = (polygon[i].normalize(), polygon[(i + 1) % n].normalize());
            a.angle_between(b) * a.cross(b).normalize().z
        })
        .sum();
    0.5 * sum.abs()
}

fn quad_text(corner: DVec3, u: DVec3, v: DVec3) -> String {
    let t = |p: DVec3| format!("({}, {}, {})", p.x, p.y, p.z);
    format!(
        "Quad(corner: {}, u: {}, v: {}, radiance: 5)",
        t(corner),
        t(u),
        t(v)
    )
}

#[test]
fn quad_light() {
    let cases = [
        // Parallel to the floor and centred: four times the closed form of a
        // rectangle with one corner above the point.
        (
            DVec3::new(-0.5, -0.4, 1.5),
            DVec3::new(0.0, 0.8, 0.0),
            DVec3::new(1.0, 0.0, 0.0),
        ),
        // Oblique and off to the side.
        (
            DVec3::new(0.7, -0.6, 0.8),
            DVec3::new(0.2, 0.9, 0.5),
            DVec3::new(0.3, -0.2, 0.9),
        ),
    ];
    for (k, (corner, u, v)) in cases.into_iter().enumerate() {
        // The side that faces the origin emits.
        let (u, v) = if u.cross(v).dot(corner) < 0.0 {
            (u, v)
        } else {
            (v, u)
        };
        let expected = 5.0 * lambert(&[corner, corner + u, corner + u + v, corner + v]);
        if k == 0 {
            let (a, b) = (0.5f64 / 1.5, 0.4f64 / 1.5);
            let quarter = a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan()
                + b / (1.0 + b * b).sqrt() * (a / (1.0 + b * b).sqrt()).atan();
            assert_close(
                expected,
                5.0 * 4.0 * 0.5 * quarter,
                1e-12,
                "both closed forms",
            );
        }
        irradiance("", &quad_text(corner, u, v)).assert_is(expected, 2e-3, "quad");
    }
}

/// A half-plane hides part of a rectangle: what is left is a rectangle again.
#[test]
fn penumbra_of_a_half_plane() {
    let whole = |x0: f64, x1: f64| {
        [(x0, -0.5), (x1, -0.5), (x1, 0.5), (x0, 0.5)].map(|(x, y)| DVec3::new(x, y, 2.0))
    };
    let (u, v) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(1.0, 0.0, 0.0));
    let light = quad_text(DVec3::new(-0.5, -0.5, 2.0), u, v);
    for edge in [-0.4, -0.1, 0.0, 0.23, 0.49] {
        // Halfway up, the half-plane covers what lies beyond 2 * edge / 2.
        let objects = format!(
            "(shape: Quad(corner: ({}, -5, 1), u: (10, 0, 0), v: (0, 10, 0)), material: \"grey\")",
            0.5 * edge
        );
        let expected = 5.0 * lambert(&whole(-0.5, edge));
        irradiance(&objects, &light).assert_is(expected, 1e-2, &format!("edge at {edge}"));
    }
}

/// More lights than shadow rays: they are picked by power, and the sum is
/// still that of all.
#[test]
fn many_lights_are_sampled_without_bias() {
    let mut lights = String::new();
    let mut expected = 0.0;
    for i in 0..20 {
        let (x, z, power) = (
            0.1 * f64::from(i),
            1.0 + 0.05 * f64::from(i),
            1.0 + f64::from(i),
        );
        lights += &format!("Point(position: ({x}, 0.2, {z}), power: {power}),");
        let d2: f64 = x * x + 0.04 + z * z;
        expected += power / (4.0 * PI) * z / (d2 * d2.sqrt());
    }
    irradiance("", &lights).assert_is(expected, 5e-3, "twenty lights");
}

/// A lamp in a mirror: the camera sees its radiance through a chain of
/// mirrors and, dimmed by Fresnel, in glass.
#[test]
fn emission_is_seen_directly_and_in_mirrors() {
    let seen = |objects: &str| {
        let scene = scene_of(
            "eye: (0, 0, 0), look_at: (1, 0, 0), fov: 0.001",
            [2, 2],
            objects,
            "Disc(center: (-3, 0, 0), normal: (1, 0, 0), radius: 1, radiance: (2, 4, 8)),
             Disc(center: (9, 0, 0), normal: (-1, 0, 0), radius: 1, radiance: (1, 2, 3))",
            "passes: 8",
        );
        let film = render(&scene).film;
        assert_eq!(film.image(), film.layer_image(Layer::Emission));
        film.image().mean()
    };
    let close = |value: nephroid::spectrum::Rgb, expected: [f64; 3], what: &str| {
        for c in 0..3 {
            assert_close(value[c], expected[c], 1e-9, what);
        }
    };
    close(seen(""), [1.0, 2.0, 3.0], "nothing between");
    close(
        seen(
            "(shape: Disc(center: (2, 0, 0), normal: (-1, 0, 0), radius: 1), material: Mirror(reflectance: (0.5, 0.6, 0.7)))",
        ),
        [1.0, 2.4, 5.6],
        "mirrored",
    );
    // One interface, seen from outside: 4 % of the lamp behind the camera and
    // 96 % of the one ahead, whose radiance falls with the squared index.
    let glass = "(shape: Disc(center: (2, 0, 0), normal: (-1, 0, 0), radius: 1), material: \"glass\", open: true)";
    let mix = |behind: f64, ahead: f64| 0.04 * behind + 0.96 * ahead / (1.5 * 1.5);
    close(
        seen(glass),
        [mix(2.0, 1.0), mix(4.0, 2.0), mix(8.0, 3.0)],
        "through glass",
    );
}

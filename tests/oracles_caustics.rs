//! Caustics in closed form: slabs, prisms, ball lenses, mirror rings.

mod common;

use std::f64::consts::PI;

use common::{assert_close, ball, layer_means, photon_paths, reflectance, render, scene, scene_of};
use glam::DVec3;
use nephroid::{
    film::{Image, Layer},
    metrics::relmse,
};

/// Flat glass between two open sheets, light from above.
fn slab(z0: f64, z1: f64) -> String {
    format!(
        "(shape: Quad(corner: (-9, -9, {z1}), u: (18, 0, 0), v: (0, 18, 0)), material: \"glass\", open: true),
         (shape: Quad(corner: (-9, 9, {z0}), u: (18, 0, 0), v: (0, -18, 0)), material: \"glass\", open: true),"
    )
}

/// Uniform light through a slab stays uniform: caustic radiance
/// E T cos rho / pi with T = (1 - R) / (1 + R), all inner reflections
/// included, for small and large kernels.
#[test]
fn uniform_light_through_a_slab() {
    for (degrees, radius) in [(0.0, 1.5), (0.0, 2.0), (0.0, 3.0), (40.0, 1.5)] {
        let angle = f64::to_radians(degrees);
        let (s, c) = angle.sin_cos();
        let scene = scene_of(
            "eye: (0, 0, 0.3), look_at: (0, 0, 0), up: (0, 1, 0), height: 0.8",
            [24, 24],
            &format!(
                "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"), {}",
                slab(0.5, 0.8)
            ),
            &format!(
                "Directional(direction: ({s}, 0, {}), irradiance: 3, beam: (center: ({}, 0, {}), radius: 1.5))",
                -c,
                -3.0 * s,
                3.0 * c
            ),
            &format!("photons: 32768, radius: {radius}, indirect: false"),
        );
        let r = reflectance(angle, 1.5);
        let expected = 3.0 * c * (1.0 - r) / (1.0 + r) * 0.5 / PI;
        let layers = layer_means(&scene, 4);
        // Around what the camera sees the guide sends fewer photons with wider
        // kernels: a little of their light falls on it, in proportion to the
        // square of the kernels (6e-4, 1.3e-3 and 4.5e-3 of the light here).
        let spilled = 6e-4 * radius * radius * expected;
        let found = layers[Layer::Caustic as usize];
        let nearest = found.mean.clamp(expected, expected + spilled);
        found.assert_is(nearest, 5e-3, &format!("{degrees}, {radius}"));
        assert_eq!(
            layers[Layer::Direct as usize].mean,
            0.0,
            "glass casts a shadow"
        );
    }
}

/// A slab of thickness h shifts a ray sideways by
/// h sin i (1 - cos i / sqrt(n^2 - sin^2 i)) and does not turn it: every
/// photon of an oblique beam, to rounding.
#[test]
fn a_slab_displaces_a_beam() {
    let (h, n) = (0.7, 1.5f64);
    for degrees in [5.0f64, 30.0, 60.0, 80.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let scene = scene_of(
            "eye: (0, 0, 0.3), look_at: (0, 0, 0), up: (0, 1, 0), height: 1",
            [1, 1],
            &format!(
                "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"), {}",
                slab(0.5, 0.5 + h)
            ),
            &format!(
                "Directional(direction: ({s}, 0, {}), irradiance: 3, beam: (center: ({}, 0, {}), radius: 0.1))",
                -c,
                -2.0 * s / c,
                2.0
            ),
            "max_depth: 2, photons: 1",
        );
        let expected = h * s * (1.0 - c / (n * n - s * s).sqrt());
        let mut landed = 0;
        for path in photon_paths(&scene, 500) {
            let Some(photon) = path.photon else { continue };
            let ray = path.emission.ray;
            let aside = photon.position - ray.origin;
            // The part across the ray; a positive shift lags behind in x.
            let aside = aside - ray.dir * aside.dot(ray.dir);
            let shift = -aside.dot(DVec3::new(c, 0.0, s));
            assert!(
                (shift - expected).abs() < 1e-13 && aside.y.abs() < 1e-13,
                "{degrees} degrees: shift {shift}, expected {expected}"
            );
            landed += 1;
        }
        assert!(landed > 150, "{landed} photons landed");
    }
}

/// Where the same photons meet two planes gives their direction.
fn on_two_planes(text: impl Fn(f64) -> String, z: [f64; 2]) -> Vec<(DVec3, DVec3)> {
    let [a, b] = z.map(|z| photon_paths(&scene(&text(z)), 2000));
    a.into_iter()
        .zip(b)
        .filter_map(|(a, b)| Some((a.photon?.position, b.photon?.position)))
        .collect()
}

/// An equilateral prism deviates a beam by i + i' - A, with Snell's law at
/// both faces; least of all where the light passes symmetrically.
#[test]
fn a_prism_deviates_a_beam() {
    let n = 1.5168f64;
    let apex = PI / 3.0;
    let closed_form = |i: f64| {
        let r = (i.sin() / n).asin();
        i + (n * (apex - r).sin()).asin() - apex
    };
    let least = 2.0 * (n * (apex / 2.0).sin()).asin() - apex;
    for i in [0.5 * (least + apex), 0.7, 1.0, 1.3] {
        // The edge points along y at z = 0.5; the left face's outward normal
        // is (-cos 30, 0, sin 30). Light meets it from the upper left.
        let normal = DVec3::new(-(PI / 6.0).cos(), 0.0, 0.5);
        let along = DVec3::new(0.5, 0.0, (PI / 6.0).cos());
        let d = -normal * i.cos() + along * i.sin();
        let target = -0.4 * along + DVec3::new(0.0, 0.0, 0.5);
        let from = target - 2.0 * d;
        let text = |x: f64| {
            let half = (PI / 6.0).tan();
            format!(
                "(camera: (eye: (0, 0, 9), look_at: (0, 0, 0), up: (0, 1, 0), fov: 40),
                  image: (width: 1, height: 1),
                  objects: [
                    (shape: Mesh(
                        vertices: [(0, -1, 0.5), (-{half}, -1, -0.5), ({half}, -1, -0.5),
                                   (0, 1, 0.5), (-{half}, 1, -0.5), ({half}, 1, -0.5)],
                        triangles: [(0, 1, 2), (3, 5, 4), (0, 3, 4), (0, 4, 1),
                                    (0, 2, 5), (0, 5, 3), (1, 4, 5), (1, 5, 2)]),
                     material: Dielectric(ior: {n})),
                    (shape: Plane(point: ({x}, 0, 0), normal: (-1, 0, 0)), material: Diffuse(reflectance: 0.5)),
                  ],
                  lights: [Directional(direction: ({}, 0, {}), irradiance: 1,
                      beam: (center: ({}, 0, {}), radius: 0.01))],
                  render: (max_depth: 2, photons: 1))",
                d.x, d.z, from.x, from.z
            )
        };
        let expected = closed_form(i);
        let through = on_two_planes(text, [3.0, 5.0]);
        let mut refracted = 0;
        for (a, b) in through {
            let turned = (b - a).normalize().angle_between(d);
            if (turned - (PI - 2.0 * i)).abs() < 1e-9 {
                // Reflected by the first face.
                continue;
            }
            assert!(
                (turned - expected).abs() < 1e-11,
                "incidence {i}: deviation {turned}, expected {expected}"
            );
            assert!(turned >= least - 1e-11, "the least deviation is {least}");
            refracted += 1;
        }
        assert!(refracted > 1000, "{refracted} photons");
    }
}

/// A ray at height h crosses the axis behind a ball of radius R at
/// R sin i / sin(2 (i - t)); close to the axis that is n R / (2 (n - 1)). The
/// beam is too narrow for light mirrored by the outside to get there.
#[test]
fn ball_lens_focal_length() {
    for index in [1.33, 1.5, 1.9] {
        let text = |z: f64| {
            format!(
                "(camera: (eye: (0, 0, 9), look_at: (0, 0, 0), up: (0, 1, 0), fov: 40),
                  image: (width: 1, height: 1),
                  objects: [
                    (shape: Sphere(center: (0, 0, 0), radius: 2), material: Dielectric(ior: {index})),
                    (shape: Plane(point: (0, 0, {z}), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
                  ],
                  lights: [Directional(direction: (0, 0, -1), irradiance: 1,
                      beam: (center: (0, 0, 4), radius: 1.3))],
                  render: (max_depth: 2, photons: 1))"
            )
        };
        let through = on_two_planes(text, [-9.0, -17.0]);
        assert!(through.len() > 1500, "{} photons", through.len());
        let mut nearest = (f64::INFINITY, 0.0);
        for (a, b) in through {
            // Undo the lens: the way across the axis gives height and crossing.
            let (ra, rb) = (a.truncate(), b.truncate());
            let slope = (rb - ra) / (a.z - b.z);
            let tan = slope.length();
            let crossing = a.z.abs() - ra.dot(slope) / slope.length_squared();
            let deviation = tan.atan();
            // h = R sin i from the deviation: sin i = f sin D / R.
            let sin_i = crossing * deviation.sin() / 2.0;
            let again = 2.0 * (sin_i.asin() - (sin_i / index).asin());
            assert!(
                (again - deviation).abs() < 1e-9,
                "index {index}: deviation {deviation} at height {sin_i}, expected {again}"
            );
            if sin_i < nearest.0 {
                nearest = (sin_i, crossing);
            }
        }
        let (sin_i, crossing) = nearest;
        assert_close(
            crossing,
            index * 2.0 / (2.0 * (index - 1.0)),
            2.0 * sin_i * sin_i,
            "paraxial focus",
        );
        assert!(sin_i < 0.03, "some ray is close to the axis: {sin_i}");
    }
}

/// Parallel light in a mirror ring: the reflected rays touch the nephroid
/// x = R (3 cos t - cos 3t) / 4, y = R (3 sin t - sin 3t) / 4 with its cusp
/// half-way between centre and wall. Across the curve, the brightest pixel is
/// the one on it or its neighbour.
#[test]
fn nephroid() {
    let pixels = 200;
    let scene = scene_of(
        "eye: (0, 0, 0.9), look_at: (0, 0, 0), up: (0, 1, 0), height: 2",
        [pixels, pixels],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\"),
         (shape: Cylinder(base: (0, 0, -0.01), end: (0, 0, 1), radius: 1), material: \"mirror\")",
        "Directional(direction: (1, 0, -1), irradiance: 1, angular_diameter: 0)",
        "passes: 8, photons: 131072, radius: 1, indirect: false, max_depth: 1",
    );
    let image = render(&scene).film.layer_image(Layer::Caustic);
    let pixel = 2.0 / f64::from(pixels);
    let at = |x: f64, y: f64| bilinear(&image, (x + 1.0) / pixel, (1.0 - y) / pixel);
    // Offset of the brightest point along a line, in pixels.
    let brightest = |x: f64, y: f64, dx: f64, dy: f64| {
        (-60..=60)
            .map(|k| f64::from(k) * 0.1)
            .max_by(|a, b| {
                let value = |k: f64| at(x + k * pixel * dx, y + k * pixel * dy);
                value(*a).total_cmp(&value(*b))
            })
            .unwrap_or(f64::NAN)
    };
    for degrees in [-55.0f64, -40.0, -25.0, 20.0, 30.0, 45.0, 58.0] {
        let t = degrees.to_radians();
        let (x, y) = (
            0.25 * (3.0 * t.cos() - (3.0 * t).cos()),
            0.25 * (3.0 * t.sin() - (3.0 * t).sin()),
        );
        // The tangent is the reflected ray, at angle 2 t.
        let (s, c) = (2.0 * t).sin_cos();
        let offset = brightest(x, y, -s, c);
        assert!(
            offset.abs() <= 1.0,
            "{degrees} degrees: the ridge is {offset} pixels off the curve"
        );
        let (on, beyond) = (at(x, y), at(x + 6.0 * pixel * s, y - 6.0 * pixel * c));
        let other = at(x - 6.0 * pixel * s, y + 6.0 * pixel * c);
        assert!(
            on > 1.5 * beyond.min(other),
            "{degrees} degrees: no ridge, {beyond} {on} {other}"
        );
    }
    // At the cusp the two branches are closer than a pixel w over a length of
    // about w^(2/3), 4.6 pixels here: so well can its tip be seen.
    let cusp = brightest(0.5, 0.0, 1.0, 0.0);
    assert!(cusp.abs() <= 4.0, "the cusp is {cusp} pixels off R / 2");
}

/// The image at continuous pixel coordinates.
fn bilinear(image: &Image, x: f64, y: f64) -> f64 {
    let (x, y) = (x - 0.5, y - 0.5);
    let (i, j) = (x.floor(), y.floor());
    let (u, v) = (x - i, y - j);
    let p = |di: f64, dj: f64| {
        let clamp = |k: f64, n: u32| (k.max(0.0) as u32).min(n - 1);
        image.pixel(clamp(i + di, image.width()), clamp(j + dj, image.height()))[1]
    };
    (1.0 - v) * ((1.0 - u) * p(0.0, 0.0) + u * p(1.0, 0.0))
        + v * ((1.0 - u) * p(0.0, 1.0) + u * p(1.0, 1.0))
}

/// The whole caustic of a ball lens, pixel by pixel, on planes before the
/// focus and behind it: the centre is a focal line, and there is a fold. The bounds are one and a half times what the
/// kernel's bias and the noise of 64 passes come to.
#[test]
fn ball_lens_irradiance() {
    for (plane, beam, window, bound) in [(1.3, 0.95, 1.4, 0.0035), (2.2, 0.7, 1.6, 0.011)] {
        let pixels = 64;
        let exact = ball::irradiance(plane, beam, window, pixels);
        let render_block = "passes: 64, photons: 32768";
        let mut scene = scene(&ball::scene_text(plane, beam, window, pixels, render_block));
        let image = render(&scene).film.layer_image(Layer::Caustic);
        let error = relmse(&image, &exact).expect("same size");
        assert!(error < bound, "plane {plane}: relMSE {error}");
        // Any kernel keeps the flux.
        scene.settings.radius = 6.0;
        scene.settings.photons = Some(16_384);
        let flux = layer_means(&scene, 64)[Layer::Caustic as usize];
        flux.assert_is(exact.mean()[1], 1e-3, &format!("total flux, plane {plane}"));
    }
}

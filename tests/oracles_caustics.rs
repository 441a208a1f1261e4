//! Caustics in closed form: slabs, prisms, ball lenses, mirror rings, and the
//! mirrored integrating sphere.

mod common;

use std::f64::consts::PI;

use common::{
    Estimate, assert_close, ball, greens, layer_means, photon_paths, render, scene, scene_of,
};
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

/// Reflectance of one surface by Fresnel's equations in angles.
fn reflectance(angle: f64, index: f64) -> f64 {
    if angle == 0.0 {
        return ((index - 1.0) / (index + 1.0)).powi(2);
    }
    let t = (angle.sin() / index).asin();
    let s = ((angle - t).sin() / (angle + t).sin()).powi(2);
    let p = ((angle - t).tan() / (angle + t).tan()).powi(2);
    0.5 * (s + p)
}

/// Uniform light through a slab stays uniform: caustic radiance
/// E T cos rho / pi with T = (1 - R) / (1 + R), all inner reflections
/// included, for small and large kernels.
#[test]
fn uniform_light_through_a_slab() {
    for (degrees, radius) in [(0.0, 0.7), (0.0, 3.0), (0.0, 10.0), (40.0, 3.0)] {
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
        layers[Layer::Caustic as usize].assert_is(expected, 5e-3, &format!("{degrees}, {radius}"));
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
        let render_block = "passes: 64, photons: 32768, radius: 1";
        let mut scene = scene(&ball::scene_text(plane, beam, window, pixels, render_block));
        let image = render(&scene).film.layer_image(Layer::Caustic);
        let error = relmse(&image, &exact).expect("same size");
        assert!(error < bound, "plane {plane}: relMSE {error}");
        // Any kernel keeps the flux, and a wide one makes peaks harmless.
        scene.settings.radius = 6.0;
        scene.settings.photons = Some(16_384);
        let flux = layer_means(&scene, 4)[Layer::Caustic as usize];
        flux.assert_is(exact.mean()[1], 1e-3, &format!("total flux, plane {plane}"));
    }
}

/// An integrating sphere: E = P / (4 pi R^2 (1 - a)) on the whole wall, a
/// part 1 - a of it straight from the lamp in its centre.
#[test]
fn furnace() {
    for albedo in [0.2, 0.5, 0.8] {
        let scene = scene_of(
            "eye: (0.3, 0.1, -0.2), look_at: (1, 0.4, 0.3), fov: 80",
            [16, 16],
            &format!(
                "(shape: Sphere(center: (0, 0, 0), radius: 2), material: Diffuse(reflectance: {albedo}))"
            ),
            "Point(position: (0, 0, 0), power: 20)",
            "",
        );
        let direct = 20.0 / (4.0 * PI * 4.0) * albedo / PI;
        let layers = layer_means(&scene, 8);
        assert_close(layers[Layer::Direct as usize].mean, direct, 1e-12, "direct");
        layers[Layer::Indirect as usize].assert_is(
            direct * albedo / (1.0 - albedo),
            1e-2,
            &format!("indirect, albedo {albedo}"),
        );
    }
}

/// The same sphere cut in half by a mirror: the mirror image completes it, so
/// the upper half looks like a whole sphere with two lamps. The image of the
/// lamp is the caustic, and all further light is uniform.
#[test]
fn mirrored_furnace() {
    let (albedo, radius, height) = (0.6, 1.0, 0.4);
    // A narrow view of one place on the wall.
    let place = DVec3::new(0.48, -0.36, 0.8);
    let scene = scene_of(
        "eye: (0, 0, 0.5), look_at: (0.48, -0.36, 0.8), fov: 3",
        [12, 12],
        &format!(
            "(shape: Sphere(center: (0, 0, 0), radius: {radius}), material: Diffuse(reflectance: {albedo})),
             (shape: Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: 1.1), material: \"mirror\")"
        ),
        &format!("Point(position: (0, 0, {height}), power: 20)"),
        "photons: 16384, radius: 8",
    );
    let from = |z: f64| {
        let to = DVec3::new(0.0, 0.0, z) - place;
        let cos = -to.normalize().dot(place);
        20.0 / (4.0 * PI) * cos / to.length_squared() * albedo / PI
    };
    let uniform = 2.0 * 20.0 / (4.0 * PI * radius * radius) * albedo / PI * albedo / (1.0 - albedo);
    let layers = layer_means(&scene, 8);
    assert_close(
        layers[Layer::Direct as usize].mean,
        from(height),
        1e-3,
        "direct",
    );
    layers[Layer::Caustic as usize].assert_is(from(-height), 1.5e-2, "caustic");
    layers[Layer::Indirect as usize].assert_is(uniform, 1.5e-2, "indirect");
}

/// A thin pane: straight light is dimmed by T(angle) and needs no photons;
/// what it reflects is the caustic of the lamp's mirror image.
#[test]
fn a_thin_pane_dims_and_mirrors() {
    let pane = |x: f64| {
        format!(
            "(shape: Quad(center: ({x}, 0, 1), size: (1, 1), normal: (0, 0, 1)),
              material: Dielectric(ior: 1.5, thin: true)),"
        )
    };
    let lamp = |x: f64| format!("Point(position: ({x}, 0, 2), intensity: 9)");
    for x in [0.0, 3.0f64] {
        let angle = (x / 2.0).atan();
        let r = reflectance(angle, 1.5);
        let dimmed = (1.0 - r) / (1.0 + r);
        // Below: 2 m under the lamp.
        let below = scene_of(
            "eye: (0, 0, 0.5), look_at: (0, 0, 0), up: (0, 1, 0), height: 1e-6",
            [2, 2],
            &format!(
                "{} (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\")",
                pane(0.5 * x)
            ),
            &lamp(x),
            "photons: 16384, passes: 8, indirect: false",
        );
        let report = render(&below);
        let e = 9.0 * angle.cos() / (4.0 + x * x);
        let layer = |l| report.film.layer_image(l).mean()[1];
        assert_close(
            layer(Layer::Direct),
            e * dimmed / PI,
            1e-6,
            "through the pane",
        );
        assert_eq!(layer(Layer::Caustic), 0.0, "no photon on the far side");
        assert_eq!(report.report.photons_stored, 0, "none at all");
        // Above: a ceiling 1 m over the lamp, 3 m over its mirror image.
        let above = scene_of(
            "eye: (0, 0, 2.5), look_at: (0, 0, 3), up: (0, 1, 0), height: 0.2",
            [8, 8],
            &format!(
                "{} (shape: Plane(point: (0, 0, 3), normal: (0, 0, -1)), material: \"white\")",
                pane(2.0 / 3.0 * x)
            ),
            &lamp(x),
            "photons: 65536, radius: 8, indirect: false",
        );
        let r = reflectance((x / 3.0).atan(), 1.5);
        let mirrored = 2.0 * r / (1.0 + r);
        let e = 9.0 * (x / 3.0).atan().cos() / (9.0 + x * x);
        let caustic = layer_means(&above, 2)[Layer::Caustic as usize];
        caustic.assert_is(e * mirrored / PI, 5e-2, "the pane's mirror image");
    }
}

/// Glass of index 1 is not there: with a point light every pixel is the same
/// to rounding, with everything switched on the picture is the same within
/// its noise.
#[test]
fn index_matched_glass_is_invisible() {
    let text = |ball: &str, lights: &str, render: &str| {
        scene_of(
            "eye: (0, -4, 2), look_at: (0, 0, 0.6), fov: 40",
            [32, 24],
            &format!(
                "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
                 (shape: Plane(point: (0, 2, 0), normal: (0, -1, 0)), material: \"grey\"),
                 (shape: Sphere(center: (0.5, 0.7, 0.6), radius: 0.4), material: \"mirror\"),{ball}"
            ),
            lights,
            render,
        )
    };
    let ball = "(shape: Sphere(center: (0, 0, 1), radius: 0.9), material: Dielectric(ior: 1))";
    let point = "Point(position: (1, -1, 3), power: 100)";
    let render_block = "passes: 1, photons: 1, indirect: false";
    let [with, without] = [ball, ""].map(|b| {
        let scene = text(b, point, render_block);
        render(&scene).film.layer_image(Layer::Direct)
    });
    let mean = without.mean()[1];
    for (a, b) in with.pixels().iter().zip(without.pixels()) {
        assert!(
            (a[1] - b[1]).abs() <= 1e-9 * mean,
            "{} is not {}",
            a[1],
            b[1]
        );
    }
    let lamps = "Sphere(center: (1, -1, 3), radius: 0.2, radiance: 30), Point(position: (-2, 0, 2), power: 5)";
    let [with, without] =
        [ball, ""].map(|b| layer_means(&text(b, lamps, "photons: 16384, radius: 4"), 5));
    for layer in [Layer::Direct, Layer::Caustic, Layer::Indirect] {
        let (a, b) = (with[layer as usize], without[layer as usize]);
        let ratio = Estimate {
            mean: a.mean / b.mean,
            error: (a.error / a.mean).hypot(b.error / b.mean),
        };
        ratio.assert_is(1.0, 0.05, layer.name());
    }
}

/// The layers sum to the picture, up to rounding and four quanta a pass (less
/// than 1e-17 here), and indirect light can be turned off.
#[test]
fn layers_partition_the_picture() {
    let everything = |render: &str| {
        scene_of(
            "eye: (0, -4, 2), look_at: (0, 0, 0.6), fov: 50",
            [32, 24],
            "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),
             (shape: Plane(point: (0, 3, 0), normal: (0, -1, 0)), material: \"white\"),
             (shape: Sphere(center: (0, 0, 0.6), radius: 0.5), material: \"glass\"),
             (shape: Sphere(center: (1.1, 0.5, 0.5), radius: 0.4), material: \"mirror\"),
             (shape: Quad(corner: (-1.5, -0.5, 0.1), u: (0.8, 0, 0), v: (0, 0.2, 1)),
              material: Dielectric(ior: 1.5, thin: true))",
            "Sphere(center: (0.2, 0.4, 2.2), radius: 0.2, radiance: (30, 20, 10)),
             Point(position: (-2, -1, 2), power: 30)",
            render,
        )
    };
    let on = render(&everything("passes: 8, photons: 16384"));
    let picture = on.film.image();
    let layers = Layer::ALL.map(|l| on.film.layer_image(l));
    for (i, pixel) in picture.pixels().iter().enumerate() {
        for c in 0..3 {
            let sum: f64 = layers.iter().map(|l| l.pixels()[i][c]).sum();
            assert!(
                (sum - pixel[c]).abs() <= 1e-14 * pixel[c] + 1e-17,
                "{sum} and {}",
                pixel[c]
            );
        }
    }
    for (layer, image) in Layer::ALL.iter().zip(&layers) {
        assert!(image.mean().mean() > 0.0, "{} is empty", layer.name());
    }
    assert!(on.report.indirect);
    let off = render(&everything("passes: 8, photons: 16384, indirect: false"));
    assert!(!off.report.indirect);
    assert!(
        off.report.to_string().contains("layer is black"),
        "{}",
        off.report
    );
    assert!(greens(&off.film.layer_image(Layer::Indirect)).all(|v| v == 0.0));
    for layer in [Layer::Caustic, Layer::Emission] {
        let [a, b] = [&on, &off].map(|o| o.film.layer_image(layer).mean()[1]);
        assert_close(a, b, 0.05, layer.name());
    }
}

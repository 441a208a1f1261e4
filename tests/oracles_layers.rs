//! Who owns which light: integrating spheres, thin panes, index-matched glass,
//! and layers that sum to the picture.

mod common;

use std::f64::consts::PI;

use common::{Estimate, assert_close, greens, layer_means, reflectance, render, scene_of};
use glam::DVec3;
use nephroid::film::Layer;

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
        "photons: 16384",
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
            "photons: 65536, radius: 1, indirect: false",
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

//! The same picture at any scale and place.
//!
//! All random numbers are the same, so the pictures differ by rounding alone:
//! single precision photon positions (relative error 6e-8 of their distance
//! from the middle of the photons, against a kernel of about a hundredth of
//! it) and, far from the origin, double precision coordinates of 1e5 m with
//! an error of 1.5e-11 m each, magnified by a few reflections in the balls.

mod common;

use common::{render, scene};
use nephroid::{
    film::{Image, Layer},
    metrics::{mean_ratio, relmse},
};

/// A closed scene with all kinds of shapes, `scale` times as large, moved by
/// `shift`. Lengths scale, radiances and irradiances stay, powers go with the
/// square; then so does no pixel.
fn picture(scale: f64, shift: [f64; 3]) -> [Image; 4] {
    let p = |x: f64, y: f64, z: f64| {
        let [a, b, c] = shift;
        format!("({}, {}, {})", x * scale + a, y * scale + b, z * scale + c)
    };
    let v = |x: f64, y: f64, z: f64| format!("({}, {}, {})", x * scale, y * scale, z * scale);
    let l = |x: f64| x * scale;
    let text = format!(
        "(camera: (eye: {}, look_at: {}, fov: 50), image: (width: 32, height: 24),
          materials: {{
            \"grey\": Diffuse(reflectance: 0.6),
            \"glass\": Dielectric(ior: 1.5),
          }},
          objects: [
            (shape: Plane(point: {}, normal: (0, 0, 1)), material: \"grey\"),
            (shape: Quad(corner: {}, u: {}, v: {}), material: \"grey\"),
            (shape: Sphere(center: {}, radius: {}), material: \"glass\"),
            (shape: Cylinder(base: {}, end: {}, radius: {}), material: Mirror(reflectance: 0.9)),
            (shape: Mesh(vertices: [{}, {}, {}, {}], triangles: [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]),
             material: \"glass\"),
          ],
          lights: [
            Sphere(center: {}, radius: {}, radiance: 30),
            Point(position: {}, power: {}),
            Directional(direction: (0.3, 0.2, -1), irradiance: 0.5, angular_diameter: 1),
          ],
          render: (passes: 8, photons: 16384))",
        p(0.0, -4.0, 2.0),
        p(0.0, 0.0, 0.6),
        p(0.0, 0.0, 0.0),
        p(-3.0, 2.0, 0.0),
        v(6.0, 0.0, 0.0),
        v(0.0, 0.0, 3.0),
        p(0.0, 0.0, 0.7),
        l(0.5),
        p(1.0, 0.5, -0.01),
        p(1.0, 0.5, 0.4),
        l(0.4),
        p(-1.3, 0.0, 0.1),
        p(-0.8, 0.0, 0.2),
        p(-1.0, 0.6, 0.15),
        p(-1.1, 0.2, 0.8),
        p(0.2, 0.4, 2.2),
        l(0.2),
        p(-2.0, -1.0, 2.0),
        30.0 * scale * scale,
    );
    let film = render(&scene(&text)).film;
    Layer::ALL.map(|layer| film.layer_image(layer))
}

fn assert_same(what: &str, pictures: &[Image; 4], truth: &[Image; 4]) {
    for (layer, (a, b)) in Layer::ALL.iter().zip(pictures.iter().zip(truth)) {
        let name = layer.name();
        assert!(b.mean().mean() > 0.0, "{name} is empty");
        let (error, ratio) = (
            relmse(a, b).expect("same size"),
            mean_ratio(a, b).expect("same size"),
        );
        // How many samples a pixel gets is decided by a threshold; rounding may
        // push a pixel over it, which changes its noise but not its mean.
        assert!(error < 1e-4, "{what}, {name}: relMSE {error:e}");
        assert!(
            (ratio - 1.0).abs() < 1e-3,
            "{what}, {name}: mean times {ratio}"
        );
    }
}

#[test]
fn any_scale_and_place() {
    let truth = picture(1.0, [0.0; 3]);
    for scale in [1e-4, 1e-2, 1e2, 1e4] {
        assert_same(&format!("scale {scale}"), &picture(scale, [0.0; 3]), &truth);
    }
    for shift in [[1e5, 0.0, 0.0], [-3e4, 7e4, 1e5]] {
        assert_same(&format!("shift {shift:?}"), &picture(1.0, shift), &truth);
    }
    // Small and far: the camera is a millimetre away, the origin 100 m.
    assert_same(
        "small and far",
        &picture(1e-3, [100.0, -50.0, 20.0]),
        &truth,
    );
}

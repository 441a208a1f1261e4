//! What the film makes of things that are smaller than a pixel: filters and
//! images of lamps, in closed form.

mod common;

use common::{layer_means, scene};
use nephroid::{
    camera::Filter,
    film::{Film, Layer},
    metrics::relmse,
    numeric::exact::Quantum,
    render::Renderer,
};

/// An edge of light through the middle of a pixel: each pixel's value is the
/// filter's own distribution, whatever the size of the window.
#[test]
fn an_edge_shows_the_filters_distribution() {
    for filter in [Filter::Box, Filter::Gaussian, Filter::BlackmanHarris] {
        let scene = scene(&format!(
            "(camera: (eye: (0, 0, 1), look_at: (0, 0, 0), up: (0, 1, 0), height: 7),
              image: (width: 7, height: 7, filter: {filter:?}),
              lights: [Quad(corner: (-20, -20, 0), u: (20.2, 0, 0), v: (0, 40, 0), radiance: 3)],
              render: (passes: 512))"
        ));
        let film = film(&scene, [0, 0, 7, 7], 512);
        let image = film.layer_image(Layer::Emission);
        for x in 0..7 {
            // The edge lies 0.2 pixels right of the middle of pixel 3.
            let expected = 3.0 * (0.5 + filter.cumulative(3.2 - f64::from(x)));
            for y in 0..7 {
                let value = image.pixel(x, y)[1];
                assert!(
                    (value - expected).abs() < 0.04,
                    "{filter:?} {x}: {value} {expected}"
                );
            }
        }
        let crop = self::film(&scene, [2, 1, 3, 4], 8).image();
        let whole = self::film(&scene, [0, 0, 7, 7], 8).image();
        for (x, y) in [(0, 0), (2, 3), (1, 2)] {
            assert_eq!(crop.pixel(x, y), whole.pixel(x + 2, y + 1), "{filter:?}");
        }
    }
}

fn film(scene: &nephroid::scene::Scene, window: [u32; 4], passes: u32) -> Film {
    let renderer = Renderer::new(scene, &scene.settings, scene.resolution, window);
    let mut film = Film::new(window[2], window[3], Quantum::for_typical(1.0));
    for pass in 0..passes {
        film.add_pass(pass, &renderer.pass(pass).samples);
    }
    film
}

/// A lamp in a mirror, a twenty-fifth of a pixel large: its light is that of its
/// area, though a sample meets it once in 25 times.
#[test]
fn a_lamp_much_smaller_than_a_pixel() {
    let lamp = |centre: f64| {
        scene(&format!(
            "(camera: (eye: (0, 0, 0.5), look_at: (0, 0, 0), up: (0, 1, 0), height: 3),
              image: (width: 3, height: 3),
              objects: [(shape: Quad(corner: (-9, -9, 0), u: (18, 0, 0), v: (0, 18, 0)),
                         material: Mirror(reflectance: 0.9))],
              lights: [Quad(center: ({centre}, 0.2, 2), size: (0.2, 0.2), facing: ({centre}, 0.2, 0),
                       radiance: 500)])"
        ))
    };
    for centre in [0.1, 0.75] {
        let scene = lamp(centre);
        let emission = layer_means(&scene, 256)[Layer::Emission as usize];
        emission.assert_is(0.9 * 500.0 * 0.04 / 9.0, 0.03, "a small lamp");
    }
    // Its noise after few passes is that of many samples: one a pass would
    // leave a relMSE near 25 / 256 = 0.1 in the pixel that shows it.
    let scene = lamp(0.1);
    let exact = {
        let mut pixels = vec![nephroid::spectrum::Rgb::BLACK; 9];
        pixels[4] = nephroid::spectrum::Rgb::grey(18.0);
        nephroid::film::Image::new(3, 3, pixels)
    };
    let seen = film(&scene, [0, 0, 3, 3], 256).layer_image(Layer::Emission);
    let error = 9.0 * relmse(&seen, &exact).expect("same size");
    assert!(error < 0.03, "relMSE {error} in the lamp's pixel");
}

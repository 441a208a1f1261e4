//! The exact caustic of a ball lens under a parallel beam.
//!
//! A ball of index `n` and radius 1 m, parallel light along its axis, a plane
//! at distance `plane` behind its centre. Only the light that goes straight
//! through (two refractions) is counted: the scenes that are compared set
//! `max_depth` to 2. A ray at height `h` arrives at radius
//! `r(h) = h / cos D - plane tan D` with the deviation
//! `D = 2 (asin h - asin(h / n))`, weakened by Fresnel at both surfaces.

use nephroid::{film::Image, spectrum::Rgb};

/// Index of the ball.
pub(crate) const INDEX: f64 = 1.5;

/// Deviation of the ray at height `h` in `[0, 1)`.
pub(crate) fn deviation(h: f64) -> f64 {
    2.0 * (h.asin() - (h / INDEX).asin())
}

/// Signed radius at which that ray meets the plane.
pub(crate) fn landing(h: f64, plane: f64) -> f64 {
    let (s, c) = deviation(h).sin_cos();
    h / c - plane * s / c
}

/// Share of the power that passes both surfaces; Fresnel's equations written
/// in angles, for unpolarised light at each surface.
pub(crate) fn transmittance(h: f64) -> f64 {
    let (i, t) = (h.asin(), (h / INDEX).asin());
    let reflectance = if h == 0.0 {
        ((INDEX - 1.0) / (INDEX + 1.0)).powi(2)
    } else {
        let s = ((i - t).sin() / (i + t).sin()).powi(2);
        let p = ((i - t).tan() / (i + t).tan()).powi(2);
        0.5 * (s + p)
    };
    (1.0 - reflectance) * (1.0 - reflectance)
}

/// Irradiance on the plane, averaged over the pixels of a square window of
/// the given width around the axis, for a beam of irradiance 1 and radius
/// `beam`. Flux is carried over ring by ring: each of the many rings of the
/// beam becomes a ring on the plane, which is divided among the pixels by
/// equally spaced angles, shifted from ring to ring by the golden ratio.
pub(crate) fn irradiance(plane: f64, beam: f64, window: f64, pixels: u32) -> Image {
    const RINGS: u32 = 100_000;
    const ANGLES: u32 = 96;
    let per_metre = f64::from(pixels) / window;
    let mut flux = vec![0.0; (pixels * pixels) as usize];
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for k in 0..RINGS {
        // Rings of equal flux; the middle of each in terms of its area.
        let h = beam * ((f64::from(k) + 0.5) / f64::from(RINGS)).sqrt();
        let ring = std::f64::consts::PI * beam * beam / f64::from(RINGS) * transmittance(h);
        let r = landing(h, plane);
        let shift = (f64::from(k) * golden).fract();
        for j in 0..ANGLES {
            let angle = std::f64::consts::TAU * (f64::from(j) + shift) / f64::from(ANGLES);
            let (s, c) = angle.sin_cos();
            let x = (r * c + 0.5 * window) * per_metre;
            let y = (r * s + 0.5 * window) * per_metre;
            let limit = f64::from(pixels);
            if (0.0..limit).contains(&x) && (0.0..limit).contains(&y) {
                flux[y as usize * pixels as usize + x as usize] += ring / f64::from(ANGLES);
            }
        }
    }
    let area = 1.0 / (per_metre * per_metre);
    Image::new(
        pixels,
        pixels,
        flux.into_iter().map(|f| Rgb::grey(f / area)).collect(),
    )
}

/// A scene that shows the plane's `caustic` layer over the same window: the
/// camera stands between the ball and a white floor. A beam's irradiance of
/// pi makes the radiance equal to the irradiance per unit of the beam's.
pub(crate) fn scene_text(plane: f64, beam: f64, window: f64, pixels: u32, render: &str) -> String {
    super::scene_text(
        &format!(
            "eye: (0, 0, {}), look_at: (0, 0, 0), up: (0, 1, 0), height: {window}",
            0.5 * (plane - 1.0)
        ),
        [pixels, pixels],
        &format!(
            "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\"),
             (shape: Sphere(center: (0, 0, {plane}), radius: 1), material: Dielectric(ior: {INDEX}))"
        ),
        &format!(
            "Directional(direction: (0, 0, -1), irradiance: {}, beam: (center: (0, 0, {}), radius: {beam}))",
            std::f64::consts::PI,
            plane + 2.0
        ),
        &format!("max_depth: 2, indirect: false, {render}"),
    )
}

//! How bright a scene is, before anything is rendered.

use std::f64::consts::PI;

use crate::{light::Light, numeric::exact::Quantum, scene::Scene};

/// The unit of a scene's films: from a typical radiance, the lights' power
/// spread over a sphere around what is bounded. A function of the scene alone.
pub fn film_quantum(scene: &Scene) -> Quantum {
    let radius = scene
        .world
        .bounds()
        .map_or(1.0, |b| b.bounding_sphere().radius)
        .max(f64::MIN_POSITIVE);
    let area = 4.0 * PI * radius * radius;
    let typical: f64 = scene
        .lights
        .iter()
        .map(|l| match (&l.light, l.light.power()) {
            (_, Some(power)) => power.mean() / area,
            (Light::Sun(sun), None) => sun.irradiance.mean(),
            (_, None) => 0.0,
        })
        .sum();
    Quantum::for_typical(typical)
}

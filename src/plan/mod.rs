//! What a scene calls for, proved from the scene alone.
//!
//! The plan is data: it names what is simulated and what is not. It never
//! measures anything; a pilot that samples the scene cannot prove a zero.

use crate::{
    light::Light,
    scene::{Scene, Settings},
};

/// What is simulated for a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Instances that can turn light into a caustic.
    pub casters: Vec<u32>,
    /// Lights that are seen by rays which meet nothing.
    pub suns: Vec<u32>,
    /// Whether some surface lets light through in a straight line, so that
    /// shadow rays must look what they cross.
    pub straight_surfaces: bool,
    /// Whether caustic photons are traced: there are lights, casters and
    /// surfaces that can receive.
    pub caustics: bool,
    /// Whether light between diffuse surfaces is simulated.
    pub indirect: bool,
}

impl Plan {
    /// The plan of a scene rendered with `settings`.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let casters: Vec<u32> = (0u32..)
            .zip(&scene.objects)
            .filter(|(_, o)| o.material.casts_caustics())
            .map(|(i, _)| i)
            .collect();
        let receives = scene.objects.iter().any(|o| o.material.is_finite());
        Self {
            suns: (0u32..)
                .zip(&scene.lights)
                .filter(|(_, l)| matches!(l.light, Light::Sun(_)))
                .map(|(i, _)| i)
                .collect(),
            straight_surfaces: scene.objects.iter().any(|o| o.material.is_straight()),
            caustics: receives && !casters.is_empty() && !scene.lights.is_empty(),
            indirect: receives && settings.indirect && !scene.lights.is_empty(),
            casters,
        }
    }
}

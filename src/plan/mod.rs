//! What a scene calls for, proved from the scene alone.
//!
//! The plan is data: it names what is simulated and what is not. It never
//! measures anything; a pilot that samples the scene cannot prove a zero.

mod media;
mod nest;
mod starts;
mod typical;

pub use media::{MOST_MEDIA, Media};
pub use nest::{Nest, Start};
pub use starts::Starts;
pub use typical::film_quantum;

use crate::{
    light::Light,
    material::Material,
    scene::{Scene, Settings},
};

/// What is simulated for a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Bodies of clear media that may overlap; `None` if no two of them do:
    /// then what lies around a body is air.
    pub nest: Option<Nested>,
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

/// What paths need to know where bodies of clear media overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Nested {
    /// The bodies.
    pub nest: Nest,
    /// In which of them paths start.
    pub starts: Starts,
}

impl Nested {
    /// The nest of a scene; `None` if no two bodies come near each other.
    fn new(scene: &Scene) -> Option<Self> {
        let nest = Nest::of(scene);
        nest.may_overlap(&scene.world).then(|| Self {
            starts: Starts::new(scene, &nest),
            nest,
        })
    }
}

impl Plan {
    /// The plan of a scene rendered with `settings`.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let nest = Nested::new(scene);
        // A bubble of air bends light where there is water around it.
        let is_nested = |material: &Material| {
            let priority = match *material {
                Material::Dielectric { priority, .. } => priority,
                _ => None,
            };
            nest.is_some() && priority.is_some()
        };
        let casters: Vec<u32> = (0u32..)
            .zip(&scene.objects)
            .filter(|(_, o)| o.material.casts_caustics() || is_nested(&o.material))
            .map(|(i, _)| i)
            .collect();
        let receives = scene.objects.iter().any(|o| o.material.is_finite());
        Self {
            suns: (0u32..)
                .zip(&scene.lights)
                .filter(|(_, l)| matches!(l.light, Light::Sun(_)))
                .map(|(i, _)| i)
                .collect(),
            straight_surfaces: nest.is_some()
                || scene.objects.iter().any(|o| o.material.is_straight()),
            caustics: receives && !casters.is_empty() && !scene.lights.is_empty(),
            indirect: receives && settings.indirect && !scene.lights.is_empty(),
            casters,
            nest,
        }
    }
}

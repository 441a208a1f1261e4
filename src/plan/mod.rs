//! What a scene calls for, proved from the scene alone.
//!
//! The plan is data: it names what is simulated and what is not. It never
//! measures anything; a pilot that samples the scene cannot prove a zero.

mod contact;
mod judge;
mod media;
mod nest;
mod reach;
mod starts;
mod typical;
mod wall;

pub use judge::{By, Verdict, judge};
pub use media::{MOST_MEDIA, Media};
pub use nest::{Nest, Start};
pub use reach::Obstacle;
pub use starts::{Starts, extent};
pub use typical::film_quantum;

use crate::{
    built,
    light::Light,
    material::Material,
    scene::{Choice, Effect, Scene, Settings},
};

use reach::Reach;

/// What is simulated for a scene.
#[allow(
    clippy::struct_excessive_bools,
    reason = "effects are on or off, each for itself"
)]
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Bodies of clear media, if two may overlap or a clear surface may stand on
    /// an opaque one; `None` if not: then what lies around a body is air.
    pub nest: Option<Nested>,
    /// Instances that can turn light into a caustic.
    pub casters: Vec<u32>,
    /// By light: which casters its photons are aimed at.
    pub lit: Vec<Lit>,
    /// Lights that are seen by rays which meet nothing.
    pub suns: Vec<u32>,
    /// Whether some surface lets light through in a straight line, so that
    /// shadow rays must look what they cross.
    pub straight_surfaces: bool,
    /// Whether some light is seen under a solid angle, so that samples of it
    /// differ.
    pub soft_lights: bool,
    /// Whether caustic photons are traced: some light can shine on a caster
    /// and on a surface that can receive.
    pub caustics: bool,
    /// Whether light between diffuse surfaces is simulated.
    pub indirect: bool,
    /// Whether small images of sources are looked for.
    pub glints: bool,
}

/// Casters at which a light's photons are aimed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Lit {
    /// All of them.
    All,
    /// Some, or none.
    Some(Vec<u32>),
}

impl Lit {
    /// Whether a caster is among them.
    pub fn contains(&self, caster: u32) -> bool {
        match self {
            Self::All => true,
            Self::Some(some) => some.binary_search(&caster).is_ok(),
        }
    }
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
    /// The nest of a scene.
    fn new(scene: &Scene) -> Self {
        let nest = Nest::of(scene);
        Self {
            starts: Starts::new(scene, &nest),
            nest,
        }
    }
}

impl Plan {
    /// The plan of a scene rendered with `settings`: what the scene calls for,
    /// without what the user leaves out.
    pub fn new(scene: &Scene, settings: &Settings) -> Self {
        let is_off = |effect| settings.choice(effect) == Choice::Off;
        let overlap = built::NESTING && Nest::of(scene).may_overlap(&scene.world);
        let touches = || built::NESTING && contact::first_contact(scene).is_some();
        let nest = (overlap || touches()).then(|| Nested::new(scene));
        let casters = casters(scene, overlap);
        let reach = Reach::new(scene);
        let lit: Vec<Lit> = (0..scene.lights.len())
            .map(|light| {
                let free = |&c: &u32| reach.obstacle(scene, light, c).is_none();
                let some: Vec<u32> = casters.iter().copied().filter(free).collect();
                if some.len() == casters.len() {
                    Lit::All
                } else {
                    Lit::Some(some)
                }
            })
            .collect();
        let some_lit = |lit: &Lit| match lit {
            Lit::All => !casters.is_empty(),
            Lit::Some(some) => !some.is_empty(),
        };
        Self {
            suns: (0u32..)
                .zip(&scene.lights)
                .filter(|(_, l)| matches!(l.light, Light::Sun(_)) && l.light.has_extent())
                .map(|(i, _)| i)
                .collect(),
            soft_lights: scene.lights.iter().any(|l| l.light.has_extent()),
            straight_surfaces: nest.is_some()
                || scene.objects.iter().any(|o| o.material.is_straight()),
            caustics: built::CAUSTICS && lit.iter().any(some_lit) && !is_off(Effect::Caustics),
            indirect: built::INDIRECT
                && judge::between_diffuse(scene).is_ok()
                && !is_off(Effect::Indirect),
            glints: built::GLINTS && judge::glinting(scene).is_ok() && !is_off(Effect::Glints),
            casters,
            lit,
            nest,
        }
    }

    /// The plan with everything worked out that the user has forced on; `None`
    /// if that is nothing.
    #[must_use]
    pub fn forced(&self, scene: &Scene, settings: &Settings) -> Option<Self> {
        let is_on = |effect| settings.choice(effect) == Choice::On;
        Effect::ALL.into_iter().any(is_on).then(|| {
            let nest = match &self.nest {
                None if is_on(Effect::Nesting) => Some(Nested::new(scene)),
                nest => nest.clone(),
            };
            Self {
                straight_surfaces: self.straight_surfaces || nest.is_some() || is_on(Effect::Panes),
                caustics: self.caustics || is_on(Effect::Caustics),
                indirect: self.indirect || is_on(Effect::Indirect),
                glints: self.glints || is_on(Effect::Glints),
                nest,
                ..self.clone()
            }
        })
    }

    /// The bodies, if any may overlap or touch. This and the other questions of
    /// paths are answered when compiling in a build that lacks the effect.
    #[inline]
    pub fn nest(&self) -> Option<&Nested> {
        self.nest.as_ref().filter(|_| built::NESTING)
    }

    /// Whether shadow rays must look what they cross.
    #[inline]
    pub fn straight_surfaces(&self) -> bool {
        (built::PANES || built::NESTING) && self.straight_surfaces
    }

    /// Whether some light is seen under a solid angle.
    #[inline]
    pub fn soft_lights(&self) -> bool {
        built::SOFT_SHADOWS && self.soft_lights
    }

    /// Whether caustic photons are traced.
    #[inline]
    pub fn caustics(&self) -> bool {
        built::CAUSTICS && self.caustics
    }

    /// Whether light between diffuse surfaces is simulated.
    #[inline]
    pub fn indirect(&self) -> bool {
        built::INDIRECT && self.indirect
    }

    /// Whether small images of sources are looked for.
    #[inline]
    pub fn glints(&self) -> bool {
        built::GLINTS && self.glints
    }

    /// The lights' casters that the plan has proved to be none: what is aimed
    /// at where caustics are forced on.
    #[must_use]
    pub fn unlit(&self) -> Vec<Lit> {
        let rest = |lit: &Lit| {
            let rest = self.casters.iter().copied();
            Lit::Some(rest.filter(|&c| !lit.contains(c)).collect())
        };
        self.lit.iter().map(rest).collect()
    }

    /// Why a light's photons make no caustic by way of a caster; `None` if
    /// they may.
    pub fn obstacle(scene: &Scene, light: usize, caster: u32) -> Option<Obstacle> {
        Reach::new(scene).obstacle(scene, light, caster)
    }
}

/// Instances that can turn light into a caustic.
fn casters(scene: &Scene, nested: bool) -> Vec<u32> {
    // A bubble of air bends light where there is water around it.
    let is_nested = |material: &Material| {
        let priority = match *material {
            Material::Dielectric { priority, .. } => priority,
            _ => None,
        };
        nested && priority.is_some()
    };
    (0u32..)
        .zip(&scene.objects)
        .filter(|(_, o)| o.material.casts_caustics() || is_nested(&o.material))
        .map(|(i, _)| i)
        .collect()
}

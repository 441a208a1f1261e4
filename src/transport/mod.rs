//! The shared core of both passes: how light goes on at a specular surface,
//! whether a shadow ray arrives, what a light sends to a point.
//!
//! Which estimator owns which paths is written in `docs/light-transport.md`;
//! in short: chains of delta steps between the eye and a light are the camera
//! walk's, a light seen directly from a finite lobe is the shadow ray's, and
//! light that was reflected or bent before it reached a finite lobe is the
//! photon map's. *Bent* is the word for that here: passing a thin pane or an
//! index-matched surface in a straight line does not bend.
//!
//! A path knows the bodies of clear media in which it is ([`Media`]), and finds
//! surfaces through [`meet()`] alone, which passes those that are hidden in a
//! body of higher rank. Where no two bodies come near each other the list is
//! empty and nobody reads it.
//!
//! [`Media`]: crate::plan::Media

pub mod differential;
pub mod direct;
pub mod meet;
pub mod shadow;
pub mod specular;
pub mod walk;

pub use differential::{Bend, Differential, Pair};
pub use direct::{DiffusePoint, LightPicker, direct_by_extent, direct_light, from_light};
pub(crate) use meet::meet_in;
pub use meet::{Met, media_beside, meet};
pub use shadow::transmittance;
pub use specular::{Carried, Lobe, Lobes, Ways, lobes};
pub use walk::{End, Walker};

use crate::{plan::Plan, scene::Scene};

/// What every path of a render may look at.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What is simulated.
    pub plan: &'a Plan,
    /// Which lights get shadow rays where there are many.
    pub picker: &'a LightPicker,
    /// Longest chain of surface interactions.
    pub max_depth: u32,
}

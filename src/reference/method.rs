//! The names of the methods, and what each cannot see.

use crate::{
    camera::Projection,
    light::Light,
    material::Material,
    scene::{NamedLight, Scene},
};

/// A reference method. Which paths each owns is said at the head of its file
/// and in `docs/light-transport.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// Path tracing from the eye.
    Path,
    /// Light tracing with connections to the eye.
    Light,
    /// Light tracing through a finite pinhole.
    LightNaive,
    /// Whitted's recursive ray tracing.
    Whitted,
    /// Bidirectional path tracing.
    Bdpt,
    /// Metropolis light transport in primary sample space.
    Metropolis,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 6] = [
        Self::Path,
        Self::Light,
        Self::LightNaive,
        Self::Whitted,
        Self::Bdpt,
        Self::Metropolis,
    ];

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Light => "light",
            Self::LightNaive => "light-naive",
            Self::Whitted => "whitted",
            Self::Bdpt => "bdpt",
            Self::Metropolis => "metropolis",
        }
    }

    /// What it does, in a few words.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Path => "path tracing from the eye, light sampling and MIS",
            Self::Light => "paths from the lights, connected to the eye",
            Self::LightNaive => "paths from the lights through a finite pinhole",
            Self::Whitted => "recursive ray tracing, hard shadows",
            Self::Bdpt => "bidirectional path tracing with MIS",
            Self::Metropolis => "Metropolis light transport on bdpt's paths",
        }
    }

    /// What of this scene the method cannot see, one sentence each.
    pub fn blind_spots(self, scene: &Scene) -> Vec<String> {
        let facts = Facts::of(scene);
        let mut notes = Vec::new();
        let mut note = |text: String| notes.push(format!("method {}: {text}", self.name()));
        match self {
            Self::Path if facts.caustics => {
                if let Some(names) = facts.without_extent {
                    note(format!(
                        "caustics of {names} are missing: no path can hit a light without extent"
                    ));
                }
            }
            Self::Light => {
                if facts.specular {
                    note("what mirrors and glass show is black: only diffuse surfaces can be connected to the eye".to_owned());
                }
                if facts.shines {
                    note("lights themselves are not seen".to_owned());
                }
                let is_sun = |l: &NamedLight| matches!(l.light, Light::Sun(_));
                if scene.lights.iter().any(is_sun) {
                    note("the sun lights only what lies in the shadow of the sphere around all bounded objects".to_owned());
                }
            }
            Self::LightNaive => {
                if scene.camera.projection() == Projection::Orthographic {
                    note(
                        "an orthographic camera has no pinhole: the picture stays black".to_owned(),
                    );
                } else {
                    note("the picture is blurred by the pinhole".to_owned());
                }
            }
            Self::Whitted => {
                if facts.caustics {
                    note("caustics are missing".to_owned());
                }
                note("light between diffuse surfaces is missing, shadows are hard".to_owned());
            }
            Self::Bdpt | Self::Metropolis if facts.caustics => {
                if let Some(names) = facts.without_extent {
                    note(format!(
                        "caustics of {names}, where seen in mirrors or glass, are missing"
                    ));
                }
            }
            Self::Path | Self::Bdpt | Self::Metropolis => {}
        }
        notes
    }
}

/// What decides on what methods see.
struct Facts {
    caustics: bool,
    specular: bool,
    shines: bool,
    /// Names of the lights without extent.
    without_extent: Option<String>,
}

impl Facts {
    fn of(scene: &Scene) -> Self {
        let any = |f: fn(&Material) -> bool| scene.objects.iter().any(|o| f(&o.material));
        let names: Vec<&str> = scene
            .lights
            .iter()
            .filter(|l| !l.light.has_extent())
            .map(|l| l.name.as_str())
            .collect();
        Self {
            caustics: any(Material::casts_caustics) && any(Material::is_finite),
            specular: any(|m| m.is_specular() && !m.is_straight()),
            shines: scene.lights.iter().any(|l| l.light.has_extent()),
            without_extent: (!names.is_empty()).then(|| names.join(", ")),
        }
    }
}

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
    /// The first photon map.
    PhotonMap,
    /// Stochastic progressive photon mapping.
    Sppm,
    /// Finite elements.
    Radiosity,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 9] = [
        Self::Path,
        Self::Light,
        Self::LightNaive,
        Self::Whitted,
        Self::Bdpt,
        Self::Metropolis,
        Self::PhotonMap,
        Self::Sppm,
        Self::Radiosity,
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
            Self::PhotonMap => "photon-map",
            Self::Sppm => "sppm",
            Self::Radiosity => "radiosity",
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
            Self::PhotonMap => "the first photon map: nearest photons, one map",
            Self::Sppm => "stochastic progressive photon mapping",
            Self::Radiosity => "finite elements, for diffuse surfaces",
        }
    }

    /// Whether a pass has a number of paths from the lights that can be
    /// chosen ([`Settings::photons`](crate::scene::Settings::photons)). The
    /// other methods start no path at a light, or one for each path from the
    /// eye.
    pub const fn has_light_paths(self) -> bool {
        match self {
            Self::Light | Self::LightNaive | Self::PhotonMap | Self::Sppm | Self::Radiosity => true,
            Self::Path | Self::Whitted | Self::Bdpt | Self::Metropolis => false,
        }
    }

    /// Whether a pass depends on those before it.
    pub const fn remembers(self) -> bool {
        matches!(self, Self::PhotonMap | Self::Sppm)
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
                if has_sun(scene) {
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
            Self::PhotonMap | Self::Sppm => {
                if has_sun(scene) {
                    note("what the sun sends by way of other surfaces is missing where its light first meets one beyond the shadow of the sphere around all bounded objects".to_owned());
                }
                note(if self == Self::Sppm {
                    "the picture is blurred by circles that shrink from pass to pass".to_owned()
                } else {
                    "the picture is blurred by circles that only more photons make smaller"
                        .to_owned()
                });
            }
            Self::Radiosity => {
                if facts.specular {
                    note("mirrors and glass are black, and the light that comes by way of them is missing".to_owned());
                }
                if has_sun(scene) {
                    note("indirect light of the sun is missing where its light falls beyond the shadow of the sphere around all bounded objects".to_owned());
                }
            }
            Self::Path | Self::Bdpt | Self::Metropolis => {}
        }
        notes
    }
}

fn has_sun(scene: &Scene) -> bool {
    let is_sun = |l: &NamedLight| matches!(l.light, Light::Sun(_));
    scene.lights.iter().any(is_sun)
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

//! How surfaces scatter light.
//!
//! A closed set: whatever a scene file can name is a variant here. Lobes are
//! classed, not surfaces: [`Material::is_specular`] asks whether all lobes
//! are delta functions (light follows one or two directions), otherwise the
//! lobe is finite and light can be gathered there.

use crate::{built, spectrum::Rgb};

/// A surface's scattering, validated: reflectances lie in `[0, 1]`, indices
/// are above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Two-sided Lambertian reflection, `f = reflectance / pi`.
    Diffuse {
        /// Fraction of the light reflected, per channel.
        reflectance: Rgb,
    },
    /// Perfect mirror on both sides.
    Mirror {
        /// Fraction of the light reflected, per channel and independent of
        /// the angle.
        reflectance: Rgb,
    },
    /// Smooth interface between two clear media. One lies on the side away
    /// from the geometric normal.
    Dielectric {
        /// Index of refraction behind the surface over the one in front of
        /// it, as the surface by itself says. The index of the medium where
        /// that is a body: what is around it has index 1, or is another body.
        ior: f64,
        /// A pane: both interfaces of a thin parallel slab in one surface.
        /// Light passes straight through or is reflected.
        thin: bool,
        /// The surface is that of a body, and this says whose medium is there
        /// where bodies overlap: that of the higher number. `None` for panes,
        /// open surfaces, and those that state both of their media.
        priority: Option<i8>,
    },
    /// Absorbs everything: the body of a light source.
    Black,
}

impl Material {
    /// The same surface with another index behind it over the one in front;
    /// of a material without index itself.
    #[must_use]
    pub fn with_index(self, ior: f64) -> Self {
        match self {
            Self::Dielectric { thin, priority, .. } => Self::Dielectric {
                ior,
                thin,
                priority,
            },
            other => other,
        }
    }

    /// The material as far as this build has what it needs: black if not.
    #[must_use]
    pub(crate) fn as_built(self) -> Self {
        let is_there = match self {
            Self::Mirror { .. } => built::MIRRORS,
            Self::Dielectric { .. } if self.is_straight() => built::PANES,
            Self::Dielectric { .. } => built::REFRACTION,
            Self::Diffuse { .. } | Self::Black => true,
        };
        if is_there { self } else { Self::Black }
    }

    /// Whether all lobes are delta functions and there is at least one.
    pub fn is_specular(&self) -> bool {
        matches!(self, Self::Mirror { .. } | Self::Dielectric { .. })
    }

    /// Whether light can be received at a finite lobe.
    pub fn is_finite(&self) -> bool {
        matches!(self, Self::Diffuse { .. })
    }

    /// Whether no light passes.
    pub fn is_opaque(&self) -> bool {
        !matches!(self, Self::Dielectric { .. })
    }

    /// Whether light passes in a straight line, so that shadow rays do too:
    /// a thin pane, or an interface with equal indices on both sides. Of a
    /// body this holds as long as it touches no other one.
    pub fn is_straight(&self) -> bool {
        match *self {
            Self::Dielectric { ior, thin, .. } => thin || ior == 1.0,
            _ => false,
        }
    }

    /// Whether the surface can turn light into a caustic: it reflects or
    /// bends at least some of it, as long as it touches no other body.
    pub fn casts_caustics(&self) -> bool {
        match *self {
            Self::Mirror { reflectance } => !reflectance.is_black(),
            Self::Dielectric { ior, .. } => ior != 1.0,
            Self::Diffuse { .. } | Self::Black => false,
        }
    }
}

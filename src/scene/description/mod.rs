//! The mirror of a scene file: what was written, before it means anything.
//!
//! The leaves of the language (a shape, a material, a light, ...) are serde
//! types that refuse unknown fields. The containers (the scene itself, lists,
//! maps, objects) are walked along the outline instead, so that every part is
//! read on its own and several mistakes are found in one go; each part keeps
//! its [`NodeId`] so that later checks can point at it.

mod curved;
mod height_field;
mod implicit;
mod light;
mod mesh;
mod shape;
mod solid;
mod transform;
mod value;

use serde::Deserialize;

pub use super::effect::EffectsDescription;
use super::{Guidance, Kernel, Sampler, outline::NodeId};

pub use curved::{
    BoxShape, ConeShape, EllipsoidShape, HyperboloidShape, ParaboloidShape, QuadricShape,
    TorusShape,
};
pub use height_field::HeightField;
pub use implicit::{ImplicitShape, MethodDescription};
pub use light::{
    DirectionalLight, DiscLight, LightDescription, PointLight, QuadLight, SphereLight, SpotLight,
};
pub use mesh::{Cells, MeshFields, MeshSource, Smooth, TorusKnot, Wave, Waves};
pub use shape::{
    CylinderShape, DiscShape, PlaneShape, QuadShape, ShapeDescription, SphereShape, TriangleShape,
};
pub use solid::{LensShape, Operand, SolidShape};
pub use transform::{Rotation, Rotations, Scale, Steps, TransformStep};
pub use value::{Colour, Number, Pair, Triple};

/// A part of the scene and where it stands.
#[derive(Clone, Debug)]
pub struct Part<T> {
    /// The part's value in the outline.
    pub node: NodeId,
    /// What it says.
    pub value: T,
}

/// Everything a scene file says, as far as it could be read: what could not
/// is missing here and has been reported.
#[derive(Clone, Debug, Default)]
pub struct Description {
    /// The view.
    pub camera: Option<Part<CameraDescription>>,
    /// The picture.
    pub image: Option<Part<ImageDescription>>,
    /// Materials by name; `None` for one that could not be read.
    pub materials: Vec<(String, Part<Option<MaterialDescription>>)>,
    /// Meshes by name; `None` for one that could not be read.
    pub meshes: Vec<(String, Part<Option<MeshSource>>)>,
    /// The objects, in order; parts of an object may be missing.
    pub objects: Vec<Part<ObjectDescription>>,
    /// The lights, in order; `None` for one that could not be read.
    pub lights: Vec<Part<Option<LightDescription>>>,
    /// How to render.
    pub render: Option<Part<RenderDescription>>,
}

/// `camera: (eye: .., look_at: .., fov: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Camera")]
pub struct CameraDescription {
    /// Position in metres.
    pub eye: Triple,
    /// A point in the middle of the picture.
    pub look_at: Triple,
    /// Direction that is up in the picture.
    #[serde(default = "z_axis")]
    pub up: Triple,
    /// Vertical field of view in degrees: a perspective camera.
    pub fov: Option<Number>,
    /// Height of the film in metres: an orthographic camera.
    pub height: Option<Number>,
    /// Name of the body in which the camera stands.
    pub medium: Option<String>,
}

fn z_axis() -> Triple {
    Triple([0.0, 0.0, 1.0])
}

/// `image: (width: .., height: ..)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Image")]
pub struct ImageDescription {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Exposure of the PNG in stops.
    pub exposure: Option<Number>,
    /// The pixel filter.
    #[serde(default)]
    pub filter: Filter,
}

/// How a pixel averages the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename = "filter")]
pub enum Filter {
    /// The mean over the pixel's own square.
    #[default]
    Box,
    /// A normal distribution about the pixel's centre.
    Gaussian,
    /// The Blackman-Harris window about the pixel's centre.
    BlackmanHarris,
}

/// A material as written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "material")]
pub enum MaterialDescription {
    /// Two-sided Lambertian reflection.
    Diffuse {
        /// Fraction reflected.
        reflectance: Colour,
    },
    /// Perfect mirror.
    Mirror {
        /// Fraction reflected.
        #[serde(default = "Colour::white")]
        reflectance: Colour,
    },
    /// Smooth interface of a clear medium.
    Dielectric {
        /// Index of refraction.
        ior: Number,
        /// Index in front of the surface: it states both of its media.
        outside: Option<Number>,
        /// Whose medium is there where bodies overlap.
        priority: Option<Number>,
        /// A pane with both its interfaces.
        #[serde(default)]
        thin: bool,
    },
}

/// What an object's `material` field says.
#[derive(Clone, Debug)]
pub enum MaterialChoice {
    /// The name of an entry of `materials`.
    Named(String),
    /// A material written in place.
    Inline(MaterialDescription),
}

/// An object's `materials`: names in a mesh file and what they stand for;
/// `None` for one that could not be read.
pub type PartMaterials = Part<Vec<(String, Part<Option<MaterialChoice>>)>>;

/// One entry of `objects`; a part that could not be read is `None`.
#[derive(Clone, Debug)]
pub struct ObjectDescription {
    /// Name in messages and reports.
    pub name: Option<String>,
    /// The surface.
    pub shape: Option<Part<ShapeDescription>>,
    /// How it scatters.
    pub material: Option<Part<MaterialChoice>>,
    /// How the parts of a mesh scatter, by the names that its file has.
    pub materials: Option<PartMaterials>,
    /// Steps that place the shape, in order, and where they stand.
    pub at: Option<Part<Vec<Part<TransformStep>>>>,
    /// Whether a refracting surface is meant not to enclose anything.
    pub open: bool,
}

/// `render: (..)`: how to render.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Render")]
pub struct RenderDescription {
    /// Number of passes.
    pub passes: Option<u32>,
    /// Seed of all random numbers.
    pub seed: Option<u64>,
    /// Photon paths per pass.
    pub photons: Option<u64>,
    /// Kernel radius of the first round in pixel footprints.
    pub radius: Option<Number>,
    /// The points at which photons and camera look.
    #[serde(default)]
    pub sampler: Sampler,
    /// The area over which a photon's light is spread.
    #[serde(default)]
    pub kernel: Kernel,
    /// What decides where photons and shadow rays go.
    #[serde(default)]
    pub guidance: Guidance,
    /// Whether light between diffuse surfaces is simulated.
    pub indirect: Option<bool>,
    /// What the user says about effects.
    pub effects: Option<EffectsDescription>,
    /// Longest chain of surface interactions.
    pub max_depth: Option<u32>,
    /// Memory of the film and of a pass's photons.
    pub memory: Option<Memory>,
}

/// Bytes, or a text such as `"512 MiB"`.
#[derive(Clone, Debug, Deserialize)]
#[serde(from = "value::NumberOrText")]
pub enum Memory {
    /// A number of bytes.
    Bytes(f64),
    /// A number with a unit.
    Text(String),
}

impl From<value::NumberOrText> for Memory {
    fn from(v: value::NumberOrText) -> Self {
        match v {
            value::NumberOrText::Number(n) => Self::Bytes(n),
            value::NumberOrText::Text(t) => Self::Text(t),
        }
    }
}

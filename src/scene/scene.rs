//! The scene as the renderer sees it: immutable, validated, indexed.

use crate::{
    camera::{Camera, Filter},
    geometry::{SurfaceId, World},
    light::Light,
    material::Material,
};

use super::{input::Input, settings::Settings};

/// What hangs on an instance of the world with the same index.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name from the scene file, or one made from the list and the index
    /// (`objects[2]`, `lights[0]`).
    pub name: String,
    /// How the surface scatters.
    pub material: Material,
    /// Index into [`Scene::lights`] if the surface emits.
    pub light: Option<u32>,
}

/// A light source and its name in messages.
#[derive(Clone, Debug)]
pub struct NamedLight {
    /// Name from the scene file or `lights[0]`.
    pub name: String,
    /// The source itself.
    pub light: Light,
    /// Index of the instance that shows the light, for shapes.
    pub instance: Option<u32>,
}

/// Everything that does not change while rendering.
#[derive(Debug)]
pub struct Scene {
    /// Geometry and acceleration structures.
    pub world: World,
    /// One entry per instance of the world.
    pub objects: Vec<Object>,
    /// All light sources.
    pub lights: Vec<NamedLight>,
    /// The view.
    pub camera: Camera,
    /// The instance of the body in which the scene says that the camera
    /// stands; `None` where that is to be found.
    pub camera_medium: Option<u32>,
    /// Image width and height in pixels.
    pub resolution: [u32; 2],
    /// How a pixel averages the picture.
    pub filter: Filter,
    /// What the file's `render` block says, defaults filled in.
    pub settings: Settings,
    /// The files the scene was made from: its own, then those it names, in the
    /// order in which they were read.
    pub inputs: Vec<Input>,
}

impl Scene {
    /// The object whose surface was met.
    #[inline]
    pub fn object(&self, surface: SurfaceId) -> &Object {
        &self.objects[surface.instance as usize]
    }
}

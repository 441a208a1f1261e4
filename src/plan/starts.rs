//! In which bodies of clear media the camera and the lights stand.

use crate::{
    geometry::BoundingSphere,
    light::Light,
    scene::{NamedLight, Scene},
};

use super::{Nest, Start};

/// In which bodies paths start.
#[derive(Clone, Debug, PartialEq)]
pub struct Starts {
    /// Those of the camera.
    pub camera: Start,
    /// Those of each light.
    pub lights: Vec<Start>,
}

impl Starts {
    /// Looks where the camera and the lights of a scene stand.
    pub fn new(scene: &Scene, nest: &Nest) -> Self {
        let world = &scene.world;
        let eye = scene.camera.eye();
        let stated = scene.camera_medium.and_then(|i| nest.rank(i));
        let camera = match (stated, scene.camera.film_normal()) {
            (Some(rank), _) => Start::inside(rank),
            (None, Some(normal)) => nest.start_on_plane(world, eye, normal),
            (None, None) => nest.start(world, &at(eye)),
        };
        let light = |light: &NamedLight| match extent(scene, light) {
            Some(sphere) => nest.start(world, &sphere),
            None => Start::default(),
        };
        Self {
            camera,
            lights: scene.lights.iter().map(light).collect(),
        }
    }
}

fn at(center: glam::DVec3) -> BoundingSphere {
    BoundingSphere {
        center,
        radius: 0.0,
    }
}

/// A sphere around all points from which a light's photons start; `None` for
/// a sun, whose photons start before everything.
pub fn extent(scene: &Scene, light: &NamedLight) -> Option<BoundingSphere> {
    match &light.light {
        Light::Point(l) => Some(at(l.position)),
        Light::Spot(l) => Some(at(l.position)),
        Light::Beam(l) => Some(BoundingSphere {
            center: l.center,
            radius: l.radius,
        }),
        Light::Sun(_) => None,
        Light::Sphere(_) | Light::Quad(_) | Light::Disc(_) => {
            light.instance.and_then(|i| scene.world.instance_sphere(i))
        }
    }
}

//! Opaque surfaces that keep light apart: what lies in them or behind them,
//! and what does not.

use crate::{
    geometry::World,
    light::Light,
    material::Material,
    scene::{NamedLight, Scene},
};

use super::starts::extent;

/// Most surfaces that are asked; of more, the largest. Each is asked about every
/// light and object.
const MOST: usize = 32;

/// A surface that encloses something, or a plane, and the sides of it on which
/// things lie: `None` where that is not sure.
#[derive(Clone, Debug)]
struct Wall {
    instance: u32,
    objects: Vec<Option<bool>>,
    lights: Vec<Option<bool>>,
}

/// The walls of a scene that have something on both sides.
#[derive(Clone, Debug)]
pub(super) struct Walls(Vec<Wall>);

impl Walls {
    /// Looks for walls.
    pub(super) fn new(scene: &Scene) -> Self {
        let opaque = |m: &Material| !matches!(m, Material::Dielectric { .. });
        let world = &scene.world;
        let mut found: Vec<(u32, f64)> = (0u32..)
            .zip(&scene.objects)
            .filter(|(_, o)| opaque(&o.material))
            .map(|(i, _)| {
                (
                    i,
                    world.instance_sphere(i).map_or(f64::INFINITY, |s| s.radius),
                )
            })
            .collect();
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        found.truncate(MOST);
        Self(
            found
                .into_iter()
                .map(|(instance, _)| Wall {
                    instance,
                    objects: (0u32..)
                        .zip(&scene.objects)
                        .map(|(i, _)| side_of_object(world, instance, i))
                        .collect(),
                    lights: scene
                        .lights
                        .iter()
                        .map(|light| side_of_light(scene, instance, light))
                        .collect(),
                })
                .filter(|wall| {
                    let sides = wall.objects.iter().chain(&wall.lights);
                    let mut sides = sides.flatten();
                    sides.next().is_some_and(|first| sides.any(|s| s != first))
                })
                .collect(),
        )
    }

    /// The wall that stands between a light and an object, if any: no straight
    /// or broken way leads from one to the other.
    pub(super) fn between(&self, light: usize, object: u32) -> Option<u32> {
        let parts = |wall: &&Wall| {
            let (light, object) = (wall.lights[light], wall.objects[object as usize]);
            light.is_some() && object.is_some() && light != object
        };
        self.0.iter().find(parts).map(|wall| wall.instance)
    }
}

fn side_of_object(world: &World, wall: u32, object: u32) -> Option<bool> {
    match (world.instance_sphere(object), world.instance_sphere(wall)) {
        (Some(sphere), _) => world.side(wall, &sphere),
        // What has no end lies outside of what it does not cross.
        (None, Some(around)) => world.side(object, &around).map(|_| false),
        (None, None) => None,
    }
}

fn side_of_light(scene: &Scene, wall: u32, light: &NamedLight) -> Option<bool> {
    let world = &scene.world;
    match (&light.light, extent(scene, light)) {
        (Light::Sun(sun), _) => world.side_of_infinity(wall, -sun.axis, sun.sin_half),
        (_, Some(sphere)) => world.side(wall, &sphere),
        (_, None) => None,
    }
}

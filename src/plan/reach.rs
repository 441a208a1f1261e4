//! Which casters a light can shine on, and why not the others.

use glam::DVec3;

use crate::{
    geometry::BoundingSphere,
    light::Light,
    numeric::{gamma, trig},
    scene::Scene,
};

use super::wall::Walls;

/// Why no photon of a light ever makes a caustic by way of a caster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// Nothing in the scene can receive it.
    NoReceiver,
    /// The caster lies outside of the light's cone.
    Cone,
    /// The caster lies behind the face that shines.
    Face,
    /// The caster lies beside the beam, or behind where it begins.
    Beam,
    /// This instance keeps light and caster apart.
    Wall(u32),
    /// This instance keeps the light apart from all diffuse surfaces.
    Walled(u32),
}

/// The proofs that need every object to be looked at.
#[derive(Clone, Debug)]
pub(super) struct Reach {
    walls: Walls,
    /// By light: what keeps it from all receivers.
    dark: Vec<Option<Obstacle>>,
}

impl Reach {
    /// Looks at a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let walls = Walls::new(scene);
        let receivers: Vec<u32> = (0u32..)
            .zip(&scene.objects)
            .filter(|(_, o)| o.material.is_finite())
            .map(|(i, _)| i)
            .collect();
        let dark = |light: usize| {
            let mut first = Obstacle::NoReceiver;
            for (k, &receiver) in receivers.iter().enumerate() {
                let wall = walls.between(light, receiver)?;
                if k == 0 {
                    first = Obstacle::Walled(wall);
                }
            }
            Some(first)
        };
        Self {
            dark: (0..scene.lights.len()).map(dark).collect(),
            walls,
        }
    }

    /// Why a light's photons make no caustic by way of a caster; `None` if
    /// they may.
    pub(super) fn obstacle(&self, scene: &Scene, light: usize, caster: u32) -> Option<Obstacle> {
        self.dark[light]
            .or_else(|| {
                let sphere = scene.world.instance_sphere(caster)?;
                beside(&scene.lights[light].light, &sphere)
            })
            .or_else(|| self.walls.between(light, caster).map(Obstacle::Wall))
    }
}

/// Why no light of this source can reach a sphere in a straight line, by the
/// shape of its emission alone.
fn beside(light: &Light, sphere: &BoundingSphere) -> Option<Obstacle> {
    // Differences, products and roots round; a caster that is touched by less
    // is none that would be missed, but it is kept.
    let slack = gamma(64) * (sphere.center.abs().max_element() + sphere.radius);
    let behind = |p: DVec3, n: DVec3| {
        (sphere.center - p).dot(n) <= -sphere.radius - slack - gamma(64) * p.abs().max_element()
    };
    match light {
        Light::Point(_) | Light::Sphere(_) | Light::Sun(_) => None,
        Light::Spot(l) => {
            let to = sphere.center - l.position;
            let d = to.length();
            if d <= sphere.radius {
                return None;
            }
            // Angles add: apart by more than both half-angles.
            let angle = |cos: f64| trig::acos(cos.clamp(-1.0, 1.0));
            let apart = angle(to.dot(l.axis) / d);
            let sin = sphere.radius / d;
            let reach = angle((1.0 - sin * sin).max(0.0).sqrt()) + angle(l.cos_outer);
            // The arc cosine makes a square root of an error near its ends.
            (apart > reach + gamma(64).sqrt()).then_some(Obstacle::Cone)
        }
        Light::Quad(l) => behind(l.corner, l.normal()).then_some(Obstacle::Face),
        Light::Disc(l) => behind(l.center, l.normal).then_some(Obstacle::Face),
        Light::Beam(l) => {
            let f = sphere.center - l.center;
            let across = (f - l.axis * f.dot(l.axis)).length();
            let wide = sphere.radius + l.radius + slack + gamma(64) * l.center.abs().max_element();
            (behind(l.center, l.axis) || across > wide).then_some(Obstacle::Beam)
        }
    }
}

impl Obstacle {
    /// In words, of a light and a caster.
    pub fn words(self, scene: &Scene, light: usize, caster: u32) -> String {
        let name = |i: u32| format!("`{}`", scene.objects[i as usize].name);
        let (light, caster) = (format!("`{}`", scene.lights[light].name), name(caster));
        match self {
            Self::NoReceiver => "no surface is diffuse: nothing can receive a caustic".to_owned(),
            Self::Cone => format!("{caster} lies outside of the cone of {light}"),
            Self::Face => format!("{caster} lies behind the face of {light} that shines"),
            Self::Beam => format!("the beam of {light} passes {caster} by"),
            Self::Wall(wall) => format!("{} stands between {light} and {caster}", name(wall)),
            Self::Walled(wall) => {
                format!("{} keeps {light} from all diffuse surfaces", name(wall))
            }
        }
    }
}

//! The verdict on every effect, with its reason in a sentence.
//!
//! One arm an effect: what in the scene calls for it, or why nothing does.

use crate::{
    built,
    geometry::{BoundingSphere, Shape},
    light::Light,
    material::Material,
    scene::{Choice, Effect, NamedLight, Object, Scene, Settings},
};

use super::{Nest, contact::first_contact, extent, reach::Reach};

/// Who has decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// The scene, by proof.
    Scene,
    /// The user.
    User,
}

/// Whether an effect is simulated, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// The effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub on: bool,
    /// Who has decided.
    pub by: By,
    /// Whether the scene calls for it, whatever the user says.
    pub called_for: bool,
    /// The reason: what in the scene calls for it, or why nothing can.
    pub why: String,
}

/// The verdicts on all effects of a scene rendered with `settings`.
pub fn judge(scene: &Scene, settings: &Settings) -> Vec<Verdict> {
    Effect::ALL
        .into_iter()
        .map(|effect| {
            let proof = proof(effect, scene);
            let called_for = proof.is_ok();
            let (Ok(why) | Err(why)) = proof;
            let (on, by) = match settings.choice(effect) {
                _ if !built::has(effect.name()) => (false, By::User),
                Choice::Auto => (called_for, By::Scene),
                Choice::Off if !called_for => (false, By::Scene),
                Choice::Off => (false, By::User),
                Choice::On if called_for => (true, By::Scene),
                Choice::On => (true, By::User),
            };
            Verdict {
                effect,
                on,
                by,
                called_for,
                why,
            }
        })
        .collect()
}

/// What calls for an effect, or why nothing does.
fn proof(effect: Effect, scene: &Scene) -> Result<String, String> {
    match effect {
        Effect::Sources => {
            let found = first_light(scene, is_visible);
            found
                .map(|l| format!("`{}` can be seen", l.name))
                .ok_or_else(|| "no light has a surface or a disc that could be seen".to_owned())
        }
        Effect::HardShadows => shadows(scene, false),
        Effect::SoftShadows => shadows(scene, true),
        Effect::Caustics => caustics(scene),
        Effect::Indirect => between_diffuse(scene),
        Effect::Mirrors => object(
            scene,
            |m| matches!(m, Material::Mirror { reflectance } if !reflectance.is_black()),
            |name| format!("{name} is a mirror"),
            "no object is a mirror",
        ),
        Effect::Refraction => object(
            scene,
            |m| matches!(m, Material::Dielectric { thin: false, ior, .. } if *ior != 1.0),
            |name| format!("{name} bends light"),
            "no object is of glass, water or the like",
        ),
        Effect::TotalReflection => total_reflection(scene),
        Effect::Panes => object(
            scene,
            Material::is_straight,
            |name| format!("{name} lets light through in a straight line"),
            "no object is a thin pane or has the index of its surroundings",
        ),
        Effect::Nesting => {
            let nest = Nest::of(scene);
            let name = |i: u32| format!("`{}`", scene.objects[i as usize].name);
            match nest.first_overlap(&scene.world) {
                Some([a, b]) => Ok(format!("{} and {} may overlap", name(a), name(b))),
                None => match first_contact(scene) {
                    Some([a, b]) => Ok(format!("{} may stand on {}", name(a), name(b))),
                    None => Err("no body of a clear medium touches another object".to_owned()),
                },
            }
        }
        Effect::ShadingNormals => {
            let smooth = |shape: &Shape| matches!(shape, Shape::Mesh(m) if m.is_smooth());
            let mut all = scene.world.instances().iter().zip(&scene.objects);
            all.find(|(i, _)| smooth(&i.shape))
                .map(|(_, o)| format!("`{}` has normals that are interpolated", o.name))
                .ok_or_else(|| "no mesh is smooth".to_owned())
        }
        Effect::Glints => glinting(scene),
    }
}

/// The first object whose material is meant, in a sentence; or another one.
fn object(
    scene: &Scene,
    is_meant: impl Fn(&Material) -> bool,
    words: impl Fn(&str) -> String,
    otherwise: &str,
) -> Result<String, String> {
    first(scene, is_meant)
        .map(|o| words(&format!("`{}`", o.name)))
        .ok_or_else(|| otherwise.to_owned())
}

fn first(scene: &Scene, is_meant: impl Fn(&Material) -> bool) -> Option<&Object> {
    scene.objects.iter().find(|o| is_meant(&o.material))
}

fn first_light(scene: &Scene, is_meant: impl Fn(&Light) -> bool) -> Option<&NamedLight> {
    scene.lights.iter().find(|l| is_meant(&l.light))
}

/// Whether a light can be met by a ray.
fn is_visible(light: &Light) -> bool {
    light.has_extent()
}

const NO_LIGHT: &str = "there is no light";
const NO_DIFFUSE: &str = "no surface is diffuse";

fn shadows(scene: &Scene, soft: bool) -> Result<String, String> {
    if first(scene, Material::is_finite).is_none() {
        return Err(format!(
            "{NO_DIFFUSE}: there is nothing for a shadow to fall on"
        ));
    }
    if scene.lights.is_empty() {
        return Err(NO_LIGHT.to_owned());
    }
    match first_light(scene, |l| l.has_extent() == soft) {
        Some(l) if soft => Ok(format!("`{}` has an extent", l.name)),
        Some(l) => Ok(format!("`{}` has no extent", l.name)),
        None if soft => Err("no light has an extent".to_owned()),
        None => Err("every light has an extent".to_owned()),
    }
}

fn caustics(scene: &Scene) -> Result<String, String> {
    if scene.lights.is_empty() {
        return Err(NO_LIGHT.to_owned());
    }
    let overlap = Nest::of(scene).may_overlap(&scene.world);
    let casters = super::casters(scene, overlap);
    if casters.is_empty() {
        return Err("no object reflects or bends light".to_owned());
    }
    let reach = Reach::new(scene);
    let mut why = None;
    for light in 0..scene.lights.len() {
        for &caster in &casters {
            let Some(obstacle) = reach.obstacle(scene, light, caster) else {
                let (light, caster) = (&scene.lights[light], &scene.objects[caster as usize]);
                return Ok(format!("`{}` may shine on `{}`", light.name, caster.name));
            };
            why.get_or_insert_with(|| obstacle.words(scene, light, caster));
        }
    }
    Err(why.unwrap_or_default())
}

/// Whether light inside glass may meet its surface beyond the critical angle.
fn total_reflection(scene: &Scene) -> Result<String, String> {
    let bends =
        |m: &Material| matches!(m, Material::Dielectric { thin: false, ior, .. } if *ior != 1.0);
    let mut glass = (0u32..)
        .zip(&scene.objects)
        .filter(|(_, o)| bends(&o.material))
        .peekable();
    let Some((_, any)) = glass.peek() else {
        return Err("no object is of glass, water or the like".to_owned());
    };
    let name = any.name.clone();
    match glass.find(|&(i, _)| !is_clear_ball(scene, i)) {
        Some((_, o)) => Ok(format!(
            "light inside `{}` may meet its surface at a low angle",
            o.name
        )),
        None => Err(format!(
            "`{name}` is a full ball: light leaves it at the angle at which it came in"
        )),
    }
}

/// Whether an object is a full ball of a denser medium, with nothing in it:
/// light meets its surface from within at the angle of its refraction on the way
/// in, which is never beyond the critical one.
fn is_clear_ball(scene: &Scene, ball: u32) -> bool {
    let world = &scene.world;
    let instance = &world.instances()[ball as usize];
    let round = instance
        .transform
        .as_ref()
        .is_none_or(|m| m.similarity().is_some());
    let dense = matches!(
        scene.objects[ball as usize].material,
        Material::Dielectric { ior, priority: Some(_), .. } if ior > 1.0
    );
    let is_outside = |s: &BoundingSphere| world.side(ball, s) == Some(false);
    let eye = BoundingSphere {
        center: scene.camera.eye(),
        radius: 0.0,
    };
    let is_alone = world.instance_sphere(ball).is_some_and(|s| {
        let (near, _) = world.neighbours(s.center, s.radius, |i| i != ball);
        near.is_empty()
    });
    matches!(instance.shape, Shape::Sphere(_))
        && round
        && dense
        && is_alone
        && !Nest::of(scene).may_overlap(world)
        && scene.camera.film_normal().is_none()
        && is_outside(&eye)
        && scene
            .lights
            .iter()
            .all(|l| extent(scene, l).is_none_or(|s| is_outside(&s)))
}

/// Whether light may go from one diffuse surface to another, and why (not).
pub(super) fn between_diffuse(scene: &Scene) -> Result<String, String> {
    if scene.lights.is_empty() {
        return Err(NO_LIGHT.to_owned());
    }
    let mut diffuse = scene
        .world
        .instances()
        .iter()
        .zip(&scene.objects)
        .filter(|(_, o)| o.material.is_finite());
    let Some((shape, one)) = diffuse.next() else {
        return Err(NO_DIFFUSE.to_owned());
    };
    if let Some((_, other)) = diffuse.next() {
        return Ok(format!(
            "`{}` and `{}` light each other",
            one.name, other.name
        ));
    }
    if let Some(turner) = first(scene, Material::is_specular) {
        return Ok(format!(
            "`{}` may throw light of `{}` back",
            turner.name, one.name
        ));
    }
    let flat = matches!(
        shape.shape,
        Shape::Plane(_) | Shape::Quad(_) | Shape::Disc(_) | Shape::Triangle(_)
    );
    if flat {
        Err(format!(
            "`{}` is the only diffuse surface, and flat: none of its light comes back",
            one.name
        ))
    } else {
        Ok(format!("`{}` may light itself", one.name))
    }
}

/// Whether small images of sources may be seen, and why (not).
pub(super) fn glinting(scene: &Scene) -> Result<String, String> {
    let light = first_light(scene, is_visible)
        .ok_or("no light has a surface or a disc that could be mirrored")?;
    let shiny = first(scene, Material::is_specular).ok_or("no object is a mirror or of glass")?;
    Ok(format!("`{}` may be seen in `{}`", light.name, shiny.name))
}

//! Bodies of clear media in each other, against Snell's law at every
//! interface, formulas for lenses, and the same scenes with every interface
//! written out.

mod coinciding;
#[path = "../common/mod.rs"]
mod common;
mod contact;
mod light;
mod rays;
mod twin;

use common::scene_of;
use glam::DVec3;
use nephroid::{
    geometry::Ray,
    plan::{Media, Plan},
    scene::Scene,
    transport::{Bend, Carried, Context, LightPicker, Lobes, lobes, media_beside, meet},
};

const CAMERA: &str = "eye: (0, -9, 3), look_at: (0, 0, 0), fov: 30";
const LAMP: &str = "Point(position: (0, 0, 8), power: 100)";

/// A sphere as it stands in a scene.
fn ball(center: [f64; 3], radius: f64, material: &str) -> String {
    let [x, y, z] = center;
    format!(
        "(shape: Sphere(center: ({x:?}, {y:?}, {z:?}), radius: {radius:?}), material: {material}),"
    )
}

/// A capped cylinder along z.
fn slab(from: f64, to: f64, radius: f64, material: &str) -> String {
    format!(
        "(shape: Cylinder(base: (0, 0, {from:?}), end: (0, 0, {to:?}), radius: {radius:?}, capped: true),
          material: {material}),"
    )
}

fn dielectric(ior: f64, priority: i32) -> String {
    format!("Dielectric(ior: {ior:?}, priority: {priority})")
}

fn objects(objects: &str) -> Scene {
    scene_of(CAMERA, [8, 8], objects, LAMP, "")
}

/// Calls `f` with what paths of a scene may look at.
fn with_context<T>(scene: &Scene, f: impl FnOnce(&Context<'_>) -> T) -> T {
    let plan = Plan::new(scene, &scene.settings);
    let picker = LightPicker::new(scene);
    f(&Context {
        scene,
        plan: &plan,
        picker: &picker,
        max_depth: scene.settings.max_depth,
    })
}

/// The bodies around a point; none where no bodies overlap.
fn around(ctx: &Context<'_>, p: DVec3) -> Media {
    ctx.plan.nest.as_ref().map_or(Media::NONE, |nested| {
        nested.nest.around(&ctx.scene.world, p)
    })
}

/// A change of direction on a way.
#[derive(Clone, Copy, Debug)]
struct Step {
    p: DVec3,
    dir: DVec3,
    /// Whether the light was refracted, not totally reflected.
    refracted: bool,
}

/// Refracted wherever that is possible, to the end or the `most`th change of
/// direction.
fn way(ctx: &Context<'_>, origin: DVec3, dir: DVec3, most: usize) -> Vec<Step> {
    let mut ray = Ray::new(origin, dir);
    let mut media = around(ctx, origin);
    let mut steps = Vec::new();
    while steps.len() < most {
        let Some(met) = meet(ctx, &ray, f64::INFINITY, &mut media) else {
            break;
        };
        let Some(found) = lobes(&met.material, &met.point, ray.dir, Carried::Flux) else {
            break;
        };
        let (Lobes::One(lobe) | Lobes::Two(_, lobe)) = found;
        if lobe.is_bent() {
            steps.push(Step {
                p: met.point.p,
                dir: lobe.dir,
                refracted: matches!(lobe.bend, Bend::Refract { .. }),
            });
        }
        media = media_beside(ctx, media, &met.point, lobe.dir);
        ray = met.point.spawn(lobe.dir);
    }
    steps
}

//! From what was written to what is rendered: every check of meaning, then
//! the immutable scene. Nothing can fail after this.

mod camera;
mod checks;
mod curved;
mod height_field;
mod implicit;
mod lens;
mod light;
mod material;
mod mesh;
mod object;
mod parts;
mod placement;
mod shape;
mod solid;
mod stock;

use std::{collections::HashMap, path::Path, sync::Arc};

use super::{
    Input, Inputs, NamedLight, Object, Scene, Settings, description::Description, mesh_file::Watch,
    outline::NodeId, report::Report,
};
use crate::{
    geometry::{Instance, Shape, TriangleMesh, World, shape::Implicit},
    light::Light,
    material::Material,
};

/// A mesh and what it was made from, shared by all objects that name it.
type SharedMesh = Option<Arc<TriangleMesh>>;

/// What is known while a scene is built.
struct Builder<'d> {
    description: &'d Description,
    report: &'d mut Report,
    base_dir: &'d Path,
    /// Built materials by name; `None` for broken ones.
    materials: HashMap<&'d str, Option<Material>>,
    /// Entries of `meshes` by name; `None` for broken ones.
    meshes: HashMap<&'d str, Option<mesh::Named<'d>>>,
    /// Meshes that were read, and those made of them.
    stock: stock::Stock,
    /// Surfaces of formulas by what is written of them.
    implicits: HashMap<String, Arc<Implicit>>,
    /// Is told how far it is.
    watch: Watch<'d>,
    /// Files that were read.
    inputs: Inputs,
    /// Triangles that generators may still make.
    triangles_left: u64,
}

/// An object that passed its checks.
struct BuiltObject {
    object: Object,
    instance: Instance,
    /// The outline's place of the object.
    node: NodeId,
}

/// Builds the scene, reporting every mistake of meaning. `None` if something
/// that a scene can't do without is broken or missing; the scene is only good
/// if nothing at all was reported.
pub(super) fn build(
    description: &Description,
    base_dir: &Path,
    watch: Watch,
    report: &mut Report,
) -> Option<Scene> {
    let mut builder = Builder {
        description,
        report,
        base_dir,
        materials: HashMap::new(),
        meshes: HashMap::new(),
        stock: stock::Stock::default(),
        implicits: HashMap::new(),
        watch,
        inputs: Inputs::new(base_dir),
        triangles_left: super::MAX_TRIANGLES,
    };
    if builder.report.diagnostics.is_full() {
        return None;
    }
    builder.stock = stock::Stock::for_scene(description, base_dir);
    builder.named_materials();
    builder.named_meshes();
    let image = builder.image();
    let camera = builder.camera(image.map_or([1, 1], |i| i.resolution));
    let settings = builder.settings(image.and_then(|i| i.exposure));
    let objects = builder.objects();
    let camera_medium = builder.camera_medium(&objects);
    let lights = builder.lights();
    builder.refuse_endless_casters(&objects, &lights);
    if !builder.report.diagnostics.is_empty() {
        return None;
    }
    let mut scene = assemble(objects, lights, camera?, image?, settings);
    scene.camera_medium = camera_medium;
    scene.inputs = vec![Input::scene(builder.report.text())];
    scene.inputs.extend(builder.inputs.into_list());
    Some(scene)
}

/// Puts the parts together; lights with a shape follow the objects.
fn assemble(
    built: Vec<BuiltObject>,
    built_lights: Vec<light::BuiltLight>,
    camera: crate::camera::Camera,
    image: camera::Image,
    settings: Settings,
) -> Scene {
    let mut instances = Vec::with_capacity(built.len());
    let mut objects = Vec::with_capacity(built.len());
    for b in built {
        instances.push(b.instance);
        let material = b.object.material.as_built();
        objects.push(Object {
            material,
            ..b.object
        });
    }
    let mut lights = Vec::with_capacity(built_lights.len());
    for (index, light::BuiltLight { name, light, shape }) in built_lights.into_iter().enumerate() {
        let instance = shape.map(|shape| {
            let instance = instances.len() as u32;
            instances.push(Instance {
                shape,
                transform: None,
            });
            let light = Some(index as u32);
            objects.push(Object {
                name: name.clone(),
                material: Material::Black,
                light,
            });
            instance
        });
        lights.push(NamedLight {
            name,
            light,
            instance,
        });
    }
    Scene {
        world: World::new(instances),
        objects,
        lights,
        camera,
        camera_medium: None,
        resolution: image.resolution,
        filter: image.filter,
        settings,
        inputs: Vec::new(),
    }
}

impl Builder<'_> {
    /// A sun lights an unbounded mirror or glass everywhere: its photons
    /// would have nowhere to start.
    fn refuse_endless_casters(&mut self, objects: &[BuiltObject], lights: &[light::BuiltLight]) {
        let Some(sun) = lights.iter().find(|l| matches!(l.light, Light::Sun(_))) else {
            return;
        };
        for b in objects {
            if matches!(b.instance.shape, Shape::Plane(_)) && b.object.material.casts_caustics() {
                let shape = self.report.field(b.node, "shape");
                let diagnostic = self
                    .report
                    .about(
                        shape,
                        format!(
                            "the sun {} shines on a mirror or glass without end",
                            sun.name
                        ),
                    )
                    .with_label("no bounds to send light to")
                    .with_help(
                        "use a Quad or a Disc instead of the Plane, or give the light a `beam`",
                    );
                self.report.push(diagnostic);
            }
        }
    }
}

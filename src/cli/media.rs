//! What is said about media: where camera and lights stand, and overlaps
//! that may not be meant.

use nephroid::{
    plan::{Nest, Start, Starts},
    scene::Scene,
};

/// What is worth a word about the media of a scene.
pub(super) struct Media {
    /// Where the camera and those lights stand that are inside of something.
    pub(super) inside: Vec<String>,
    /// What may not be meant.
    pub(super) warnings: Vec<String>,
}

impl Media {
    /// Looks at a scene.
    pub(super) fn of(scene: &Scene) -> Self {
        let nest = Nest::of(scene);
        let starts = Starts::new(scene, &nest);
        let mut inside: Vec<String> = Vec::new();
        let camera = ("the camera", &starts.camera);
        inside.extend(place(scene, &nest, camera.0, camera.1));
        for (light, start) in scene.lights.iter().zip(&starts.lights) {
            let name = format!("the light `{}`", light.name);
            inside.extend(place(scene, &nest, &name, start));
        }
        Self {
            inside,
            warnings: nest
                .tie(&scene.world)
                .map(|pair| tie(scene, pair))
                .into_iter()
                .collect(),
        }
    }
}

/// In which body something stands; `None` if in none.
fn place(scene: &Scene, nest: &Nest, what: &str, start: &Start) -> Option<String> {
    let name = |i: u32| format!("`{}`", scene.objects[i as usize].name);
    let around = nest.medium(start.sure()).map(name);
    let crossed: Vec<String> = start.unsure().map(name).collect();
    match (around, crossed.as_slice()) {
        (None, []) => None,
        (Some(body), []) => Some(format!("{what} is inside {body}")),
        (None, some) => Some(format!("{what} may reach into {}", some.join(", "))),
        (Some(body), some) => Some(format!(
            "{what} is inside {body} and may reach into {}",
            some.join(", ")
        )),
    }
}

/// Two bodies that no priority tells apart.
fn tie(scene: &Scene, [first, second]: [u32; 2]) -> String {
    let name = |i: u32| &scene.objects[i as usize].name;
    let (first, second) = (name(first), name(second));
    format!(
        "`{first}` and `{second}` overlap and have the same priority: the medium of `{second}`, \
         which stands later in the file, is there; write a `priority` in the material of the one \
         that is to win"
    )
}

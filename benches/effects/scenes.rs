//! The scenes of this bench: a grey floor, with what stands on it.

use std::path::{Path, PathBuf};

use nephroid::{
    light::Light,
    material::Material,
    scene::{Choice, Effect, Scene, Settings, load, load_str},
    spectrum::Rgb,
};

/// A scene by what is in it.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    objects: &'static str,
    lights: &'static str,
}

const BALL: &str =
    "(shape: Sphere(center: (0, 0, 1), radius: 0.8), material: Diffuse(reflectance: 0.5)),";
const GLASS: &str =
    "(shape: Sphere(center: (0, 0, 1), radius: 0.8), material: Dielectric(ior: 1.5)),";
const MIRROR: &str =
    "(shape: Sphere(center: (0, 0, 1), radius: 0.8), material: Mirror(reflectance: 0.9)),";
/// Flat faces, turned, so that normals are mapped.
const WEDGE: &str = "(shape: Mesh(
    vertices: [(-1, -1, 0.1), (1, -1, 0.1), (1, 1, 0.1), (-1, 1, 0.1), (0, -1, 1.6), (0, 1, 1.6)],
    triangles: [(0, 2, 1), (0, 3, 2), (0, 1, 4), (2, 3, 5), (1, 2, 5), (1, 5, 4), (0, 4, 5), (0, 5, 3)],
  ), at: (rotate: (axis: (0, 0, 1), degrees: 20)), material: Dielectric(ior: 1.5)),";
const PANE: &str = "(shape: Quad(center: (-0.8, -0.4, 2.5), size: (2, 2), normal: (0, 0, 1)),
    material: Dielectric(ior: 1.5, thin: true)),";
const POINT: &str = "Point(position: (-2, -1, 5), power: 300)";
const LAMP: &str = "Sphere(center: (-2, -1, 5), radius: 0.3, power: 300)";
const BELOW: &str = "Point(position: (-2, -1, -5), power: 300)";

/// All of them.
pub(crate) const CASES: [Case; 9] = [
    case("floor, point", "", POINT),
    case("ball, point", BALL, POINT),
    case("ball, lamp", BALL, LAMP),
    case("glass, point", GLASS, POINT),
    case("glass, lamp", GLASS, LAMP),
    case("mirror, lamp", MIRROR, LAMP),
    case("wedge, lamp", WEDGE, LAMP),
    case("glass, no light", GLASS, BELOW),
    case("pane, lamp", PANE, LAMP),
];

const fn case(name: &'static str, objects: &'static str, lights: &'static str) -> Case {
    Case {
        name,
        objects,
        lights,
    }
}

/// The scene of a name: one of the above, or a file among those that ship.
pub(crate) fn named(name: &str) -> Scene {
    let Some(case) = CASES.iter().find(|c| c.name == name) else {
        return load(&shipped(name)).unwrap_or_else(|e| panic!("{e}"));
    };
    let Case {
        objects, lights, ..
    } = case;
    let text = format!(
        "(camera: (eye: (0, -6, 4), look_at: (0, 0, 0.5), fov: 40), image: (width: 8, height: 8),
          objects: [
            (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
            {objects}
          ],
          lights: [{lights}])"
    );
    load_str(&text, name, Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

fn shipped(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    folder.join(name).with_extension("ron")
}

/// Whether [`take_out`] knows how.
pub(crate) fn can_take_out(effect: Effect) -> bool {
    !matches!(
        effect,
        Effect::Sources | Effect::TotalReflection | Effect::Nesting | Effect::ShadingNormals
    )
}

/// Makes a scene of which nobody sees the effect: it is switched off, or the
/// lights that bring it are dark, or the objects that show it are black.
pub(crate) fn take_out(scene: &mut Scene, settings: &mut Settings, effect: Effect) {
    let is_meant = |material: &Material| match effect {
        Effect::Mirrors => matches!(material, Material::Mirror { .. }),
        Effect::Panes => material.is_straight(),
        Effect::Refraction => matches!(material, Material::Dielectric { thin: false, .. }),
        _ => false,
    };
    for object in scene.objects.iter_mut().filter(|o| is_meant(&o.material)) {
        object.material = Material::Black;
    }
    for light in scene.lights.iter_mut().map(|l| &mut l.light) {
        let shadows = if light.has_extent() {
            Effect::SoftShadows
        } else {
            Effect::HardShadows
        };
        if effect == shadows {
            darken(light);
        }
    }
    if Choice::Off.suits(effect) {
        settings.effects.set(effect, Choice::Off);
    }
}

fn darken(light: &mut Light) {
    let shine = match light {
        Light::Point(l) => &mut l.intensity,
        Light::Spot(l) => &mut l.intensity,
        Light::Beam(l) => &mut l.irradiance,
        Light::Sun(l) => &mut l.irradiance,
        Light::Sphere(l) => &mut l.radiance,
        Light::Quad(l) => &mut l.radiance,
        Light::Disc(l) => &mut l.radiance,
    };
    *shine = Rgb::BLACK;
}

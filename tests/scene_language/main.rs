//! What the scene language says: every snippet of its documentation is read,
//! and what is written is what is built.

mod meshes;

use std::{f64::consts::PI, path::Path};

use glam::DVec3;
use nephroid::{
    camera::Filter,
    geometry::Transform,
    light::Light,
    material::Material,
    scene::{Choice, Choices, Effect, Guidance, Kernel, Sampler, Scene, Settings, load, load_str},
    spectrum::Rgb,
};

fn parse(text: &str) -> Scene {
    load_str(text, "test.ron", Path::new("")).unwrap_or_else(|e| panic!("{text}\n{e}"))
}

/// A scene with one section replaced by `section`.
fn with(section: &str) -> String {
    let mut text = String::from("(");
    for default in [
        "camera: (eye: (0, -5, 3), look_at: (0, 0, 0), fov: 45),",
        "image: (width: 8, height: 6),",
    ] {
        let key = &default[..=default.find(':').expect("a key")];
        if !section.starts_with(key) {
            text += default;
        }
    }
    text + section + ")"
}

fn light(light: &str) -> Light {
    parse(&with(&format!("lights: [{light}]"))).lights[0]
        .light
        .clone()
}

fn object(object: &str) -> Scene {
    parse(&with(&format!("objects: [{object}]")))
}

fn close(a: DVec3, b: [f64; 3]) -> bool {
    (a - DVec3::from(b)).abs().max_element() < 1e-8
}

#[test]
fn every_snippet_of_the_documentation_is_read() {
    let docs = include_str!("../../docs/scene-format.md");
    let mut count = 0;
    for block in docs.split("\n```ron").skip(1) {
        let (kind, rest) = block.split_once('\n').expect("a fence");
        let (body, _) = rest.split_once("\n```").expect("an end");
        let text = match kind.trim_start_matches(',') {
            "" => body.to_owned(),
            "shape" => with(&format!("objects: [(shape: {body}, material: Mirror())],")),
            "object" => with(&format!("objects: [{body}],")),
            "light" => with(&format!("lights: [{body}],")),
            "at" => with(&format!(
                "objects: [(shape: Sphere(center: (0, 0, 0), radius: 1), material: Mirror(), at: {body})],"
            )),
            section @ ("camera" | "image" | "materials" | "render") => {
                with(&format!("{section}: {body},"))
            }
            other => panic!("unknown kind of snippet {other:?}"),
        };
        parse(&text);
        count += 1;
    }
    assert!(count >= 25, "only {count} snippets");
}

#[test]
fn the_documentation_names_every_setting_with_its_default() {
    let docs = include_str!("../../docs/scene-format.md");
    let Settings {
        passes,
        seed,
        photons,
        radius,
        sampler,
        kernel,
        guidance,
        indirect,
        effects,
        max_depth,
        memory,
        exposure,
    } = Settings::default();
    assert_eq!(effects, Choices::default());
    assert!((photons, exposure) == (None, None));
    for (field, default) in [
        ("passes", passes.to_string()),
        ("seed", seed.to_string()),
        ("radius", radius.to_string()),
        ("sampler", format!("`{sampler:?}`")),
        ("kernel", format!("`{kernel:?}`")),
        ("guidance", format!("`{guidance:?}`")),
        ("indirect", format!("`{indirect}`")),
        ("max_depth", max_depth.to_string()),
        ("memory", format!("`\"{} GiB\"`", memory >> 30)),
    ] {
        let row = docs
            .lines()
            .rfind(|l| l.starts_with(&format!("| `{field}` |")))
            .expect("a row");
        assert!(row.ends_with(&format!("| {default} |")), "{row}");
    }
}

/// Every filter can be written, the documentation has a row for each, and the
/// default is the one it names.
#[test]
fn filters() {
    let docs = include_str!("../../docs/scene-format.md");
    let image = |rest: &str| parse(&with(&format!("image: (width: 8, height: 6{rest}),"))).filter;
    for filter in [Filter::Box, Filter::Gaussian, Filter::BlackmanHarris] {
        assert_eq!(image(&format!(", filter: {filter:?}")), filter);
        assert!(docs.contains(&format!("\n| `{filter:?}` | ")), "{filter:?}");
    }
    assert_eq!(image(""), Filter::default());
    let row = docs
        .lines()
        .find(|l| l.starts_with("| `filter` |"))
        .expect("a row");
    let default = format!("| `{:?}` |", Filter::default());
    assert!(row.ends_with(&default), "{row}");
}

#[test]
fn every_shipped_scene_is_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the scenes") {
        let path = entry.expect("a file").path();
        if path.extension().is_some_and(|e| e == "ron") {
            let scene = load(&path).unwrap_or_else(|e| panic!("{e}"));
            assert!(!scene.lights.is_empty(), "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 5, "only {count} scenes");
}

#[test]
fn quads_and_their_normals() {
    // The corners that an independent program computed for lights facing a
    // point: center, side, target, four corners.
    for (center, side, target, corners) in [
        (
            "(-1.5, 0.25, 1.9)",
            "(0.2, 0.2)",
            "(0, 0, 0.1)",
            [
                [-1.591789093, 0.163918807, 1.835464811],
                [-1.558909295, 0.361197591, 1.835464811],
                [-1.408210907, 0.336081193, 1.964535189],
                [-1.441090705, 0.138802409, 1.964535189],
            ],
        ),
        (
            "(1.2, 1.6, 6.0)",
            "(0.5, 0.5)",
            "(0, 0, 0)",
            [
                [1.142302495, 1.93973666, 5.920943058],
                [1.542302495, 1.63973666, 5.920943058],
                [1.257697505, 1.26026334, 6.079056942],
                [0.857697505, 1.56026334, 6.079056942],
            ],
        ),
    ] {
        let text = format!("Quad(center: {center}, size: {side}, facing: {target}, radiance: 3)");
        let Light::Quad(q) = light(&text) else {
            panic!("a quad")
        };
        let built = [
            q.corner,
            q.corner + q.u,
            q.corner + q.u + q.v,
            q.corner + q.v,
        ];
        for (a, b) in built.into_iter().zip(corners) {
            assert!(close(a, b), "{a} is not {b:?}");
        }
        assert_eq!(q.radiance, Rgb::grey(3.0));
    }
}

#[test]
fn powers_become_radiance_and_intensity() {
    let Light::Point(l) = light("Point(position: (0, 0, 1), power: (1, 2, 4))") else {
        panic!("a point")
    };
    assert!((l.intensity[2] - 1.0 / PI).abs() < 1e-15);
    let Light::Sphere(l) = light("Sphere(center: (0, 0, 1), radius: 0.5, power: 3)") else {
        panic!("a sphere")
    };
    assert!((l.radiance[0] * PI * 4.0 * PI * 0.25 - 3.0).abs() < 1e-14);
    let Light::Quad(l) = light("Quad(corner: (0, 0, 1), u: (0, 2, 0), v: (3, 1, 0), power: 3)")
    else {
        panic!("a quad")
    };
    assert!((l.radiance[0] * PI * 6.0 - 3.0).abs() < 1e-14);
    let Light::Disc(l) = light("Disc(center: (0, 0, 1), radius: 2, normal: (0, 0, -7), power: 3)")
    else {
        panic!("a disc")
    };
    assert!((l.radiance[0] * PI * PI * 4.0 - 3.0).abs() < 1e-14);
    assert_eq!(l.normal, DVec3::NEG_Z);
    // A spot that shines to all sides at full strength is a point light.
    let Light::Spot(l) =
        light("Spot(position: (0, 0, 1), direction: (0, 0, -1), inner: 180, outer: 180, power: 1)")
    else {
        panic!("a spot")
    };
    assert!((l.intensity[0] * 4.0 * PI - 1.0).abs() < 1e-14);
}

#[test]
fn directional_lights_are_beams_or_suns() {
    let text =
        "Directional(direction: (0, 0, -4), irradiance: 5, beam: (center: (1, 2, 3), radius: 0.5))";
    let Light::Beam(beam) = light(text) else {
        panic!("a beam")
    };
    assert_eq!(
        (beam.axis, beam.radius, beam.irradiance),
        (DVec3::NEG_Z, 0.5, Rgb::grey(5.0))
    );
    let text = "Directional(direction: (0, 0, -4), irradiance: 5, angular_diameter: 60)";
    let Light::Sun(sun) = light(text) else {
        panic!("a sun")
    };
    assert!((sun.sin_half - 0.5).abs() < 1e-15 && sun.axis == DVec3::NEG_Z);
}

#[test]
fn colours_in_three_spellings() {
    let reflectance = |colour: &str| {
        let scene = object(&format!(
            "(shape: Sphere(center: (0, 0, 0), radius: 1), material: Diffuse(reflectance: {colour}))"
        ));
        match scene.objects[0].material {
            Material::Diffuse { reflectance } => reflectance,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(reflectance("0.1"), Rgb::grey(0.1));
    assert_eq!(reflectance("1"), Rgb::WHITE);
    assert_eq!(reflectance("(0.1, 0, 1)"), Rgb::new(0.1, 0.0, 1.0));
    assert_eq!(reflectance("[0.1, 0, 1]"), Rgb::new(0.1, 0.0, 1.0));
    assert_eq!(reflectance("\"#ff0000\""), Rgb::new(1.0, 0.0, 0.0));
}

fn transform(at: &str) -> Transform {
    let scene = object(&format!(
        "(shape: Sphere(center: (0, 0, 0), radius: 1), material: Mirror(), at: {at})"
    ));
    scene.world.instances()[0].transform.expect("a transform")
}

#[test]
fn placements_scale_then_rotate_then_translate() {
    let t = transform(
        "(translate: (1, 2, 3), rotate: (axis: (0, 0, 2), degrees: 90), scale: (2, 1, 1))",
    );
    assert_eq!(t.point(DVec3::X), DVec3::new(1.0, 4.0, 3.0));
    assert_eq!(t.point(DVec3::Y), DVec3::new(0.0, 2.0, 3.0));
    // A list is applied in its own order.
    let t = transform(
        "[(translate: (1, 0, 0)), (rotate: (axis: (0, 0, 1), degrees: 90)), (scale: -2)]",
    );
    assert_eq!(t.point(DVec3::ZERO), DVec3::new(0.0, -2.0, 0.0));
    let t = transform("(rotate: [(axis: (0, 0, 1), degrees: 90), (axis: (1, 0, 0), degrees: 90)])");
    assert_eq!(t.point(DVec3::X), DVec3::Z);
    let t = transform("(rotate: (axis: (1, 1, 1), degrees: 120))");
    assert!(close(t.point(DVec3::X), [0.0, 1.0, 0.0]));
}

#[test]
fn nothing_moves_without_a_placement() {
    let scene = object("(shape: Sphere(center: (0, 0, 0), radius: 1), material: Mirror(), at: ())");
    assert!(scene.world.instances()[0].transform.is_none());
}

#[test]
fn glowing_shapes_follow_the_objects() {
    let scene = parse(&with(
        "objects: [(name: \"ball\", shape: Sphere(center: (0, 0, 0), radius: 1), material: Mirror()),
                   (shape: Sphere(center: (0, 0, 3), radius: 1), material: Mirror())],
         lights: [Point(position: (0, 0, 9), power: 1),
                  Disc(name: \"lamp\", center: (0, 0, 9), facing: (0, 0, 0), radius: 1, radiance: 1),
                  Sphere(center: (0, 0, 9), radius: 1, radiance: 1)]",
    ));
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["ball", "objects[1]", "lamp", "lights[2]"]);
    assert_eq!(scene.objects.len(), scene.world.instances().len());
    let lights: Vec<_> = scene
        .lights
        .iter()
        .map(|l| (l.name.as_str(), l.instance))
        .collect();
    assert_eq!(
        lights,
        [
            ("lights[0]", None),
            ("lamp", Some(2)),
            ("lights[2]", Some(3))
        ]
    );
    assert_eq!(scene.objects[2].light, Some(1));
    assert_eq!(scene.objects[3].material, Material::Black);
    assert_eq!(scene.objects[0].light, None);
}

/// Effects by name, each as it may be, and a row of the documentation for each.
#[test]
fn effects_are_chosen_by_name() {
    let docs = include_str!("../../docs/effects.md");
    for effect in Effect::ALL {
        let name = effect.name();
        let row = format!("| `{name}` |");
        assert!(
            docs.lines().any(|l| l.starts_with(&row)),
            "no row of {name}"
        );
        for choice in [Choice::Auto, Choice::Off, Choice::On] {
            let text = with(&format!("render: (effects: ({name}: {choice:?}))"));
            let read = load_str(&text, "test.ron", Path::new(""));
            assert_eq!(read.is_ok(), choice.suits(effect), "{name}: {choice:?}");
            if let Ok(scene) = read {
                assert_eq!(scene.settings.choice(effect), choice);
            }
        }
    }
    let off = parse(&with("render: (indirect: false)"));
    assert_eq!(off.settings.choice(Effect::Indirect), Choice::Off);
}

#[test]
fn settings_come_from_render_and_image() {
    let scene = parse(
        "Scene(camera: (eye: (0, -5, 3), look_at: (0, 0, 0), height: 2),
          image: (width: 64, height: 32, exposure: -0.5),
          render: (passes: 16, seed: 18446744073709551615, photons: 1_000_000, radius: 1.5,
                   sampler: Independent, kernel: Circle, guidance: Power, indirect: false, max_depth: 9, memory: \"2 MiB\"))",
    );
    let expected = Settings {
        passes: 16,
        seed: u64::MAX,
        photons: Some(1_000_000),
        radius: 1.5,
        sampler: Sampler::Independent,
        kernel: Kernel::Circle,
        guidance: Guidance::Power,
        indirect: false,
        effects: Choices::default(),
        max_depth: 9,
        memory: 2 << 20,
        exposure: Some(-0.5),
    };
    assert_eq!(scene.settings, expected);
    assert_eq!(scene.resolution, [64, 32]);
    assert_eq!(scene.camera.pixel_footprint().width, 2.0 / 32.0);
    assert_eq!(parse(&with("")).settings, Settings::default());
}

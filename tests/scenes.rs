//! The scenes that ship: each loads, says what to look for, and keeps the
//! number that its header gives as known.

use std::{
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use glam::DVec3;
use nephroid::{
    film::Layer,
    geometry::{Ray, Shape, Surface, SurfacePoint},
    light::Source,
    plan::{Media, Plan},
    render::{self, Job},
    sampling::{Purpose, Sequence, warp},
    scene::{self, Scene, Summary},
    spectrum::Rgb,
    transport::{
        Carried, Context, LightPicker, Lobe, Lobes, Walker, lobes, media_beside, meet,
        transmittance,
    },
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

fn load(name: &str) -> Scene {
    let path = folder().join(name);
    scene::load(&path).unwrap_or_else(|mistakes| panic!("{}", mistakes.render(false)))
}

fn scene_files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_scene_loads_and_has_a_header() {
    let files = scene_files();
    assert!(files.len() >= 17, "only {} scenes", files.len());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let header: Vec<&str> = text.lines().take_while(|l| l.starts_with("//")).collect();
        for word in ["// Look for: ", "// Known: "] {
            let found = header.iter().any(|line| line.starts_with(word));
            assert!(found, "{}: no line with {word:?}", file.display());
        }
        if let Err(mistakes) = scene::load(&file) {
            panic!("{}", mistakes.render(false));
        }
    }
}

/// The next surface along a ray: the object's name, the point, and how light
/// goes on there.
fn step(scene: &Scene, ray: &Ray) -> Option<(String, SurfacePoint, Option<Lobes>)> {
    let hit = scene.world.closest(ray, f64::INFINITY)?;
    let point = scene.world.surface(ray, &hit);
    let object = scene.object(hit.surface);
    let lobes = lobes(&object.material, &point, ray.dir, Carried::Flux);
    Some((object.name.clone(), point, lobes))
}

/// Of two ways the refracted one; the only one of a mirror.
fn onward(lobes: Lobes) -> Lobe {
    match lobes {
        Lobes::One(lobe) | Lobes::Two(_, lobe) => lobe,
    }
}

/// The ray that leaves after `steps` specular steps.
fn after(scene: &Scene, mut ray: Ray, steps: usize) -> Ray {
    for i in 0..steps {
        let (name, point, lobes) =
            step(scene, &ray).unwrap_or_else(|| panic!("nothing met at step {i}"));
        let lobes = lobes.unwrap_or_else(|| panic!("{name} is not specular"));
        ray = point.spawn(onward(lobes).dir);
    }
    ray
}

/// How far beyond `center` along the unit vector `axis` rays meet that ran
/// parallel to it, `height` from it, and came from `before` the centre.
fn focus(scene: &Scene, center: DVec3, axis: DVec3, before: f64, height: f64) -> f64 {
    let side = axis.any_orthonormal_vector();
    let start = center - axis * before + side * height;
    let out = after(scene, Ray::new(start, axis), 2);
    let t = -(out.origin - center).dot(side) / out.dir.dot(side);
    (out.origin + out.dir * t - center).dot(axis)
}

#[test]
fn ball_lenses_focus_at_their_focal_length() {
    let beam = DVec3::new(0.7453559925, 0.0, -0.6666666667).normalize();
    let down = DVec3::new(1.0, 0.3, -0.7).normalize();
    for (file, center, axis, known) in [
        ("ball_lens.ron", DVec3::new(0.0, 0.0, 0.40001), beam, 0.6),
        ("first.ron", DVec3::new(-0.75, 0.1, 0.42), down, 0.6),
        ("glass_sphere.ron", DVec3::new(0.0, 0.0, 1.2), down, 1.5),
    ] {
        let scene = load(file);
        let found = focus(&scene, center, axis, 1.5 * known, 1e-4);
        // The aberration at height h is of the order h^2.
        assert!(
            (found - known).abs() < 1e-6,
            "{file}: {found} instead of {known}"
        );
    }
    // The beam's focus lies on the table where the header says.
    let scene = load("ball_lens.ron");
    let f = focus(&scene, DVec3::new(0.0, 0.0, 0.40001), beam, 0.9, 1e-4);
    let on_table = DVec3::new(0.0, 0.0, 0.40001) + beam * f;
    assert!(on_table.z.abs() < 2e-5 && (on_table.x - 0.2f64.sqrt()).abs() < 1e-5);
}

/// From focus to focus, by ways of one length.
#[test]
fn the_ellipsoid_of_the_lamp_has_another_focus() {
    let scene = load("ellipsoids.ron");
    let [from, to] = [-0.6, 0.6].map(|x| DVec3::new(x, 0.0, 0.9));
    for (y, z) in [(0.1, 0.0), (1.7, -0.3), (-1.5, 1.9)] {
        let dir = DVec3::new(-1.0, y, z).normalize();
        // Outside of the lamp, whose body is no mirror.
        let out = after(&scene, Ray::new(from + dir * 0.04, dir), 1);
        let past = (to - out.origin).dot(out.dir);
        assert!((out.origin + out.dir * past - to).length() < 1e-14);
        let way = from.distance(out.origin) + past;
        assert!((way - 2.0).abs() < 1e-14, "{way}");
    }
}

#[test]
fn the_searchlight_and_its_cone_are_as_the_header_says() {
    let scene = load("conics.ron");
    // Every ray from the focus leaves the mirror along the axis.
    let focus = DVec3::new(-1.0, 0.0, 0.75);
    for (y, z) in [(0.1, 0.0), (0.7, -0.3), (-1.5, 1.0)] {
        let ray = Ray::new(focus, DVec3::new(-1.0, y, z).normalize());
        let out = after(&scene, ray, 1);
        assert!((out.dir - DVec3::X).length() < 1e-14, "{}", out.dir);
    }
    // Not through the tip, where the cone has no normal.
    let ray = Ray::new(DVec3::new(0.0, 0.12, 0.9), DVec3::X);
    let out = after(&scene, ray, 2);
    let turned = out.dir.x.acos().to_degrees();
    let a = (0.05f64 / 0.15).atan();
    let known = (1.5 * a.sin()).asin() - a;
    assert!(
        (known.to_degrees() - 9.88).abs() < 0.005,
        "{}",
        known.to_degrees()
    );
    assert!((turned - known.to_degrees()).abs() < 1e-9, "{turned}");
}

#[test]
fn the_glass_ring_focuses_on_the_table() {
    let scene = load("torus.ron");
    let center = DVec3::new(-0.25, 0.0, 0.18);
    for degrees in [0.0f64, 77.0, 200.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let side = DVec3::new(cos, sin, 0.0);
        let start = center + side * (0.4 + 1e-4) + DVec3::Z;
        let out = after(&scene, Ray::new(start, DVec3::NEG_Z), 2);
        let t = (0.4 - (out.origin - center).dot(side)) / out.dir.dot(side);
        let height = (out.origin + out.dir * t).z;
        assert!(height.abs() < 1e-6, "{height}");
    }
}

#[test]
fn the_burning_glass_focuses_on_the_table() {
    let scene = load("solids.ron");
    let power: f64 = 0.5 * (4.0 - 0.05 / (1.5 * 0.25));
    let known = (1.0 - 0.05 / (1.5 * 0.5)) / power;
    assert!((1.0 / power - 0.5172).abs() < 5e-5 && (known - 0.4828).abs() < 5e-5);
    let center = DVec3::new(-0.3, 0.0, 0.5327586207);
    let found = focus(&scene, center, DVec3::NEG_Z, 1.0, 1e-4);
    assert!((found - 0.05 - known).abs() < 1e-6, "{found}");
    assert!((center.z - found).abs() < 1e-6, "on the table");
}

/// The brightest caustic of a small render lies at the focus.
#[test]
fn the_ball_lens_picture_is_brightest_at_the_focus() {
    let scene = load("ball_lens.ron");
    let mut job = Job::of(&scene);
    job.resolution = [90, 68];
    job.settings.passes = 8;
    job.settings.photons = Some(1 << 15);
    let outcome = render::run(&scene, &job, &mut |_| ControlFlow::Continue(()));
    let image = outcome.film.layer_image(Layer::Caustic);
    let brightest = (0..image.pixels().len())
        .max_by(|&a, &b| {
            let mean = |i: usize| image.pixels()[i].mean();
            mean(a).total_cmp(&mean(b))
        })
        .unwrap();
    let film = glam::DVec2::new((brightest % 90) as f64 + 0.5, (brightest / 90) as f64 + 0.5);
    let ray = scene.camera.with_resolution(job.resolution).ray(film);
    let (name, point, _) = step(&scene, &ray).unwrap();
    assert_eq!(name, "table");
    let away = point.p.distance(DVec3::new(0.2f64.sqrt(), 0.0, 0.0));
    // Pixels are 1.9 cm wide there.
    assert!(away < 0.05, "brightest at {}, {away} m away", point.p);
}

#[test]
fn mirror_rings_have_their_cusp_half_way() {
    for (file, center, radius) in [
        ("cup.ron", DVec3::new(0.0, 0.0, 0.1), 0.5),
        ("first.ron", DVec3::new(0.65, -0.1, 0.1), 0.45),
    ] {
        let scene = load(file);
        let ray = Ray::new(center + DVec3::new(0.0, 1e-4, 0.0), DVec3::X);
        let out = after(&scene, ray, 1);
        let t = (center.y - out.origin.y) / out.dir.y;
        let cusp = (out.origin + out.dir * t - center).x;
        assert!(
            (cusp - 0.5 * radius).abs() < 1e-6,
            "{file}: cusp at {cusp} of {radius}"
        );
    }
}

#[test]
fn plano_convex_lenses_focus_on_the_axis() {
    let scene = load("plano_convex_lens.ron");
    for center in [
        DVec3::new(-0.6, 0.0, 0.438),
        DVec3::new(0.0, 0.0, 0.876),
        DVec3::new(0.6, 0.0, 1.314),
    ] {
        // t / n less than the focal length, in the mesh's own numbers.
        let thickness = 0.5 * (0.9 + 0.02 - (0.9f64 * 0.9 - 0.09).sqrt());
        let known = 0.9 - thickness / 1.5;
        assert!((known - 0.876).abs() < 5e-4 && (thickness - 0.0357).abs() < 5e-5);
        let near = focus(&scene, center, DVec3::NEG_Z, 0.9, 1e-3);
        // The mesh has single precision: 3e-8 of error in a normal, seen from
        // a height of 1e-3, moves the focus by 3e-5 of the focal length.
        assert!((near - known).abs() < 1e-4, "{near} instead of {known}");
        let rim = focus(&scene, center, DVec3::NEG_Z, 0.9, 0.149);
        assert!(
            (known - rim - 0.03).abs() < 0.005,
            "aberration {}",
            known - rim
        );
    }
}

/// Glass where the formula says, on the diagonals and at its widest, and
/// none in the windows.
#[test]
fn the_tanglecube_is_where_its_formula_says() {
    let scene = load("tanglecube.ron");
    let cube = scene.objects.iter().position(|o| o.name == "tanglecube");
    let cube = cube.unwrap();
    assert!(scene.world.instances()[cube].shape.is_closed());
    let (scale, center) = (0.22, DVec3::new(0.0, 0.0, 0.55));
    let far = |s: f64| center + DVec3::splat(s * scale);
    let inward = -DVec3::ONE.normalize();
    let (name, corner, _) = step(&scene, &Ray::new(far(9.0), inward)).unwrap();
    let (_, inner, _) = step(&scene, &corner.spawn(inward)).unwrap();
    assert_eq!(name, "tanglecube");
    assert!((corner.p - far(2.00551)).length() < 5e-6 * scale);
    assert!((inner.p - far(0.98891)).length() < 1.5e-5 * scale);
    let side = center + DVec3::new(9.0, 2.5f64.sqrt(), 2.5f64.sqrt()) * scale;
    let (_, widest, _) = step(&scene, &Ray::new(side, DVec3::NEG_X)).unwrap();
    assert!(((widest.p - center).x / scale - 2.2663).abs() < 5e-5);
    assert!((widest.ng - DVec3::X).length() < 1e-12);
    let (name, ..) = step(&scene, &Ray::new(center + DVec3::Z, DVec3::NEG_Z)).unwrap();
    assert_eq!(name, "floor", "the window is open");
}

#[test]
fn the_gem_sends_a_ray_down_its_axis_back_through_the_table() {
    let scene = load("gem.ron");
    let Shape::Mesh(gem) = &scene.world.instances()[1].shape else {
        panic!("a mesh")
    };
    assert!(gem.is_closed() && !gem.is_smooth());
    assert_eq!((gem.vertex_count(), gem.triangle_count()), (25, 46));
    let lie = glam::DQuat::from_rotation_y(40.75f64.to_radians());
    let place = |p: DVec3| lie * (p * 0.3) + DVec3::Z * 0.19584;
    let axis = lie * DVec3::Z;
    let out = after(&scene, Ray::new(place(DVec3::new(0.1, 0.0, 2.0)), -axis), 4);
    let angle = out.dir.dot(axis).acos().to_degrees();
    let known = (2.42 * 17f64.to_radians().sin()).asin().to_degrees();
    // The corners have single precision.
    assert!(
        (known - 45.04).abs() < 0.0051 && (angle - known).abs() < 1e-4,
        "{angle}"
    );
}

#[test]
fn the_prism_turns_the_beam_by_minimum_deviation() {
    let scene = load("prism.ron");
    let through = Ray::new(DVec3::new(-0.02, -1.0, 0.4), DVec3::Y);
    let out = after(&scene, through, 2);
    let deviation = out.dir.x.atan2(out.dir.y).to_degrees();
    let known = 2.0 * 0.75f64.asin().to_degrees() - 60.0;
    assert!((known - 37.18).abs() < 0.005);
    assert!(
        (deviation - known).abs() < 1e-6,
        "{deviation} instead of {known}"
    );
    let (name, ..) = step(&scene, &out).unwrap();
    assert_eq!(name, "wall");
    let above = Ray::new(DVec3::new(-0.02, -1.0, 0.55), DVec3::Y);
    assert_eq!(step(&scene, &above).unwrap().0, "wall");
}

#[test]
fn the_tumbler_is_as_thick_as_it_says() {
    for (file, center) in [
        ("tumbler.ron", DVec3::new(-0.2, 0.4, 0.00001)),
        ("glasses.ron", DVec3::new(-0.5, 0.35, 0.00001)),
    ] {
        let scene = load(file);
        let glass = scene
            .objects
            .iter()
            .position(|o| o.name == "tumbler")
            .unwrap();
        assert!(scene.world.instances()[glass].shape.is_closed());
        let height = scene.world.instance_bounds(glass as u32).unwrap();
        assert!((height.max.z - 0.95).abs() < 1e-4);
        // Straight down the axis: the base.
        let down = Ray::new(center + DVec3::new(1e-3, 2e-3, 2.0), DVec3::NEG_Z);
        let (_, top, _) = step(&scene, &down).unwrap();
        let (_, bottom, _) = step(&scene, &top.spawn(DVec3::NEG_Z)).unwrap();
        assert!((top.p.z - bottom.p.z - 0.12).abs() < 1e-6);
        // Through the wall along its normal.
        for degrees in [10.0f64, 100.0, 215.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let out = DVec3::new(cos, sin, 0.0);
            let inward = Ray::new(center + out * 0.55 + DVec3::Z * 0.5, -out);
            let (_, outer, _) = step(&scene, &inward).unwrap();
            let (_, inner, _) = step(&scene, &outer.spawn(-outer.ng)).unwrap();
            let wall = outer.p.distance(inner.p);
            // Facets of 2.6 degrees stand up to 1e-4 m off the true wall.
            assert!((wall - 0.05).abs() < 2e-4, "{file}: wall {wall}");
        }
    }
}

/// Everything that enters the flat end is reflected totally at the side and
/// leaves at the other end.
#[test]
fn the_light_guide_guides_all_light() {
    let scene = load("light_guide.ron");
    let (side, top) = (0, 2);
    let sequence = Sequence::new(1, Purpose::Pilot, 0, 0);
    let mut reflections = 0u32;
    for i in 0..2000 {
        let mut u = sequence.at(i);
        let p = warp::disc(u.next_2d()) * 0.0999;
        let d = warp::cosine_hemisphere(u.next_2d());
        let dir = DVec3::new(d.z, d.x, d.y);
        let start = DVec3::new(-0.7, p.x, 0.3 + p.y) - dir * 1e-6;
        let mut ray = after(&scene, Ray::new(start, dir), 1);
        loop {
            let (name, point, lobes) = step(&scene, &ray).unwrap();
            assert_eq!(name, "rod", "lost on the way");
            if point.surface.part == top {
                break;
            }
            assert_eq!(point.surface.part, side);
            let Some(Lobes::One(lobe)) = lobes else {
                panic!("path {i} leaks through the side at {}", point.p)
            };
            ray = point.spawn(lobe.dir);
            reflections += 1;
        }
    }
    assert!(reflections > 2000, "paths went straight through");
}

#[test]
fn the_hall_dims_by_the_power_of_its_reflectance() {
    let scene = load("hall_of_mirrors.ron");
    let mut ray = Ray::new(
        DVec3::new(-0.9, 0.0, 0.6),
        DVec3::new(0.05, 1.0, 0.0).normalize(),
    );
    let (mut weight, mut k) = (Rgb::WHITE, 0);
    let end = loop {
        let (name, point, lobes) = step(&scene, &ray).unwrap();
        let Some(lobes) = lobes else { break name };
        let lobe = onward(lobes);
        weight *= lobe.weight;
        ray = point.spawn(lobe.dir);
        k += 1;
    };
    // 42 m of way along y between mirrors 2.2 m apart.
    assert_eq!((end.as_str(), k), ("right wall", 19));
    for (c, r) in [0.92f64, 0.90, 0.85].into_iter().enumerate() {
        assert!((weight[c] / r.powi(k) - 1.0).abs() < 1e-13);
    }
}

/// Share of a light that reaches a point of the floor.
fn visible(scene: &Scene, light: usize, x: f64, y: f64) -> f64 {
    let settings = scene.settings.clone();
    let plan = Plan::new(scene, &settings);
    let picker = LightPicker::new(scene);
    let ctx = Context {
        scene,
        plan: &plan,
        picker: &picker,
        max_depth: settings.max_depth,
    };
    let (_, floor, _) = step(scene, &Ray::new(DVec3::new(x, y, 0.01), DVec3::NEG_Z)).unwrap();
    let named = &scene.lights[light];
    let n = 1024;
    let sequence = Sequence::new(2, Purpose::Pilot, 0, 0);
    let sum: f64 = (0..n)
        .map(|i| {
            let u = sequence.at(i).next_2d();
            let sample = named.light.sample_direct(floor.p, u).unwrap();
            assert!(matches!(sample.source, Source::Point(_)));
            transmittance(&ctx, &floor, &Media::NONE, &sample, named.instance)
        })
        .sum();
    sum / n as f64
}

#[test]
fn the_penumbra_is_as_wide_as_geometry_says() {
    let scene = load("soft_shadow.ron");
    let (lamp, spark) = (0, 1);
    let y = 0.533;
    // The card's right edge is at x = 0.4, seen from the lamp's two edges.
    let edge = |x_lamp: f64| x_lamp + (0.4 - x_lamp) * 3.0 / (3.0 - 0.75);
    let (inner, outer) = (edge(-1.6), edge(-2.4));
    assert!((outer - inner - 0.2667).abs() < 1e-4);
    assert_eq!(visible(&scene, lamp, inner - 0.005, y), 0.0);
    assert!(visible(&scene, lamp, inner + 0.005, y) > 0.0);
    assert!(visible(&scene, lamp, outer - 0.005, y) < 1.0);
    assert_eq!(visible(&scene, lamp, outer + 0.005, y), 1.0);
    let middle = visible(&scene, lamp, 0.5 * (inner + outer), y);
    assert!((middle - 0.5).abs() < 0.01, "half-way: {middle}");
    // The point's shadow has no width.
    let sharp = 2.0 + (-0.3 - 2.0) * 3.0 / (3.0 - 0.75);
    assert_eq!(visible(&scene, spark, sharp - 1e-9, y), 1.0);
    assert_eq!(visible(&scene, spark, sharp + 1e-9, y), 0.0);
}

#[test]
fn lamps_and_meshes_are_as_the_headers_say() {
    for (file, powers, within) in [
        ("glass_sphere.ron", [790.0, 711.0, 632.0], 0.5),
        ("cornell_glass.ron", [15.8, 13.6, 11.3], 0.05),
        ("glasses.ron", [284.0, 245.0, 197.0], 0.6),
    ] {
        let power = load(file).lights[0].light.power().unwrap();
        for (c, known) in powers.into_iter().enumerate() {
            assert!(
                (power[c] - known).abs() < within,
                "{file}: {} W instead of {known}",
                power[c]
            );
        }
    }
    for file in ["pool.ron", "mesh_glass.ron"] {
        assert_eq!(Summary::of(&load(file)).triangles, 131_072, "{file}");
    }
}

/// One small pass, with so many threads.
fn small_pass(scene: &Scene, threads: usize) -> render::PassOutput {
    let mut job = Job::of(scene);
    job.settings.photons = Some(6000);
    let window = [0, 0, 24, 18];
    let renderer = render::Renderer::new(scene, &job.settings, [24, 18], window);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(|| renderer.pass(9))
}

/// In every scene each light's watts are accounted for, the same ones by any
/// number of threads, and so is each pixel.
#[test]
fn every_scene_balances_and_ignores_threads() {
    for file in scene_files() {
        let name = file.display();
        let scene = load(file.file_name().unwrap().to_str().unwrap());
        let one = small_pass(&scene, 1);
        for light in &one.tally.lights {
            let off = light.imbalance().abs();
            assert!(off <= 1e-9 * light.launched, "{name}: {off} of {light:?}");
        }
        let five = small_pass(&scene, 5);
        assert_eq!(one.tally, five.tally, "{name}: watts");
        assert!(one.samples == five.samples, "{name}: pixels");
    }
}

/// What the headers of the scenes with water know.
#[test]
fn water_meets_glass_and_air_as_the_headers_say() {
    let scene = load("water_glass.ron");
    let plan = Plan::new(&scene, &scene.settings);
    let picker = LightPicker::new(&scene);
    let ctx = Context {
        scene: &scene,
        plan: &plan,
        picker: &picker,
        max_depth: scene.settings.max_depth,
    };
    // From the middle of the water straight at the conical wall.
    let nest = &plan.nest.as_ref().expect("bodies in each other").nest;
    let name = |i: Option<u32>| i.map(|i| scene.objects[i as usize].name.as_str());
    for (from, medium, share) in [
        (DVec3::new(0.0, 0.2, 0.3), "water", (0.17f64 / 2.83).powi(2)),
        (DVec3::new(0.0, 0.2, 0.85), "", 0.04),
    ] {
        let mut media = nest.around(&scene.world, from);
        assert_eq!(name(nest.medium(&media)).unwrap_or(""), medium);
        let first = meet(&ctx, &Ray::new(from, DVec3::Y), 9.0, &mut { media }).expect("the wall");
        let ray = Ray::new(from, -first.point.ns);
        let met = meet(&ctx, &ray, 9.0, &mut media).expect("the wall");
        assert_eq!(
            name(nest.medium(&media_beside(&ctx, media, &met.point, ray.dir))),
            Some("tumbler")
        );
        let Some(Lobes::Two(reflected, _)) =
            lobes(&met.material, &met.point, ray.dir, Carried::Flux)
        else {
            panic!("light splits at the wall");
        };
        // Normals of the true cone, interpolated: nearly straight on.
        assert!((reflected.share / share - 1.0).abs() < 1e-3, "{medium}");
    }
    let bubble = DVec3::new(-0.13, -0.12, 0.36);
    for (height, lobes_there) in [(0.0375, 2), (0.0377, 1)] {
        let ray = Ray::new(bubble + DVec3::new(0.0, -0.06, height), DVec3::Y);
        let mut media = nest.around(&scene.world, ray.origin);
        let met = meet(&ctx, &ray, 9.0, &mut media).expect("the bubble");
        let found = lobes(&met.material, &met.point, ray.dir, Carried::Flux);
        let count = match found {
            Some(Lobes::Two(..)) => 2,
            _ => 1,
        };
        assert_eq!(count, lobes_there, "at {height}");
    }
}

#[test]
fn the_window_under_water_is_as_wide_as_snell_says() {
    let scene = load("underwater.ron");
    let plan = Plan::new(&scene, &scene.settings);
    let picker = LightPicker::new(&scene);
    let ctx = Context {
        scene: &scene,
        plan: &plan,
        picker: &picker,
        max_depth: scene.settings.max_depth,
    };
    let eye = DVec3::new(0.0, 0.0, 0.4);
    for (away, sky) in [(1.820, true), (1.830, false)] {
        // Away from bubbles and buoy.
        let to = DVec3::new(-away, 0.0, 2.0);
        let mut walker = Walker::from_camera(&ctx, Ray::new(eye, (to - eye).normalize()));
        let met = meet(&ctx, &walker.ray, 9.0, &mut walker.media).expect("the surface");
        assert!((met.point.p - to).length() < 1e-9);
        let found = lobes(&met.material, &met.point, walker.ray.dir, Carried::Radiance);
        assert_eq!(matches!(found, Some(Lobes::Two(..))), sky, "{away} m away");
    }
}

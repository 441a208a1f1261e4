//! Ways of light, angles and thicknesses that the headers know.

use glam::DVec3;
use nephroid::{
    geometry::{Ray, Shape, Surface},
    light::Source,
    plan::{Media, Plan},
    sampling::{Purpose, Sequence, warp},
    scene::Scene,
    spectrum::Rgb,
    transport::{
        Carried, Context, LightPicker, Lobes, Walker, lobes, media_beside, meet, transmittance,
    },
};

use crate::{after, load, onward, step};

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

//! Glass that stands on what is opaque: light goes through the glass to the
//! table, and never beyond it.

use glam::DVec3;
use nephroid::{
    geometry::Ray,
    plan::Media,
    scene::Scene,
    transport::{Carried, Lobes, lobes, media_beside, meet},
};

use crate::{
    CAMERA, LAMP,
    coinciding::{KINDS, PLACES, block, triple, turned},
    common::{greens, independent, render, scene_of},
    with_context,
};

const TABLES: [&str; 4] = ["plane", "quad", "box", "mesh"];

const WOOD: &str = "Diffuse(reflectance: 0.5)";

/// A table whose top is at the height of `at`, turned as a block of this kind.
fn table(kind: &str, block: &str, size: f64, at: DVec3) -> String {
    let far = 30.0 * size;
    let corner = |x: f64, y: f64, z: f64| triple(at + DVec3::new(x, y, z) * far);
    let shape = match kind {
        "plane" => format!("Plane(point: {}, normal: (0, 0, 1))", triple(at)),
        "quad" => format!(
            "Quad(corner: {}, u: ({:?}, 0, 0), v: (0, {:?}, 0))",
            corner(-1.0, -1.0, 0.0),
            2.0 * far,
            2.0 * far
        ),
        "box" => format!(
            "Box(min: {}, max: {})",
            corner(-1.0, -1.0, -0.5),
            corner(1.0, 1.0, 0.0)
        ),
        _ => format!(
            "Mesh(vertices: [{}, {}, {}, {}], triangles: [(0, 1, 2), (0, 2, 3)])",
            corner(-1.0, -0.9, 0.0),
            corner(1.1, -1.0, 0.0),
            corner(1.0, 1.2, 0.0),
            corner(-1.3, 1.0, 0.0)
        ),
    };
    let turned = match block {
        "turned" => {
            ", at: (rotate: [(axis: (1, 0, 0), degrees: 17), (axis: (0, 0, 1), degrees: 40)])"
        }
        _ => "",
    };
    format!("(name: \"table\", shape: {shape}, material: {WOOD}{turned}),")
}

/// Surfaces that a ray meets one after the other: whether each is the table, and
/// where.
type Way = Vec<(bool, DVec3)>;

/// The way of a ray that is refracted where it can be, to the table, and a ray
/// back from there.
fn met(scene: &Scene, mut ray: Ray, mut media: Media) -> (Way, Option<(Ray, Media)>) {
    with_context(scene, |ctx| {
        let mut found = Vec::new();
        while let Some(met) = meet(ctx, &ray, f64::INFINITY, &mut media) {
            found.push((met.material.is_opaque(), met.point.p));
            let dir = match lobes(&met.material, &met.point, ray.dir, Carried::Flux) {
                Some(Lobes::One(lobe) | Lobes::Two(_, lobe)) => lobe.dir,
                // Back, up into the glass.
                None => {
                    let up = met.point.ng * -met.point.ng.dot(ray.dir).signum();
                    let dir = (up - 0.1 * ray.dir).normalize();
                    return (found, Some((met.point.spawn(dir), media)));
                }
            };
            media = media_beside(ctx, media, &met.point, dir);
            ray = met.point.spawn(dir);
            assert!(found.len() < 30, "no end");
        }
        (found, None)
    })
}

/// Blocks of every kind, on every table, at all sizes and places, with a
/// rounding between them or in each other: rays from above come through the
/// upper face to the table and no farther, and rays from there come out above.
#[test]
fn a_table_holds_what_stands_on_it() {
    let mut rays = 0;
    for kind in KINDS {
        for (size, shift) in PLACES {
            for board in TABLES {
                for order in 0..6 {
                    let at = DVec3::new(0.31, -0.17, 0.23) * shift;
                    let foot = [0.0, 0.0f64.next_up(), -f64::EPSILON * size][order % 3];
                    let glass = block(kind, [foot, 0.4 * size], size, at, "Dielectric(ior: 1.5)");
                    let wood = table(board, kind, size, at);
                    let both = [wood.clone() + &glass, glass + &wood];
                    let scene = scene_of(CAMERA, [8, 8], &both[order / 3], LAMP, "");
                    for _ in 0..8 {
                        let mut random = independent(7, rays);
                        let mut in_reach = || (random.next_1d() - 0.5) * size;
                        let mark = DVec3::new(in_reach(), in_reach(), 0.0);
                        let (s, c) = (0.8 * random.next_1d()).sin_cos();
                        let around = 6.3 * random.next_1d();
                        let dir = DVec3::new(s * around.cos(), s * around.sin(), -c);
                        let start = turned(kind, at + mark + DVec3::Z * (0.4 * size) - dir * size);
                        let ray = Ray::new(start, turned(kind, dir));
                        let case = format!("{kind} on {board}, {size:e} at {shift:e}, {order}");
                        let (down, end) = met(&scene, ray, Media::NONE);
                        let on_table: Vec<bool> = down.iter().map(|(table, _)| *table).collect();
                        assert_eq!(on_table, [false, true], "{case}");
                        // By Snell's law.
                        let expected = mark
                            + dir.with_z(0.0) / 1.5 * 0.4 * size / (1.0 - (s / 1.5).powi(2)).sqrt();
                        let off = down[1].1.distance(turned(kind, at + expected));
                        assert!(off <= 1e-13 * (size + shift), "{case}: {off}");
                        let (ray, media) = end.expect("a table");
                        let (up, end) = met(&scene, ray, media);
                        let on_table: Vec<bool> = up.iter().map(|(table, _)| *table).collect();
                        assert_eq!(on_table, [false], "{case}");
                        assert!(end.is_none());
                        rays += 1;
                    }
                }
            }
        }
    }
    assert_eq!(rays, 4 * 5 * 4 * 6 * 8);
}

/// Whichever order the objects have and whatever the table is made of, the
/// picture is that of a block that reaches into the table a little.
#[test]
fn pictures_do_not_depend_on_the_table() {
    let picture = |board: &str, foot: f64| {
        let glass = block("box", [foot, 0.9], 0.7, DVec3::ZERO, "Dielectric(ior: 1.5)");
        let objects = glass + &table(board, "box", 1.0, DVec3::ZERO);
        let camera = "eye: (1, -6, 3), look_at: (0, 0, 0.4), fov: 22";
        let lamp = "Sphere(center: (2, -3, 5), radius: 0.3, power: 300)";
        let scene = scene_of(camera, [24, 18], &objects, lamp, "passes: 8");
        render(&scene).film.image()
    };
    let sunk = picture("quad", -1e-4);
    for board in TABLES {
        let off: f64 = greens(&picture(board, 0.0))
            .zip(greens(&sunk))
            .map(|(a, b)| (a - b).abs())
            .sum();
        let sum: f64 = greens(&sunk).sum();
        // Kernels that reach over an edge see another table.
        assert!(off < 0.02 * sum, "{board}: {}", off / sum);
    }
}

/// Only what may have a piece in common pays for being looked at.
#[test]
fn a_ball_touches_in_a_point() {
    let of = |objects: &str| {
        let scene = scene_of(CAMERA, [8, 8], objects, LAMP, "");
        with_context(&scene, |ctx| ctx.plan.nest.is_some())
    };
    let floor = table("quad", "box", 1.0, DVec3::ZERO);
    let room = format!("(shape: Box(min: (-3, -3, 0), max: (3, 3, 3)), material: {WOOD}),");
    let glass = "Dielectric(ior: 1.5)";
    let ball = format!("(shape: Sphere(center: (0, 0, 1), radius: 1), material: {glass}),");
    let on = |low: f64| block("box", [low, 0.5], 0.5, DVec3::ZERO, glass);
    assert!(!of(&(floor.clone() + &ball)) && !of(&(room.clone() + &ball)));
    assert!(of(&(floor.clone() + &on(0.0))) && of(&(room.clone() + &on(0.0))));
    assert!(!of(&(floor.clone() + &on(1e-9))) && of(&(floor + &on(-1e-9))));
    let plane = table("plane", "box", 1.0, DVec3::ZERO);
    assert!(of(&(plane.clone() + &on(0.0))) && !of(&(plane + &on(1e-9))));
}

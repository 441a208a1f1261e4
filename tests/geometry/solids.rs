//! Solids: faces that coincide, nesting, places, and the lens.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use nephroid::{
    geometry::{
        Aabb, Ray, Shape, Transform, Turning, World,
        shape::{Body, Cuboid, Plane, Solid, SolidError, Sphere},
    },
    scene,
    transport::{Carried, Lobe, Lobes, lobes},
};

use crate::scenes::{Random, instance, single};

fn cuboid(min: [f64; 3], max: [f64; 3]) -> Body {
    instance(Shape::Cuboid(Cuboid::new(Aabb {
        min: DVec3::from_array(min),
        max: DVec3::from_array(max),
    })))
}

fn ball(center: [f64; 3], radius: f64) -> Body {
    instance(Shape::Sphere(Sphere::new(
        DVec3::from_array(center),
        radius,
    )))
}

fn solid(body: Body) -> Shape {
    Shape::Solid(Arc::new(Solid::new(body).expect("a sound solid")))
}

/// A world of one solid, sent somewhere by a map.
fn placed(body: Body, map: Option<DAffine3>) -> World {
    single(
        solid(body),
        map.map(|m| Transform::new(m).expect("regular")),
    )
}

/// Places and normals along a ray, one after the other, by rays that leave.
fn passages(world: &World, origin: DVec3, target: DVec3) -> Vec<(DVec3, DVec3)> {
    let dir = (target - origin).normalize();
    let (mut ray, mut list) = (Ray::new(origin, dir), Vec::new());
    while let Some(hit) = world.closest(&ray, f64::INFINITY) {
        let point = world.surface(&ray, &hit);
        list.push((point.p, point.ng));
        ray = point.spawn(dir);
        assert!(list.len() < 100, "rays come to an end");
    }
    list
}

/// Maps under which faces that coincided still do, up to rounding.
fn maps() -> Vec<Option<DAffine3>> {
    let mut random = Random(11);
    let mut list = vec![None];
    for size in [1e-4, 1.0, 1e5] {
        for away in [0.0, 1e3, 1e5] {
            list.push(Some(DAffine3::from_scale_rotation_translation(
                DVec3::new(1.0, 0.7, -1.3) * size,
                random.rotation(),
                random.direction() * away,
            )));
        }
    }
    list
}

/// Two boxes that share a wall: there is none between them.
#[test]
fn a_shared_face_is_no_wall() {
    for map in maps() {
        for gap in [0.0, 1e-17, -1e-17] {
            let third = 1.0 / 3.0;
            let body = Body::Union(vec![
                cuboid([-1.0, -1.0, -1.0], [third, 1.0, 1.0]),
                cuboid([third + gap, -1.0, -1.0], [2.0, 1.0, 1.0]),
            ]);
            let world = placed(body, map);
            let send = |p: DVec3| map.map_or(p, |m| m.transform_point3(p));
            let mut random = Random(3);
            for _ in 0..300 {
                let from = DVec3::new(-3.0, random.range(-0.9, 0.9), random.range(-0.9, 0.9));
                let to = DVec3::new(4.0, random.range(-0.9, 0.9), random.range(-0.9, 0.9));
                let found = passages(&world, send(from), send(to));
                assert_eq!(found.len(), 2, "{map:?}: {found:?}");
            }
        }
    }
}

/// A blind hole whose mouth is flush with a face is open there, and a recess
/// whose block is flush with a side is open on two sides.
#[test]
fn flush_holes_are_open() {
    for map in maps() {
        let body = || {
            Body::Difference(vec![
                cuboid([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
                cuboid([-0.5, -0.5, -0.2], [0.5, 0.5, 1.0]),
            ])
        };
        let world = placed(body(), map);
        let send = |p: DVec3| map.map_or(p, |m| m.transform_point3(p));
        let mut random = Random(4);
        for _ in 0..300 {
            let (x, y) = (random.range(-0.4, 0.4), random.range(-0.4, 0.4));
            let above = DVec3::new(x, y, 3.0);
            let below = DVec3::new(0.4 * y, 0.4 * x, -3.0);
            for (from, to) in [(above, below), (below, above)] {
                let found = passages(&world, send(from), send(to));
                assert_eq!(found.len(), 2, "{map:?}: {found:?}");
            }
            // Light from the bottom of the hole gets out.
            let bottom = send(DVec3::new(x, y, -0.2));
            let ray = Ray::new(send(above), (bottom - send(above)).normalize());
            let hit = world.closest(&ray, f64::INFINITY).expect("the bottom");
            let point = world.surface(&ray, &hit);
            let (out, distance) = point.spawn_towards(send(above)).expect("apart");
            assert!(!world.occluded(&out, distance, |_| false), "{map:?}");
        }
    }
}

/// An intersection whose operands share a face, entered through it: both are
/// entered at once.
#[test]
fn a_face_of_both_is_one_face() {
    for map in maps() {
        let body = Body::Intersection(vec![
            cuboid([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
            cuboid([-0.5, -2.0, -3.0], [0.5, 2.0, 1.0]),
            ball([0.0, 0.0, 0.0], 1.2),
            ball([0.0, 0.0, 0.0], 1.2),
        ]);
        let world = placed(body, map);
        let send = |p: DVec3| map.map_or(p, |m| m.transform_point3(p));
        let mut random = Random(5);
        for _ in 0..300 {
            let (x, y) = (random.range(-0.4, 0.4), random.range(-0.4, 0.4));
            let ends = [DVec3::new(x, y, 3.0), DVec3::new(y, x, -3.0)].map(send);
            for (from, to) in [(ends[0], ends[1]), (ends[1], ends[0])] {
                let found = passages(&world, from, to);
                assert_eq!(found.len(), 2, "{map:?}: {found:?}");
                assert!(found[0].1.dot(to - from) < 0.0 && found[1].1.dot(to - from) > 0.0);
            }
        }
    }
}

/// What a shape takes from itself leaves nothing behind.
#[test]
fn nothing_minus_nothing() {
    let mut random = Random(6);
    for map in maps() {
        let third = 1.0 / 3.0;
        let turn = Transform::new(DAffine3::from_quat(random.rotation()));
        let turned = |shape| Body::of(shape, turn);
        // The same ball, once turned: its centre rounds otherwise.
        let body = Body::Difference(vec![
            ball([0.0; 3], third),
            turned(Shape::Sphere(Sphere::new(DVec3::ZERO, third))),
        ]);
        let world = placed(body, map);
        let s = world.instance_sphere(0).expect("bounded");
        for _ in 0..300 {
            let origin = s.center + random.direction() * s.radius * 3.0;
            let target = s.center + random.vector(0.5) * s.radius;
            let found = passages(&world, origin, target);
            assert!(found.is_empty(), "{map:?}: {found:?}");
        }
    }
}

/// A half-space cuts; its own normal is the face's.
#[test]
fn planes_cut() {
    let upper = Body::Difference(vec![
        ball([0.0; 3], 1.0),
        instance(Shape::Plane(Plane::new(DVec3::Z * 0.25, DVec3::Z))),
    ]);
    let lower = Body::Intersection(vec![
        ball([0.0; 3], 1.0),
        instance(Shape::Plane(Plane::new(DVec3::Z * 0.25, DVec3::Z))),
    ]);
    for (body, sign) in [(upper, -1.0), (lower, 1.0)] {
        let world = placed(body, None);
        let from = DVec3::new(0.1, 0.2, 0.25 + sign * 3.0);
        let found = passages(&world, from, DVec3::new(0.1, 0.2, 0.25));
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].1, DVec3::Z * sign);
        assert_eq!(found[0].0.z, 0.25);
        let inside = DVec3::new(0.0, 0.0, 0.25 - sign * 0.5);
        assert_eq!(
            passages(&world, inside, DVec3::X * 5.0).len(),
            1,
            "from inside"
        );
        // A ray within a plane parallel to the cut never crosses it.
        let level = 0.25 - sign * 0.3;
        let across = [DVec3::new(-3.0, 0.0, level), DVec3::new(3.0, 0.0, level)];
        assert_eq!(passages(&world, across[0], across[1]).len(), 2);
    }
}

#[test]
fn what_cannot_be_a_solid_is_refused() {
    let plane = || instance(Shape::Plane(Plane::new(DVec3::ZERO, DVec3::Z)));
    let refused = |body| Solid::new(body).expect_err("no solid");
    assert_eq!(refused(plane()), SolidError::Unbounded);
    assert_eq!(
        refused(Body::Union(vec![ball([0.0; 3], 1.0), plane()])),
        SolidError::Unbounded
    );
    assert_eq!(
        refused(Body::Difference(vec![plane(), ball([0.0; 3], 1.0)])),
        SolidError::Unbounded
    );
    let apart = vec![ball([0.0; 3], 1.0), ball([3.0, 0.0, 0.0], 1.0)];
    assert_eq!(refused(Body::Intersection(apart)), SolidError::Empty);
    let many = (0..65).map(|_| ball([0.0; 3], 1.0)).collect();
    assert_eq!(refused(Body::Union(many)), SolidError::TooMany(65));
    let full = (0..64)
        .map(|i| ball([f64::from(i), 0.0, 0.0], 0.6))
        .collect();
    let world = placed(Body::Union(full), None);
    assert_eq!(passages(&world, DVec3::X * -5.0, DVec3::ZERO).len(), 2);
}

/// The normal of what is taken away turns the other way.
#[test]
fn dents_are_curved_inward() {
    let body = Body::Difference(vec![
        cuboid([-1.0; 3], [1.0, 1.0, 0.0]),
        ball([0.0; 3], 0.5),
    ]);
    let world = placed(body, None);
    let ray = Ray::new(DVec3::new(0.1, 0.0, 3.0), DVec3::NEG_Z);
    let hit = world.closest(&ray, f64::INFINITY).expect("the dent");
    let point = world.surface(&ray, &hit);
    assert!(point.ng.z > 0.9, "out of the solid: {}", point.ng);
    assert_eq!(
        world.turning(&hit, &point),
        Turning::Round { curvature: -2.0 }
    );
}

/// A lens in a scene of its own.
fn lens(fields: &str) -> World {
    let text = format!(
        "(camera: (eye: (0, 9, 0), look_at: (0, 0, 0), fov: 40), image: (width: 8, height: 8),
          objects: [(shape: Lens({fields}), material: Dielectric(ior: 1.5))])"
    );
    scene::load_str(&text, "lens.ron", ".".as_ref())
        .unwrap_or_else(|mistakes| panic!("{}", mistakes.render(false)))
        .world
}

/// Where a ray along +z at a height above the axis meets it again.
fn meets_axis(world: &World, ior: f64, height: f64) -> f64 {
    let glass = nephroid::material::Material::Dielectric {
        ior,
        priority: None,
        thin: false,
    };
    let mut ray = Ray::new(DVec3::new(height, 0.0, -5.0), DVec3::Z);
    for _ in 0..2 {
        let hit = world.closest(&ray, f64::INFINITY).expect("a face");
        let point = world.surface(&ray, &hit);
        let Some(Lobes::Two(_, Lobe { dir, .. })) = lobes(&glass, &point, ray.dir, Carried::Flux)
        else {
            panic!("refracted");
        };
        ray = point.spawn(dir);
    }
    assert!(
        world.closest(&ray, f64::INFINITY).is_none(),
        "out of the lens"
    );
    ray.origin.z - ray.origin.x / ray.dir.x * ray.dir.z
}

/// The back focus is where the formula of thick lenses puts it:
/// `1 / f = (n - 1) (1 / r1 - 1 / r2 + (n - 1) t / (n r1 r2))`, and it lies
/// `f (1 - (n - 1) t / (n r1))` behind the second face (E. Hecht, *Optics*,
/// section 6.1).
#[test]
fn lenses_focus_where_the_formula_says() {
    let inverse = |r: f64| if r.is_finite() { 1.0 / r } else { 0.0 };
    for (r1, r2, t, aperture) in [
        (0.5, -0.5, 0.1, 0.3),
        (0.5, -0.7, 0.4, 0.6),
        (0.3, f64::INFINITY, 0.05, 0.2),
        (f64::INFINITY, -0.3, 0.05, 0.2),
        (0.2, 0.5, 0.1, 0.25),
        (-0.5, -0.2, 0.1, 0.25),
        (-0.4, 0.6, 0.02, 0.4),
        (f64::INFINITY, 0.6, 0.02, 0.4),
        (-0.6, f64::INFINITY, 0.02, 0.4),
        (0.4, 0.3, 0.05, 0.2),
        // A ball: both faces belong to one sphere.
        (0.5, -0.5, 1.0, 0.9),
    ] {
        let field = |name: &str, r: f64| {
            if r.is_finite() {
                format!("{name}: {r}, ")
            } else {
                String::new()
            }
        };
        let world = lens(&format!(
            "{}{}thickness: {t}, aperture: {aperture}",
            field("r1", r1),
            field("r2", r2)
        ));
        for n in [1.5, 1.33, 2.0] {
            let (c1, c2) = (inverse(r1), inverse(r2));
            let power = (n - 1.0) * (c1 - c2 + (n - 1.0) * t / n * c1 * c2);
            let known = 0.5 * t + (1.0 - (n - 1.0) * t / n * c1) / power;
            // Aberration goes with the square of the height.
            let found = meets_axis(&world, n, 1e-5);
            assert!(
                (found / known - 1.0).abs() < 1e-7,
                "r1 {r1}, r2 {r2}, n {n}: {found} instead of {known}"
            );
        }
        let b = world.instance_bounds(0).expect("bounded");
        assert!((b.max.x - 0.5 * aperture).abs() < 1e-12, "{b:?}");
        let rim = |r: f64| {
            let half = 0.5 * aperture;
            inverse(r) * half * half / (1.0 + (1.0 - (half * inverse(r)).powi(2)).sqrt())
        };
        let ends = [
            (-0.5 * t).min(-0.5 * t + rim(r1)),
            (0.5 * t).max(0.5 * t + rim(r2)),
        ];
        assert!(
            (b.min.z - ends[0]).abs() < 1e-12 && (b.max.z - ends[1]).abs() < 1e-12,
            "{b:?} {ends:?}"
        );
    }
}

/// Nested solids, each operand in its own place, against the same one put
/// together by hand.
#[test]
fn nested_places_compose() {
    let text = |shape: &str| {
        format!(
            "(camera: (eye: (0, 9, 0), look_at: (0, 0, 0), fov: 40), image: (width: 8, height: 8),
              objects: [(shape: {shape}, material: Dielectric(ior: 1.5))])"
        )
    };
    let world = |shape: &str| {
        scene::load_str(&text(shape), "x.ron", ".".as_ref())
            .unwrap_or_else(|mistakes| panic!("{}", mistakes.render(false)))
            .world
    };
    let nested = world(
        "Difference(of: [
            (shape: Box(center: (0, 0, 0), size: (2, 2, 2))),
            (shape: Union(of: [
                (shape: Cylinder(base: (0, 0, -1), end: (0, 0, 1), radius: 0.3, capped: true), at: (scale: (1, 1, 2))),
                (shape: Sphere(center: (0, 0, 0), radius: 0.5), at: [(translate: (1, 0, 0)), (rotate: (axis: (0, 0, 1), degrees: 90))]),
             ]), at: (rotate: (axis: (1, 0, 0), degrees: 90))),
        ])",
    );
    let flat = world(
        "Difference(of: [
            (shape: Box(min: (-1, -1, -1), max: (1, 1, 1))),
            (shape: Cylinder(base: (0, 2, 0), end: (0, -2, 0), radius: 0.3, capped: true)),
            (shape: Sphere(center: (0, 0, 1), radius: 0.5)),
        ])",
    );
    let mut random = Random(8);
    let mut hits = 0;
    for _ in 0..2000 {
        let origin = random.direction() * 4.0;
        let target = random.vector(1.0);
        let [a, b] = [&nested, &flat].map(|w| passages(w, origin, target));
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            assert!(
                a.0.distance(b.0) < 1e-12 && a.1.distance(b.1) < 1e-12,
                "{a:?} {b:?}"
            );
            hits += 1;
        }
    }
    assert!(hits > 2000, "{hits}");
}

//! How normals turn, against the difference between the normals that two
//! neighbouring rays find.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use nephroid::{
    geometry::{
        Hit, Ray, Shape, SurfacePoint, Transform, TriangleMesh, Turning, World,
        shape::{Cylinder, Sphere},
    },
    numeric::Frame,
};

use crate::scenes::{KINDS, Random, grid_mesh, shape, single, sphere_mesh};

/// What a ray finds in a world.
fn look(world: &World, ray: &Ray) -> Option<(Hit, SurfacePoint)> {
    let hit = world.closest(ray, f64::INFINITY)?;
    Some((hit, world.surface(ray, &hit)))
}

/// Compares the turning at where `ray` arrives with the normals around it;
/// `bend` bounds the turning in radians a metre over the whole surface.
/// Returns how large the turning was in units of what the comparison
/// tolerates, or `None` if there was nothing to compare.
fn compare(world: &World, ray: &Ray, random: &mut Random, bend: f64) -> Option<f64> {
    let (hit, point) = look(world, ray)?;
    if point.ng.dot(ray.dir).abs() < 0.2 {
        return None;
    }
    let turning = world.turning(&hit, &point);
    let frame = Frame::around(point.ng);
    let angle = random.direction();
    // A step whose square is far below the step and far above rounding.
    let step = (frame.s * angle.x + frame.t * angle.y) * (1e-5 / bend);
    let beside = Ray::new(ray.origin + step, ray.dir);
    let (_, other) = look(world, &beside).filter(|(h, _)| h.surface == hit.surface)?;
    let moved = other.p - point.p;
    let v = moved - point.ng * point.ng.dot(moved);
    let expected = other.ns - point.ns;
    let found = turning.of(v);
    // The second derivative of a normal is a few squares of the first, and
    // each normal is some roundings from its place: a hundred, and as many
    // for the position of a vertex.
    let tolerance = 8.0 * (bend * v.length()).powi(2) + 1e-14 * (1.0 + bend * point.p.length());
    assert!(
        (found - expected).length() <= tolerance,
        "{turning:?}: {found} instead of {expected}, tolerance {tolerance:e}, {:?}",
        world.instances()[0],
    );
    assert!(
        found.dot(point.ns).abs() <= 1e-12 * found.length().max(bend * v.length()),
        "a unit normal turns across itself"
    );
    Some(expected.length() / tolerance)
}

/// A ray from outside to somewhere near `at`.
fn towards(random: &mut Random, at: DVec3, spread: f64) -> Ray {
    let origin = at + random.direction() * 5.0 * spread;
    let target = at + random.vector(spread);
    Ray::new(origin, (target - origin).normalize())
}

/// Shapes of every kind, as they are and under sheared and mirrored maps.
#[test]
fn normals_turn_as_their_derivative_says() {
    const ALL: usize = KINDS as usize + 1;
    let mut compared = [[0, 0]; ALL];
    let mut sharp = [[0, 0]; ALL];
    for seed in 0..600 * ALL as u64 {
        let mut random = Random(seed);
        let kind = seed % ALL as u64;
        let made = if kind == KINDS {
            Shape::Mesh(Arc::new(sphere_mesh(&mut random, 6, DVec3::ZERO, 1.0, 0.0)))
        } else {
            shape(&mut random, kind, DVec3::ZERO, 1.0)
        };
        let map = (random.below(2) == 0).then(|| random.transform(1.0));
        // Radii are at least 0.3 and stretches in [0.2, 3]; the corners of a
        // mesh lie up to a fifth deeper than the sphere of their normals.
        let own = match kind {
            0..=4 | 6 | 9 | 11..KINDS => 4.0,
            _ => 8.0,
        };
        let bend = own
            * if map.is_some() {
                3.0 / (0.2 * 0.2)
            } else {
                1.0
            };
        let at = map.map_or(DVec3::ZERO, |m| m.point(DVec3::ZERO));
        let world = single(made, map);
        for _ in 0..20 {
            let ray = towards(&mut random, at, 1.0);
            if let Some(signal) = compare(&world, &ray, &mut random, bend) {
                let mapped = usize::from(map.is_some());
                compared[kind as usize][mapped] += 1;
                sharp[kind as usize][mapped] += usize::from(signal > 10.0);
            }
        }
    }
    for kind in 0..ALL {
        for mapped in 0..2 {
            assert!(compared[kind][mapped] > 200, "{compared:?}");
            // Discs, quads, lone triangles and boxes do not turn; other shapes
            // have flat parts, too.
            if !(2..5).contains(&kind) && kind != 11 {
                let (sharp, all) = (sharp[kind][mapped], compared[kind][mapped]);
                assert!(3 * sharp > all, "kind {kind}: {sharp} of {all} could fail");
            }
        }
    }
}

fn turning_from(world: &World, from: DVec3, to: DVec3) -> (Turning, SurfacePoint) {
    let ray = Ray::new(from, (to - from).normalize());
    let (hit, point) = look(world, &ray).expect("a hit");
    (world.turning(&hit, &point), point)
}

#[test]
fn similar_spheres_stay_round() {
    let mut random = Random(5);
    let sphere = Shape::Sphere(Sphere::new(DVec3::new(0.3, -0.2, 0.1), 0.5));
    for scale in [1e-3, 0.7, -4.0, 1e4] {
        let turn = random.rotation();
        let again = DAffine3::from_quat(random.rotation());
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            turn,
            random.vector(2.0),
        ) * again;
        let map = Transform::new(map).expect("regular");
        let center = map.point(DVec3::new(0.3, -0.2, 0.1));
        let world = single(sphere.clone(), Some(map));
        let (turning, _) = turning_from(&world, center + random.direction() * 3.0 * scale, center);
        let Turning::Round { curvature } = turning else {
            panic!("{turning:?} at scale {scale}");
        };
        let expected = 2.0 / scale.abs();
        assert!((curvature / expected - 1.0).abs() < 1e-14, "{curvature}");
    }
    let squashed = Transform::new(DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.0 + 1e-12)));
    let (turning, _) = turning_from(&single(sphere, squashed), DVec3::Z * 3.0, DVec3::ZERO);
    assert!(matches!(turning, Turning::General(_)), "{turning:?}");
}

#[test]
fn caps_and_facets_are_flat() {
    let tube = Shape::Cylinder(Cylinder::new(DVec3::ZERO, DVec3::Z, 1.0, true));
    for from in [2.0, -2.0] {
        let world = single(tube.clone(), None);
        let (turning, _) = turning_from(&world, DVec3::Z * from, DVec3::ZERO);
        assert_eq!(turning, Turning::Flat);
    }
    // Legs of 3 and 4, hypotenuse 5: the incircle has radius 1.
    let corners = vec![DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 4.0];
    let facet = TriangleMesh::new(corners, None, vec![[0, 1, 2]]).unwrap();
    let facet = Shape::Mesh(Arc::new(facet));
    let above = DVec3::new(0.5, 0.5, 2.0);
    let below = DVec3::new(0.5, 0.5, 0.0);
    let size = |map: Option<DAffine3>| {
        let world = single(facet.clone(), map.and_then(Transform::new));
        match turning_from(&world, above, below).0 {
            Turning::Facet { size } => size,
            other => panic!("{other:?}"),
        }
    };
    assert!((size(None) - 2.0).abs() < 1e-15);
    let doubled = DAffine3::from_scale(DVec3::new(2.0, 2.0, 9.0));
    assert!((size(Some(doubled)) - 4.0).abs() < 1e-14);
    // Squeezed to legs of 3 and 1/4.
    let squeezed = DAffine3::from_scale(DVec3::new(1.0, 1.0 / 4.0, 1.0));
    let expected = 3.0 + 1.0 - 10f64.sqrt();
    assert!((size(Some(squeezed)) - expected).abs() < 1e-14);
    let (bumpy, _) = grid_mesh(&mut Random(7), 4, 0.1);
    let world = single(Shape::Mesh(Arc::new(bumpy)), None);
    let (turning, _) = turning_from(&world, DVec3::Z * 2.0, DVec3::new(0.1, 0.2, 0.0));
    assert!(matches!(turning, Turning::Facet { .. }), "{turning:?}");
    assert_eq!(turning.of(DVec3::X), DVec3::ZERO);
}

/// A map that drives the corners' normals away from the facet's: shading
/// falls back to the facet, and so does its turning.
#[test]
fn replaced_normals_turn_with_the_facet() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let leaning = DVec3::new(1.0, 0.0, 0.2);
    let normals = vec![leaning, leaning + DVec3::Y * 0.1, leaning];
    let mesh = TriangleMesh::new(corners, Some(normals), vec![[0, 1, 2]]).unwrap();
    let shape = Shape::Mesh(Arc::new(mesh));
    let inside = DVec3::new(0.25, 0.25, 0.0);
    let (turning, point) = turning_from(&single(shape.clone(), None), inside + DVec3::Z, inside);
    assert!(matches!(turning, Turning::General(_)), "{turning:?}");
    assert!(point.ns != point.ng);
    // Normals go by the inverse transpose: the shear tips `leaning` over.
    let mut shear = DAffine3::IDENTITY;
    shear.matrix3.x_axis = DVec3::new(1.0, 0.0, 1.0);
    let map = Transform::new(shear).expect("regular");
    let target = map.point(inside);
    let world = single(shape, Some(map));
    let (turning, point) = turning_from(&world, target + DVec3::Z, target);
    assert_eq!(point.ns, point.ng, "replaced");
    assert!(matches!(turning, Turning::Facet { .. }), "{turning:?}");
}

/// A smooth mesh whose normals are the facet's own does not become one of
/// facets: its neighbours need not be flat.
#[test]
fn equal_normals_are_not_replaced_ones() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let normals = vec![DVec3::Z, DVec3::Z, DVec3::Z];
    let mesh = TriangleMesh::new(corners, Some(normals), vec![[0, 1, 2]]).unwrap();
    let double = Transform::new(DAffine3::from_scale(DVec3::splat(2.0)));
    for map in [None, double] {
        let world = single(Shape::Mesh(Arc::new(mesh.clone())), map);
        let inside = DVec3::new(0.25, 0.25, 0.0);
        let (turning, point) = turning_from(&world, inside + DVec3::Z, inside);
        assert_eq!(point.ns, point.ng);
        assert!(matches!(turning, Turning::General(_)), "{turning:?}");
        assert_eq!(turning.of(DVec3::X), DVec3::ZERO);
    }
}

//! Every closed shape against what is inside of it.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use nephroid::{
    formula::Formula,
    geometry::{
        Aabb, Ray, Shape, Surface, SurfacePoint, Transform, TriangleMesh, World,
        shape::{Body, Implicit, RootFinder, ShapeHit, Solid},
    },
};
use proptest::prelude::*;

use crate::{
    known::{CONVEX, KINDS, Known, known},
    scenes::{Random, single},
};

fn crossings(shape: &Shape, origin: DVec3, dir: DVec3) -> Vec<ShapeHit> {
    let mut list = Vec::new();
    shape.crossings(origin, dir, None, &mut |hit| list.push(hit));
    list.sort_by(|a, b| a.t.total_cmp(&b.t));
    list
}

/// Crossings one after the other, by the nearest hit of rays that leave.
fn marched(world: &World, origin: DVec3, dir: DVec3) -> Vec<(f64, SurfacePoint)> {
    let (mut ray, mut past, mut list) = (Ray::new(origin, dir), 0.0, Vec::new());
    while let Some(hit) = world.closest(&ray, f64::INFINITY) {
        let point = world.surface(&ray, &hit);
        past += hit.t;
        list.push((past, point));
        ray = point.spawn(dir);
    }
    list
}

/// A line that comes near the shape, from inside or from as far as `far`
/// sizes.
fn line(random: &mut Random, shape: &Shape, far: f64) -> (DVec3, DVec3, f64) {
    let s = shape.bounding_sphere().expect("bounded");
    let away = if random.below(3) == 0 { 0.7 } else { far };
    let origin = s.center + random.direction() * s.radius * away;
    let target = s.center + random.vector(0.7) * s.radius;
    (origin, (target - origin).normalize(), s.radius)
}

/// What is inside at so many places along the line must be what the crossings
/// say.
fn check_line(
    k: &Known,
    list: &[ShapeHit],
    origin: DVec3,
    dir: DVec3,
    from: f64,
    to: f64,
    slack: f64,
) {
    for i in 0..150 {
        let t = from + (to - from) * (f64::from(i) + 0.5) / 150.0;
        let level = (k.level)(origin + dir * t);
        if t <= 0.0 || level.abs() <= slack {
            continue;
        }
        let ahead = list.iter().filter(|h| h.t > t).count();
        assert_eq!(
            ahead % 2 == 1,
            level < 0.0,
            "{}: level {level:e} at {t} of {origin} {dir}, {list:?}, {:?}",
            k.name,
            k.shape
        );
    }
}

/// Scales, places and distances.
fn any_case() -> impl Strategy<Value = (u64, f64, f64, f64)> {
    (
        any::<u64>(),
        -4.0..5.0f64,
        prop_oneof![Just(0.0), 0.0..1e5f64],
        prop_oneof![Just(2.5), Just(1e4)],
    )
}

/// How far levels may be off: coordinates are rounded where the shape is, and
/// where rays start; the coefficients of a quadric are, as the square of where
/// it is.
fn slack(kind: u64, size: f64, away: f64, far: f64) -> f64 {
    let written = if kind == 5 {
        1e-15 * away * away / size
    } else {
        0.0
    };
    1e-13 * (away + far * size) + 1e-9 * size + written
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn crossings_tell_what_is_inside((seed, exponent, away, far) in any_case()) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let at = random.direction() * away;
        for kind in 0..KINDS {
            let k = known(&mut random, kind, at, size);
            let slack = slack(kind, size, away, far);
            if slack > 0.05 * size {
                continue;
            }
            for _ in 0..20 {
                let (origin, dir, radius) = line(&mut random, &k.shape, far);
                let list = crossings(&k.shape, origin, dir);
                for hit in &list {
                    let p = k.shape.surface(origin, dir, hit).p;
                    prop_assert!((k.level)(p).abs() <= slack, "{}: {}", k.name, (k.level)(p));
                }
                let middle = (k.shape.bounding_sphere().unwrap().center - origin).dot(dir);
                check_line(&k, &list, origin, dir, middle - 1.5 * radius, middle + 1.5 * radius, slack);
                // The nearest hit is the first of them, and bounds hold all.
                let first = k.shape.intersect(origin, dir, f64::INFINITY, None);
                prop_assert_eq!(first.map(|h| h.t), list.first().map(|h| h.t), "{}", k.name);
                if let Some(hit) = first {
                    prop_assert_eq!(k.shape.intersect(origin, dir, hit.t, None), None);
                    prop_assert!(k.shape.occludes(origin, dir, hit.t * 1.01, None));
                }
            }
        }
    }

    /// From hit to hit, by rays that leave the last one, the same crossings
    /// are found; normals alternate.
    #[test]
    fn leaving_finds_the_same_crossings((seed, exponent, away, far) in any_case()) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let at = random.direction() * away;
        for kind in 0..KINDS {
            let k = known(&mut random, kind, at, size);
            let slack = slack(kind, size, away, far);
            if slack > 0.05 * size {
                continue;
            }
            let world = single(k.shape.clone(), None);
            for _ in 0..20 {
                let (origin, dir, _) = line(&mut random, &k.shape, far);
                let list = crossings(&k.shape, origin, dir);
                let steps = marched(&world, origin, dir);
                // Grazing pairs may be seen by one of them only.
                let sharp = list.iter().all(|h| k.shape.surface(origin, dir, h).ng.dot(dir).abs() > 1e-3)
                    && steps.iter().all(|(_, p)| p.ng.dot(dir).abs() > 1e-3)
                    && list.windows(2).all(|w| w[1].t - w[0].t > 10.0 * slack);
                if !sharp {
                    continue;
                }
                prop_assert_eq!(list.len(), steps.len(), "{}: {:?} {:?}, {:?} from {} along {}", k.name, list, steps, k.shape, origin, dir);
                let inside = list.len() % 2 == 1;
                for (i, (hit, (t, point))) in list.iter().zip(&steps).enumerate() {
                    prop_assert!((hit.t - t).abs() <= 1e4 * slack, "{}: {} {}", k.name, hit.t, t);
                    prop_assert_eq!(point.ng.dot(dir) < 0.0, (i % 2 == 0) != inside, "{}", k.name);
                }
            }
        }
    }

    /// Random walks inside and outside: what the tangent plane and the level
    /// say decides whether a ray that leaves meets the shape again.
    #[test]
    fn convex_shapes_are_left_for_good(seed: u64, exponent in -4.0..5.0f64, away in prop_oneof![Just(0.0), 0.0..1e5f64], moved: bool) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let at = random.direction() * away.min(1e9 * size);
        for kind in 0..CONVEX {
            let k = known(&mut random, kind, at, size);
            let transform: Option<Transform> = moved.then(|| random.transform(10.0 * size));
            let world = single(k.shape.clone(), transform);
            let s = world.instance_sphere(0).expect("bounded");
            for _ in 0..40 {
                let origin = s.center + random.direction() * s.radius * random.range(1.5, 4.0);
                let target = s.center + random.vector(0.5) * s.radius;
                let ray = Ray::new(origin, (target - origin).normalize());
                let Some(hit) = world.closest(&ray, f64::INFINITY) else { continue };
                let point = world.surface(&ray, &hit);
                let dir = random.direction();
                // Within rounding of the tangent plane either is right.
                let noise = 1e-9 + 1e3 * point.error / s.radius;
                if dir.dot(point.ng).abs() <= noise {
                    continue;
                }
                let next = world.closest(&point.spawn(dir), f64::INFINITY);
                if dir.dot(point.ng) > 0.0 {
                    prop_assert!(next.is_none(), "{}: left {:?} along {}, met {:?} {:?}", k.name, point, dir, next, k.shape);
                    continue;
                }
                // Near an edge the way through may be shorter than rounding.
                let Some(next) = next else {
                    let t = 1e3 * point.error / dir.dot(point.ng).abs() + 1e-9 * s.radius;
                    let through = point.p + dir * t;
                    let own = transform.map_or(through, |m| m.inverse_point(through));
                    prop_assert!((k.level)(own) > -1e-12 * (away + size), "{}: no exit from {:?} along {} {:?}", k.name, point, dir, k.shape);
                    continue;
                };
                let leaving = point.spawn(dir);
                let exit = world.surface(&leaving, &next);
                if exit.ng.dot(dir).abs() > noise {
                    prop_assert!(exit.ng.dot(dir) > 0.0, "{}: an exit is an exit: {:?} to {:?}", k.name, point, exit);
                    let gone = world.closest(&exit.spawn(dir), f64::INFINITY);
                    prop_assert!(gone.is_none(), "{}: left {:?} along {}, met {:?}", k.name, exit, dir, gone);
                }
            }
        }
    }
}

/// A box around a shape touches it on all six sides.
#[test]
fn boxes_are_tight() {
    let mut random = Random(77);
    for _ in 0..10 {
        for kind in [0, 1, 2, 3, 4, 7, 8] {
            let k = known(&mut random, kind, DVec3::ZERO, 1.0);
            let b = k.shape.bounds().expect("bounded");
            for axis in 0..3 {
                for side in [1.0, -1.0] {
                    // The support of the level set, by walking towards the
                    // face over its nearest points.
                    let face = if side > 0.0 { b.max[axis] } else { b.min[axis] };
                    let reached = farthest(&k, axis, side, &b);
                    assert!(
                        (face - reached) * side >= -1e-12 && (face - reached) * side < 2e-3,
                        "{}: {reached} of {face}",
                        k.name
                    );
                }
            }
        }
    }
}

/// How far a shape reaches along an axis: the farthest hit of rays along that
/// axis, refined around the best one.
fn farthest(k: &Known, axis: usize, side: f64, b: &nephroid::geometry::Aabb) -> f64 {
    let dir = DVec3::AXES[axis] * -side;
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (mut center, mut half) = (b.center(), b.half_diagonal());
    let mut best = f64::NEG_INFINITY;
    for _ in 0..12 {
        let mut at = center;
        for i in -20i32..=20 {
            for j in -20i32..=20 {
                let mut origin = center;
                origin[u] += half[u] * f64::from(i) / 20.0;
                origin[v] += half[v] * f64::from(j) / 20.0;
                origin[axis] = side * 10.0;
                let Some(hit) = k.shape.intersect(origin, dir, f64::INFINITY, None) else {
                    continue;
                };
                if 10.0 - hit.t > best {
                    best = 10.0 - hit.t;
                    at = origin;
                }
            }
        }
        center = at;
        half *= 0.4;
    }
    best * side
}

/// An octahedron of triangles, without a ball that a formula makes: operands
/// that tell their crossings one after the other.
#[test]
fn meshes_and_formulas_are_operands() {
    let signs = [1.0, -1.0];
    let corners: Vec<DVec3> = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|axis| signs.map(|s| axis * s))
        .collect();
    // Corners 2k and 2k + 1 are the two ends of axis k.
    let triangles = (0..8u32).map(|i| {
        let [x, y, z] = [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2)];
        if i.count_ones() % 2 == 0 {
            [x, y, z]
        } else {
            [x, z, y]
        }
    });
    let mesh = TriangleMesh::new(corners, None, triangles.collect()).expect("sound");
    assert!(mesh.is_closed() && mesh.signed_volume() > 0.0);
    let formula = Formula::parse("x^2 + y^2 + z^2 - 0.49").expect("a formula");
    let bounds = Aabb {
        min: DVec3::splat(-0.75),
        max: DVec3::splat(0.75),
    };
    let ball = Implicit::new(formula, bounds, RootFinder::Interval).expect("a surface");
    let map = DAffine3::from_translation(DVec3::new(0.2, 0.1, -0.1));
    let parts = vec![
        Body::of(Shape::Mesh(Arc::new(mesh)), None),
        Body::of(Shape::Implicit(Arc::new(ball)), Transform::new(map)),
    ];
    let solid = Solid::new(Body::Difference(parts)).expect("bounded");
    let middle = map.transform_point3(DVec3::ZERO);
    let k = Known {
        name: "octahedron without a ball",
        shape: Shape::Solid(Arc::new(solid)),
        level: Box::new(move |p| {
            let facets = (p.abs().element_sum() - 1.0) / 3f64.sqrt();
            facets.max(0.7 - p.distance(middle))
        }),
    };
    let mut random = Random(11);
    for _ in 0..400 {
        let (origin, dir, radius) = line(&mut random, &k.shape, 2.5);
        let list = crossings(&k.shape, origin, dir);
        for hit in &list {
            let p = k.shape.surface(origin, dir, hit).p;
            assert!((k.level)(p).abs() < 1e-9, "{}", (k.level)(p));
        }
        let at = -origin.dot(dir);
        check_line(&k, &list, origin, dir, at - radius, at + radius, 1e-9);
    }
}

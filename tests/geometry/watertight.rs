//! Rays aimed at the edges and vertices that triangles share.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use nephroid::geometry::{Ray, Shape, Surface, Transform, TriangleMesh, World};

use crate::{
    leaks::{hunt_judged, hunt_meshes, hunt_surface, surfaces},
    scenes::{Random, grid_mesh, single, sphere_mesh},
};

/// Points on vertices and edges of a mesh.
fn seams(random: &mut Random, mesh: &TriangleMesh, count: usize) -> Vec<DVec3> {
    let mut points = Vec::with_capacity(2 * count);
    for _ in 0..count {
        let part = random.below(mesh.triangle_count() as u64) as u32;
        let corners = mesh.triangle(part);
        let k = random.below(3) as usize;
        points.push(corners[k]);
        points.push(corners[k].lerp(corners[(k + 1) % 3], random.range(0.0, 1.0)));
    }
    points
}

fn misses(world: &World, rays: impl Iterator<Item = Ray>) -> usize {
    rays.filter(|r| world.closest(r, f64::INFINITY).is_none())
        .count()
}

#[test]
fn no_ray_escapes_from_a_closed_mesh() {
    for (scale, shift) in [
        (1e-3, 0.0),
        (1.0, 0.0),
        (1.0, 1e5),
        (1e6, 0.0),
        (1e-3, 10.0),
    ] {
        let mut random = Random(9);
        let center = DVec3::new(shift, -shift, 0.5 * shift);
        let mesh = sphere_mesh(&mut random, 24, center, scale, 0.3);
        assert!(mesh.is_closed());
        let targets = seams(&mut random, &mesh, 20_000);
        let world = single(Shape::Mesh(Arc::new(mesh)), None);
        let rays = targets.iter().map(|&target| {
            let origin = center + random.vector(0.3) * scale;
            Ray::new(origin, (target - origin).normalize())
        });
        assert_eq!(misses(&world, rays), 0, "scale {scale}, moved {shift}");
    }
}

/// The same from small to large and from near to far, with meshes from coarse
/// to fine; `benches/leaks.rs` goes on with it.
#[test]
fn no_ray_escapes_at_any_scale_and_place() {
    let bag = hunt_meshes(3, 60_000, 1000);
    assert_eq!((bag.rays, bag.leaks()), (60_000, 0), "{bag:?}");
}

/// Rays leave each surface from its own points and meet what they should.
#[test]
fn surfaces_are_left_and_met_as_they_should() {
    for name in surfaces() {
        let rays = if name.starts_with("formula") {
            1000
        } else {
            10_000
        };
        let bag = hunt_surface(name, 5, rays);
        assert_eq!(bag.leaks(), 0, "{name}: {bag:?}");
        // What the error of the start leaves open are a few grazing chords.
        assert!(bag.undecided * 25 < bag.rays, "{name}: {bag:?}");
    }
}

/// Where a surface is less steep than at the start of a ray, the level of the
/// start lies far from it: six of these rays once met that instead, and went on
/// beside their line.
#[test]
fn a_waist_is_met_where_it_is() {
    let bag = hunt_surface("hyperboloid", 0, 100_000);
    assert_eq!(bag.leaks(), 0, "{bag:?}");
}

/// A tube that is taken for a closed cylinder, and the other way round, and
/// any shape that is larger by a millionth: the judge above notices.
#[test]
fn a_wrong_surface_is_noticed() {
    assert!(hunt_judged("tube", "cylinder", 1.0, 5, 2000).leaks() > 100);
    assert!(hunt_judged("cylinder", "tube", 1.0, 5, 2000).leaks() > 100);
    for name in surfaces().skip(4) {
        let bag = hunt_judged(name, name, 1.0 + 1e-6, 5, 500);
        assert!(20 * bag.leaks() > bag.rays, "{name}: {bag:?}");
    }
}

#[test]
fn no_ray_passes_a_grid() {
    let mut random = Random(10);
    // Slopes below that of every ray: no ray can graze a crest.
    let (mesh, inner) = grid_mesh(&mut random, 64, 0.005);
    let world = single(Shape::Mesh(Arc::new(mesh)), None);
    for height in [1.0, 1e5] {
        let rays = inner.iter().map(|&target| {
            let origin = DVec3::new(random.range(-0.5, 0.5), random.range(-0.5, 0.5), 1.0) * height;
            Ray::new(origin, (target - origin).normalize())
        });
        assert_eq!(misses(&world, rays), 0, "from {height}");
    }
}

/// Rays parallel to an axis run exactly through vertices and along edges;
/// zeros of either sign must not matter.
#[test]
fn no_axis_parallel_ray_passes_a_grid() {
    let mut random = Random(11);
    for n in [16, 37] {
        let (mesh, inner) = grid_mesh(&mut random, n, 0.05);
        let step = 1.0 / f64::from(n);
        let mesh = Shape::Mesh(Arc::new(mesh));
        let upright = single(mesh.clone(), None);
        // The same with the axes exchanged: rays along x instead of z.
        let turn = DAffine3::from_mat3(glam::DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X));
        let lying = single(mesh, Transform::new(turn));
        for zeros in [[0.0, 0.0], [-0.0, 0.0], [0.0, -0.0], [-0.0, -0.0]] {
            for target in &inner {
                for offset in [
                    DVec3::ZERO,
                    DVec3::X * step,
                    DVec3::Y * step,
                    (DVec3::X + DVec3::Y) * step,
                ] {
                    let p = *target + offset;
                    let down = Ray::new(
                        DVec3::new(p.x, p.y, 1.0),
                        DVec3::new(zeros[0], zeros[1], -1.0),
                    );
                    assert!(upright.closest(&down, f64::INFINITY).is_some(), "{down:?}");
                    let along = Ray::new(
                        DVec3::new(1.0, p.x, p.y),
                        DVec3::new(-1.0, zeros[0], zeros[1]),
                    );
                    assert!(lying.closest(&along, f64::INFINITY).is_some(), "{along:?}");
                }
            }
        }
    }
}

/// The mesh without one triangle: the test above can fail.
#[test]
fn a_hole_is_seen() {
    let mut random = Random(12);
    let whole = sphere_mesh(&mut random, 12, DVec3::ZERO, 1.0, 0.0);
    let corners: Vec<_> = (0..whole.triangle_count() as u32)
        .map(|i| whole.triangle(i))
        .collect();
    let positions = corners.iter().flatten().copied().collect();
    let triangles = (1..corners.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let open = TriangleMesh::new(positions, None, triangles).unwrap();
    assert!(!open.is_closed());
    let [a, b, c] = corners[0];
    let world = single(Shape::Mesh(Arc::new(open)), None);
    let through = Ray::new(DVec3::ZERO, ((a + b + c) / 3.0).normalize());
    assert_eq!(misses(&world, [through].into_iter()), 1);
}

/// An edge whose supporting values cancel: the ray starts 1e5 away from
/// slivers, so that edge functions are all rounding.
#[test]
fn slivers_from_afar() {
    let mut random = Random(13);
    // A fan of thin triangles around an inner vertex, in a plane.
    let n = 97u32;
    let mut positions = vec![DVec3::new(1e-9, 0.3e-9, 0.0)];
    for i in 0..n {
        let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
        positions.push(DVec3::new(c, 1e-6 * s, 0.0));
    }
    let triangles = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
    let mesh = TriangleMesh::new(positions.clone(), None, triangles).unwrap();
    let world = single(Shape::Mesh(Arc::new(mesh)), None);
    for _ in 0..20_000 {
        let spoke = positions[1 + random.below(u64::from(n)) as usize];
        let target = positions[0].lerp(spoke, random.range(0.0, 0.99));
        // Straight above, so that the point aimed at is exact.
        let ray = Ray::new(DVec3::new(target.x, target.y, 1e5), DVec3::NEG_Z);
        assert!(world.closest(&ray, f64::INFINITY).is_some(), "{ray:?}");
    }
}

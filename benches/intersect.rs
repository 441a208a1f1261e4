//! One ray against one shape, half of the rays hitting: nanoseconds per test
//! (items are tests), and the cost of the full surface point.

use std::sync::Arc;

use divan::{Bencher, counter::ItemsCount};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use nephroid::geometry::{
    Aabb, Instance, Ray, Shape, Surface, Transform, TriangleMesh, World,
    shape::{
        Body, Conic, Cuboid, Cylinder, Disc, Ellipsoid, Plane, Quad, Quadric, Solid, Sphere, Torus,
        Triangle,
    },
};

fn main() {
    divan::main();
}

const SHAPES: [&str; 15] = [
    "plane",
    "quad",
    "disc",
    "sphere",
    "cylinder",
    "triangle",
    "mesh",
    "cone",
    "paraboloid",
    "hyperboloid",
    "ellipsoid",
    "torus",
    "box",
    "quadric",
    "lens",
];

fn shape(name: &str) -> Shape {
    let low = DVec3::new(-0.6, -0.6, 0.0);
    let (low_end, high_end) = (DVec3::NEG_Y * 0.6, DVec3::Y * 0.6);
    let cube = Aabb {
        min: DVec3::splat(-0.6),
        max: DVec3::splat(0.6),
    };
    match name {
        "plane" => Shape::Plane(Plane::new(DVec3::ZERO, DVec3::Z)),
        "quad" => Shape::Quad(Quad::new(low, DVec3::X * 1.2, DVec3::Y * 1.2)),
        "disc" => Shape::Disc(Disc::new(DVec3::ZERO, DVec3::Z, 0.7)),
        "sphere" => Shape::Sphere(Sphere::new(DVec3::ZERO, 0.7)),
        "cylinder" => Shape::Cylinder(Cylinder::new(DVec3::NEG_Y * 0.6, DVec3::Y * 0.6, 0.6, true)),
        "cone" => Shape::Conic(Conic::cone(low_end, high_end, [0.8, 0.0], true)),
        "paraboloid" => Shape::Conic(Conic::paraboloid(low_end, high_end, 0.8, true)),
        "hyperboloid" => {
            let conic = Conic::hyperboloid(low_end, high_end, [0.8, 0.8], 0.5, true);
            Shape::Conic(conic)
        }
        "ellipsoid" => {
            let axes = DVec3::new(0.9, 0.6, 0.7);
            let ellipsoid = Ellipsoid::new(DVec3::ZERO, axes, DMat3::IDENTITY);
            Shape::Ellipsoid(Arc::new(ellipsoid.expect("regular")))
        }
        "torus" => Shape::Torus(Torus::new(DVec3::ZERO, DVec3::Z, 0.6, 0.25)),
        "box" => Shape::Cuboid(Cuboid::new(cube)),
        "quadric" => {
            let saddle = [0.5, -0.3, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0];
            Shape::Quadric(Arc::new(Quadric::new(&saddle, cube, true)))
        }
        "lens" => {
            let face = |z| Shape::Sphere(Sphere::new(DVec3::Z * z, 1.0));
            let edge = Cylinder::new(DVec3::NEG_Z, DVec3::Z, 0.7, true);
            let parts = [Shape::Cylinder(edge), face(0.7), face(-0.7)];
            let parts = parts.map(|shape| Body::of(shape, None));
            let solid = Solid::new(Body::Intersection(parts.into()));
            Shape::Solid(Arc::new(solid.expect("bounded")))
        }
        "triangle" => Shape::Triangle(Triangle::new(low * 1.5, DVec3::X, DVec3::Y)),
        _ => {
            let positions = vec![low, low + DVec3::X * 1.2, low + DVec3::Y * 1.2];
            let mesh = TriangleMesh::new(positions, None, vec![[0, 1, 2]]);
            Shape::Mesh(Arc::new(mesh.expect("sound")))
        }
    }
}

/// Rays from one side to the other of a cube around the shape.
fn rays() -> Vec<Ray> {
    let fraction = |i: u32, step: f64| 2.0 * (f64::from(i) * step).fract() - 1.0;
    (0..1024)
        .map(|i| {
            let from = DVec3::new(fraction(i, 0.618), fraction(i, 0.414), 2.0);
            let to = DVec3::new(fraction(i, 0.732), fraction(i, 0.236), -2.0);
            Ray::new(from, (to - from).normalize())
        })
        .collect()
}

#[divan::bench(args = SHAPES)]
fn closest(bencher: Bencher, name: &str) {
    let (shape, rays) = (shape(name), rays());
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| {
            rays.iter()
                .filter(|r| {
                    shape
                        .intersect(r.origin, r.dir, f64::INFINITY, None)
                        .is_some()
                })
                .count()
        });
}

fn surfaces(bencher: Bencher, world: &World) {
    let rays = rays();
    let hits: Vec<_> = rays
        .iter()
        .filter_map(|r| world.closest(r, f64::INFINITY).map(|h| (*r, h)))
        .collect();
    bencher
        .counter(ItemsCount::new(hits.len()))
        .bench_local(|| {
            hits.iter()
                .map(|(r, h)| world.surface(r, h).p)
                .sum::<DVec3>()
        });
}

#[divan::bench(args = SHAPES)]
fn surface(bencher: Bencher, name: &str) {
    surfaces(
        bencher,
        &World::new(vec![Instance {
            shape: shape(name),
            transform: None,
        }]),
    );
}

#[divan::bench(args = SHAPES)]
fn surface_transformed(bencher: Bencher, name: &str) {
    let turn = DAffine3::from_quat(DQuat::from_rotation_x(0.3));
    let transform = Transform::new(turn);
    surfaces(
        bencher,
        &World::new(vec![Instance {
            shape: shape(name),
            transform,
        }]),
    );
}

/// A world of a handful of shapes, as most scenes are.
#[divan::bench]
fn small_world(bencher: Bencher) {
    let placed = |(i, name): (usize, &&str)| Instance {
        shape: shape(name),
        transform: Transform::new(DAffine3::from_translation(DVec3::X * (i as f64 - 3.0))),
    };
    let world = World::new(SHAPES[..7].iter().enumerate().map(placed).collect());
    let rays = rays();
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| {
            rays.iter()
                .filter(|r| world.closest(r, f64::INFINITY).is_some())
                .count()
        });
}

//! Rays through a mesh, one thread: what follows light from surface to
//! surface. Items are rays, so that the figures are rays per second.
//!
//! The rival is the traversal of the crate that builds the tree, all in
//! `f32`, neither watertight nor safe at other scales: the price of being
//! both is the ratio. Brute force shows what the tree is worth.

use std::{f64::consts::TAU, sync::Arc};

use divan::{Bencher, counter::ItemsCount};
use glam::{DVec3, Vec3A};
use nephroid::geometry::{Instance, Ray, Shape, TriangleMesh, World, brute};
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2_from_tris},
    ray::{Ray as RivalRay, RayHit},
    rt_triangle::RtTriangle,
    triangle::Triangle as RivalTriangle,
};

fn main() {
    divan::main();
}

/// Vertices and triangles of a tube around a (2, 3) torus knot.
fn knot(along: u32, around: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let curve = |t: f64| {
        let r = 2.0 + (3.0 * t).cos();
        DVec3::new(
            r * (2.0 * t).cos(),
            r * (2.0 * t).sin(),
            1.2 * (3.0 * t).sin(),
        )
    };
    let mut positions = Vec::new();
    for i in 0..along {
        let t = TAU * f64::from(i) / f64::from(along);
        let tangent = (curve(t + 1e-4) - curve(t - 1e-4)).normalize();
        let (a, b) = tangent.any_orthonormal_pair();
        for j in 0..around {
            let (s, c) = (TAU * f64::from(j) / f64::from(around)).sin_cos();
            positions.push(curve(t) + (a * c + b * s) * 0.5);
        }
    }
    let at = |i: u32, j: u32| (i % along) * around + j % around;
    let cell = |(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let cells = (0..along).flat_map(|i| (0..around).map(move |j| (i, j)));
    (positions, cells.flat_map(cell).collect())
}

/// 2^17 triangles.
const LARGE: (u32, u32) = (512, 128);

fn world(size: (u32, u32)) -> World {
    let (positions, triangles) = knot(size.0, size.1);
    let mesh = TriangleMesh::new(positions, None, triangles).expect("sound");
    World::new(vec![Instance {
        shape: Shape::Mesh(Arc::new(mesh)),
        transform: None,
    }])
}

/// Directions that look random, from a rotation by irrational angles.
fn scattered(i: usize) -> DVec3 {
    let x = i as f64;
    let z = 2.0 * (x * 0.618_033_988_749_895).fract() - 1.0;
    let (s, c) = (TAU * (x * 0.414_213_562_373_095).fract()).sin_cos();
    DVec3::new(c, s, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
}

fn primary(n: u32) -> Vec<Ray> {
    let eye = DVec3::new(0.0, -7.0, 7.0);
    let (forward, right) = (-eye.normalize(), DVec3::X);
    let up = right.cross(forward);
    let film = |i: u32| 0.9 * (f64::from(i) / f64::from(n) - 0.5);
    let pixel = |k: u32| (forward + right * film(k % n) + up * film(k / n)).normalize();
    (0..n * n).map(|k| Ray::new(eye, pixel(k))).collect()
}

/// Rays that leave the hits of others in scattered directions, in an order
/// without coherence.
fn bounce(world: &World, rays: &[Ray]) -> Vec<Ray> {
    let hits: Vec<_> = rays
        .iter()
        .filter_map(|r| {
            world
                .closest(r, f64::INFINITY)
                .map(|h| world.surface(r, &h))
        })
        .collect();
    // A step that shares no factor with the count visits each once.
    let step = (hits.len() * 5 / 8) | 1;
    (0..hits.len())
        .map(|i| hits[i * step % hits.len()].spawn(scattered(i)))
        .collect()
}

fn trace(bencher: Bencher, world: &World, rays: &[Ray]) {
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| {
            rays.iter()
                .filter_map(|r| world.closest(r, f64::INFINITY))
                .map(|h| h.t)
                .sum::<f64>()
        });
}

#[divan::bench]
fn knot_primary(bencher: Bencher) {
    trace(bencher, &world(LARGE), &primary(256));
}

#[divan::bench]
fn knot_bounce(bencher: Bencher) {
    let world = world(LARGE);
    trace(bencher, &world, &bounce(&world, &primary(256)));
}

#[divan::bench]
fn knot_occlusion(bencher: Bencher) {
    let world = world(LARGE);
    let rays = bounce(&world, &primary(256));
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| {
            rays.iter()
                .filter(|r| world.occluded(r, 4.0, |_| false))
                .count()
        });
}

/// A million triangles: the tree no longer fits into the cache.
#[divan::bench(sample_count = 10)]
fn million_bounce(bencher: Bencher) {
    let world = world((2048, 256));
    trace(bencher, &world, &bounce(&world, &primary(256)));
}

#[divan::bench]
fn small_bounce(bencher: Bencher) {
    let world = world((32, 8));
    trace(bencher, &world, &bounce(&world, &primary(64)));
}

#[divan::bench(sample_count = 10)]
fn small_bounce_brute_force(bencher: Bencher) {
    let world = world((32, 8));
    let rays = bounce(&world, &primary(64));
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| {
            rays.iter()
                .filter_map(|r| brute::closest(&world, r, f64::INFINITY))
                .map(|h| h.t)
                .sum::<f64>()
        });
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn build(bencher: Bencher) {
    let (positions, triangles) = knot(LARGE.0, LARGE.1);
    bencher
        .counter(ItemsCount::new(triangles.len()))
        .with_inputs(|| (positions.clone(), triangles.clone()))
        .bench_local_values(|(p, t)| TriangleMesh::new(p, None, t));
}

/// The rival's tree and its triangles in leaf order.
struct Rival {
    tree: Bvh2,
    triangles: Vec<RtTriangle>,
}

impl Rival {
    fn new(size: (u32, u32)) -> Self {
        let (positions, triangles) = knot(size.0, size.1);
        let corner = |i: u32| Vec3A::from(positions[i as usize].as_vec3());
        let triangles: Vec<_> = triangles
            .iter()
            .map(|t| RivalTriangle {
                v0: corner(t[0]),
                v1: corner(t[1]),
                v2: corner(t[2]),
            })
            .collect();
        let mut time = std::time::Duration::default();
        let tree = build_bvh2_from_tris(&triangles, BvhBuildParams::medium_build(), &mut time);
        let order = tree.primitive_indices.iter();
        let triangles = order
            .map(|&i| RtTriangle::from(&triangles[i as usize]))
            .collect();
        Self { tree, triangles }
    }

    fn trace(&self, bencher: Bencher, rays: &[Ray]) {
        let single = |v: DVec3| Vec3A::from(v.as_vec3());
        // Its only guard against meeting what it leaves: a fixed distance.
        let rays: Vec<_> = rays
            .iter()
            .map(|r| RivalRay::new(single(r.origin), single(r.dir), 1e-4, f32::INFINITY))
            .collect();
        bencher
            .counter(ItemsCount::new(rays.len()))
            .bench_local(|| {
                let mut sum = 0.0;
                for ray in &rays {
                    let mut hit = RayHit::none();
                    if self
                        .tree
                        .ray_traverse(*ray, &mut hit, |ray, i| self.triangles[i].intersect(ray))
                    {
                        sum += hit.t;
                    }
                }
                sum
            });
    }
}

#[divan::bench]
fn rival_primary(bencher: Bencher) {
    Rival::new(LARGE).trace(bencher, &primary(256));
}

#[divan::bench]
fn rival_bounce(bencher: Bencher) {
    let rays = bounce(&world(LARGE), &primary(256));
    Rival::new(LARGE).trace(bencher, &rays);
}

#[divan::bench(sample_count = 10)]
fn rival_million_bounce(bencher: Bencher) {
    let size = (2048, 256);
    let rays = bounce(&world(size), &primary(256));
    Rival::new(size).trace(bencher, &rays);
}

//! Rays through a mesh, one thread: what follows light from surface to
//! surface. Items are rays, so that the figures are rays per second.
//!
//! The rival is the traversal of the crate that builds the tree, all in
//! `f32`, neither watertight nor safe at other scales: the price of being
//! both is the ratio. Brute force shows what the tree is worth.

use divan::{Bencher, counter::ItemsCount};
use glam::{DVec3, Vec3A};
use nephroid::geometry::{Ray, TriangleMesh, World, brute};
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2_from_tris},
    ray::{Ray as RivalRay, RayHit},
    rt_triangle::RtTriangle,
    triangle::Triangle as RivalTriangle,
};

#[allow(dead_code, reason = "each bench uses a part")]
#[path = "common/knot.rs"]
mod knot;

use knot::{bounce, knot, primary, world};

fn main() {
    divan::main();
}

/// 2^17 triangles.
const LARGE: (u32, u32) = (512, 128);

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

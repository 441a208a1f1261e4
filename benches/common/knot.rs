//! Rays and a mesh for measuring traversal.

use std::{f64::consts::TAU, sync::Arc};

use glam::DVec3;
use nephroid::geometry::{Instance, Ray, Shape, TriangleMesh, World};

/// Vertices and triangles of a tube around a (2, 3) torus knot.
pub(crate) fn knot(along: u32, around: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
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

/// The knot alone in the world.
pub(crate) fn world(size: (u32, u32)) -> World {
    let (positions, triangles) = knot(size.0, size.1);
    let mesh = TriangleMesh::new(positions, None, triangles).expect("sound");
    World::new(vec![Instance {
        shape: Shape::Mesh(Arc::new(mesh)),
        transform: None,
    }])
}

/// Directions that look random, from a rotation by irrational angles.
pub(crate) fn scattered(i: usize) -> DVec3 {
    let x = i as f64;
    let z = 2.0 * (x * 0.618_033_988_749_895).fract() - 1.0;
    let (s, c) = (TAU * (x * 0.414_213_562_373_095).fract()).sin_cos();
    DVec3::new(c, s, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
}

/// `n * n` rays of a pinhole camera, row by row.
pub(crate) fn primary(n: u32) -> Vec<Ray> {
    let eye = DVec3::new(0.0, -7.0, 7.0);
    let (forward, right) = (-eye.normalize(), DVec3::X);
    let up = right.cross(forward);
    let film = |i: u32| 0.9 * (f64::from(i) / f64::from(n) - 0.5);
    let pixel = |k: u32| (forward + right * film(k % n) + up * film(k / n)).normalize();
    (0..n * n).map(|k| Ray::new(eye, pixel(k))).collect()
}

/// Rays that leave the hits of others in scattered directions, in an order
/// without coherence.
pub(crate) fn bounce(world: &World, rays: &[Ray]) -> Vec<Ray> {
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

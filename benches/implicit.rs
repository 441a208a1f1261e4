//! One ray against implicit surfaces, by each root finder, beside the exact
//! shapes: nanoseconds per ray (items are rays). Half of the rays or more
//! hit; the rest pass through the bounds.

use std::sync::Arc;

use divan::{Bencher, counter::ItemsCount};
use glam::DVec3;
use nephroid::{
    formula::Formula,
    geometry::{
        Aabb, Ray, Shape, Surface,
        shape::{Implicit, RootFinder, Sphere},
    },
};

fn main() {
    divan::main();
}

const FINDERS: [&str; 3] = ["interval", "sphere tracing", "march"];
/// Name, formula, half the side of the bounds.
const SURFACES: [(&str, &str, f64); 4] = [
    ("sphere", "x^2 + y^2 + z^2 - 0.49", 0.75),
    ("torus", "(x^2 + y^2 + z^2 + 0.2)^2 - (x^2 + y^2)", 0.8),
    (
        "tanglecube",
        "81*(x^4 + y^4 + z^4) - 45*(x^2 + y^2 + z^2) + 11.8",
        1.0,
    ),
    (
        "gyroid",
        "sin(8*x)*cos(8*y) + sin(8*y)*cos(8*z) + sin(8*z)*cos(8*x)",
        0.8,
    ),
];

fn implicit(surface: usize, finder: &str) -> Shape {
    let (_, text, r) = SURFACES[surface];
    let finder = match finder {
        "interval" => RootFinder::Interval,
        "sphere tracing" => RootFinder::SphereTracing,
        // A hundredth of the bounds: what shows the shape, but misses rims.
        _ => RootFinder::March { step: 0.02 * r },
    };
    let bounds = Aabb {
        min: DVec3::splat(-r),
        max: DVec3::splat(r),
    };
    let formula = Formula::parse(text).expect("a formula");
    Shape::Implicit(Arc::new(
        Implicit::new(formula, bounds, finder).expect("a surface"),
    ))
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

fn closest(bencher: Bencher, shape: &Shape) {
    let rays = rays();
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

fn surface(bencher: Bencher, shape: &Shape) {
    let hits: Vec<_> = rays()
        .into_iter()
        .filter_map(|r| {
            let hit = shape.intersect(r.origin, r.dir, f64::INFINITY, None)?;
            Some((r, hit))
        })
        .collect();
    bencher
        .counter(ItemsCount::new(hits.len()))
        .bench_local(|| {
            hits.iter()
                .map(|(r, h)| shape.surface(r.origin, r.dir, h).p)
                .sum::<DVec3>()
        });
}

#[divan::bench(args = FINDERS)]
fn sphere(bencher: Bencher, finder: &str) {
    closest(bencher, &implicit(0, finder));
}

#[divan::bench(args = FINDERS)]
fn torus(bencher: Bencher, finder: &str) {
    closest(bencher, &implicit(1, finder));
}

#[divan::bench(args = FINDERS)]
fn tanglecube(bencher: Bencher, finder: &str) {
    closest(bencher, &implicit(2, finder));
}

#[divan::bench(args = FINDERS)]
fn gyroid(bencher: Bencher, finder: &str) {
    closest(bencher, &implicit(3, finder));
}

#[divan::bench]
fn exact_sphere(bencher: Bencher) {
    closest(bencher, &Shape::Sphere(Sphere::new(DVec3::ZERO, 0.7)));
}

#[divan::bench(args = [0, 1, 2, 3])]
fn surface_point(bencher: Bencher, which: usize) {
    surface(bencher, &implicit(which, "interval"));
}

#[divan::bench]
fn exact_surface_point(bencher: Bencher) {
    surface(bencher, &Shape::Sphere(Sphere::new(DVec3::ZERO, 0.7)));
}

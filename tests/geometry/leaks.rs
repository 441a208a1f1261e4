//! Hunts for leaks, of any length: rays that should be stopped by a closed
//! mesh, and rays that leave a surface from its own points. The tests run
//! them for a moment, the program `benches/leaks.rs` for as long as asked.

use std::sync::Arc;

use glam::DVec3;
use nephroid::{
    geometry::{
        Ray, Shape, SurfacePoint, TriangleMesh, World,
        shape::{Disc, Plane, Quad, Triangle},
    },
    numeric::Frame,
};

use crate::{
    kinds::{KIND_NAMES, kind},
    scenes::{Random, single, sphere_mesh},
    truth::Truth,
};

/// Sizes and distances from the origin that are tried in turn, in metres.
const SCALES: [f64; 6] = [1e-4, 1e-2, 1.0, 30.0, 1e3, 1e5];
const SHIFTS: [f64; 5] = [0.0, 1.0, 1e2, 1e4, 1e5];

/// What a hunt brought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bag {
    /// Rays shot.
    pub(crate) rays: u64,
    /// Rays that a glance in floats was enough for.
    pub(crate) glances: u64,
    /// Rays of which moving their start by the error that it states might
    /// change what they meet: they decide nothing.
    pub(crate) undecided: u64,
    /// Rays that met nothing where something is.
    pub(crate) missed: u64,
    /// Rays that met something where nothing is, or too early.
    pub(crate) false_hits: u64,
}

impl Bag {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            glances: self.glances + other.glances,
            undecided: self.undecided + other.undecided,
            missed: self.missed + other.missed,
            false_hits: self.false_hits + other.false_hits,
        }
    }

    pub(crate) fn leaks(self) -> u64 {
        self.missed + self.false_hits
    }
}

/// A vertex, or a point on an edge, of a mesh; rounded as it may be.
pub(crate) fn seam(random: &mut Random, mesh: &TriangleMesh) -> DVec3 {
    let corners = mesh.triangle(random.below(mesh.triangle_count() as u64) as u32);
    let k = random.below(3) as usize;
    if random.below(2) == 0 {
        return corners[k];
    }
    corners[k].lerp(corners[(k + 1) % 3], random.range(0.0, 1.0))
}

/// Shoots `count` rays from inside rough closed meshes at their edges and
/// vertices, `per_mesh` at each; every one must meet something.
pub(crate) fn hunt_meshes(seed: u64, count: u64, per_mesh: u64) -> Bag {
    let mut random = Random(seed);
    let mut bag = Bag::default();
    while bag.rays < count {
        let scale = SCALES[random.below(6) as usize];
        let shift = SHIFTS[random.below(5) as usize];
        let center = random.direction() * shift;
        let rings = 3 + random.below(30) as u32;
        let mesh = Arc::new(sphere_mesh(&mut random, rings, center, scale, 0.3));
        assert!(mesh.defects().is_closed(), "a test mesh is open");
        let world = single(Shape::Mesh(mesh.clone()), None);
        for _ in 0..per_mesh {
            let target = seam(&mut random, &mesh);
            // The facets of so few rings reach down to less than a third of
            // the radius; half of that is inside for sure.
            let origin = center + random.vector(0.1) * scale;
            let ray = Ray::new(origin, (target - origin).normalize());
            bag.rays += 1;
            bag.missed += u64::from(world.closest(&ray, f64::INFINITY).is_none());
        }
    }
    bag
}

/// Flat surfaces: a line that leaves one never meets it again.
const FLAT: [&str; 4] = ["plane", "quad", "disc", "triangle"];

/// The surfaces that [`hunt_surface`] knows.
pub(crate) fn surfaces() -> impl Iterator<Item = &'static str> {
    FLAT.into_iter().chain(KIND_NAMES)
}

/// Shoots `count` rays from points of surfaces of a kind; what they should
/// meet is worked out in 32 digits from the shape's own numbers.
pub(crate) fn hunt_surface(name: &str, seed: u64, count: u64) -> Bag {
    hunt_judged(name, name, 1.0, seed, count)
}

/// The same, judged as if the surfaces were of another kind, or larger by a
/// factor.
pub(crate) fn hunt_judged(name: &str, as_if: &str, factor: f64, seed: u64, count: u64) -> Bag {
    hunt(name, as_if, factor, seed, count, Truth::judge)
}

/// The same, with a judge of the caller's.
pub(crate) fn hunt(
    name: &str,
    as_if: &str,
    factor: f64,
    seed: u64,
    count: u64,
    judge: impl Fn(&Truth, &World, &SurfacePoint, DVec3) -> Bag,
) -> Bag {
    let mut random = Random(seed);
    let mut bag = Bag::default();
    while bag.rays < count {
        let size = SCALES[random.below(6) as usize];
        let at = random.direction() * SHIFTS[random.below(5) as usize];
        let (_, truth) = surface(&mut Random(random.0), as_if, at, size * factor);
        let (shape, _) = surface(&mut random, name, at, size);
        let world = single(shape, None);
        for _ in 0..64 {
            let from = at + random.direction() * size * random.range(0.0, 5.0);
            let to = at + random.vector(0.7) * size;
            let ray = Ray::new(from, (to - from).normalize());
            let Some(hit) = world.closest(&ray, f64::INFINITY) else {
                continue;
            };
            let point = world.surface(&ray, &hit);
            let dir = away(&mut random, &point);
            bag = bag.plus(match &truth {
                Some(truth) => judge(truth, &world, &point, dir),
                None => Bag {
                    rays: 1,
                    false_hits: u64::from(
                        world.closest(&point.spawn(dir), f64::INFINITY).is_some(),
                    ),
                    ..Bag::default()
                },
            });
        }
    }
    bag
}

/// A direction, near the tangent plane now and then.
fn away(random: &mut Random, point: &SurfacePoint) -> DVec3 {
    let dir = random.direction();
    if random.below(2) == 0 {
        return dir;
    }
    let lift = libm::exp10(random.range(-12.0, 0.0)) * random.range(-1.0, 1.0);
    (dir - point.ng * dir.dot(point.ng) + point.ng * lift).normalize()
}

/// A surface, and what it is unless it is flat.
fn surface(random: &mut Random, name: &str, at: DVec3, size: f64) -> (Shape, Option<Truth>) {
    if !FLAT.contains(&name) {
        let (shape, truth) = kind(random, name, at, size);
        return (shape, Some(truth));
    }
    let frame = Frame::around(random.direction());
    let radius = size * random.range(0.3, 1.0);
    let (u, v) = (frame.s * size, frame.t * radius);
    let shape = match name {
        "plane" => Shape::Plane(Plane::new(at, frame.n)),
        "quad" => Shape::Quad(Quad::new(at, u, v)),
        "disc" => Shape::Disc(Disc::new(at, frame.n, radius)),
        _ => Shape::Triangle(Triangle::new(at, at + u, at + v)),
    };
    (shape, None)
}

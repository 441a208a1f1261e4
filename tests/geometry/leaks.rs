//! Hunts for leaks, of any length: rays that should be stopped by a closed
//! mesh, and rays that leave a surface from its own points. The tests run
//! them for a moment, the program `benches/leaks.rs` for as long as asked.

use std::sync::Arc;

use glam::DVec3;
use nephroid::{
    geometry::{
        Ray, Shape, SurfacePoint, TriangleMesh, World,
        shape::{Cylinder, Disc, Plane, Quad, Sphere, Triangle},
    },
    numeric::Frame,
};

use crate::{
    exact::{Dd, Vec3Dd, dot, sub, vec},
    scenes::{Random, single, sphere_mesh},
};

/// Sizes and distances from the origin that are tried in turn, in metres.
const SCALES: [f64; 6] = [1e-4, 1e-2, 1.0, 30.0, 1e3, 1e5];
const SHIFTS: [f64; 5] = [0.0, 1.0, 1e2, 1e4, 1e5];

/// What a hunt brought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bag {
    /// Rays shot.
    pub(crate) rays: u64,
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

/// The surfaces that [`hunt_surface`] knows.
pub(crate) const SURFACES: [&str; 7] = [
    "plane", "quad", "disc", "triangle", "sphere", "cylinder", "tube",
];

/// Shoots `count` rays from points of surfaces of a kind; what they should
/// meet is worked out in 32 digits from the shape's own numbers.
pub(crate) fn hunt_surface(kind: usize, seed: u64, count: u64) -> Bag {
    hunt_judged(kind, kind, seed, count)
}

/// The same, judged as if the surfaces were of another kind.
pub(crate) fn hunt_judged(kind: usize, truth: usize, seed: u64, count: u64) -> Bag {
    let mut random = Random(seed);
    let mut bag = Bag::default();
    while bag.rays < count {
        let size = SCALES[random.below(6) as usize];
        let at = random.direction() * SHIFTS[random.below(5) as usize];
        let (_, truth) = surface(&mut Random(random.0), truth, at, size);
        let (shape, _) = surface(&mut random, kind, at, size);
        let world = single(shape, None);
        for _ in 0..64 {
            let from = at + random.direction() * size * random.range(0.0, 5.0);
            let to = at + random.vector(0.7) * size;
            let ray = Ray::new(from, (to - from).normalize());
            let Some(hit) = world.closest(&ray, f64::INFINITY) else {
                continue;
            };
            let point = world.surface(&ray, &hit);
            bag = bag.plus(leave(&mut random, &world, &point, &truth));
        }
    }
    bag
}

/// One ray away from a point, near the tangent plane now and then.
fn leave(random: &mut Random, world: &World, point: &SurfacePoint, truth: &Truth) -> Bag {
    let mut dir = random.direction();
    if random.below(2) == 0 {
        let lift = libm::exp10(random.range(-12.0, 0.0)) * random.range(-1.0, 1.0);
        dir = (dir - point.ng * dir.dot(point.ng) + point.ng * lift).normalize();
    }
    let ray = point.spawn(dir);
    let found = world.closest(&ray, f64::INFINITY).map(|hit| hit.t);
    let mut bag = Bag {
        rays: 1,
        ..Bag::default()
    };
    match (truth.ahead(&ray, point), found) {
        (Ahead::Undecided, _) => bag.undecided = 1,
        (Ahead::Nothing, None) => {}
        (Ahead::Nothing, Some(_)) => bag.false_hits = 1,
        (Ahead::At(_), None) => bag.missed = 1,
        (Ahead::At(t), Some(found)) => bag.false_hits = u64::from(found < 0.5 * t),
    }
    bag
}

/// What a shape is, for the slow way.
enum Truth {
    Flat,
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Cylinder {
        base: DVec3,
        end: DVec3,
        radius: f64,
        capped: bool,
    },
}

/// What a ray meets on its way.
enum Ahead {
    Nothing,
    At(f64),
    Undecided,
}

fn surface(random: &mut Random, kind: usize, at: DVec3, size: f64) -> (Shape, Truth) {
    let frame = Frame::around(random.direction());
    let radius = size * random.range(0.3, 1.0);
    let (u, v) = (frame.s * size, frame.t * radius);
    match SURFACES[kind] {
        "plane" => (Shape::Plane(Plane::new(at, frame.n)), Truth::Flat),
        "quad" => (Shape::Quad(Quad::new(at, u, v)), Truth::Flat),
        "disc" => (Shape::Disc(Disc::new(at, frame.n, radius)), Truth::Flat),
        "triangle" => (
            Shape::Triangle(Triangle::new(at, at + u, at + v)),
            Truth::Flat,
        ),
        "sphere" => (
            Shape::Sphere(Sphere::new(at, radius)),
            Truth::Sphere { center: at, radius },
        ),
        kind => {
            let (end, capped) = (at + frame.n * size, kind == "cylinder");
            let truth = Truth::Cylinder {
                base: at,
                end,
                radius,
                capped,
            };
            (
                Shape::Cylinder(Cylinder::new(at, end, radius, capped)),
                truth,
            )
        }
    }
}

impl Truth {
    fn ahead(&self, ray: &Ray, from: &SurfacePoint) -> Ahead {
        match *self {
            Self::Flat => Ahead::Nothing,
            Self::Sphere { center, radius } => {
                let o = sub(vec(ray.origin), vec(center));
                far_root(o, vec(ray.dir), radius, from.error)
            }
            Self::Cylinder {
                base,
                end,
                radius,
                capped,
            } => Barrel {
                base: vec(base),
                axis: sub(vec(end), vec(base)),
                radius,
                capped,
            }
            .ahead(ray, from),
        }
    }
}

/// The other root of a quadric on which the ray starts: the sum of both is
/// `-2 h / a`. A start that is `error` off the surface moves chords shorter
/// than `2 sqrt(2 error radius)`; twice that is left out.
fn far_root(o: Vec3Dd, d: Vec3Dd, radius: f64, error: f64) -> Ahead {
    let (h, a) = (dot(o, d), dot(d, d));
    let t = (h / a).round() * -2.0;
    let unsure = 4.0 * (2.0 * error * radius).sqrt();
    if t.abs() * a.round().sqrt() <= unsure {
        return Ahead::Undecided;
    }
    if t > 0.0 {
        Ahead::At(t)
    } else {
        Ahead::Nothing
    }
}

/// A cylinder in 32 digits.
struct Barrel {
    base: Vec3Dd,
    axis: Vec3Dd,
    radius: f64,
    capped: bool,
}

impl Barrel {
    fn ahead(&self, ray: &Ray, from: &SurfacePoint) -> Ahead {
        let (o, d) = (sub(vec(ray.origin), self.base), vec(ray.dir));
        let length2 = dot(self.axis, self.axis);
        let length = length2.round().sqrt();
        // Along the axis, and what is left across it.
        let split = |v: Vec3Dd| {
            let z = dot(v, self.axis) / length2;
            let across: Vec3Dd = std::array::from_fn(|i| v[i] - self.axis[i] * z);
            (z, across)
        };
        let ((oz, op), (dz, dp)) = (split(o), split(d));
        let margin = 8.0 * from.error;
        let depth = oz.round().min(1.0 - oz.round()) * length;
        let rim = self.radius - dot(op, op).round().sqrt();
        // Where side and cap meet, the error decides which of them it is.
        let on_side = from.surface.part == 0;
        if on_side && depth.abs() <= margin || !on_side && rim.abs() <= margin {
            return Ahead::Undecided;
        }
        let side = if on_side {
            far_root(op, dp, self.radius, from.error)
        } else {
            self.side_from_within(op, dp)
        };
        if !self.capped {
            let Ahead::At(t) = side else { return side };
            let z = (oz + dz * Dd::of(t)).round();
            let slope = (dz.round() * length).abs() / dot(dp, dp).round().sqrt();
            // The far end of the chord moves by the error over its cosine.
            let unsure = margin * (1.0 + slope) * (1.0 + self.radius / (0.5 * t));
            return match z.min(1.0 - z) * length {
                gap if gap.abs() <= unsure => Ahead::Undecided,
                gap if gap > 0.0 => side,
                _ => Ahead::Nothing,
            };
        }
        let cap = match dz.round() {
            z if z > 0.0 => ((Dd::of(1.0) - oz) / dz).round(),
            z if z < 0.0 => (Dd::of(0.0) - oz / dz).round(),
            _ => f64::INFINITY,
        };
        if on_side {
            return match side {
                Ahead::At(t) => Ahead::At(t.min(cap)),
                other => other,
            };
        }
        // From a cap: inward, or away from it for good.
        let outward = if from.surface.part == 2 { 1.0 } else { -1.0 };
        let steep = dz.round() * length * outward;
        if steep.abs() <= 16.0 * f64::EPSILON {
            return Ahead::Undecided;
        }
        match side {
            _ if steep > 0.0 => Ahead::Nothing,
            Ahead::At(t) => Ahead::At(t.min(cap)),
            _ => Ahead::At(cap),
        }
    }

    /// Where a ray that starts within the round wall meets it.
    fn side_from_within(&self, o: Vec3Dd, d: Vec3Dd) -> Ahead {
        let a = dot(d, d);
        if a.round() == 0.0 {
            return Ahead::Nothing;
        }
        let (h, k) = (
            dot(o, d),
            dot(o, o) - Dd::of(self.radius) * Dd::of(self.radius),
        );
        let root = (h * h - a * k).sqrt();
        Ahead::At(((root - h) / a).round())
    }
}

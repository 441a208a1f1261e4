//! Random shapes, worlds and rays that look for trouble.

use std::{f64::consts::TAU, sync::Arc};

use glam::{DAffine3, DMat3, DQuat, DVec3};
use nephroid::geometry::{
    Aabb, Instance, Ray, Shape, Transform, TriangleMesh, World,
    shape::{
        Body, Conic, Cuboid, Cylinder, Disc, Ellipsoid, Plane, Quad, Quadric, Solid, Sphere, Torus,
        Triangle,
    },
};

/// A counter hashed by `SplitMix64`: enough randomness for tests.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.bits() % n
    }

    /// Uniform in `[lo, hi)`.
    pub(crate) fn range(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::new(
            self.range(-size, size),
            self.range(-size, size),
            self.range(-size, size),
        )
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector(1.0);
            let length = v.length();
            if length > 0.1 && length <= 1.0 {
                return v / length;
            }
        }
    }

    pub(crate) fn rotation(&mut self) -> DQuat {
        DQuat::from_axis_angle(self.direction(), self.range(0.0, TAU))
    }

    /// A rotation with uniform, non-uniform or mirroring scale, and a shift.
    pub(crate) fn transform(&mut self, size: f64) -> Transform {
        let scale = match self.below(3) {
            0 => DVec3::splat(self.range(0.5, 2.0)),
            1 => DVec3::new(
                self.range(0.2, 3.0),
                self.range(0.2, 3.0),
                self.range(0.2, 3.0),
            ),
            _ => DVec3::new(
                -self.range(0.2, 3.0),
                self.range(0.2, 3.0),
                self.range(0.2, 3.0),
            ),
        };
        let turned =
            DAffine3::from_scale_rotation_translation(scale, self.rotation(), self.vector(size));
        // A second rotation below makes the scale oblique.
        Transform::new(turned * DAffine3::from_quat(self.rotation())).expect("regular")
    }
}

/// How many kinds [`shape`] makes.
pub(crate) const KINDS: u64 = 14;

/// A bounded shape of about the given size and kind (modulo [`KINDS`]), near
/// `at`.
pub(crate) fn shape(random: &mut Random, kind: u64, at: DVec3, size: f64) -> Shape {
    let r = random.range(0.3, 1.0) * size;
    match kind % KINDS {
        0 => Shape::Sphere(Sphere::new(at, r)),
        1 => {
            let end = at + random.direction() * random.range(0.3, 2.0) * size;
            Shape::Cylinder(Cylinder::new(at, end, r, random.below(2) == 0))
        }
        2 => Shape::Disc(Disc::new(at, random.direction(), r)),
        3 => {
            let frame = nephroid::numeric::Frame::around(random.direction());
            let v = frame.t * r + frame.s * random.range(-0.5, 0.5) * size;
            Shape::Quad(Quad::new(at, frame.s * size, v))
        }
        4 => {
            let frame = nephroid::numeric::Frame::around(random.direction());
            let c = at + frame.t * r + frame.s * random.range(-0.5, 0.5) * size;
            Shape::Triangle(Triangle::new(at, at + frame.s * size, c))
        }
        5 => Shape::Mesh(Arc::new(sphere_mesh(random, 8, at, r, 0.2))),
        6..=8 => conic(random, kind % KINDS, at, size),
        9 => {
            let axes = [0; 3].map(|_| random.range(0.5, 1.0) * size);
            let turn = DMat3::from_quat(random.rotation());
            let ellipsoid = Ellipsoid::new(at, DVec3::from_array(axes), turn);
            Shape::Ellipsoid(Arc::new(ellipsoid.expect("regular")))
        }
        10 => {
            let minor = random.range(0.2, 0.6) * size;
            Shape::Torus(Torus::new(at, random.direction(), size, minor))
        }
        11 => Shape::Cuboid(Cuboid::new(Aabb {
            min: at - DVec3::splat(r),
            max: at + DVec3::new(0.5, 0.7, 1.0) * size,
        })),
        12 => {
            let parts = [
                Shape::Sphere(Sphere::new(at, size)),
                Shape::Sphere(Sphere::new(at + random.direction() * r, 0.7 * size)),
                Shape::Cylinder(Cylinder::new(
                    at - DVec3::Z * size,
                    at + DVec3::Z * size,
                    0.3 * size,
                    true,
                )),
            ];
            let parts = parts.map(|shape| Body::of(shape, None));
            Shape::Solid(Arc::new(
                Solid::new(Body::Difference(parts.into())).expect("bounded"),
            ))
        }
        _ => Shape::Quadric(Arc::new(saddle(random, at, size))),
    }
}

/// A frustum (6), paraboloid (7) or hyperboloid (8), open or capped.
fn conic(random: &mut Random, kind: u64, at: DVec3, size: f64) -> Shape {
    // A short hyperboloid would have a sharp waist.
    let (shortest, widest) = if kind == 8 { (0.8, 0.8) } else { (0.4, 1.0) };
    let end = at + random.direction() * random.range(shortest, 1.0) * size;
    let capped = random.below(2) == 0;
    let [r, s] = [0; 2].map(|_| random.range(0.6, widest) * size);
    Shape::Conic(match kind {
        6 => Conic::cone(at, end, [r, s], capped),
        7 => Conic::paraboloid(at, end, r, capped),
        _ => Conic::hyperboloid(at, end, [r, s], 0.55 * size, capped),
    })
}

/// A quadric with a gradient that is nowhere small: a saddle in a box.
fn saddle(random: &mut Random, at: DVec3, size: f64) -> Quadric {
    let [a, b, c] = [0; 3].map(|_| random.range(-0.5, 0.5) / size);
    let [x, y, z] = at.to_array();
    // z = a x^2 + b y^2 + c x y, about `at`.
    let coefficients = [
        a,
        b,
        0.0,
        c,
        0.0,
        0.0,
        -2.0 * a * x - c * y,
        -2.0 * b * y - c * x,
        -1.0,
        a * x * x + b * y * y + c * x * y + z,
    ];
    let bounds = Aabb {
        min: at - DVec3::splat(size),
        max: at + DVec3::new(0.5, 0.7, 1.0) * size,
    };
    Quadric::new(&coefficients, bounds, true)
}

/// A world of `count` shapes of all kinds in a box of half-size 3, some
/// transformed, with now and then a plane.
pub(crate) fn world(random: &mut Random, count: u64) -> World {
    let flat = random.below(4) == 0;
    let instances = (0..count).map(|i| {
        if random.below(12) == 0 {
            let plane = Plane::new(random.vector(3.0), random.direction());
            return Instance {
                shape: Shape::Plane(plane),
                transform: None,
            };
        }
        // Everything in one plane, or sizes over many decades, or mixed.
        let size = if random.below(3) == 0 {
            10f64.powf(random.range(-5.0, 1.0))
        } else {
            0.7
        };
        let mut at = random.vector(3.0);
        if flat {
            at.z = 0.25;
            let quad = Quad::new(at, DVec3::X * size, DVec3::Y * size);
            return Instance {
                shape: Shape::Quad(quad),
                transform: None,
            };
        }
        let transform = (random.below(2) == 0).then(|| random.transform(3.0));
        Instance {
            shape: shape(random, i, at, size),
            transform,
        }
    });
    World::new(instances.collect())
}

/// A ray towards the world: from inside, from outside, along an axis, or
/// aimed at the middle of an instance.
pub(crate) fn ray(random: &mut Random, world: &World) -> Ray {
    let far = if random.below(4) == 0 { 1e3 } else { 4.0 };
    let origin = random.vector(far);
    let dir = match random.below(4) {
        0 => random.direction(),
        1 => {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            let axis = axes[random.below(3) as usize];
            if random.below(2) == 0 { axis } else { -axis }
        }
        _ => {
            let i = random.below(world.instances().len() as u64) as u32;
            let target = world.instance_bounds(i).map_or(DVec3::ZERO, |b| b.center());
            (target + random.vector(0.3) - origin).normalize()
        }
    };
    Ray::new(origin, dir)
}

/// A sphere of triangles with `n` rings whose vertices are moved radially by
/// up to `rough` of the radius; closed, wound outward.
pub(crate) fn sphere_mesh(
    random: &mut Random,
    n: u32,
    center: DVec3,
    radius: f64,
    rough: f64,
) -> TriangleMesh {
    let around = 2 * n;
    let mut unit = vec![DVec3::Z, DVec3::NEG_Z];
    for i in 1..n {
        for j in 0..around {
            let (s, c) = (std::f64::consts::PI * f64::from(i) / f64::from(n)).sin_cos();
            let (sp, cp) = (TAU * f64::from(j) / f64::from(around)).sin_cos();
            unit.push(DVec3::new(s * cp, s * sp, c));
        }
    }
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == n => 1,
        i => 2 + (i - 1) * around + j % around,
    };
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..around {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if i > 0 {
                triangles.push([a, b, d]);
            }
            if i + 1 < n {
                triangles.push([d, b, c]);
            }
        }
    }
    let place = |&p: &DVec3| center + p * radius * (1.0 - random.range(0.0, 1.0) * rough);
    let positions: Vec<_> = unit.iter().map(place).collect();
    TriangleMesh::new(positions, Some(unit), triangles).expect("a sound mesh")
}

/// A bumpy grid of `n` by `n` cells over `[-1, 1]^2`, and its inner vertices.
pub(crate) fn grid_mesh(random: &mut Random, n: u32, height: f64) -> (TriangleMesh, Vec<DVec3>) {
    let coordinate = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(n);
    let mut positions = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            positions.push(DVec3::new(
                coordinate(i),
                coordinate(j),
                random.range(0.0, height),
            ));
        }
    }
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let inner = (1..n).flat_map(|j| (1..n).map(move |i| at(i, j) as usize));
    let inner = inner.map(|i| positions[i]).collect();
    (
        TriangleMesh::new(positions, None, triangles).expect("a sound mesh"),
        inner,
    )
}

/// A shape as part of a solid.
pub(crate) fn instance(shape: Shape) -> Body {
    Body::of(shape, None)
}

/// A world of one shape.
pub(crate) fn single(shape: Shape, transform: Option<Transform>) -> World {
    World::new(vec![Instance { shape, transform }])
}

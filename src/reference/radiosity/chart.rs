//! Flat maps of surfaces: the unit square laid over a part of a shape, in the
//! shape's own space. Equal areas of the square are equal areas of the surface.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::{
    geometry::{Shape, Surface, shape::ShapePoint},
    numeric::{Frame, gamma, trig::sin_cos},
};

/// Roundings on the way from the square to the surface, each of at most the
/// size of the terms that are added: two of the coordinate, at most five of
/// the sine or root and the products, two of the sums.
const ROUNDINGS: u32 = 9;

/// The map of one part of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) enum Chart {
    /// A parallelogram.
    Parallelogram {
        corner: DVec3,
        u: DVec3,
        v: DVec3,
        normal: DVec3,
    },
    /// A disc: squared distance from the middle, angle.
    Disc {
        center: DVec3,
        frame: Frame,
        radius: f64,
    },
    /// A sphere: height, angle.
    Sphere { center: DVec3, radius: f64 },
    /// The side of a tube: height, angle.
    Tube {
        base: DVec3,
        frame: Frame,
        length: f64,
        radius: f64,
    },
    /// A triangle with the edges `u` and `v` from its first corner: the square
    /// of the distance from that corner to the third side, the place along it.
    Triangle {
        corner: DVec3,
        u: DVec3,
        v: DVec3,
        normal: DVec3,
    },
}

/// Number of parts of a shape; `None` if it cannot be laid out.
pub(super) fn parts(shape: &Shape) -> Option<u32> {
    Some(match shape {
        Shape::Quad(_) | Shape::Disc(_) | Shape::Sphere(_) | Shape::Triangle(_) => 1,
        Shape::Cylinder(c) => 1 + 2 * u32::from(c.is_capped()),
        Shape::Cuboid(_) => 6,
        // A mesh has fewer triangles than 2^28.
        Shape::Mesh(mesh) => mesh.triangle_count() as u32,
        Shape::Plane(_)
        | Shape::Conic(_)
        | Shape::Ellipsoid(_)
        | Shape::Quadric(_)
        | Shape::Torus(_)
        | Shape::Solid(_)
        | Shape::Implicit(_) => return None,
    })
}

impl Chart {
    /// The map of a part, counted as hits count it. `None` for shapes without
    /// [`parts`].
    pub(super) fn of(shape: &Shape, part: u32) -> Option<Self> {
        Some(match shape {
            Shape::Quad(quad) => {
                let [u, v] = quad.edges();
                Self::parallelogram(quad.corner(), u, v)
            }
            Shape::Disc(disc) => Self::disc(disc.center(), disc.normal(), disc.radius()),
            Shape::Sphere(sphere) => Self::Sphere {
                center: sphere.center(),
                radius: sphere.radius(),
            },
            Shape::Cylinder(c) => match part {
                0 => Self::Tube {
                    base: c.base(),
                    frame: Frame::around(c.axis()),
                    length: c.length(),
                    radius: c.radius(),
                },
                1 => Self::disc(c.base(), -c.axis(), c.radius()),
                _ => Self::disc(c.base() + c.axis() * c.length(), c.axis(), c.radius()),
            },
            Shape::Cuboid(cuboid) => {
                let bounds = cuboid.bounds()?;
                let (axis, high) = (part as usize / 2, part % 2 == 1);
                let size = bounds.max - bounds.min;
                let edge = |axis: usize| DVec3::AXES[axis] * size[axis];
                let (mut u, mut v) = (edge((axis + 1) % 3), edge((axis + 2) % 3));
                let mut corner = bounds.min;
                if high {
                    corner[axis] = bounds.max[axis];
                } else {
                    (u, v) = (v, u);
                }
                Self::parallelogram(corner, u, v)
            }
            Shape::Triangle(triangle) => Self::triangle(triangle.vertices()),
            Shape::Mesh(mesh) => Self::triangle(mesh.triangle(part)),
            _ => return None,
        })
    }

    fn parallelogram(corner: DVec3, u: DVec3, v: DVec3) -> Self {
        let normal = u.cross(v).normalize();
        Self::Parallelogram {
            corner,
            u,
            v,
            normal,
        }
    }

    fn disc(center: DVec3, normal: DVec3, radius: f64) -> Self {
        Self::Disc {
            center,
            frame: Frame::around(normal),
            radius,
        }
    }

    fn triangle([a, b, c]: [DVec3; 3]) -> Self {
        let (u, v) = (b - a, c - a);
        Self::Triangle {
            corner: a,
            u,
            v,
            normal: u.cross(v).normalize(),
        }
    }

    /// The point of the surface at a place of the unit square.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> ShapePoint {
        let around = |frame: &Frame, turn: f64| {
            let (s, c) = sin_cos(TAU * turn - PI);
            frame.s * c + frame.t * s
        };
        let (p, ng, size) = match *self {
            Self::Parallelogram {
                corner,
                u,
                v,
                normal,
            } => (corner + u * x + v * y, normal, [corner, u, v]),
            Self::Disc {
                center,
                ref frame,
                radius,
            } => {
                let p = center + around(frame, y) * (radius * x.sqrt());
                (p, frame.n, [center, DVec3::splat(radius), DVec3::ZERO])
            }
            Self::Sphere { center, radius } => {
                let z = 2.0 * x - 1.0;
                let (s, c) = sin_cos(TAU * y - PI);
                let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
                let n = DVec3::new(across * c, across * s, z);
                let size = [center, DVec3::splat(radius), DVec3::ZERO];
                (center + n * radius, n, size)
            }
            Self::Tube {
                base,
                ref frame,
                length,
                radius,
            } => {
                let n = around(frame, y);
                let p = base + frame.n * (length * x) + n * radius;
                (p, n, [base, DVec3::splat(radius), DVec3::splat(length)])
            }
            Self::Triangle {
                corner,
                u,
                v,
                normal,
            } => {
                let s = x.sqrt();
                let p = corner + u * (s * (1.0 - y)) + v * (s * y);
                (p, normal, [corner, u, v])
            }
        };
        let size: f64 = size.iter().map(|v| v.abs().max_element()).sum();
        ShapePoint {
            p,
            error: gamma(ROUNDINGS) * size,
            ng,
            ns: ng,
        }
    }

    /// The place of the unit square at a point of the surface.
    pub(super) fn place(&self, p: DVec3) -> [f64; 2] {
        let turn = |frame: &Frame, d: DVec3| angle(d.dot(frame.s), d.dot(frame.t));
        match *self {
            Self::Parallelogram { corner, u, v, .. } => along(p - corner, u, v),
            Self::Disc {
                center,
                ref frame,
                radius,
            } => {
                let d = p - center;
                let across = d - frame.n * d.dot(frame.n);
                [across.length_squared() / (radius * radius), turn(frame, d)]
            }
            Self::Sphere { center, radius } => {
                let d = p - center;
                [0.5 + 0.5 * d.z / radius, angle(d.x, d.y)]
            }
            Self::Tube {
                base,
                ref frame,
                length,
                ..
            } => {
                let d = p - base;
                [d.dot(frame.n) / length, turn(frame, d)]
            }
            Self::Triangle { corner, u, v, .. } => {
                let [b, c] = along(p - corner, u, v);
                let s = b + c;
                [s * s, if s > 0.0 { c / s } else { 0.0 }]
            }
        }
    }

    /// Area of the whole part in square metres.
    pub(super) fn area(&self) -> f64 {
        match *self {
            Self::Parallelogram { u, v, .. } => u.cross(v).length(),
            Self::Triangle { u, v, .. } => 0.5 * u.cross(v).length(),
            Self::Disc { radius, .. } => PI * radius * radius,
            Self::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            Self::Tube { length, radius, .. } => TAU * radius * length,
        }
    }

    /// The longest lines of the surface along which the square's sides run, in
    /// metres, and the fewest cells that follow them around a curve.
    pub(super) fn sides(&self) -> ([f64; 2], [u32; 2]) {
        match *self {
            Self::Parallelogram { u, v, .. } => ([u.length(), v.length()], [1, 1]),
            Self::Triangle { u, v, .. } => {
                let reach = u.length().max(v.length());
                ([reach, (v - u).length()], [1, 1])
            }
            Self::Disc { radius, .. } => ([radius, TAU * radius], [1, 6]),
            Self::Sphere { radius, .. } => ([2.0 * radius, TAU * radius], [4, 8]),
            Self::Tube { length, radius, .. } => ([length, TAU * radius], [1, 8]),
        }
    }
}

/// `d` in terms of two edges that span its plane.
fn along(d: DVec3, u: DVec3, v: DVec3) -> [f64; 2] {
    let n = u.cross(v);
    let scale = 1.0 / n.length_squared();
    [d.cross(v).dot(n) * scale, u.cross(d).dot(n) * scale]
}

/// The angle of (x, y) as a part of a turn, from 0 at -x.
fn angle(x: f64, y: f64) -> f64 {
    0.5 + libm::atan2(y, x) / TAU
}

//! The lens: a cylinder between two spherical faces.
//!
//! Radii have signs as in optics, for light that runs along +z: positive if
//! the centre of curvature lies behind the face.

use glam::DVec3;

use super::Builder;
use crate::{
    geometry::{
        Shape,
        shape::{Body, Cylinder, Sphere},
    },
    numeric::gamma,
    scene::{
        MAX_LENGTH, MIN_LENGTH,
        description::{LensShape, Number},
        outline::NodeId,
    },
};

/// One face: where it meets the axis, and its radius unless it is flat.
#[derive(Clone, Copy)]
struct Face {
    vertex: f64,
    radius: Option<f64>,
}

impl Face {
    /// How far the face lies beyond its vertex at a distance from the axis,
    /// without a difference of nearly equal numbers.
    fn sag(&self, height: f64) -> f64 {
        self.radius.map_or(0.0, |r| {
            let depth = ((r.abs() - height) * (r.abs() + height)).sqrt();
            height * height / (r.abs() + depth) * r.signum()
        })
    }

    fn at(&self, height: f64) -> f64 {
        self.vertex + self.sag(height)
    }

    fn sphere(&self) -> Option<Sphere> {
        self.radius
            .map(|r| Sphere::new(DVec3::Z * (self.vertex + r), r.abs()))
    }
}

impl Builder<'_> {
    /// The lens around the origin, its axis along z.
    pub(super) fn lens(&mut self, node: NodeId, s: &LensShape) -> Option<Body> {
        let thickness = self.report.length(node, "thickness", s.thickness);
        let aperture = self.report.length(node, "aperture", s.aperture);
        let r1 = self.curvature_radius(node, "r1", s.r1);
        let r2 = self.curvature_radius(node, "r2", s.r2);
        let (thickness, aperture, r1, r2) = (thickness?, aperture?, r1?, r2?);
        self.wide_enough(node, "r1", r1, aperture)?;
        self.wide_enough(node, "r2", r2, aperture)?;
        let faces = [(-0.5, r1), (0.5, r2)].map(|(side, radius)| Face {
            vertex: side * thickness,
            radius,
        });
        self.has_an_edge(node, &faces, thickness, aperture)?;
        self.thin_enough(node, &faces, aperture)?;
        Some(body(&faces, thickness, 0.5 * aperture))
    }

    /// A radius that is not zero, or none; `None` if it is wrong.
    #[allow(
        clippy::option_option,
        reason = "a mistake, a flat face, or a radius: three answers"
    )]
    fn curvature_radius(
        &mut self,
        node: NodeId,
        key: &str,
        value: Option<Number>,
    ) -> Option<Option<f64>> {
        let Some(Number(r)) = value else {
            return Some(None);
        };
        if (MIN_LENGTH..=MAX_LENGTH).contains(&r.abs()) {
            return Some(Some(r));
        }
        let place = self.report.field(node, key);
        let message = format!("{key} is not a radius of curvature");
        let label = format!("expected {MIN_LENGTH:e} to {MAX_LENGTH:e} metres, or their negatives");
        let help = format!("leave `{key}` out for a flat face");
        self.report.reject(place, message, label, help)
    }

    fn wide_enough(
        &mut self,
        node: NodeId,
        key: &str,
        radius: Option<f64>,
        aperture: f64,
    ) -> Option<()> {
        match radius {
            Some(r) if 2.0 * r.abs() < aperture => {
                let place = self.report.field(node, "aperture");
                let label = format!("expected at most twice {key}, {}", 2.0 * r.abs());
                let help = "the aperture is the lens' diameter: no sphere is wider than its own";
                let message = "an aperture wider than the lens' face";
                self.report.reject(place, message, label, help)
            }
            _ => Some(()),
        }
    }

    /// The faces must not meet within the aperture. Their distance is monotone
    /// from the axis outward.
    fn has_an_edge(
        &mut self,
        node: NodeId,
        faces: &[Face; 2],
        thickness: f64,
        aperture: f64,
    ) -> Option<()> {
        let [a, b] = faces.map(|f| f.sag(0.5 * aperture));
        if thickness + (b - a) >= MIN_LENGTH {
            return Some(());
        }
        let place = self.report.field(node, "thickness");
        let label = format!("its edge would be {:.3e} m thick", thickness + (b - a));
        let help = format!(
            "make it thicker than {:.6e}, or the aperture smaller",
            a - b
        );
        let message = "the faces of this lens cross within its aperture";
        self.report.reject(place, message, label, help)
    }

    /// A convex face is part of a sphere that must reach to the other face.
    fn thin_enough(&mut self, node: NodeId, faces: &[Face; 2], aperture: f64) -> Option<()> {
        let [first, second] = faces;
        let reaches = |face: &Face, other: &Face, height: f64| {
            face.radius.is_none_or(|r| {
                let far = face.vertex + r + (r - face.sag(height));
                // The faces of a ball are one sphere, up to rounding.
                let rounding = gamma(16) * (r.abs() + face.vertex.abs());
                (far - other.at(height)) * r.signum() >= -rounding
            })
        };
        let convex = [
            (first, second, first.radius.is_some_and(|r| r > 0.0)),
            (second, first, second.radius.is_some_and(|r| r < 0.0)),
        ];
        let bad = convex.into_iter().any(|(face, other, is)| {
            is && [0.0, 0.5 * aperture]
                .iter()
                .any(|&h| !reaches(face, other, h))
        });
        if !bad {
            return Some(());
        }
        let place = self.report.field(node, "thickness");
        let label = "thicker than the sphere of a convex face";
        let help = "a convex face of radius r belongs to a lens at most 2 r thick; \
                    for a rod write a Union of a Cylinder and Spheres";
        self.report
            .reject(place, "this lens is too thick for its faces", label, help)
    }
}

/// The cylinder of the edge within the spheres of convex faces and without
/// those of concave ones. It ends in the flat faces themselves and at the rims
/// of concave ones, and goes on beyond convex ones, which end it.
fn body(faces: &[Face; 2], thickness: f64, half_aperture: f64) -> Body {
    let [first, second] = faces;
    let beyond = |face: &Face, outward: f64| match face.radius {
        Some(r) if r * outward < 0.0 => face.vertex + outward * thickness,
        _ => face.at(half_aperture),
    };
    let ends = [beyond(first, -1.0), beyond(second, 1.0)].map(|z| DVec3::Z * z);
    let edge = Cylinder::new(ends[0], ends[1], half_aperture, true);
    let mut common = vec![shape(Shape::Cylinder(edge))];
    let mut without = vec![];
    for (face, outward) in [(first, -1.0), (second, 1.0)] {
        let Some(sphere) = face.sphere() else {
            continue;
        };
        let convex = face.radius.is_some_and(|r| r * outward < 0.0);
        let list = if convex { &mut common } else { &mut without };
        list.push(shape(Shape::Sphere(sphere)));
    }
    let common = Body::Intersection(common);
    if without.is_empty() {
        return common;
    }
    without.insert(0, common);
    Body::Difference(without)
}

fn shape(shape: Shape) -> Body {
    Body::of(shape, None)
}

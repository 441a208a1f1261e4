//! Shapes.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Builder, checks::unit};
use crate::{
    geometry::{
        Shape,
        shape::{Cylinder, Disc, Plane, Quad, Sphere, Triangle},
    },
    numeric::gamma,
    scene::{
        description::{DiscShape, QuadShape, ShapeDescription, Triple},
        outline::NodeId,
    },
};

/// A parallelogram whose edges span an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct QuadGeometry {
    pub(super) corner: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
}

impl QuadGeometry {
    pub(super) fn area(&self) -> f64 {
        self.u.cross(self.v).length()
    }
}

/// A disc with a unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DiscGeometry {
    pub(super) center: DVec3,
    pub(super) normal: DVec3,
    pub(super) radius: f64,
}

impl DiscGeometry {
    pub(super) fn area(&self) -> f64 {
        PI * self.radius * self.radius
    }
}

impl<'d> Builder<'d> {
    pub(super) fn shape(&mut self, node: NodeId, shape: &'d ShapeDescription) -> Option<Shape> {
        match shape {
            ShapeDescription::Plane(s) => {
                let point = self.report.point(node, "point", s.point);
                let normal = self.report.direction(node, "normal", s.normal);
                Some(Shape::Plane(Plane::new(point?, normal?)))
            }
            ShapeDescription::Quad(s) => {
                let q = self.quad(node, s)?;
                Some(Shape::Quad(Quad::new(q.corner, q.u, q.v)))
            }
            ShapeDescription::Disc(s) => {
                let d = self.disc(node, s)?;
                Some(Shape::Disc(Disc::new(d.center, d.normal, d.radius)))
            }
            ShapeDescription::Sphere(s) => {
                let center = self.report.point(node, "center", s.center);
                let radius = self.report.length(node, "radius", s.radius);
                Some(Shape::Sphere(Sphere::new(center?, radius?)))
            }
            ShapeDescription::Cylinder(s) => {
                let base = self.report.point(node, "base", s.base);
                let end = self.report.point(node, "end", s.end);
                let radius = self.report.length(node, "radius", s.radius);
                let (base, end) = (base?, end?);
                self.distinct(node, "end", base, end, "a cylinder of no length")?;
                Some(Shape::Cylinder(Cylinder::new(base, end, radius?, s.capped)))
            }
            ShapeDescription::Triangle(s) => {
                let a = self.report.point(node, "a", s.a);
                let b = self.report.point(node, "b", s.b);
                let c = self.report.point(node, "c", s.c);
                let (a, b, c) = (a?, b?, c?);
                if !spans_area(b - a, c - a) {
                    let label = "the corners lie on a line";
                    let help = "move one corner off the line through the other two";
                    return self
                        .report
                        .reject(node, "a triangle of no area", label, help);
                }
                Some(Shape::Triangle(Triangle::new(a, b, c)))
            }
            ShapeDescription::Cone(s) => self.cone(node, s),
            ShapeDescription::Paraboloid(s) => self.paraboloid(node, s),
            ShapeDescription::Hyperboloid(s) => self.hyperboloid(node, s),
            ShapeDescription::Ellipsoid(s) => self.ellipsoid(node, s),
            ShapeDescription::Quadric(s) if !s.capped => self.quadric(node, s),
            ShapeDescription::Torus(s) => self.torus(node, s),
            ShapeDescription::Box(s) => self.cuboid(node, s).map(Shape::Cuboid),
            ShapeDescription::Quadric(_)
            | ShapeDescription::Union(_)
            | ShapeDescription::Intersection(_)
            | ShapeDescription::Difference(_)
            | ShapeDescription::Lens(_) => self.solid(node, shape),
            ShapeDescription::Mesh(s) => self.mesh_shape(node, s).map(Shape::Mesh),
            ShapeDescription::Waves(s) => self.waves_shape(node, s).map(Shape::Mesh),
            ShapeDescription::TorusKnot(s) => self.torus_knot_shape(node, s).map(Shape::Mesh),
            ShapeDescription::Implicit(s) => self.implicit(node, s).map(Shape::Implicit),
            ShapeDescription::HeightField(s) => self.height_field_shape(node, s).map(Shape::Mesh),
        }
    }

    /// Two points that must differ, also after rounding.
    pub(super) fn distinct(
        &mut self,
        node: NodeId,
        key: &str,
        a: DVec3,
        b: DVec3,
        message: &str,
    ) -> Option<()> {
        let size = a.abs().max_element().max(b.abs().max_element());
        if (b - a).length() > gamma(16) * size && (b - a).length() >= crate::scene::MIN_LENGTH {
            return Some(());
        }
        let place = self.report.field(node, key);
        self.report.reject(
            place,
            message,
            "both ends are at the same place",
            "move one of them",
        )
    }

    /// A quad from a corner and two edges, or from a centre.
    pub(super) fn quad(&mut self, node: NodeId, s: &QuadShape) -> Option<QuadGeometry> {
        let fields = [
            ("corner", s.corner.is_some()),
            ("center", s.center.is_some()),
        ];
        let which = self.report.exactly_one(node, &fields)?;
        let corner_form = [("u", s.u.is_some()), ("v", s.v.is_some())];
        let center_form = [
            ("size", s.size.is_some()),
            ("facing", s.facing.is_some()),
            ("normal", s.normal.is_some()),
        ];
        let (name, strangers) = match which {
            0 => ("corner", center_form.as_slice()),
            _ => ("center", corner_form.as_slice()),
        };
        if let Some((key, _)) = strangers.iter().find(|(_, given)| *given) {
            let place = self.report.field(node, key);
            let diagnostic = self
                .report
                .about_key(place, format!("`{key}` does not go with `{name}`"))
                .with_label("belongs to the other way to write a quad")
                .with_help("write Quad(corner, u, v) or Quad(center, size, facing or normal)");
            self.report.push(diagnostic);
            return None;
        }
        let geometry = match which {
            0 => self.quad_at_corner(node, s)?,
            _ => self.quad_around_center(node, s)?,
        };
        if !spans_area(geometry.u, geometry.v) {
            let label = "expected two edges that are neither zero nor parallel";
            return self.report.reject(
                node,
                "a quad of no area",
                label,
                "turn or lengthen an edge",
            );
        }
        Some(geometry)
    }

    fn quad_at_corner(&mut self, node: NodeId, s: &QuadShape) -> Option<QuadGeometry> {
        let u = self.required(node, "u", s.u);
        let v = self.required(node, "v", s.v);
        let corner = self.report.point(node, "corner", s.corner?)?;
        let u = self.report.point(node, "u", u?);
        let v = self.report.point(node, "v", v?);
        Some(QuadGeometry {
            corner,
            u: u?,
            v: v?,
        })
    }

    fn quad_around_center(&mut self, node: NodeId, s: &QuadShape) -> Option<QuadGeometry> {
        let center = self.report.point(node, "center", s.center?);
        let size = self.required(node, "size", s.size);
        let normal = self.normal_or_facing(node, center, s.normal, s.facing);
        let (center, size, normal) = (center?, size?, normal?);
        for length in size.0 {
            self.report
                .length(node, "size", crate::scene::description::Number(length))?;
        }
        let (u, v) = edges_around(normal);
        let (u, v) = (u * size.0[0], v * size.0[1]);
        Some(QuadGeometry {
            corner: center - 0.5 * u - 0.5 * v,
            u,
            v,
        })
    }

    pub(super) fn disc(&mut self, node: NodeId, s: &DiscShape) -> Option<DiscGeometry> {
        let center = self.report.point(node, "center", s.center);
        let normal = self.normal_or_facing(node, center, s.normal, s.facing);
        let radius = self.report.length(node, "radius", s.radius);
        Some(DiscGeometry {
            center: center?,
            normal: normal?,
            radius: radius?,
        })
    }

    /// The unit normal, given itself or by a point that it points to.
    fn normal_or_facing(
        &mut self,
        node: NodeId,
        center: Option<DVec3>,
        normal: Option<Triple>,
        facing: Option<Triple>,
    ) -> Option<DVec3> {
        let fields = [("facing", facing.is_some()), ("normal", normal.is_some())];
        if self.report.exactly_one(node, &fields)? == 1 {
            return self.report.direction(node, "normal", normal?);
        }
        let target = self.report.point(node, "facing", facing?)?;
        let direction = unit(target - center?);
        if direction.is_none() {
            let place = self.report.field(node, "facing");
            let help = "`facing` is a point to look at, not a direction";
            return self.report.reject(
                place,
                "`facing` is where the center is",
                "same as `center`",
                help,
            );
        }
        direction
    }

    /// The value of a field that this form needs.
    pub(super) fn required<T>(&mut self, node: NodeId, key: &str, value: Option<T>) -> Option<T> {
        if value.is_none() {
            let diagnostic = self.report.missing_field(node, key);
            self.report.push(diagnostic);
        }
        value
    }
}

/// The horizontal unit vector orthogonal to a unit normal, and the one that
/// completes the frame: `u x v = n`. For a vertical normal `u` is the x axis.
pub(super) fn edges_around(n: DVec3) -> (DVec3, DVec3) {
    let u = DVec3::new(-n.y, n.x, 0.0)
        .try_normalize()
        .unwrap_or(DVec3::X);
    (u, n.cross(u))
}

/// Whether two edges are long enough and not parallel, to rounding: each
/// edge carries an error of two roundings of its ends, the cross product
/// three more.
fn spans_area(u: DVec3, v: DVec3) -> bool {
    let shortest = u.length().min(v.length());
    shortest >= crate::scene::MIN_LENGTH
        && u.cross(v).length() > gamma(16) * u.length() * v.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_a_right_handed_frame_with_u_horizontal() {
        for n in [
            DVec3::Z,
            DVec3::NEG_Z,
            DVec3::X,
            DVec3::new(0.6, -0.48, 0.64),
        ] {
            let (u, v) = edges_around(n);
            assert!((u.cross(v) - n).length() < 1e-15, "{n}");
            assert_eq!(u.z, 0.0, "{n}");
        }
        assert_eq!(edges_around(DVec3::Z), (DVec3::X, DVec3::Y));
    }

    #[test]
    fn parallel_and_empty_edges_span_nothing() {
        assert!(spans_area(DVec3::X, DVec3::new(1.0, 1e-9, 0.0)));
        assert!(!spans_area(DVec3::X, DVec3::X * 3.0));
        assert!(!spans_area(
            DVec3::new(0.1, 0.3, 0.7),
            DVec3::new(0.3, 0.9, 2.1)
        ));
        assert!(!spans_area(DVec3::X, DVec3::ZERO));
    }
}

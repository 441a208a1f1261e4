//! Cone, paraboloid, hyperboloid, ellipsoid, quadric, torus and box.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::Builder;
use crate::{
    geometry::{
        Aabb, Shape,
        shape::{Conic, Cuboid, Ellipsoid, Quadric, Torus},
    },
    scene::{
        description::{
            BoxShape, ConeShape, EllipsoidShape, HyperboloidShape, Number, ParaboloidShape,
            QuadricShape, TorusShape, Triple,
        },
        outline::NodeId,
    },
};

impl Builder<'_> {
    pub(super) fn cone(&mut self, node: NodeId, s: &ConeShape) -> Option<Shape> {
        let base = self.report.point(node, "base", s.base);
        let radius = self.report.length(node, "radius", s.radius);
        let fields = [("apex", s.apex.is_some()), ("end", s.end.is_some())];
        let (key, end, top) = if self.report.exactly_one(node, &fields)? == 0 {
            if s.top_radius.is_some() {
                let place = self.report.field(node, "top_radius");
                let help = "write `end` instead of `apex` for a cone that is cut off";
                let label = "at its apex a cone has no radius";
                let message = "`top_radius` does not go with `apex`";
                return self.report.reject(place, message, label, help);
            }
            ("apex", s.apex?, Some(0.0))
        } else {
            let top = self.required(node, "top_radius", s.top_radius)?;
            ("end", s.end?, self.report.length(node, "top_radius", top))
        };
        let end = self.report.point(node, key, end);
        let (base, end) = (base?, end?);
        self.distinct(node, key, base, end, "a cone of no height")?;
        Some(Shape::Conic(Conic::cone(
            base,
            end,
            [radius?, top?],
            s.capped,
        )))
    }

    pub(super) fn paraboloid(&mut self, node: NodeId, s: &ParaboloidShape) -> Option<Shape> {
        let base = self.report.point(node, "base", s.base);
        let apex = self.report.point(node, "apex", s.apex);
        let radius = self.report.length(node, "radius", s.radius);
        let (base, apex) = (base?, apex?);
        self.distinct(node, "apex", base, apex, "a paraboloid of no height")?;
        Some(Shape::Conic(Conic::paraboloid(
            base, apex, radius?, s.capped,
        )))
    }

    pub(super) fn hyperboloid(&mut self, node: NodeId, s: &HyperboloidShape) -> Option<Shape> {
        let base = self.report.point(node, "base", s.base);
        let end = self.report.point(node, "end", s.end);
        let radius = self.report.length(node, "radius", s.radius);
        let waist = self.report.length(node, "waist", s.waist);
        let end_radius = match s.end_radius {
            Some(r) => self.report.length(node, "end_radius", r),
            None => radius,
        };
        let (base, end, waist) = (base?, end?, waist?);
        self.distinct(node, "end", base, end, "a hyperboloid of no height")?;
        let radii = [radius?, end_radius?];
        let [least, most] = [radii[0].min(radii[1]), radii[0].max(radii[1])];
        if waist > least || waist >= most {
            let place = self.report.field(node, "waist");
            let label = format!("expected less than the radius at the ends, {least}");
            let help = "a hyperboloid is narrowest at its waist; a Cylinder is as wide everywhere";
            return self
                .report
                .reject(place, "a waist that is no waist", label, help);
        }
        Some(Shape::Conic(Conic::hyperboloid(
            base, end, radii, waist, s.capped,
        )))
    }

    pub(super) fn ellipsoid(&mut self, node: NodeId, s: &EllipsoidShape) -> Option<Shape> {
        let center = self.report.point(node, "center", s.center);
        let semi_axes = self.lengths(node, "semi_axes", s.semi_axes);
        let rotation = match &s.rotate {
            Some(list) => self.rotations(node, list)?,
            None => DMat3::IDENTITY,
        };
        let Some(ellipsoid) = Ellipsoid::new(center?, semi_axes?, rotation) else {
            let place = self.report.field(node, "semi_axes");
            let label = "these lengths are too different to compute with";
            let help = "a Disc has no thickness at all";
            return self
                .report
                .reject(place, "a degenerate ellipsoid", label, help);
        };
        Some(Shape::Ellipsoid(Arc::new(ellipsoid)))
    }

    /// The surface in its box, open where the box cuts it.
    pub(super) fn quadric(&mut self, node: NodeId, s: &QuadricShape) -> Option<Shape> {
        let (quadric, _) = self.quadric_and_box(node, s, true)?;
        Some(Shape::Quadric(Arc::new(quadric)))
    }

    /// The surface, cut or not, and its box.
    pub(super) fn quadric_and_box(
        &mut self,
        node: NodeId,
        s: &QuadricShape,
        cut: bool,
    ) -> Option<(Quadric, Aabb)> {
        let place = self.report.field(node, "bounds");
        let min = self.report.point_here(place, s.bounds[0]);
        let max = self.report.point_here(place, s.bounds[1]);
        let coefficients = s.coefficients.map(|c| c.0);
        if coefficients[..9].iter().all(|&c| c == 0.0) {
            let place = self.report.field(node, "coefficients");
            let label = "only the constant is not zero";
            let help = "the first nine belong to x^2, y^2, z^2, xy, yz, xz, x, y and z";
            let message = "a quadric without a surface";
            return self.report.reject(place, message, label, help);
        }
        let bounds = self.box_between(place, min?, max?)?;
        Some((Quadric::new(&coefficients, bounds, cut), bounds))
    }

    pub(super) fn torus(&mut self, node: NodeId, s: &TorusShape) -> Option<Shape> {
        let center = self.report.point(node, "center", s.center);
        let axis = self.report.direction(node, "axis", s.axis);
        let major = self.report.length(node, "major", s.major);
        let minor = self.report.length(node, "minor", s.minor);
        let (major, minor) = (major?, minor?);
        if minor >= major {
            let place = self.report.field(node, "minor");
            let label = format!("expected less than `major`, {major}");
            let help = "the tube of a torus leaves a hole: its surface would pass through itself";
            return self
                .report
                .reject(place, "a torus without a hole", label, help);
        }
        Some(Shape::Torus(Torus::new(center?, axis?, major, minor)))
    }

    pub(super) fn cuboid(&mut self, node: NodeId, s: &BoxShape) -> Option<Cuboid> {
        let fields = [("min", s.min.is_some()), ("center", s.center.is_some())];
        let which = self.report.exactly_one(node, &fields)?;
        let (name, stranger, given) = match which {
            0 => ("min", "size", s.size.is_some()),
            _ => ("center", "max", s.max.is_some()),
        };
        if given {
            let place = self.report.field(node, stranger);
            let diagnostic = self
                .report
                .about_key(place, format!("`{stranger}` does not go with `{name}`"))
                .with_label("belongs to the other way to write a box")
                .with_help("write Box(min, max) or Box(center, size)");
            self.report.push(diagnostic);
            return None;
        }
        let bounds = if which == 0 {
            let max = self.required(node, "max", s.max)?;
            let min = self.report.point(node, "min", s.min?);
            let max = self.report.point(node, "max", max);
            let place = self.report.field(node, "max");
            self.box_between(place, min?, max?)?
        } else {
            let size = self.required(node, "size", s.size)?;
            let center = self.report.point(node, "center", s.center?);
            let half = 0.5 * self.lengths(node, "size", size)?;
            let center = center?;
            let place = self.report.field(node, "size");
            self.box_between(place, center - half, center + half)?
        };
        Some(Cuboid::new(bounds))
    }

    /// The box between two corners, of which the first must be the smaller
    /// one.
    fn box_between(&mut self, place: NodeId, min: DVec3, max: DVec3) -> Option<Aabb> {
        if (max - min).min_element() >= crate::scene::MIN_LENGTH {
            return Some(Aabb { min, max });
        }
        let axis = (0..3).find(|&i| max[i] - min[i] < crate::scene::MIN_LENGTH)?;
        let name = ["x", "y", "z"][axis];
        let label = format!("{name} goes from {} to {}", min[axis], max[axis]);
        let help = "the first corner has the smaller coordinates, the second the larger ones";
        self.report.reject(place, "a box of no volume", label, help)
    }

    /// Three lengths above zero.
    fn lengths(&mut self, node: NodeId, key: &str, value: Triple) -> Option<DVec3> {
        for length in value.0 {
            self.report.length(node, key, Number(length))?;
        }
        Some(DVec3::from(value))
    }
}

//! Lights, and the shapes that show them.

use std::f64::consts::PI;

use super::Builder;
use crate::{
    geometry::{
        Shape,
        shape::{Disc, Quad, Sphere},
    },
    light::{self, Beam, Light, Sun},
    scene::{
        description::{
            Colour, DirectionalLight, DiscLight, DiscShape, LightDescription, PointLight,
            QuadLight, SphereLight, SpotLight,
        },
        outline::NodeId,
    },
    spectrum::Rgb,
};

/// A light that passed its checks, and its body if it has one.
pub(super) struct BuiltLight {
    pub(super) name: String,
    pub(super) light: Light,
    pub(super) shape: Option<Shape>,
}

impl Builder<'_> {
    pub(super) fn lights(&mut self) -> Vec<BuiltLight> {
        let mut list = Vec::new();
        for (index, part) in self.description.lights.iter().enumerate() {
            if self.report.diagnostics.is_full() {
                break;
            }
            let Some(description) = &part.value else {
                continue;
            };
            if let Some((light, shape)) = self.light(part.node, description) {
                let name = description
                    .name()
                    .map_or_else(|| format!("lights[{index}]"), str::to_owned);
                list.push(BuiltLight { name, light, shape });
            }
        }
        list
    }

    fn light(
        &mut self,
        node: NodeId,
        description: &LightDescription,
    ) -> Option<(Light, Option<Shape>)> {
        match description {
            LightDescription::Point(l) => self.point_light(node, l).map(|l| (l, None)),
            LightDescription::Spot(l) => self.spot_light(node, l).map(|l| (l, None)),
            LightDescription::Directional(l) => self.directional_light(node, l).map(|l| (l, None)),
            LightDescription::Sphere(l) => self.sphere_light(node, l),
            LightDescription::Quad(l) => self.quad_light(node, l),
            LightDescription::Disc(l) => self.disc_light(node, l),
        }
    }

    /// The one of two quantities that is given, the second one multiplied by
    /// `first_per_second`.
    fn quantity(
        &mut self,
        node: NodeId,
        first: (&str, Option<Colour>),
        second: (&str, Option<Colour>),
        first_per_second: f64,
    ) -> Option<Rgb> {
        let fields = [(first.0, first.1.is_some()), (second.0, second.1.is_some())];
        if self.report.exactly_one(node, &fields)? == 0 {
            return self.report.light_colour(node, first.0, first.1?);
        }
        let colour = self.report.light_colour(node, second.0, second.1?)?;
        Some(colour * first_per_second)
    }

    fn point_light(&mut self, node: NodeId, l: &PointLight) -> Option<Light> {
        let position = self.report.point(node, "position", l.position);
        let (intensity, power) = (("intensity", l.intensity), ("power", l.power));
        let intensity = self.quantity(node, intensity, power, 1.0 / (4.0 * PI));
        Some(Light::Point(light::PointLight {
            position: position?,
            intensity: intensity?,
        }))
    }

    fn spot_light(&mut self, node: NodeId, l: &SpotLight) -> Option<Light> {
        let position = self.report.point(node, "position", l.position);
        let axis = self.spot_axis(node, l, position);
        let angles = self.spot_angles(node, l);
        let (position, axis, (inner, outer)) = (position?, axis?, angles?);
        let unit = light::SpotLight::new(position, axis, inner, outer, Rgb::WHITE);
        let (intensity, power) = (("intensity", l.intensity), ("power", l.power));
        let intensity =
            self.quantity(node, intensity, power, 1.0 / unit.effective_solid_angle())?;
        Some(Light::Spot(light::SpotLight { intensity, ..unit }))
    }

    fn spot_axis(
        &mut self,
        node: NodeId,
        l: &SpotLight,
        position: Option<glam::DVec3>,
    ) -> Option<glam::DVec3> {
        let fields = [
            ("look_at", l.look_at.is_some()),
            ("direction", l.direction.is_some()),
        ];
        if self.report.exactly_one(node, &fields)? == 1 {
            return self.report.direction(node, "direction", l.direction?);
        }
        let target = self.report.point(node, "look_at", l.look_at?)?;
        let axis = super::checks::unit(target - position?);
        if axis.is_none() {
            let place = self.report.field(node, "look_at");
            let message = "`look_at` is where the light is";
            return self
                .report
                .reject(place, message, "same as `position`", "move one of them");
        }
        axis
    }

    /// Half-angles with `0 <= inner <= outer`; the outer one is large enough
    /// that its cosine differs from 1.
    fn spot_angles(&mut self, node: NodeId, l: &SpotLight) -> Option<(f64, f64)> {
        let (inner, outer) = (l.inner.0, l.outer.0);
        if !(1e-3..=180.0).contains(&outer) {
            let place = self.report.field(node, "outer");
            let label = "expected a half-angle from 0.001 to 180 degrees";
            return self
                .report
                .reject(place, "an outer angle out of range", label, "such as 30");
        }
        if inner < 0.0 {
            let place = self.report.field(node, "inner");
            let label = "expected a half-angle from 0 to `outer`";
            return self
                .report
                .reject(place, "a negative inner angle", label, "such as 20");
        }
        if inner > outer {
            let place = self.report.field(node, "inner");
            let label = format!("expected at most `outer`, which is {outer}");
            let help = "light is full up to `inner` and fades to nothing at `outer`; swap the two?";
            return self.report.reject(
                place,
                "the inner angle is larger than the outer one",
                label,
                help,
            );
        }
        Some((inner, outer))
    }

    fn directional_light(&mut self, node: NodeId, l: &DirectionalLight) -> Option<Light> {
        let axis = self.report.direction(node, "direction", l.direction);
        let irradiance = self.report.light_colour(node, "irradiance", l.irradiance);
        let fields = [
            ("beam", l.beam.is_some()),
            ("angular_diameter", l.angular_diameter.is_some()),
        ];
        if self.report.exactly_one(node, &fields)? == 0 {
            let beam = l.beam.as_ref()?;
            let place = self.report.field(node, "beam");
            let center = self.report.point(place, "center", beam.center);
            let radius = self.report.length(place, "radius", beam.radius);
            let (axis, irradiance) = (axis?, irradiance?);
            return Some(Light::Beam(Beam {
                center: center?,
                axis,
                radius: radius?,
                irradiance,
            }));
        }
        let diameter = l.angular_diameter?.0;
        // The sine of half the diameter must stay below 1.
        if !(0.0..=179.9).contains(&diameter) {
            let place = self.report.field(node, "angular_diameter");
            let label = "expected 0 to below 180 degrees";
            return self.report.reject(
                place,
                "an angular diameter out of range",
                label,
                "the sun has 0.53",
            );
        }
        Some(Light::Sun(Sun::new(axis?, diameter, irradiance?)))
    }

    fn sphere_light(&mut self, node: NodeId, l: &SphereLight) -> Option<(Light, Option<Shape>)> {
        let center = self.report.point(node, "center", l.center);
        let radius = self.report.length(node, "radius", l.radius);
        let area = 4.0 * PI * radius.unwrap_or(1.0) * radius.unwrap_or(1.0);
        let radiance = self.radiance(node, l.radiance, l.power, area);
        let (center, radius, radiance) = (center?, radius?, radiance?);
        let light = Light::Sphere(light::SphereLight {
            center,
            radius,
            radiance,
        });
        Some((light, Some(Shape::Sphere(Sphere::new(center, radius)))))
    }

    fn quad_light(&mut self, node: NodeId, l: &QuadLight) -> Option<(Light, Option<Shape>)> {
        let q = self.quad(node, &l.shape());
        let radiance = self.radiance(node, l.radiance, l.power, q.map_or(1.0, |q| q.area()));
        let (q, radiance) = (q?, radiance?);
        let light = Light::Quad(light::QuadLight {
            corner: q.corner,
            u: q.u,
            v: q.v,
            radiance,
        });
        Some((light, Some(Shape::Quad(Quad::new(q.corner, q.u, q.v)))))
    }

    fn disc_light(&mut self, node: NodeId, l: &DiscLight) -> Option<(Light, Option<Shape>)> {
        let shape = DiscShape {
            center: l.center,
            facing: l.facing,
            normal: l.normal,
            radius: l.radius,
        };
        let d = self.disc(node, &shape);
        let radiance = self.radiance(node, l.radiance, l.power, d.map_or(1.0, |d| d.area()));
        let (d, radiance) = (d?, radiance?);
        let (center, normal, radius) = (d.center, d.normal, d.radius);
        let light = Light::Disc(light::DiscLight {
            center,
            normal,
            radius,
            radiance,
        });
        Some((light, Some(Shape::Disc(Disc::new(center, normal, radius)))))
    }

    /// Radiance itself, or from the power of an emitting area:
    /// `power = pi * area * radiance`.
    fn radiance(
        &mut self,
        node: NodeId,
        radiance: Option<Colour>,
        power: Option<Colour>,
        area: f64,
    ) -> Option<Rgb> {
        self.quantity(
            node,
            ("radiance", radiance),
            ("power", power),
            1.0 / (PI * area),
        )
    }
}

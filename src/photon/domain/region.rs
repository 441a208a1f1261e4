//! The parts of an emission domain from which a sphere around casters can be
//! reached.
//!
//! A start is drawn from one part and asked whether others contain it, so the
//! helpers here are shared by both questions.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::{
    geometry::BoundingSphere,
    light::Light,
    sampling::warp::{self, one_minus_cos},
};

use super::Start;

/// A part of a light's domain.
#[derive(Clone, Copy, Debug)]
pub(in crate::photon) enum Target {
    /// What can reach a sphere around casters.
    Sphere(BoundingSphere),
    /// All of it.
    Whole,
}

/// A cone of directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    /// Unit direction of the axis.
    pub(super) axis: DVec3,
    /// `1 - cos` of the half-angle.
    pub(super) q: f64,
}

impl Cone {
    /// All directions.
    pub(super) const WHOLE: Self = Self {
        axis: DVec3::Z,
        q: 2.0,
    };

    /// The directions from `p` in which a sphere lies; `None` inside.
    pub(super) fn to(sphere: &BoundingSphere, p: DVec3) -> Option<Self> {
        let to = sphere.center - p;
        let d = to.length();
        (d > sphere.radius).then(|| Self {
            axis: to / d,
            q: one_minus_cos(sphere.radius / d),
        })
    }

    /// How the cone to a sphere changes with the point from which it is seen:
    /// the derivatives of axis and size when `p` moves by `dp`.
    pub(super) fn change(&self, sphere: &BoundingSphere, p: DVec3, dp: DVec3) -> Self {
        let d = (sphere.center - p).length();
        let dd = -self.axis.dot(dp);
        let sin = sphere.radius / d;
        Self {
            axis: -(dp + self.axis * dd) / d,
            // q = 1 - sqrt(1 - sin^2), and d(sin) = -sin dd / d.
            q: -sin * sin * dd / (d * (1.0 - self.q)),
        }
    }

    /// Whether the unit vector `dir` lies in the cone.
    pub(super) fn contains(&self, dir: DVec3) -> bool {
        0.5 * (dir - self.axis).length_squared() <= self.q
    }
}

/// A disc across parallel light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

impl Section {
    /// The disc through which light along `axis` can reach a target, within
    /// the light's own disc where that is smaller. A light without a disc of
    /// its own has one of radius 0.
    pub(super) fn of(target: Target, axis: DVec3, own: Self) -> Self {
        match target {
            Target::Sphere(s) if own.radius == 0.0 || s.radius < own.radius => {
                let along = (s.center - own.center).dot(axis);
                Self {
                    center: s.center - axis * along,
                    radius: s.radius,
                }
            }
            _ => own,
        }
    }

    fn contains(&self, start: &Start) -> bool {
        let f = start.origin - self.center;
        let across = (f - start.dir * f.dot(start.dir)).length_squared();
        across <= self.radius * self.radius
    }
}

/// The section of the sun, which has none of its own.
pub(super) const UNBOUNDED: Section = Section {
    center: DVec3::ZERO,
    radius: 0.0,
};

/// The cone of directions from `p` for a target, within the light's own cone
/// where that is narrower.
pub(super) fn directions(p: DVec3, own: Cone, target: Target) -> Cone {
    match target {
        Target::Sphere(s) => Cone::to(&s, p).filter(|c| c.q < own.q).unwrap_or(own),
        Target::Whole => own,
    }
}

/// The cone from a point of a glowing shape to a target; `None` where the
/// whole hemisphere is used.
pub(super) fn aimed(p: DVec3, target: Target) -> Option<(BoundingSphere, Cone)> {
    match target {
        Target::Sphere(s) => Cone::to(&s, p).filter(|c| c.q > 0.0).map(|c| (s, c)),
        Target::Whole => None,
    }
}

/// The part of a glowing sphere that can see the target: a cap of normals.
pub(super) fn cap(center: DVec3, radius: f64, target: Target) -> Cone {
    let Target::Sphere(s) = target else {
        return Cone::WHOLE;
    };
    let to = s.center - center;
    let d = to.length();
    // A point at angle a from the axis sees the sphere over its own horizon
    // iff d cos a > radius - s.radius.
    let cos = (radius - s.radius) / d;
    if d > 0.0 && cos > -1.0 {
        Cone {
            axis: to / d,
            q: 1.0 - cos.min(1.0),
        }
    } else {
        Cone::WHOLE
    }
}

/// Area of the cap of a sphere.
pub(super) fn cap_area(radius: f64, cap: &Cone) -> f64 {
    TAU * radius * radius * cap.q
}

/// Whether `draw` from `target` could have given this start of the light.
pub(in crate::photon) fn contains(light: &Light, target: Target, start: &Start) -> bool {
    let toward = |p| aimed(p, target).is_none_or(|(_, c)| c.contains(start.dir));
    match light {
        Light::Point(l) => directions(l.position, Cone::WHOLE, target).contains(start.dir),
        Light::Spot(l) => directions(l.position, super::own_cone(l), target).contains(start.dir),
        Light::Sphere(l) => {
            cap(l.center, l.radius, target).contains(start.normal) && toward(start.origin)
        }
        Light::Quad(_) | Light::Disc(_) => toward(start.origin),
        Light::Beam(l) => Section::of(target, l.axis, super::own_section(l)).contains(start),
        Light::Sun(_) => Section::of(target, start.dir, UNBOUNDED).contains(start),
    }
}

/// How much of the light's domain leads to a sphere, in a unit that is the same
/// for all spheres.
pub(in crate::photon) fn extent(light: &Light, sphere: &BoundingSphere) -> f64 {
    let cone = |p: DVec3| Cone::to(sphere, p).map_or(Cone::WHOLE.q, |c| c.q);
    match light {
        Light::Point(l) => cone(l.position),
        Light::Spot(l) => cone(l.position),
        Light::Sphere(l) => cone(l.center),
        Light::Quad(l) => cone(l.point([0.5; 2])),
        Light::Disc(l) => cone(l.center),
        Light::Beam(_) | Light::Sun(_) => sphere.radius * sphere.radius,
    }
}

/// Density per solid angle of directions drawn from a cone.
pub(super) fn density(cone: &Cone) -> f64 {
    warp::cone_pdf(cone.q)
}

//! The emission domain of each kind of light, and the part of it from which a
//! caster can be reached.
//!
//! A start of a photon is a point of the domain: a direction for point-like
//! lights, a point and a direction for glowing shapes, a point of the
//! cross-section for parallel light. Densities and emission are given in the
//! same measure (solid angle; area times solid angle; perpendicular area), so
//! that their quotient is a flux in W.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::{
    geometry::BoundingSphere, light::Light, numeric::Frame, sampling::warp, spectrum::Rgb,
};

use super::emit::disc_area;

/// A part of a light's domain.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    /// What can reach a sphere around casters.
    Sphere(BoundingSphere),
    /// All of it.
    Whole,
}

/// A point of an emission domain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// Where the photon starts; for the sun, a point that its line passes.
    pub(super) origin: DVec3,
    /// Unit direction of travel.
    pub(super) dir: DVec3,
    /// Emission in the domain's measure.
    pub(super) emission: Rgb,
    /// Normal of a glowing shape at the origin.
    normal: DVec3,
    /// Density of the part from which the start was drawn.
    pub(super) own_density: f64,
}

/// `1 - cos` of the half-angle of a sphere seen from `p`, with the direction
/// to its centre; `None` inside.
fn cone_to(sphere: &BoundingSphere, p: DVec3) -> Option<(DVec3, f64)> {
    let to = sphere.center - p;
    let d = to.length();
    (d > sphere.radius).then(|| (to / d, warp::one_minus_cos(sphere.radius / d)))
}

/// Whether the unit vector `dir` lies within `1 - cos <= q` of `axis`.
fn in_cone(dir: DVec3, axis: DVec3, q: f64) -> bool {
    0.5 * (dir - axis).length_squared() <= q
}

/// Draws a start from the part of the domain that `target` names.
pub(super) fn draw(light: &Light, target: Target, dir: [f64; 2], point: [f64; 2]) -> Start {
    match light {
        Light::Point(l) => from_point(l.position, whole_sphere(), target, dir, |_| l.intensity),
        Light::Spot(l) => {
            let cone = (l.axis, 1.0 - l.cos_outer);
            from_point(l.position, cone, target, dir, |w| l.intensity_along(w))
        }
        Light::Sphere(l) => {
            let (axis, q) = cap(l.center, l.radius, target);
            let normal = Frame::around(axis).to_world(warp::cone(point, q));
            let area = TAU * l.radius * l.radius * q;
            from_surface(
                l.center + normal * l.radius,
                normal,
                area,
                l.radiance,
                target,
                dir,
            )
        }
        Light::Quad(l) => from_surface(
            l.point(point),
            l.normal(),
            l.area(),
            l.radiance,
            target,
            dir,
        ),
        Light::Disc(l) => from_surface(
            l.point(point),
            l.normal,
            disc_area(l.radius),
            l.radiance,
            target,
            dir,
        ),
        Light::Beam(l) => {
            let (center, radius) = section(target, l.center, l.axis, l.radius);
            let offset = warp::disc(dir) * radius;
            let frame = Frame::around(l.axis);
            let origin = center + frame.s * offset.x + frame.t * offset.y;
            let across = (origin - l.center).length_squared();
            let emission = if across <= l.radius * l.radius {
                l.irradiance
            } else {
                Rgb::BLACK
            };
            parallel(origin, l.axis, emission, radius)
        }
        Light::Sun(l) => {
            let (travel, emission) = l.sample_travel(point);
            // Without a bounded target there is no cross-section to draw from.
            let (center, radius) = section(target, DVec3::ZERO, travel, 0.0);
            let offset = warp::disc(dir) * radius;
            let frame = Frame::around(travel);
            parallel(
                center + frame.s * offset.x + frame.t * offset.y,
                travel,
                emission,
                radius,
            )
        }
    }
}

/// Density with which `draw` from `target` would give the start of another
/// part.
pub(super) fn density(light: &Light, target: Target, start: &Start) -> f64 {
    match light {
        Light::Point(l) => direction_density(l.position, whole_sphere(), target, start.dir),
        Light::Spot(l) => {
            direction_density(l.position, (l.axis, 1.0 - l.cos_outer), target, start.dir)
        }
        Light::Sphere(l) => {
            let (axis, q) = cap(l.center, l.radius, target);
            if in_cone(start.normal, axis, q) {
                surface_density(start, TAU * l.radius * l.radius * q, target)
            } else {
                0.0
            }
        }
        Light::Quad(l) => surface_density(start, l.area(), target),
        Light::Disc(l) => surface_density(start, disc_area(l.radius), target),
        Light::Beam(l) => {
            let (center, radius) = section(target, l.center, l.axis, l.radius);
            section_density(center, radius, start)
        }
        Light::Sun(_) => {
            let (center, radius) = section(target, DVec3::ZERO, start.dir, 0.0);
            section_density(center, radius, start)
        }
    }
}

/// Largest emission of a light in its domain's measure, mean of the channels.
pub(super) fn strength(light: &Light) -> f64 {
    match light {
        Light::Point(l) => l.intensity,
        Light::Spot(l) => l.intensity,
        Light::Sphere(l) => l.radiance,
        Light::Quad(l) => l.radiance,
        Light::Disc(l) => l.radiance,
        Light::Beam(l) => l.irradiance,
        Light::Sun(l) => l.sample_travel([0.5; 2]).1,
    }
    .mean()
}

/// Whether any light from this source can reach the sphere.
pub(super) fn reaches(light: &Light, sphere: &BoundingSphere) -> bool {
    let beyond = |p: DVec3, n: DVec3| (sphere.center - p).dot(n) > -sphere.radius;
    match light {
        Light::Point(_) | Light::Sphere(_) | Light::Sun(_) => true,
        Light::Spot(l) => match cone_to(sphere, l.position) {
            None => true,
            // Angles add: apart by more than both half-angles.
            Some((axis, q)) => {
                let apart = crate::numeric::trig::acos(axis.dot(l.axis).clamp(-1.0, 1.0));
                let reach = |c: f64| crate::numeric::trig::acos(c.clamp(-1.0, 1.0));
                apart <= reach(1.0 - q) + reach(l.cos_outer)
            }
        },
        Light::Quad(l) => beyond(l.corner, l.normal()),
        Light::Disc(l) => beyond(l.center, l.normal),
        Light::Beam(l) => {
            let f = sphere.center - l.center;
            let across = (f - l.axis * f.dot(l.axis)).length();
            beyond(l.center, l.axis) && across <= sphere.radius + l.radius
        }
    }
}

fn whole_sphere() -> (DVec3, f64) {
    (DVec3::Z, 2.0)
}

/// The cone of directions from `p` for a target, within the light's own cone
/// where that is narrower.
fn directions(p: DVec3, own: (DVec3, f64), target: Target) -> (DVec3, f64) {
    match target {
        Target::Sphere(s) => cone_to(&s, p).filter(|c| c.1 < own.1).unwrap_or(own),
        Target::Whole => own,
    }
}

fn from_point(
    p: DVec3,
    own: (DVec3, f64),
    target: Target,
    u: [f64; 2],
    intensity: impl Fn(DVec3) -> Rgb,
) -> Start {
    let (axis, q) = directions(p, own, target);
    let dir = Frame::around(axis).to_world(warp::cone(u, q)).normalize();
    let emission = intensity(dir);
    Start {
        origin: p,
        dir,
        emission,
        normal: dir,
        own_density: warp::cone_pdf(q),
    }
}

fn direction_density(p: DVec3, own: (DVec3, f64), target: Target, dir: DVec3) -> f64 {
    let (axis, q) = directions(p, own, target);
    if in_cone(dir, axis, q) {
        warp::cone_pdf(q)
    } else {
        0.0
    }
}

/// The part of a glowing sphere that can see the target: a cap, as axis and
/// `1 - cos`.
fn cap(center: DVec3, radius: f64, target: Target) -> (DVec3, f64) {
    let Target::Sphere(s) = target else {
        return whole_sphere();
    };
    let to = s.center - center;
    let d = to.length();
    // A point at angle a from the axis sees the sphere over its own horizon
    // iff d cos a > radius - s.radius.
    let cos = (radius - s.radius) / d;
    if d > 0.0 && cos > -1.0 {
        (to / d, 1.0 - cos.min(1.0))
    } else {
        whole_sphere()
    }
}

fn from_surface(
    origin: DVec3,
    normal: DVec3,
    area: f64,
    radiance: Rgb,
    target: Target,
    u: [f64; 2],
) -> Start {
    let (dir, pdf) = match target {
        Target::Sphere(s) if cone_to(&s, origin).is_some_and(|c| c.1 > 0.0) => {
            let (axis, q) = cone_to(&s, origin).unwrap_or(whole_sphere());
            (
                Frame::around(axis).to_world(warp::cone(u, q)).normalize(),
                warp::cone_pdf(q),
            )
        }
        _ => {
            let local = warp::cosine_hemisphere(u);
            (
                Frame::around(normal).to_world(local).normalize(),
                warp::cosine_hemisphere_pdf(local.z),
            )
        }
    };
    let emission = radiance * normal.dot(dir).max(0.0);
    Start {
        origin,
        dir,
        emission,
        normal,
        own_density: pdf / area,
    }
}

fn surface_density(start: &Start, area: f64, target: Target) -> f64 {
    let cone = match target {
        Target::Sphere(s) => cone_to(&s, start.origin).filter(|c| c.1 > 0.0),
        Target::Whole => None,
    };
    let pdf = match cone {
        Some((axis, q)) if in_cone(start.dir, axis, q) => warp::cone_pdf(q),
        Some(_) => 0.0,
        None => warp::cosine_hemisphere_pdf(start.normal.dot(start.dir)),
    };
    pdf / area
}

/// The disc through which parallel light along `axis` can reach a target,
/// within the light's own disc where that is smaller. `own` radius 0 means
/// that the light has none.
fn section(target: Target, own_center: DVec3, axis: DVec3, own: f64) -> (DVec3, f64) {
    match target {
        Target::Sphere(s) if own == 0.0 || s.radius < own => {
            let along = (s.center - own_center).dot(axis);
            (s.center - axis * along, s.radius)
        }
        _ => (own_center, own),
    }
}

fn parallel(origin: DVec3, dir: DVec3, emission: Rgb, radius: f64) -> Start {
    let own_density = 1.0 / disc_area(radius);
    // A disc of no area emits nothing.
    let emission = if own_density.is_finite() {
        emission
    } else {
        Rgb::BLACK
    };
    Start {
        origin,
        dir,
        emission,
        normal: dir,
        own_density,
    }
}

fn section_density(center: DVec3, radius: f64, start: &Start) -> f64 {
    let f = start.origin - center;
    let across = (f - start.dir * f.dot(start.dir)).length_squared();
    if across <= radius * radius {
        1.0 / disc_area(radius)
    } else {
        0.0
    }
}

//! Lights as ends of paths: how they are chosen, sampled from a point and as
//! the start of a path, and with which densities.
//!
//! The end of a path at a light is its [`Seat`]: a point with densities per
//! area, or, for parallel light, a direction with densities per solid angle.
//! Lights that are points or ideally parallel have one seat each, whose
//! density is 1; they can't be hit. All densities include the chance of
//! choosing the light.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::{
    geometry::{BoundingSphere, Ray, SurfaceId},
    light::{Light, Source},
    numeric::Frame,
    sampling::{Discrete, warp},
    scene::NamedLight,
    spectrum::Rgb,
    transport::Context,
};

/// Where on a light a path ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum Seat {
    /// A point; its unit normal if it lies on a surface.
    At { p: DVec3, ng: Option<DVec3> },
    /// Infinity, or anywhere on the disc of a beam: the unit direction in
    /// which the light travels.
    Far { travel: DVec3 },
}

/// A light as sampled from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Connection {
    pub(super) light: usize,
    pub(super) seat: Seat,
    pub(super) source: Source,
    /// Unit direction towards the light.
    pub(super) wi: DVec3,
    /// Incident radiance over density per solid angle (for lights without
    /// extent, irradiance across the ray), over the chance of the light.
    pub(super) weight: Rgb,
    /// The instance that shows the light.
    pub(super) body: Option<u32>,
}

/// The start of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub(super) light: usize,
    pub(super) seat: Seat,
    pub(super) ray: Ray,
    /// Flux in W over all probabilities.
    pub(super) flux: Rgb,
}

/// The lights of a scene.
#[derive(Clone, Copy)]
pub(super) struct Sources<'a> {
    ctx: Context<'a>,
    choice: Option<&'a Discrete>,
    /// The sphere around what is bounded: a sun sends paths through its cross-section.
    center: DVec3,
    radius: f64,
}

impl<'a> Sources<'a> {
    /// The lights of the context's scene; `sphere` is around what is bounded.
    pub(super) fn new(ctx: Context<'a>, sphere: Option<BoundingSphere>) -> Self {
        Self {
            ctx,
            choice: ctx.picker.table(),
            center: sphere.map_or(DVec3::ZERO, |s| s.center),
            radius: sphere.map_or(1.0, |s| s.radius),
        }
    }

    fn named(&self, index: usize) -> &'a NamedLight {
        &self.ctx.scene.lights[index]
    }

    /// The light itself.
    pub(super) fn light(&self, index: usize) -> &'a Light {
        &self.named(index).light
    }

    fn chance(&self, index: usize) -> f64 {
        self.choice.map_or(0.0, |c| c.probability(index))
    }

    /// Chooses a light by its power and samples it from `p`. `None` if
    /// nothing can arrive from there.
    pub(super) fn connect(&self, p: DVec3, choice: f64, u: [f64; 2]) -> Option<Connection> {
        let light = self.choice?.choose(|| choice);
        let sample = self.light(light).sample_direct(p, u)?;
        let seat = match (self.light(light), sample.source) {
            (Light::Beam(_) | Light::Sun(_), _) | (_, Source::Direction(_)) => {
                Seat::Far { travel: -sample.wi }
            }
            (_, Source::Point(q)) => self.seat(light, q),
        };
        Some(Connection {
            light,
            seat,
            source: sample.source,
            wi: sample.wi,
            weight: sample.weight / self.chance(light),
            body: self.named(light).instance,
        })
    }

    /// The seat at a point of a light that is no parallel one.
    pub(super) fn seat(&self, light: usize, p: DVec3) -> Seat {
        let ng = match self.light(light) {
            Light::Sphere(l) => Some((p - l.center) / l.radius),
            Light::Quad(l) => Some(l.normal()),
            Light::Disc(l) => Some(l.normal),
            Light::Point(_) | Light::Spot(_) | Light::Beam(_) | Light::Sun(_) => None,
        };
        Seat::At { p, ng }
    }

    /// Density of a light's seats where a path starts with them.
    pub(super) fn origin(&self, light: usize) -> f64 {
        let density = match self.light(light) {
            Light::Sphere(l) => 1.0 / (4.0 * PI * l.radius * l.radius),
            Light::Quad(l) => 1.0 / l.area(),
            Light::Disc(l) => 1.0 / (PI * l.radius * l.radius),
            Light::Sun(l) if l.sin_half > 0.0 => warp::cone_pdf(warp::one_minus_cos(l.sin_half)),
            Light::Sun(_) | Light::Point(_) | Light::Spot(_) | Light::Beam(_) => 1.0,
        };
        self.chance(light) * density
    }

    /// Density of a seat where the light is sampled from `p`, as in
    /// [`connect`](Self::connect).
    pub(super) fn direct(&self, light: usize, seat: &Seat, p: DVec3) -> f64 {
        match (self.light(light), seat) {
            (Light::Sphere(l), Seat::At { p: q, ng: Some(ng) }) => {
                let sin = (l.radius / (l.center - p).length()).min(1.0);
                let to = p - *q;
                let d2 = to.length_squared();
                let cos = to.dot(*ng).max(0.0) / d2.sqrt();
                self.chance(light) * warp::cone_pdf(warp::one_minus_cos(sin)) * cos / d2
            }
            _ => self.origin(light),
        }
    }

    /// Density per area, at a point `p` of normal `ng`, of paths that start
    /// from a seat and land there.
    pub(super) fn landing(&self, light: usize, seat: &Seat, p: DVec3, ng: DVec3) -> f64 {
        match *seat {
            Seat::At { p: q, ng: own } => {
                let to = p - q;
                let d2 = to.length_squared();
                let dir = to / d2.sqrt();
                let directions = match (self.light(light), own) {
                    (Light::Spot(l), _) if dir.dot(l.axis) > l.cos_outer => {
                        1.0 / (TAU * (1.0 - l.cos_outer))
                    }
                    (Light::Point(_), _) => 0.5 / TAU,
                    (_, Some(own)) => warp::cosine_hemisphere_pdf(dir.dot(own)),
                    _ => 0.0,
                };
                directions * ng.dot(dir).abs() / d2
            }
            Seat::Far { travel } => {
                let (center, radius) = match self.light(light) {
                    Light::Beam(l) => (l.center, l.radius),
                    _ => (self.center, self.radius),
                };
                let f = p - center;
                let across = (f - travel * f.dot(travel)).length_squared();
                if across <= radius * radius {
                    ng.dot(travel).abs() / (PI * radius * radius)
                } else {
                    0.0
                }
            }
        }
    }

    /// Chooses a light by its power and starts a path; `u` holds direction,
    /// then point. `None` if that start sends nothing.
    pub(super) fn start(&self, choice: f64, u: [f64; 4]) -> Option<Start> {
        let light = self.choice?.choose(|| choice);
        let [direction, point] = [[u[0], u[1]], [u[2], u[3]]];
        let (seat, ray, flux) = match self.light(light) {
            Light::Point(l) => {
                let ray = Ray::new(l.position, warp::sphere(direction));
                (self.seat(light, l.position), ray, l.intensity * (2.0 * TAU))
            }
            Light::Spot(l) => {
                let q = 1.0 - l.cos_outer;
                let local = warp::cone(direction, q);
                let dir = Frame::around(l.axis).to_world(local).normalize();
                let flux = l.intensity_along(dir) * (TAU * q);
                (
                    self.seat(light, l.position),
                    Ray::new(l.position, dir),
                    flux,
                )
            }
            Light::Sphere(l) => {
                let p = l.center + warp::sphere(point) * l.radius;
                self.start_on_surface(light, p, direction)?
            }
            Light::Quad(l) => self.start_on_surface(light, l.point(point), direction)?,
            Light::Disc(l) => self.start_on_surface(light, l.point(point), direction)?,
            Light::Beam(l) => {
                let origin = across(l.center, l.axis, l.radius, point);
                let flux = l.irradiance * (PI * l.radius * l.radius);
                (Seat::Far { travel: l.axis }, Ray::new(origin, l.axis), flux)
            }
            Light::Sun(l) => {
                let (travel, irradiance) = (l.travel(direction).at, l.travelling());
                let travel = travel.normalize();
                let rim = self.center - travel * self.radius;
                let origin = across(rim, travel, self.radius, point);
                let flux = irradiance * (PI * self.radius * self.radius);
                (
                    Seat::Far { travel },
                    self.ray_out_of_infinity(origin, travel),
                    flux,
                )
            }
        };
        let flux = flux / self.chance(light);
        (!flux.is_black()).then_some(Start {
            light,
            seat,
            ray,
            flux,
        })
    }

    /// The start on a shining surface.
    fn start_on_surface(&self, light: usize, p: DVec3, u: [f64; 2]) -> Option<(Seat, Ray, Rgb)> {
        let seat = self.seat(light, p);
        let Seat::At { ng: Some(ng), .. } = seat else {
            return None;
        };
        let dir = Frame::around(ng).to_world(warp::cosine_hemisphere(u));
        let leaving = self
            .named(light)
            .instance
            .map(|instance| SurfaceId { instance, part: 0 });
        let ray = Ray {
            origin: p,
            dir: dir.normalize(),
            leaving,
        };
        // For a surface of constant radiance, cosine and density cancel.
        Some((seat, ray, self.light(light).power()?))
    }

    /// The ray that comes from infinity through `p`: it starts before
    /// everything that is in its way.
    fn ray_out_of_infinity(&self, p: DVec3, travel: DVec3) -> Ray {
        let world = &self.ctx.scene.world;
        let mut back = Ray::new(p, -travel);
        for _ in 0..=self.ctx.max_depth {
            let Some(hit) = world.closest(&back, f64::INFINITY) else {
                break;
            };
            back = world.surface(&back, &hit).spawn(-travel);
        }
        // Half a radius more, so that the start lies on no surface.
        Ray::new(back.at(0.5 * self.radius), travel)
    }
}

/// A point of the disc of the given centre, normal and radius.
fn across(center: DVec3, normal: DVec3, radius: f64, u: [f64; 2]) -> DVec3 {
    let (frame, p) = (Frame::around(normal), warp::disc(u) * radius);
    center + frame.s * p.x + frame.t * p.y
}

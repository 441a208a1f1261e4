//! The two halves of a path: places in the order in which they were found,
//! with the densities of both ways through them.

use glam::{DVec2, DVec3};

use crate::{
    camera::Camera,
    geometry::SurfacePoint,
    spectrum::Rgb,
    transport::{Bend, Carried, DiffusePoint, Lobe},
};

use super::super::{
    flight::{Flight, Met, density, landing},
    random::{Layout, Random},
    setup::Setup,
    sources::{Seat, Sources},
};

/// What a place is.
#[derive(Clone, Copy, Debug)]
pub(super) enum What {
    /// The eye.
    Eye,
    /// A diffuse surface.
    Diffuse(DiffusePoint),
    /// A mirror or glass.
    Bent,
    /// A seat on a light.
    Source { light: usize, seat: Seat },
    /// The sky, met along this direction.
    Sky(DVec3),
}

/// A place of a subpath.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) what: What,
    pub(super) p: DVec3,
    /// Unit normal; zero where densities are not per area.
    pub(super) ng: DVec3,
    /// What arrives here: for a path from the eye the factor on the radiance
    /// that will be found, for one from a light flux in W, for a source what
    /// leaves it.
    pub(super) throughput: Rgb,
    /// Density with which this subpath came here.
    pub(super) own: f64,
    /// Density with which a path of the other kind would come here from the
    /// place after.
    pub(super) other: f64,
    /// Surfaces on the way, as far as [`Flight`] counts them.
    pub(super) depth: u32,
}

impl Vertex {
    /// Whether it is a diffuse surface.
    pub(super) fn diffuse(&self) -> Option<&DiffusePoint> {
        match &self.what {
            What::Diffuse(at) => Some(at),
            _ => None,
        }
    }

    /// A density per solid angle around the unit direction `w` at a place
    /// `distance` metres away, as one per area here (as it is, where there is
    /// no area).
    pub(super) fn per_area(&self, directions: f64, w: DVec3, distance: f64) -> f64 {
        if self.ng == DVec3::ZERO {
            directions
        } else {
            directions * self.ng.dot(w).abs() / (distance * distance)
        }
    }
}

/// How the directions are distributed in which a subpath goes on.
enum Ahead<'a> {
    /// With a density per solid angle.
    Directions(f64),
    /// Over the film, one path a pixel.
    Film(&'a Camera),
    /// As a light sends them.
    From {
        sources: Sources<'a>,
        light: usize,
        seat: Seat,
    },
}

/// Follows a path from a place on the film; the eye comes first.
pub(super) fn from_camera(setup: &Setup<'_>, film: DVec2, random: &mut impl Random) -> Vec<Vertex> {
    let ray = setup.camera.ray(film);
    let eye = Vertex {
        what: What::Eye,
        p: ray.origin,
        ng: DVec3::ZERO,
        throughput: Rgb::WHITE,
        own: 1.0,
        other: 0.0,
        depth: 0,
    };
    follow(
        setup,
        vec![eye],
        Flight::from_camera(&setup.context(), ray),
        Ahead::Film(&setup.camera),
        random,
    )
}

/// Follows a path from a light; its seat comes first. Empty if the start
/// sends nothing.
pub(super) fn from_light(setup: &Setup<'_>, random: &mut impl Random) -> Vec<Vertex> {
    let sources = setup.sources();
    random.seek(Layout::START);
    let ([a, b], [c, d]) = (random.next_2d(), random.next_2d());
    let Some(start) = sources.start(random.next_1d(), [a, b, c, d]) else {
        return Vec::new();
    };
    let source = source(&sources, start.light, start.seat, start.ray.origin);
    let ahead = Ahead::From {
        sources,
        light: start.light,
        seat: start.seat,
    };
    let flight = Flight::from_light(&setup.context(), &start);
    follow(setup, vec![source], flight, ahead, random)
}

/// A light's seat as the place where its paths start.
pub(super) fn source(sources: &Sources<'_>, light: usize, seat: Seat, p: DVec3) -> Vertex {
    let (p, ng) = match seat {
        Seat::At { p, ng } => (p, ng.unwrap_or(DVec3::ZERO)),
        Seat::Far { .. } => (p, DVec3::ZERO),
    };
    Vertex {
        what: What::Source { light, seat },
        p,
        ng,
        throughput: Rgb::WHITE,
        own: sources.origin(light),
        other: 0.0,
        depth: 0,
    }
}

/// Goes on from the place in `vertices`.
fn follow(
    setup: &Setup<'_>,
    mut vertices: Vec<Vertex>,
    mut flight: Flight,
    mut ahead: Ahead<'_>,
    random: &mut impl Random,
) -> Vec<Vertex> {
    let ctx = setup.context();
    let carried = flight.carried();
    let back = match carried {
        Carried::Radiance => Carried::Flux,
        Carried::Flux => Carried::Radiance,
    };
    loop {
        let d = flight.ray.dir;
        let met = flight.next(&ctx, random);
        let last = vertices.len() - 1;
        let before = vertices[last];
        let mut vertex = match &met {
            Met::End => return vertices,
            Met::Sky => {
                if carried == Carried::Flux {
                    return vertices;
                }
                Vertex {
                    what: What::Sky(d),
                    p: before.p,
                    ..before
                }
            }
            Met::Bent { point, .. } => at(point, What::Bent),
            Met::Diffuse(at) => Vertex {
                p: at.point.p,
                ng: at.ng,
                what: What::Diffuse(*at),
                ..before
            },
            Met::Light { point, light } => {
                if carried == Carried::Flux {
                    return vertices;
                }
                let seat = setup.sources().seat(*light, point.p);
                at(
                    point,
                    What::Source {
                        light: *light,
                        seat,
                    },
                )
            }
        };
        vertex.throughput = flight.throughput;
        vertex.depth = flight.depth;
        vertex.other = 0.0;
        let distance = (vertex.p - before.p).length();
        vertex.own = match (&ahead, &met) {
            (Ahead::Directions(density), Met::Sky) => *density,
            (Ahead::Directions(density), _) => vertex.per_area(*density, d, distance),
            (Ahead::Film(camera), Met::Sky) => film_per_angle(camera, &before, d),
            (Ahead::Film(camera), _) => camera
                .sight(vertex.p)
                .map_or(0.0, |s| s.per_area * vertex.ng.dot(d).abs()),
            (
                Ahead::From {
                    sources,
                    light,
                    seat,
                },
                _,
            ) => sources.landing(*light, seat, vertex.p, vertex.ng),
        };
        let mut link = |directions: f64| {
            vertices[last].other = before.per_area(directions, d, distance);
        };
        match met {
            Met::Bent { lobe, from, .. } => {
                let (on, reverse) = bend_densities(&lobe, from);
                link(reverse);
                // What arrives is what left the place before; the lobe's part
                // of it is already gone, which matters to nobody here.
                vertices.push(vertex);
                ahead = Ahead::Directions(on);
            }
            Met::Diffuse(at) => {
                link(density(&at, -d, back));
                if carried == Carried::Flux {
                    vertex.throughput *= landing(&at, d);
                }
                vertices.push(vertex);
                if !setup.allows(flight.bounces + 1) || !flight.bounce(&ctx, &at, random) {
                    return vertices;
                }
                ahead = Ahead::Directions(density(&at, flight.ray.dir, carried));
            }
            Met::Sky | Met::Light { .. } | Met::End => {
                vertices.push(vertex);
                return vertices;
            }
        }
    }
}

/// A place at a surface, not yet linked.
fn at(point: &SurfacePoint, what: What) -> Vertex {
    Vertex {
        what,
        p: point.p,
        ng: point.ng,
        throughput: Rgb::BLACK,
        own: 0.0,
        other: 0.0,
        depth: 0,
    }
}

/// Film positions per solid angle around a direction in which the eye meets
/// nothing: seen one metre away.
fn film_per_angle(camera: &Camera, eye: &Vertex, d: DVec3) -> f64 {
    camera.sight(eye.p + d).map_or(0.0, |s| s.per_area)
}

/// Densities of the step at a mirror or glass, on and back, up to a common
/// factor. Solid angles on the two sides of an interface are as
/// `1 / (n^2 cos)` (the beam's etendue is kept), so densities are as `eta
/// cos_t` to `cos_i / eta`; a path that comes the other way finds the same.
fn bend_densities(lobe: &Lobe, from: DVec3) -> (f64, f64) {
    match lobe.bend {
        Bend::Straight | Bend::Mirror { .. } => (1.0, 1.0),
        Bend::Refract { n, eta, cos_t, .. } => (eta * cos_t, from.dot(n).abs() / eta),
    }
}

//! Joins a path from the eye and one from a light in every possible way.

use glam::DVec2;

use crate::{
    light::Source,
    spectrum::Rgb,
    transport::{Carried, Context},
};

use super::{
    super::{
        flight::{arriving, between, density},
        random::{Layout, Random},
        setup::{Contribution, Setup, layer_of},
        sources::{Seat, Sources},
    },
    subpath::{Vertex, What, from_camera, from_light, source},
    weight::{Ends, Place, weight},
};

/// A path that was made by one strategy, before it is weighed.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    /// Its places, from the eye to the light.
    pub(super) places: Vec<Place>,
    pub(super) ends: Ends,
    /// Places from the camera.
    pub(super) t: usize,
    pub(super) contribution: Contribution,
}

impl Joined {
    /// The power heuristic's weight of the strategy.
    pub(super) fn weight(&self) -> f64 {
        weight(&self.places, &self.ends, self.t)
    }
}

/// The contributions of a path from the place `film` and one of `paths` paths
/// from the lights, added to `found`: one for each layer of what is seen at
/// `film`, and one for each place of the light's path that the eye sees.
pub(in super::super) fn sample(
    setup: &Setup<'_>,
    film: DVec2,
    paths: u64,
    camera: &mut impl Random,
    light: &mut impl Random,
    found: &mut Vec<Contribution>,
) {
    let from_eye = from_camera(setup, film, camera);
    let from_light = from_light(setup, light);
    let join = Join::new(setup, film, paths, &from_eye, &from_light);
    let own = found.len();
    join.all(camera, &mut |joined| {
        let weight = joined.weight();
        // A density that is not finite belongs to a place at grazing light.
        if weight > 0.0 {
            let mut contribution = joined.contribution;
            contribution.value *= weight;
            let same = |c: &&mut Contribution| {
                c.film == contribution.film && c.layer == contribution.layer
            };
            match found[own..].iter_mut().find(same) {
                Some(sum) => sum.value += contribution.value,
                None => found.push(contribution),
            }
        }
    });
}

/// Two subpaths to be joined.
pub(super) struct Join<'a> {
    ctx: Context<'a>,
    setup: &'a Setup<'a>,
    sources: Sources<'a>,
    film: DVec2,
    paths: f64,
    eye: &'a [Vertex],
    light: &'a [Vertex],
}

impl<'a> Join<'a> {
    pub(super) fn new(
        setup: &'a Setup<'a>,
        film: DVec2,
        paths: u64,
        eye: &'a [Vertex],
        light: &'a [Vertex],
    ) -> Self {
        Self {
            ctx: setup.context(),
            setup,
            sources: setup.sources(),
            film,
            paths: paths as f64,
            eye,
            light,
        }
    }

    /// Every path that can be made, by every strategy.
    pub(super) fn all(&self, random: &mut impl Random, found: &mut impl FnMut(Joined)) {
        for s in 2..=self.light.len() {
            self.with_eye(s).into_iter().for_each(&mut *found);
        }
        for t in 2..=self.eye.len() {
            let vertex = &self.eye[t - 1];
            match vertex.what {
                What::Source { light, seat } => {
                    let radiance = match seat {
                        Seat::At { ng: Some(ng), p } => {
                            let cos = (self.eye[t - 2].p - p).normalize().dot(ng);
                            self.sources.light(light).surface_radiance(cos)
                        }
                        _ => Rgb::BLACK,
                    };
                    found_some(self.hit(t, light, seat, radiance), found);
                }
                What::Sky(travel) => {
                    for &sun in &self.ctx.plan.suns {
                        let radiance = self.sources.light(sun as usize).sky_radiance(travel);
                        let seat = Seat::Far { travel: -travel };
                        found_some(self.hit(t, sun as usize, seat, radiance), found);
                    }
                }
                What::Diffuse(_) => {
                    found_some(self.with_light(t, random), found);
                    for s in 2..=self.light.len() {
                        found_some(self.joint(t, s), found);
                    }
                }
                What::Eye | What::Bent => {}
            }
        }
    }

    /// The eye's path hits a light.
    fn hit(&self, t: usize, light: usize, seat: Seat, radiance: Rgb) -> Option<Joined> {
        let vertex = &self.eye[t - 1];
        let value = vertex.throughput * radiance;
        if value.is_black() {
            return None;
        }
        let before = &self.eye[t - 2];
        let mut places = self.places(t, 0, 0)?;
        places[t - 2].light = self.sources.landing(light, &seat, before.p, before.ng);
        let ends = self.ends(light, &seat, before);
        Some(self.joined(places, ends, t, 0, self.film, value))
    }

    /// A light is sampled for a diffuse place of the eye's path.
    fn with_light(&self, t: usize, random: &mut impl Random) -> Option<Joined> {
        let vertex = &self.eye[t - 1];
        let at = vertex.diffuse()?;
        random.seek(Layout::light(vertex.depth));
        let choice = random.next_1d();
        let c = self.sources.connect(vertex.p, choice, random.next_2d())?;
        let scattered = density(at, c.wi, Carried::Radiance);
        let value = vertex.throughput * at.reflectance * c.weight * scattered;
        if value.is_black() {
            return None;
        }
        let value = value * arriving(&self.ctx, at, c.source, c.wi, c.body);
        if value.is_black() {
            return None;
        }
        let seat = source(&self.sources, c.light, c.seat, vertex.p);
        let distance = (seat.p - vertex.p).length();
        let mut places = self.places(t, 0, 1)?;
        places[t - 1].light = self.sources.landing(c.light, &c.seat, vertex.p, vertex.ng);
        places.push(Place {
            camera: seat.per_area(scattered, c.wi, distance),
            light: 0.0,
            open: false,
        });
        let ends = self.ends(c.light, &c.seat, vertex);
        Some(self.joined(places, ends, t, 1, self.film, value))
    }

    /// Two diffuse places are joined.
    fn joint(&self, t: usize, s: usize) -> Option<Joined> {
        let (z, y) = (&self.eye[t - 1], &self.light[s - 1]);
        let (at_z, at_y) = (z.diffuse()?, y.diffuse()?);
        let to = y.p - z.p;
        let d2 = to.length_squared();
        let w = to / d2.sqrt();
        // Reflectance / pi times the cosine, at either end.
        let scattered = density(at_z, w, Carried::Radiance);
        let sent = density(at_y, -w, Carried::Flux);
        let value = z.throughput * at_z.reflectance * y.throughput * at_y.reflectance;
        let mut value = value * (scattered * sent / d2);
        if value.is_black() || !value.is_finite() {
            return None;
        }
        let mut places = self.places(t, s, 0)?;
        value *= between(&self.ctx, at_z, at_y, w);
        if value.is_black() {
            return None;
        }
        let distance = d2.sqrt();
        places[t - 1].light = z.per_area(sent, w, distance);
        places[t].camera = y.per_area(scattered, w, distance);
        Some(self.joined(places, self.ends_of_light()?, t, s, self.film, value))
    }

    /// A place of the light's path is seen by the eye.
    fn with_eye(&self, s: usize) -> Option<Joined> {
        let y = &self.light[s - 1];
        let at = y.diffuse()?;
        let sight = self.setup.camera.sight(y.p)?;
        let to = (sight.eye - y.p).normalize();
        let sent = density(at, to, Carried::Flux);
        let factor = sent * sight.per_area / self.paths;
        let value = y.throughput * at.reflectance * factor;
        if value.is_black() {
            return None;
        }
        let arrives = arriving(&self.ctx, at, Source::Point(sight.eye), to, None);
        let value = value * arrives;
        if value.is_black() {
            return None;
        }
        let mut places = self.places(1, s, 0)?;
        places[1].camera = sight.per_area * y.ng.dot(to).abs();
        Some(self.joined(places, self.ends_of_light()?, 1, s, sight.film, value))
    }

    /// The first `t` places of the eye's path and the first `s` of the
    /// light's; `None` if the path, with so many `further` places, is longer
    /// than allowed, or meets more diffuse surfaces.
    fn places(&self, t: usize, s: usize, further: usize) -> Option<Vec<Place>> {
        let (eye, light) = (&self.eye[..t], &self.light[..s]);
        let all = || eye.iter().chain(light);
        let diffuse = all().filter(|v| v.diffuse().is_some()).count() as u32;
        if !self.setup.allows(diffuse) || t + s + further > self.ctx.max_depth as usize + 2 {
            return None;
        }
        let mut places = Vec::with_capacity(t + s + further);
        places.extend(eye.iter().map(|v| Place {
            camera: v.own,
            light: v.other,
            open: v.diffuse().is_some(),
        }));
        places.extend(light.iter().rev().map(|v| Place {
            camera: v.other,
            light: v.own,
            open: v.diffuse().is_some(),
        }));
        Some(places)
    }

    /// The end of a path at a seat, seen from the place before it.
    fn ends(&self, light: usize, seat: &Seat, before: &Vertex) -> Ends {
        Ends {
            paths: self.paths,
            origin: self.sources.origin(light),
            direct: self.sources.direct(light, seat, before.p),
            hittable: self.sources.light(light).has_extent(),
        }
    }

    /// The end of the light's path.
    fn ends_of_light(&self) -> Option<Ends> {
        let What::Source { light, seat } = self.light.first()?.what else {
            return None;
        };
        Some(self.ends(light, &seat, self.light.get(1)?))
    }

    fn joined(
        &self,
        places: Vec<Place>,
        ends: Ends,
        t: usize,
        s: usize,
        film: DVec2,
        value: Rgb,
    ) -> Joined {
        // From the light to the first diffuse place: what lies between is
        // bent.
        let from_light = self.light[..s].iter().chain(self.eye[..t].iter().rev());
        let mut bent = false;
        let mut diffuse = 0;
        for vertex in from_light {
            match vertex.what {
                What::Bent => bent |= diffuse == 0,
                What::Diffuse(_) => diffuse += 1,
                What::Eye | What::Source { .. } | What::Sky(_) => {}
            }
        }
        Joined {
            places,
            ends,
            t,
            contribution: Contribution {
                film,
                layer: layer_of(diffuse, bent),
                value,
            },
        }
    }
}

fn found_some(joined: Option<Joined>, found: &mut impl FnMut(Joined)) {
    if let Some(joined) = joined {
        found(joined);
    }
}

//! The emission domain of each kind of light, and the part of it from which a
//! caster can be reached.
//!
//! A start of a photon is a point of the domain: a direction for point-like
//! lights, a point and a direction for glowing shapes, a point of the
//! cross-section for parallel light. Densities and emission are given in the
//! same measure (solid angle; area times solid angle; perpendicular area), so
//! that their quotient is a flux in W.
//!
//! With a start come its derivatives along the sides of its cell, the part of the
//! domain for which it stands: the first pair of them is the direction (for
//! parallel light, the point of the cross-section), the second one the point on
//! the light (for the sun, the direction within its disc). Lights without extent
//! have one pair. A cell has the area that the maps give it, but not their shape
//! (see [`warp`]).

mod region;
#[cfg(test)]
mod tests;

use glam::{DVec2, DVec3};

use crate::{
    geometry::BoundingSphere,
    light::{Beam, Light, SpotLight, Sun},
    numeric::{Frame, VectorPair},
    sampling::{
        GUIDE_PAIRS, Guided,
        warp::{self, Mapped},
    },
    spectrum::Rgb,
    transport::{Differential, Pair},
};

use super::emit::disc_area;
use region::{Cone, Section, UNBOUNDED, aimed, cap, cap_area, density, directions};

pub(super) use region::{Target, contains, extent};

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
    /// Derivatives of origin and direction along the sides of the cell. Not
    /// finite where the density is infinite or the sample lies on a rim.
    pub(super) differential: Differential,
}

impl Start {
    /// The same start as one that was drawn by a guide: denser, its neighbours
    /// nearer.
    pub(super) fn stretch(&mut self, guided: &Guided) {
        self.own_density *= guided.density;
        for i in 0..GUIDE_PAIRS {
            self.differential
                .stretch(i, guided.edge[i], guided.kernel[i]);
        }
    }

    /// Moves back along the start's line, to where parallel light has met
    /// nothing of what lies in the sphere.
    pub(super) fn move_before(&mut self, all: &BoundingSphere) {
        let f = self.origin - all.center;
        let back = f.dot(self.dir) + 2.0 * all.radius;
        for pair in self.differential.pairs_mut() {
            let further = pair.dp.dot(self.dir) + pair.dd.dot(f);
            pair.dp = pair.dp - (pair.dd * back + VectorPair::along(self.dir, further));
        }
        self.origin -= self.dir * back;
    }
}

/// Draws a start from the part of the domain that `target` names.
pub(super) fn draw(light: &Light, target: Target, dir: [f64; 2], point: [f64; 2]) -> Start {
    match light {
        Light::Point(l) => from_point(l.position, Cone::WHOLE, target, dir, |_| l.intensity),
        Light::Spot(l) => from_point(l.position, own_cone(l), target, dir, |w| {
            l.intensity_along(w)
        }),
        Light::Sphere(l) => {
            let cap = cap(l.center, l.radius, target);
            let frame = Frame::around(cap.axis);
            let local = warp::cone_mapped(point, cap.q).0;
            let normal = frame.to_world(local.at);
            let turns = frame.pair_to_world(local.by);
            let place = Place {
                origin: l.center + normal * l.radius,
                moves: turns * l.radius,
                room: local.room,
                normal,
                turns,
                area: cap_area(l.radius, &cap),
            };
            let mut start = from_surface(&place, l.radiance, target, dir);
            // From no place is all of the cap seen.
            start.differential.without_sheet();
            start
        }
        Light::Quad(l) => {
            let place = Place {
                origin: l.point(point),
                moves: VectorPair::from([l.u, l.v]),
                room: DVec2::from_array(point.map(|u| u.min(1.0 - u))),
                normal: l.normal(),
                turns: VectorPair::ZERO,
                area: l.area(),
            };
            from_surface(&place, l.radiance, target, dir)
        }
        Light::Disc(l) => {
            let mapped = l.point_mapped(point);
            let place = Place {
                origin: mapped.at,
                moves: mapped.by,
                room: mapped.room,
                normal: l.normal,
                turns: VectorPair::ZERO,
                area: disc_area(l.radius),
            };
            from_surface(&place, l.radiance, target, dir)
        }
        Light::Beam(l) => from_beam(l, target, dir),
        Light::Sun(l) => from_sun(l, target, dir, point),
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
        Light::Sun(l) => l.travelling(),
    }
    .mean()
}

/// The cone into which a spot shines.
fn own_cone(light: &SpotLight) -> Cone {
    Cone {
        axis: light.axis,
        q: 1.0 - light.cos_outer,
    }
}

/// The cross-section of a beam.
fn own_section(light: &Beam) -> Section {
    Section {
        center: light.center,
        radius: light.radius,
    }
}

fn from_point(
    p: DVec3,
    own: Cone,
    target: Target,
    u: [f64; 2],
    intensity: impl Fn(DVec3) -> Rgb,
) -> Start {
    let cone = directions(p, own, target);
    let frame = Frame::around(cone.axis);
    let local = warp::cone_mapped(u, cone.q).0;
    let dir = frame.to_world(local.at).normalize();
    let mut differential = Differential::new();
    let pair = Pair {
        dp: VectorPair::ZERO,
        dd: frame.pair_to_world(local.by),
    };
    differential.push(pair, local.room);
    Start {
        origin: p,
        dir,
        emission: intensity(dir),
        normal: dir,
        own_density: density(&cone),
        differential,
    }
}

/// A point of a glowing shape.
struct Place {
    origin: DVec3,
    /// Derivatives of the origin.
    moves: VectorPair,
    /// How far the coordinates are from the end of their range.
    room: DVec2,
    normal: DVec3,
    /// Derivatives of the normal.
    turns: VectorPair,
    /// Area over which such points are uniform.
    area: f64,
}

/// A direction from a place: towards the target, or by Lambert's law.
fn from_surface(at: &Place, radiance: Rgb, target: Target, u: [f64; 2]) -> Start {
    let (dir, pdf, dirs, room, point_dirs);
    if let Some((sphere, cone)) = aimed(at.origin, target) {
        let (local, by_q) = warp::cone_mapped(u, cone.q);
        let frame = Frame::around(cone.axis);
        dir = frame.to_world(local.at).normalize();
        pdf = density(&cone);
        dirs = frame.pair_to_world(local.by);
        room = local.room;
        // The cone turns and widens as the point moves.
        let widening = frame.to_world(by_q);
        point_dirs = VectorPair::from(at.moves.to_array().map(|dp| {
            let change = cone.change(&sphere, at.origin, dp);
            frame.change(change.axis).to_world(local.at) + widening * change.q
        }));
    } else {
        let local = warp::cosine_hemisphere_mapped(u);
        let frame = Frame::around(at.normal);
        dir = frame.to_world(local.at).normalize();
        pdf = warp::cosine_hemisphere_pdf(local.at.z);
        dirs = frame.pair_to_world(local.by);
        room = local.room;
        let turns = at.turns.to_array();
        point_dirs = VectorPair::from(turns.map(|dn| frame.change(dn).to_world(local.at)));
    }
    let mut differential = Differential::new();
    let direction = Pair {
        dp: VectorPair::ZERO,
        dd: dirs,
    };
    let point = Pair {
        dp: at.moves,
        dd: point_dirs,
    };
    differential.push(direction, room);
    differential.push(point, at.room);
    Start {
        origin: at.origin,
        dir,
        emission: radiance * at.normal.dot(dir).max(0.0),
        normal: at.normal,
        own_density: pdf / at.area,
        differential,
    }
}

fn from_beam(light: &Beam, target: Target, u: [f64; 2]) -> Start {
    let section = Section::of(target, light.axis, own_section(light));
    let mut start = across(&section, light.axis, light.irradiance, u);
    let off = (start.origin - light.center).length_squared();
    if off > light.radius * light.radius {
        start.emission = Rgb::BLACK;
    }
    start
}

fn from_sun(light: &Sun, target: Target, u: [f64; 2], point: [f64; 2]) -> Start {
    let Mapped {
        at: travel,
        by: turns,
        room,
    } = light.travel(point);
    // Without a bounded target there is no cross-section to draw from.
    let section = Section::of(target, travel, UNBOUNDED);
    let mut start = across(&section, travel, light.travelling(), u);
    if light.sin_half > 0.0 {
        let frame = Frame::around(travel);
        let f = start.origin - section.center;
        let (x, y) = (f.dot(frame.s), f.dot(frame.t));
        let center = match target {
            Target::Sphere(s) => s.center - UNBOUNDED.center,
            Target::Whole => DVec3::ZERO,
        };
        let pair = Pair {
            // The section's centre is that of the target, less its part along
            // the direction of travel.
            dp: VectorPair::from(turns.to_array().map(|dt| {
                let change = frame.change(dt);
                change.s * x + change.t * y - dt * center.dot(travel) - travel * center.dot(dt)
            })),
            dd: turns,
        };
        start.differential.push(pair, room);
    }
    start
}

/// A point of the cross-section of parallel light.
fn across(section: &Section, dir: DVec3, emission: Rgb, u: [f64; 2]) -> Start {
    let disc = warp::disc_mapped(u);
    let frame = Frame::around(dir);
    let offset = disc.at * section.radius;
    let own_density = 1.0 / disc_area(section.radius);
    let mut differential = Differential::new();
    let pair = Pair {
        dp: frame.pair_to_world(disc.by) * section.radius,
        dd: VectorPair::ZERO,
    };
    differential.push(pair, disc.room);
    Start {
        origin: section.center + frame.s * offset.x + frame.t * offset.y,
        dir,
        // A disc of no area emits nothing.
        emission: if own_density.is_finite() {
            emission
        } else {
            Rgb::BLACK
        },
        normal: dir,
        own_density,
        differential,
    }
}

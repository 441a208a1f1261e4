//! Glints: sources seen by way of mirrors and glass, small and very bright.
//!
//! A lamp in a curved surface is an image much smaller than a pixel. One
//! sample in a thousand meets it and is ten thousand times brighter than all
//! others: a few such pixels hold all the error of a picture. Rays that look
//! for sources alone are cheap, so pixels where they may pay get a number of
//! them in every pass, aimed at the places in the pixel where an image may be
//! ([`Places`]). Which they are, a pilot of their own decides: it looks for ways
//! that pass *near* a source, which are many times as frequent as those that
//! meet it, and closes in where they come nearer. Since the pilot shares no random
//! numbers with the passes and places are weighed by their chance, what it
//! decides leaves every pixel's mean as it is.

mod places;

use glam::DVec3;

use crate::{
    light::Light,
    sampling::{Purpose, Sequence, Stream},
    scene::Scene,
    transport::{End, Walker},
};

pub(super) use places::{NEAR, Places, WAYS};

/// Strength above which the pilot follows both ways: images weaker than this
/// are not the ones that spoil a picture.
pub(super) const PILOT_SPLIT_ABOVE: f64 = 0.1;

/// Specular steps after which the pilot gives a way up. Nineteen of twenty rays
/// that meet a lamp by way of a glass mesh have made no more; what is seen after
/// dozens of inner reflections is too rare for a pilot to find.
pub(super) const PILOT_DEPTH: u32 = 7;

/// Rays that look for sources through a chosen pixel in every pass. A power
/// of two: they and those of later rounds are then whole nets of the pixel.
pub(super) const RAYS: u64 = 4;

/// Places by pixels, where sources may glint; no pixels where none can.
pub(super) type Glinting = Vec<Option<Box<Places>>>;

/// The round from which on pixels are looked at more closely: what is so rare that only
/// that finds it spoils long renders alone, and the search takes as long as about
/// two passes.
pub(super) const CLOSER_ROUND: u32 = 4;

/// What can glint.
#[derive(Clone, Debug)]
pub(super) struct Glints {
    /// Centre and radius, in metres, of the sphere around each source.
    spheres: Vec<(DVec3, f64)>,
    /// Direction towards each sun, and the sine of half its width.
    suns: Vec<(DVec3, f64)>,
}

impl Glints {
    /// The sources of a scene that can be seen.
    pub(super) fn new(scene: &Scene) -> Self {
        let mut glints = Self {
            spheres: Vec::new(),
            suns: Vec::new(),
        };
        for light in &scene.lights {
            if let Light::Sun(sun) = &light.light {
                // A sun without extent is never met.
                if sun.sin_half > 0.0 {
                    glints.suns.push((-sun.axis, sun.sin_half));
                }
            } else if let Some(s) = light.instance.and_then(|i| scene.world.instance_sphere(i)) {
                glints.spheres.push((s.center, s.radius));
            }
        }
        glints
    }

    /// How near to a source the last leg of a walk passes, in the source's radii;
    /// infinite where it leads away from all of them. Only walks by way of a mirror or
    /// glass count: what is seen directly is large.
    pub(super) fn distance(&self, walker: &Walker, end: &End) -> f64 {
        let (reach, hits) = match end {
            End::Escaped => (f64::INFINITY, 0),
            End::Surface { point, .. } => ((point.p - walker.ray.origin).length(), 1),
            End::Truncated => return f64::INFINITY,
        };
        if walker.depth <= hits {
            return f64::INFINITY;
        }
        let (origin, dir) = (walker.ray.origin, walker.ray.dir);
        let passes = |&(center, radius): &(DVec3, f64)| {
            let to = center - origin;
            let along = to.dot(dir).clamp(0.0, reach);
            (to - dir * along).length() / radius
        };
        let faces = |&(sun, sin): &(DVec3, f64)| {
            if reach.is_infinite() && dir.dot(sun) > 0.0 {
                dir.cross(sun).length() / sin
            } else {
                f64::INFINITY
            }
        };
        let spheres = self.spheres.iter().map(passes);
        let all = spheres.chain(self.suns.iter().map(faces));
        all.fold(f64::INFINITY, f64::min)
    }
}

/// The pilot's ray number `j` through a pixel of the whole picture.
pub(super) fn pilot_stream(seed: u64, item: u64, j: u64) -> Stream {
    Sequence::new(seed, Purpose::Glint, u32::MAX, item).at(j)
}

//! Glints: sources seen by way of mirrors and glass, small and very bright.
//!
//! A lamp in a curved surface is an image much smaller than a pixel. One
//! sample in a hundred meets it and is a thousand times brighter than all
//! others: a few such pixels hold all the error of a picture. Rays that look
//! for sources alone are cheap, so pixels where they may pay get a number of
//! them in every pass. Which pixels these are, a pilot of their own decides:
//! it looks for ways that pass *near* a source, which are many times as
//! frequent as those that meet it. Since the pilot shares no random numbers
//! with the passes, what it decides leaves every pixel's mean as it is.

use glam::DVec3;

use crate::{
    light::Light,
    sampling::{Purpose, Sequence, Stream},
    scene::Scene,
    transport::{End, Walker},
};

/// Rays of the pilot through every pixel.
pub(super) const PILOT_RAYS: u64 = 4;

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

/// How near is near: within so many radii of the source's bounding sphere.
/// The disc that is looked for has nine times the area.
const NEAR: f64 = 3.0;

/// What can glint, or rather the surroundings of it.
#[derive(Clone, Debug)]
pub(super) struct Glints {
    /// Centre and radius, in metres, of the space around each source.
    spheres: Vec<(DVec3, f64)>,
    /// Direction towards each sun, and the cosine to its surroundings' edge.
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
                    let sin = (NEAR * sun.sin_half).min(1.0);
                    glints.suns.push((-sun.axis, (1.0 - sin * sin).sqrt()));
                }
            } else if let Some(s) = light.instance.and_then(|i| scene.world.instance_sphere(i)) {
                glints.spheres.push((s.center, NEAR * s.radius));
            }
        }
        glints
    }

    /// Whether the last leg of a walk passes near a source. Only walks by way
    /// of a mirror or glass count: what is seen directly is large.
    pub(super) fn near(&self, walker: &Walker, end: &End) -> bool {
        let (reach, hits) = match end {
            End::Escaped => (f64::INFINITY, 0),
            End::Surface { point, .. } => ((point.p - walker.ray.origin).length(), 1),
            End::Truncated => return false,
        };
        if walker.depth <= hits {
            return false;
        }
        let (origin, dir) = (walker.ray.origin, walker.ray.dir);
        let passes = |&(center, radius): &(DVec3, f64)| {
            let to = center - origin;
            let along = to.dot(dir).clamp(0.0, reach);
            (to - dir * along).length_squared() <= radius * radius
        };
        let faces = |&(sun, cos): &(DVec3, f64)| reach.is_infinite() && dir.dot(sun) >= cos;
        self.spheres.iter().any(passes) || self.suns.iter().any(faces)
    }
}

/// The pilot's ray number `j` through a pixel of the whole picture.
pub(super) fn pilot_stream(seed: u64, item: u64, j: u64) -> Stream {
    Sequence::new(seed, Purpose::Glint, u32::MAX, item).at(j)
}

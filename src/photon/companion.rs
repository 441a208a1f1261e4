//! How far derivatives hold: a photon's companion.
//!
//! A kernel is as wide as the derivatives say that the light of a cell is
//! spread. Next to a fold of a caustic they change within the cell: the light
//! turns back, and a kernel that does not know reaches into the dark beyond.
//! No derivative at the photon itself tells; a second ray does: one that
//! starts where the rim of the kernel would, at the end of its minor axis, and
//! goes the same way. Between the two the landing point is taken to move along
//! a parabola, so the place where it turns back is known.

use glam::DVec3;

use crate::{
    geometry::Ray,
    transport::{Bend, Carried, Context, Met, Ways, media_beside, meet_in},
};

use super::{Emission, footprint::Rim};

/// Most specular steps that are gone again; longer paths have no companion.
const MOST_STEPS: usize = 16;

/// What a path did at a specular surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Turned {
    instance: u32,
    kind: Kind,
}

/// How a direction changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
    #[default]
    Straight,
    Mirror,
    Refract,
}

impl Kind {
    fn of(bend: &Bend) -> Self {
        match bend {
            Bend::Straight => Self::Straight,
            Bend::Mirror { .. } => Self::Mirror,
            Bend::Refract { .. } => Self::Refract,
        }
    }
}

/// The way of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    turns: [Turned; MOST_STEPS],
    steps: usize,
}

impl Way {
    /// No step yet.
    pub(super) fn new() -> Self {
        Self {
            turns: [Turned::default(); MOST_STEPS],
            steps: 0,
        }
    }

    /// Adds a step.
    #[inline]
    pub(super) fn push(&mut self, instance: u32, bend: &Bend) {
        if let Some(turned) = self.turns.get_mut(self.steps) {
            *turned = Turned {
                instance,
                kind: Kind::of(bend),
            };
        }
        self.steps += 1;
    }

    /// Where the companion lands that starts from `emission` towards `rim` and
    /// goes this way to the object `last`; `None` if its way is another.
    #[inline]
    pub(super) fn follow<const NESTED: bool>(
        &self,
        ctx: &Context<'_>,
        emission: &Emission,
        rim: &Rim,
        last: u32,
    ) -> Option<DVec3> {
        let turns = self.turns.get(..self.steps)?;
        let (mut ray, mut media) = (beside(emission, rim)?, emission.media);
        for turned in turns {
            let Met {
                hit,
                point,
                material,
            } = meet_in::<NESTED>(ctx, &ray, f64::INFINITY, &mut media)?;
            // Where bodies touch, either surface may be the one that is met.
            if !NESTED && hit.surface.instance != turned.instance {
                return None;
            }
            let coin = if turned.kind == Kind::Mirror {
                0.0
            } else {
                1.0
            };
            let lobe =
                Ways::at(&material, &point, ray.dir)?.choose(ray.dir, Carried::Flux, || coin);
            if Kind::of(&lobe.bend) != turned.kind {
                return None;
            }
            if NESTED {
                media = media_beside(ctx, media, &point, lobe.dir);
            }
            ray = point.spawn(lobe.dir);
        }
        let met = meet_in::<NESTED>(ctx, &ray, f64::INFINITY, &mut media)?;
        (met.hit.surface.instance == last).then_some(met.point.p)
    }
}

/// The start of a path that would reach the rim of a kernel, to first order.
fn beside(emission: &Emission, rim: &Rim) -> Option<Ray> {
    let (mut origin, mut dir) = (emission.ray.origin, emission.ray.dir);
    for (pair, step) in emission.differential.pairs().iter().zip(rim.steps) {
        let [a, b] = pair.dp.to_array();
        origin += a * step.x + b * step.y;
        let [a, b] = pair.dd.to_array();
        dir += a * step.x + b * step.y;
    }
    Some(Ray {
        origin,
        dir: dir.try_normalize()?,
        ..emission.ray
    })
}

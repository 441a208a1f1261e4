//! The surface on which a formula is zero.
//!
//! Inside is where the formula is negative. A surface is a change of sign at
//! which the formula is continuous: poles, jumps and the rims of where it is
//! defined are none, and neither is a zero at which the sign stays. What a
//! formula says outside its bounds does not count; a surface that reaches
//! them is cut open there.
//!
//! A ray is first cut to the bounds. Then one of three root finders looks
//! for the first change of sign, each in a file of its own ([`RootFinder`]).
//! A ray that leaves the surface needs no epsilon: it starts beyond the
//! error bound of its point, where intervals prove the sign, and a change of
//! this sign is another crossing. Where they cannot prove it, the side is
//! that to which the ray goes by the formula's derivative along it.

mod crossing;
mod line;
mod march;
mod region;
mod sphere_tracing;

use glam::DVec3;

use self::line::Line;
use super::{Place, ShapeHit, ShapePoint, Surface};
use crate::{
    formula::Formula,
    geometry::{Aabb, Turning, turning::outer},
    numeric::{Interval, gamma},
};

/// Crossings closer to each other than this may be missed, as a fraction of
/// the diagonal of the bounds.
pub const TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;
/// Bounds may touch a closed surface: they are widened by this fraction of
/// their diagonal where that is what proves it closed.
pub const WIDENING: f64 = 1.0 / 1024.0;
/// Most steps of fixed-step marching from corner to corner of the bounds.
pub const MAX_STEPS: f64 = 1e5;

/// How the first crossing along a ray is searched for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RootFinder {
    /// Interval subdivision: while the budget of [`PIECES`] lasts, no two
    /// crossings are missed but those closer than [`TOLERANCE`] or those
    /// between which the formula is as small as its own rounding.
    #[default]
    Interval,
    /// Steps of a fixed length in metres: crossings within one step that
    /// undo each other are missed.
    March {
        /// Length of a step, above zero.
        step: f64,
    },
    /// Steps as long as the largest gradient in the bounds allows.
    SphereTracing,
}

pub use crossing::PIECES;

/// Why a formula makes no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImplicitError {
    /// It is proven not to be zero anywhere in the bounds.
    #[error("the formula is nowhere zero in its bounds")]
    NoSurface,
    /// No largest gradient could be found for sphere tracing.
    #[error("the formula's gradient has no bound that could be found")]
    UnboundedGradient,
}

/// The zeros of a formula in a box.
#[derive(Clone, Debug)]
pub struct Implicit {
    formula: Formula,
    /// Where it is searched for: no surface is outside but what is cut.
    domain: Aabb,
    /// [`TOLERANCE`] in metres.
    tolerance: f64,
    finder: RootFinder,
    /// Bound on the gradient's length in the domain; may be infinite.
    steepest: f64,
    closed: bool,
}

impl Implicit {
    /// The zeros of a formula within `bounds`, a box with a volume.
    ///
    /// # Errors
    /// If there are provably none, or if the root finder needs what the
    /// formula does not offer.
    pub fn new(formula: Formula, bounds: Aabb, finder: RootFinder) -> Result<Self, ImplicitError> {
        let diagonal = (bounds.max - bounds.min).length();
        let widened = bounds.padded(WIDENING * diagonal);
        let (whole, closed) = if region::is_closed(&formula, &bounds) {
            (bounds, true)
        } else if region::is_closed(&formula, &widened) {
            (widened, true)
        } else {
            (bounds, false)
        };
        let tolerance = TOLERANCE * diagonal;
        let domain = region::shrunk(&formula, &whole).ok_or(ImplicitError::NoSurface)?;
        let (steepest, smooth) = region::steepest(&formula, &domain);
        if finder == RootFinder::SphereTracing && !(smooth && steepest.is_finite()) {
            return Err(ImplicitError::UnboundedGradient);
        }
        Ok(Self {
            formula,
            domain,
            tolerance,
            finder,
            steepest,
            closed,
        })
    }

    /// The formula.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// The crossings nearer than this, in metres, may be missed.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The point moved onto the surface along the gradient, by Newton's
    /// method as long as it helps.
    fn moved(&self, mut p: DVec3) -> (DVec3, DVec3) {
        let (mut f, mut g) = self.formula.gradient(p);
        for _ in 0..4 {
            let q = p - g * (f / g.length_squared());
            let (f_q, g_q) = self.formula.gradient(q);
            // False for NaN as well.
            if !(f_q.abs() < f.abs() && q.is_finite()) {
                break;
            }
            (p, f, g) = (q, f_q, g_q);
        }
        (p, g)
    }

    /// A bound on the distance from `p` to the surface: the value there over
    /// the least slope along the normal around it. The tolerance where
    /// intervals prove none, as at the tip of a cone.
    fn error(&self, p: DVec3, normal: DVec3, steep: f64) -> f64 {
        let at = self.formula.range(p.to_array().map(Interval::point));
        let off = at.range.magnitude();
        let mut reach = 2.0 * off / steep;
        for _ in 0..8 {
            // A cube that holds the ball of that radius, with one rounding
            // of the coordinates.
            let region = p.to_array().map(|x| {
                let margin = reach + gamma(1) * (x.abs() + reach);
                Interval::new(x - margin, x + margin)
            });
            let (value, slopes) = self.formula.gradient_range(region);
            let mut along = Interval::ZERO;
            for (i, slope) in slopes.into_iter().enumerate() {
                along = along + slope * Interval::point(normal[i]);
            }
            let distance = off / along.lo();
            if value.continuous && along.lo() > 0.0 && distance <= reach {
                // The quotient and the normal's length round. Beyond three
                // more of these the sign is proven, not only right.
                return 4.0 * distance * (1.0 + gamma(4));
            }
            reach *= 4.0;
        }
        self.tolerance
    }

    /// The part of a ray within the domain, and where on the ray it starts.
    fn line(&self, origin: DVec3, dir: DVec3, t_max: f64) -> Option<(Line<'_>, f64)> {
        let (mut enter, mut exit) = (0.0f64, t_max);
        for i in 0..3 {
            let (low, high) = (
                self.domain.min[i] - origin[i],
                self.domain.max[i] - origin[i],
            );
            if dir[i] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low / dir[i], high / dir[i]);
            enter = enter.max(a.min(b));
            exit = exit.min(a.max(b));
        }
        // From outside the line starts at the box: parameters stay small.
        let from = if enter > 0.0 {
            origin + dir * enter
        } else {
            origin
        };
        let line = Line {
            formula: &self.formula,
            origin: from,
            dir,
            end: exit - enter,
            tolerance: self.tolerance / dir.length(),
        };
        (line.end > 0.0).then_some((line, enter))
    }
}

impl Surface for Implicit {
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        let (line, start) = self.line(origin, dir, t_max)?;
        let side = line.side_at_start(leaving.is_some());
        let root = match self.finder {
            RootFinder::Interval => crossing::first(&line, side),
            RootFinder::March { step } => march::first(&line, side, step / dir.length()),
            RootFinder::SphereTracing => {
                sphere_tracing::first(&line, side, self.steepest * dir.length())
            }
        };
        let t = start + root?;
        (t > 0.0 && t < t_max).then(|| ShapeHit::on(0, t))
    }

    /// Where the formula has no gradient, the normal points against the ray.
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let met = origin + dir * hit.t;
        let (p, gradient) = self.moved(met);
        let steep = gradient.length();
        let sound = steep > 0.0 && steep.is_finite();
        let ng = if sound {
            gradient / steep
        } else {
            -dir.normalize()
        };
        ShapePoint {
            p,
            error: if sound {
                self.error(p, ng, steep)
            } else {
                self.tolerance
            },
            ng,
            ns: ng,
        }
    }

    /// The derivative of the unit gradient: the part across it of the second
    /// derivatives, over its length.
    fn turning(&self, _part: u32, _uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        let f = self.formula.curved(at().p);
        let steep = f.gradient.length();
        let n = f.gradient / steep;
        let map = (f.hessian - outer(n, f.hessian * n)) * (1.0 / steep);
        if map.is_finite() {
            Turning::General(map)
        } else {
            Turning::Flat
        }
    }

    fn bounds(&self) -> Option<Aabb> {
        // Points of the surface are moved by no more than their error.
        let rounding = gamma(4) * self.domain.max_abs();
        Some(self.domain.padded(self.tolerance + rounding))
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    /// Outside the bounds the distance to them; inside the value over the
    /// largest gradient, and whatever cube around the point intervals prove
    /// to be free.
    fn distance_bound(&self, p: DVec3, within: f64) -> f64 {
        let nearest = p.clamp(self.domain.min, self.domain.max);
        let outside = p.distance(nearest) * (1.0 - gamma(6));
        if outside > 0.0 {
            return outside;
        }
        let at = self.formula.range(p.to_array().map(Interval::point));
        let mut bound = if at.continuous && self.steepest.is_finite() {
            at.range.mignitude() / self.steepest * (1.0 - gamma(2))
        } else {
            0.0
        };
        let mut reach = within;
        for _ in 0..6 {
            if bound >= reach {
                break;
            }
            let region = p.to_array().map(|x| {
                let margin = reach + gamma(1) * (x.abs() + reach);
                Interval::new(x - margin, x + margin)
            });
            if self.formula.narrow_range(region).range.sign() != 0 {
                bound = reach;
            }
            reach *= 0.5;
        }
        bound
    }
}

#[cfg(test)]
mod tests;

//! The part of a ray in which roots are searched for.

use glam::DVec3;

use crate::{formula::Formula, numeric::Interval};

/// Steps of the safeguarded Newton method at most; bisection alone needs
/// fewer to tell floats apart that differ by less than 2^-60 of a line.
const NEWTON_STEPS: u32 = 100;

/// A formula on `origin + dir * t`, `0 <= t <= end`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'f> {
    pub(super) formula: &'f Formula,
    pub(super) origin: DVec3,
    pub(super) dir: DVec3,
    pub(super) end: f64,
    /// Smallest piece that is looked at, in lengths of the direction.
    pub(super) tolerance: f64,
}

impl Line<'_> {
    /// The sign of the formula at `t` if intervals prove it, otherwise 0.
    #[inline]
    pub(super) fn sign(&self, t: f64) -> i8 {
        self.formula.at(self.origin, self.dir, t).range.sign()
    }

    /// The sign just behind the start. A ray that leaves the surface is on
    /// the side to which it goes, if nothing else is known.
    #[inline]
    pub(super) fn side_at_start(&self, leaving: bool) -> i8 {
        match self.sign(0.0) {
            0 if leaving => {
                let (_, slope) = self.formula.along(self.origin, self.dir, 0.0);
                if slope < 0.0 { -1 } else { 1 }
            }
            sign => sign,
        }
    }

    /// True if the formula is defined and continuous within the tolerance of
    /// `t`: what changes its sign there is no pole and no jump.
    pub(super) fn is_continuous_at(&self, t: f64) -> bool {
        let around = Interval::new(t - self.tolerance, t + self.tolerance);
        self.formula
            .along_range(self.origin, self.dir, around)
            .value
            .continuous
    }

    /// The root between `a` and `b`, where the signs differ and the one at
    /// `b` is `sign`: Newton's method, and bisection where it leaves the
    /// bracket or does not halve its steps (*Numerical Recipes*, section
    /// 9.4, `rtsafe`).
    pub(super) fn root(&self, mut a: f64, mut b: f64, sign: i8) -> f64 {
        let mut t = a + 0.5 * (b - a);
        let mut last = b - a;
        for _ in 0..NEWTON_STEPS {
            let (value, slope) = self.formula.along(self.origin, self.dir, t);
            if value == 0.0 {
                return t;
            }
            if (value > 0.0) == (sign > 0) {
                b = t;
            } else {
                a = t;
            }
            let newton = t - value / slope;
            // False for NaN as well.
            let good = a <= newton && newton <= b && (newton - t).abs() <= 0.5 * last;
            let next = if good { newton } else { a + 0.5 * (b - a) };
            last = (next - t).abs();
            if last == 0.0 || next == a || next == b {
                return next;
            }
            t = next;
        }
        t
    }
}

/// The last proven sign along a line, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last {
    sign: i8,
    at: f64,
}

impl Last {
    /// A sign at the start of a line; 0 if it is not known.
    pub(super) fn at_start(sign: i8) -> Self {
        Self { sign, at: 0.0 }
    }

    /// What lies behind says nothing about what follows.
    pub(super) fn forget(&mut self) {
        self.sign = 0;
    }

    /// The sign, looked up at `t` if there is none yet.
    pub(super) fn or_at(&mut self, line: &Line, t: f64) {
        if self.sign == 0 {
            (self.sign, self.at) = (line.sign(t), t);
        }
    }

    /// Takes note of a sign from `from` to `to`: if it has changed, the
    /// bracket in which it did. A sign of 0 tells nothing.
    pub(super) fn meet(&mut self, sign: i8, from: f64, to: f64) -> Option<(f64, f64)> {
        if sign == 0 {
            return None;
        }
        let bracket = (self.sign == -sign).then_some((self.at, from));
        (self.sign, self.at) = (sign, to);
        bracket
    }
}

//! Sphere tracing (J. Hart, *Sphere Tracing*, The Visual Computer 12, 1996):
//! where the value is f and it changes by no more than L a metre, no zero is
//! nearer than |f| / L. L comes from intervals, not from the user: once for
//! all the bounds, and, since that is often far too much, for the piece of
//! the ray that the next step may cover (E. Galin, E. Guérin, A. Paris, A.
//! Peytavie, *Segment Tracing Using Local Lipschitz Bounds*, Computer
//! Graphics Forum 39(2), 2020).

use super::line::{Last, Line};
use crate::numeric::{Interval, gamma};

/// Steps along one ray; what is not met until then is missed.
const STEPS: u32 = 1 << 12;
/// The next piece that is bounded, in lengths of the last step.
const GROWTH: f64 = 2.0;

/// The first crossing; `steepest` bounds the derivative along the line.
pub(super) fn first(line: &Line, side: i8, steepest: f64) -> Option<f64> {
    let mut last = Last::at_start(side);
    let (mut t, mut reach) = (0.0, line.end);
    for _ in 0..STEPS {
        let range = line.formula.at(line.origin, line.dir, t).range;
        let sign = range.sign();
        if let Some((a, b)) = last.meet(sign, t, t) {
            return Some(line.root(a, b, sign));
        }
        if t >= line.end {
            return None;
        }
        let ahead = (t + reach).min(line.end);
        let piece = Interval::new(t, ahead);
        let slope = line.formula.along_range(line.origin, line.dir, piece).slope;
        let off = range.mignitude() * (1.0 - gamma(4));
        let free = (off / slope.magnitude()).min(ahead - t).max(off / steepest);
        // Never less than the tolerance, so that it ends. Zero over zero,
        // which `min` passes over, is a formula that stays zero.
        let step = free.max(line.tolerance);
        reach = GROWTH * step;
        t = (t + step).min(line.end);
    }
    None
}

//! Sphere tracing (J. Hart, *Sphere Tracing*, The Visual Computer 12, 1996):
//! where the value is f and no gradient is longer than L, no zero is nearer
//! than |f| / L. L comes from intervals, not from the user.

use super::line::{Last, Line};
use crate::numeric::gamma;

/// Steps along one ray; what is not met until then is missed.
const STEPS: u32 = 1 << 14;

/// The first crossing; `steepest` bounds the derivative along the line.
pub(super) fn first(line: &Line, side: i8, steepest: f64) -> Option<f64> {
    let mut last = Last::at_start(side);
    let mut t = 0.0;
    for _ in 0..STEPS {
        let range = line.formula.at(line.origin, line.dir, t).range;
        let sign = range.sign();
        if let Some((a, b)) = last.meet(sign, t, t) {
            return Some(line.root(a, b, sign));
        }
        if t >= line.end {
            return None;
        }
        // Never less than the tolerance, so that it ends.
        let free = range.mignitude() / steepest * (1.0 - gamma(4));
        t = (t + free.max(line.tolerance)).min(line.end);
    }
    None
}

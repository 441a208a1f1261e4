//! Fixed-step marching: the simplest root finder, for comparison. Steps go
//! along the ray until the sign changes; bisection and Newton's method finish
//! it. Two crossings within one step are missed.

use super::line::{Last, Line};

/// The first crossing that steps of length `step` notice.
pub(super) fn first(line: &Line, side: i8, step: f64) -> Option<f64> {
    let mut last = Last::at_start(side);
    let mut k = 0.0;
    loop {
        k += 1.0;
        let t = (k * step).min(line.end);
        let (value, _) = line.formula.along(line.origin, line.dir, t);
        let sign = i8::from(value > 0.0) - i8::from(value < 0.0);
        if value.is_nan() {
            last.forget();
        }
        if let Some((a, b)) = last.meet(sign, t, t) {
            let root = line.root(a, b, sign);
            if line.is_continuous_at(root) {
                return Some(root);
            }
        }
        if t >= line.end {
            return None;
        }
    }
}

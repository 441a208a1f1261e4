//! Interval subdivision, the default root finder (after D. Mitchell, *Robust
//! Ray Intersection with Interval Arithmetic*, 1990).
//!
//! The line is cut into pieces, from its start on, each halved until it is
//! decided: the formula keeps one sign all along it, or it is monotonic, so
//! that the signs at both ends tell, or cutting further would tell nothing
//! new. Whenever a proven sign differs from the one proven before, and the
//! formula was continuous all the way between, there is the first crossing.

use super::line::{Last, Line};
use crate::{formula::Along, numeric::Interval};

/// Pieces that are looked at along one ray. When these are used up, what is
/// left is cut no further: signs at the ends decide. Formulas that touch zero
/// without crossing it over a length need so many, and others hardly ever.
pub const PIECES: u32 = 4096;
/// Halvings of a line; pieces of the tolerance are reached before.
const DEPTH: usize = 64;

/// The first crossing, if the sign at the start is `side`, or unknown if
/// that is 0.
pub(super) fn first(line: &Line, side: i8) -> Option<f64> {
    let mut last = Last::at_start(side);
    // Where pieces end that are still to be looked at, the nearest on top.
    let mut ends = [line.end; DEPTH];
    let (mut open, mut from) = (1, 0.0);
    let mut budget = PIECES;
    while open > 0 {
        let to = ends[open - 1];
        let all = line
            .formula
            .along_range(line.origin, line.dir, Interval::new(from, to));
        budget = budget.saturating_sub(1);
        let middle = from + 0.5 * (to - from);
        let small = to - from <= line.tolerance || middle <= from || middle >= to;
        if !is_decided(&all) && !small && budget > 0 && open < DEPTH {
            ends[open] = middle;
            open += 1;
            continue;
        }
        if let Some((a, b)) = met(line, &mut last, &all, from, to) {
            let sign = line.sign(b);
            return Some(line.root(a, b, sign));
        }
        from = to;
        open -= 1;
    }
    None
}

/// True if halving the piece would not help.
fn is_decided(all: &Along) -> bool {
    let range = all.value.range;
    if range.is_empty() || range.sign() != 0 {
        return true;
    }
    let monotonic = all.slope.sign() != 0;
    // What is left is what a single place leaves undecided.
    let noisy = all.noise > 0.0 && range.width() <= 2.0 * all.noise;
    all.value.continuous && (monotonic || noisy)
}

/// Takes note of a piece: the bracket of a crossing, if there is one.
fn met(line: &Line, last: &mut Last, all: &Along, from: f64, to: f64) -> Option<(f64, f64)> {
    if !all.value.continuous {
        last.forget();
        return None;
    }
    match all.value.range.sign() {
        0 => {
            last.or_at(line, from);
            last.meet(line.sign(to), to, to)
        }
        sign => last.meet(sign, from, to),
    }
}

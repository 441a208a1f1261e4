//! Stretches of a ray inside a solid.
//!
//! A solid that is the overlap of simpler ones is met where all stretches
//! overlap: no ray can slip through between two parts of its surface.

use super::ShapeHit;
use crate::numeric::quadratic::{Roots, quadratic};

/// Where a ray enters and where it leaves, in its own parameter, and the part
/// that it passes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    enter: (f64, u32),
    exit: (f64, u32),
}

impl Span {
    /// The stretch from `enter` to `exit` within a surface of one part.
    #[inline]
    pub(super) fn of_part(enter: f64, exit: f64, part: u32) -> Self {
        Self {
            enter: (enter, part),
            exit: (exit, part),
        }
    }

    /// The stretch between the planes at heights 0 and `width` along an axis
    /// on which the ray is at `o + d t`. `parts` are the lower and the upper
    /// plane's; the one on which the ray stands is crossed at zero, exactly.
    #[inline]
    pub(super) fn between_planes(
        o: f64,
        d: f64,
        width: f64,
        parts: [u32; 2],
        leaving: Option<u32>,
    ) -> Option<Self> {
        let [low, high] = parts;
        if d == 0.0 {
            // Within a plane the ray touches the rim only; a ray that leaves
            // the plane counts as outside.
            let inside = o > 0.0 && o < width;
            return inside.then_some(Self {
                enter: (f64::NEG_INFINITY, low),
                exit: (f64::INFINITY, high),
            });
        }
        let low_at = if leaving == Some(low) { 0.0 } else { -o / d };
        let high_at = if leaving == Some(high) {
            0.0
        } else {
            (width - o) / d
        };
        Some(if d > 0.0 {
            Self {
                enter: (low_at, low),
                exit: (high_at, high),
            }
        } else {
            Self {
                enter: (high_at, high),
                exit: (low_at, low),
            }
        })
    }

    /// What both have in common; `other` gives the part where both begin or
    /// end at once.
    #[inline]
    pub(super) fn overlap(self, other: Self) -> Option<Self> {
        let enter = if self.enter.0 > other.enter.0 {
            self.enter
        } else {
            other.enter
        };
        let exit = if self.exit.0 < other.exit.0 {
            self.exit
        } else {
            other.exit
        };
        (enter.0 <= exit.0).then_some(Self { enter, exit })
    }

    /// The first of its ends with `0 < t < t_max`, where the span is counted
    /// from `slide`.
    #[inline]
    pub(super) fn first(&self, slide: f64, t_max: f64) -> Option<ShapeHit> {
        let accept = |(local, part): (f64, u32)| {
            let t = local + slide;
            (t > 0.0 && t < t_max).then(|| ShapeHit::on(part, t))
        };
        accept(self.enter).or_else(|| accept(self.exit))
    }

    /// Both ends.
    #[inline]
    pub(super) fn places(&self) -> [f64; 2] {
        [self.enter.0, self.exit.0]
    }

    /// True if the ray never leaves again.
    pub(super) fn is_endless(&self) -> bool {
        self.exit.0 == f64::INFINITY
    }

    /// Tells both ends with `0 < t`, but for infinite ones.
    pub(super) fn ends(&self, slide: f64, found: &mut dyn FnMut(ShapeHit)) {
        for (local, part) in [self.enter, self.exit] {
            let t = local + slide;
            if t > 0.0 && t < f64::INFINITY {
                found(ShapeHit::on(part, t));
            }
        }
    }
}

/// Up to two stretches, in order.
pub(super) type Spans = [Option<Span>; 2];

/// Where `a t^2 + 2 h t + k` is not above zero: the inside of a surface of
/// second degree along a line. With `leaving` the line starts beside the
/// surface at zero, pushed off by the error of the start: the root there is left
/// out, and the other one is that of the line as it is. (The sum of both roots
/// is where the line meets the level of the start again, which is farther from
/// the surface where that is less steep.)
pub(super) fn below_zero(a: f64, h: f64, k: f64, leaving: bool, part: u32) -> Spans {
    const END: f64 = f64::INFINITY;
    let span = |enter, exit| Some(Span::of_part(enter, exit, part));
    let roots = if leaving {
        // The start lies on the side to which the line goes: `k` has the sign
        // of `h`, and the root at the start is not ahead.
        let k = if h == 0.0 { 0.0 } else { k.abs().copysign(h) };
        match quadratic(a, h, k) {
            Roots::Two(near, far) => Roots::Two(near.min(0.0), far.max(0.0)),
            // The line runs along the surface: no way to cross it.
            Roots::None if h == 0.0 => return [None; 2],
            Roots::None if h < 0.0 => return [span(-END, END), None],
            roots => roots,
        }
    } else {
        quadratic(a, h + 0.0, k)
    };
    match roots {
        Roots::Two(near, far) if a > 0.0 => [span(near, far), None],
        Roots::Two(near, far) => [span(-END, near), span(far, END)],
        Roots::One(t) if h > 0.0 => [span(-END, t), None],
        Roots::One(t) => [span(t, END), None],
        Roots::None if k <= 0.0 && a <= 0.0 => [span(-END, END), None],
        Roots::None => [None; 2],
    }
}

/// The stretches within another one.
#[inline]
pub(super) fn within(spans: Spans, other: Span) -> Spans {
    spans.map(|span| span.and_then(|s| s.overlap(other)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line that starts beside a surface meets the surface and not the level
    /// on which it starts.
    #[test]
    fn the_far_root_is_that_of_the_surface() {
        // a (t + e)(t - 1): the roots are off by e at the start, 1 ahead.
        let e = 1.0 / f64::from(1 << 30);
        for a in [1.0, -1.0] {
            let (h, k) = (0.5 * a * (e - 1.0), -a * e);
            let spans = below_zero(a, h, k, true, 0);
            let ahead: Vec<f64> = spans.iter().flatten().flat_map(Span::places).collect();
            let ahead: Vec<f64> = ahead
                .into_iter()
                .filter(|t| *t > 0.0 && t.is_finite())
                .collect();
            assert_eq!(ahead, [1.0], "{a}");
        }
    }

    /// A line that goes on to the side on which it starts has the other side of
    /// the surface ahead or nothing, whatever the rounding of `k` says.
    #[test]
    fn the_root_at_the_start_is_not_ahead() {
        for h in [1e-9, 1.0] {
            for k in [-1e-20, 0.0, 1e-20] {
                let outward = below_zero(1.0, h, k, true, 0);
                let ahead = |span: &Span| span.places().iter().any(|&t| t > 0.0);
                assert!(!outward.iter().flatten().any(ahead), "{h}, {k}");
                let inward = below_zero(1.0, -h, k, true, 0);
                let far = inward[0].expect("a chord").places();
                assert!(far[0] <= 0.0 && far[1] >= 2.0 * h, "{h}, {k}: {far:?}");
            }
        }
    }
}

//! Stretches of a ray inside a solid.
//!
//! A solid that is the overlap of simpler ones is met where all stretches
//! overlap: no ray can slip through between two parts of its surface.

use super::ShapeHit;

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
/// second degree along a line. The discriminant is `h^2 - a k`. With
/// `leaving` the line stands on the surface at zero: `k` counts as zero, and
/// the other root is the sum of both.
pub(super) fn below_zero(
    a: f64,
    h: f64,
    k: f64,
    discriminant: f64,
    leaving: bool,
    part: u32,
) -> Spans {
    use crate::numeric::quadratic::{Roots, quadratic_with_discriminant};
    const END: f64 = f64::INFINITY;
    let span = |enter, exit| Some(Span::of_part(enter, exit, part));
    let roots = if leaving {
        let other = -2.0 * h / a;
        if other.is_finite() {
            Roots::Two(other.min(0.0), other.max(0.0))
        } else if h == 0.0 {
            // The line runs along the surface: no way to cross it.
            return [None; 2];
        } else {
            Roots::One(0.0)
        }
    } else {
        quadratic_with_discriminant(a, h + 0.0, k, discriminant)
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

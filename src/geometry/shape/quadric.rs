//! The general quadric: where a polynomial of second degree is zero.
//!
//! The polynomial is kept about a place near the part that matters, the centre
//! of the box that cuts it, so that its coefficients are as small there as its
//! terms.

use glam::{DMat3, DVec3};

use super::{
    Place, ShapeHit, ShapePoint, Surface,
    conic::level_distance,
    span::{Span, Spans, below_zero},
};
use crate::{
    geometry::{Aabb, Turning, transform::power_of_two_near},
    numeric::{gamma, two_product, two_sum},
};

/// A quadric; its normals point to where the polynomial is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    center: DVec3,
    /// `x . second x + 2 x . slope + constant`, about the centre.
    second: DMat3,
    slope: DVec3,
    constant: f64,
    bounds: Aabb,
    cut: bool,
}

/// `A x^2 + B y^2 + C z^2 + D x y + E y z + F x z + G x + H y + I z + J`.
type Coefficients = [f64; 10];

impl Quadric {
    /// The quadric with these coefficients, not all of the first nine zero,
    /// within a box. With `cut` only what lies in the box exists, an open
    /// surface; without it the box tells where to look closely, and the
    /// surface is without end: an operand of solids.
    pub fn new(coefficients: &Coefficients, bounds: Aabb, cut: bool) -> Self {
        let center = bounds.center();
        // A common factor changes nothing but what overflows; that of a power
        // of two is exact.
        let largest = coefficients.iter().fold(0.0f64, |m, c| m.max(c.abs()));
        let scale = 1.0 / power_of_two_near(largest);
        let c = coefficients.map(|c| c * scale);
        let second = DMat3::from_cols(
            DVec3::new(c[0], 0.5 * c[3], 0.5 * c[5]),
            DVec3::new(0.5 * c[3], c[1], 0.5 * c[4]),
            DVec3::new(0.5 * c[5], 0.5 * c[4], c[2]),
        );
        let slope = 0.5 * DVec3::new(c[6], c[7], c[8]);
        // Far from the origin the terms cancel, so that all of this is summed
        // with twice the digits.
        let [x, y, z] = center.to_array();
        let moved: [(f64, f64); 3] = std::array::from_fn(|i| {
            let row = second.row(i);
            sum_of_products(&[(slope[i], 1.0), (row.x, x), (row.y, y), (row.z, z)])
        });
        let mut terms = vec![(c[9], 1.0)];
        for i in 0..3 {
            let (high, low) = moved[i];
            terms.extend([high, low, slope[i]].map(|s| (center[i], s)));
        }
        let (constant, _) = sum_of_products(&terms);
        let moved = DVec3::from_array(moved.map(|(high, _)| high));
        Self {
            center,
            second,
            slope: moved,
            constant,
            bounds,
            cut,
        }
    }

    /// Half the gradient at a place relative to the centre.
    #[inline]
    fn half_gradient(&self, x: DVec3) -> DVec3 {
        self.second * x + self.slope
    }

    /// The value there, and the sum of the magnitudes of its terms.
    #[inline]
    fn level(&self, x: DVec3) -> (f64, f64) {
        let curved = self.second * x;
        let value = x.dot(curved + 2.0 * self.slope) + self.constant;
        let size = x.abs();
        let columns = [self.second.x_axis, self.second.y_axis, self.second.z_axis];
        let magnitude: DVec3 = (0..3).map(|i| columns[i].abs() * size[i]).sum();
        let terms = size.dot(magnitude + 2.0 * self.slope.abs()) + self.constant.abs();
        (value, terms)
    }

    /// How far a ray from afar slides first, and the stretches inside.
    #[inline]
    fn inside(&self, origin: DVec3, dir: DVec3, leaving: bool) -> (f64, Spans) {
        let from = origin - self.center;
        let slide = if leaving {
            0.0
        } else {
            -from.dot(dir) / dir.length_squared()
        };
        let x = from + dir * slide;
        let a = dir.dot(self.second * dir);
        let h = dir.dot(self.half_gradient(x));
        // On the surface itself `h` tells on which side of the tangent plane
        // the ray goes on; where the error of its start does not tell, there
        // is no chord, as for a cone.
        let h = if leaving && h.abs() <= self.unsure(x, dir) {
            0.0
        } else {
            h
        };
        let k = self.level(x).0;
        (slide, below_zero(a, h, k, leaving, 0))
    }

    /// The hits along the ray, in order.
    #[inline]
    fn hits(&self, origin: DVec3, dir: DVec3, leaving: bool) -> impl Iterator<Item = ShapeHit> {
        let (slide, spans) = self.inside(origin, dir, leaving);
        let (bounds, cut) = (self.bounds, self.cut);
        spans
            .into_iter()
            .flatten()
            .flat_map(|span| span.places())
            .map(move |local| ShapeHit::on(0, local + slide))
            .filter(|hit| hit.t > 0.0 && hit.t < f64::INFINITY)
            .filter(move |hit| !cut || bounds.contains(origin + dir * hit.t))
    }
}

/// The sum of products, rounded, and what rounding has taken, to twice the
/// digits of a float (Ogita, Rump, Oishi 2005, algorithm `Dot2`).
fn sum_of_products(terms: &[(f64, f64)]) -> (f64, f64) {
    let (mut sum, mut rest) = (0.0, 0.0);
    for &(a, b) in terms {
        let (p, lost) = two_product(a, b);
        let (s, also) = two_sum(sum, p);
        sum = s;
        rest += lost + also;
    }
    two_sum(sum, rest)
}

impl Surface for Quadric {
    #[inline]
    fn intersect(
        &self,
        origin: DVec3,
        dir: DVec3,
        t_max: f64,
        leaving: Option<u32>,
    ) -> Option<ShapeHit> {
        self.hits(origin, dir, leaving.is_some())
            .find(|hit| hit.t < t_max)
    }

    fn crossings(
        &self,
        origin: DVec3,
        dir: DVec3,
        leaving: Option<u32>,
        found: &mut dyn FnMut(ShapeHit),
    ) {
        self.hits(origin, dir, leaving.is_some()).for_each(found);
    }

    fn ends_inside(&self, origin: DVec3, dir: DVec3, leaving: Option<u32>) -> bool {
        let (_, spans) = self.inside(origin, dir, leaving.is_some());
        spans.iter().flatten().any(Span::is_endless)
    }

    /// By a step of Newton's method from where the ray is.
    #[inline]
    fn surface(&self, origin: DVec3, dir: DVec3, hit: &ShapeHit) -> ShapePoint {
        let x = (origin - self.center) + dir * hit.t;
        let g = self.half_gradient(x);
        let slope_squared = g.length_squared();
        let (level, terms) = self.level(x);
        let step = if slope_squared > 0.0 {
            0.5 * level / slope_squared
        } else {
            0.0
        };
        let x = x - g * step;
        let slope = slope_squared.sqrt();
        // The value's rounding over the gradient. Near the tip of a cone the
        // gradient vanishes, and the distance goes with the root of the value.
        let rounding = 0.5 * gamma(16) * terms;
        let steepest = slope.max((rounding * self.stretch()).sqrt());
        let second = 0.5 * step * step * slope * self.stretch();
        let ng = self
            .half_gradient(x)
            .try_normalize()
            .unwrap_or(-dir.normalize());
        let p = self.center + x;
        let around = if steepest > 0.0 {
            rounding / steepest
        } else {
            0.0
        };
        ShapePoint {
            p,
            error: around
                + second
                + gamma(2) * (x.abs().max_element() + self.center.abs().max(p.abs()).max_element()),
            ng,
            ns: ng,
        }
    }

    #[inline]
    fn turning(&self, _part: u32, _uv: [f64; 2], at: impl Fn() -> Place) -> Turning {
        Turning::of_level(self.half_gradient(at().p - self.center), self.second)
    }

    fn bounds(&self) -> Option<Aabb> {
        // Points are moved onto the surface after the box has cut it: by their
        // error at most, which grows with the size of the box.
        let reach = self.bounds.max_abs() + self.bounds.half_diagonal().length();
        self.cut.then(|| self.bounds.padded(gamma(64) * reach))
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn distance_bound(&self, p: DVec3, _within: f64) -> f64 {
        let x = p - self.center;
        let slope = self.half_gradient(x).length();
        level_distance(self.level(x).0.abs(), slope, self.stretch())
    }
}

impl Quadric {
    /// A bound on what half the slope along a ray is off at its start `x`
    /// relative to the centre: a start is the root of 3 errors off its point,
    /// which is one off the surface, and rounded to the next float.
    fn unsure(&self, x: DVec3, dir: DVec3) -> f64 {
        let rounding = 0.5 * gamma(16) * self.level(x).1;
        let slope = self.half_gradient(x).length();
        let steepest = slope.max((rounding * self.stretch()).sqrt());
        let around = if steepest > 0.0 {
            rounding / steepest
        } else {
            0.0
        };
        let reach = x.abs().max_element() + self.center.abs().max_element();
        let off = 4.0 * (around + gamma(2) * 2.0 * reach);
        let sizes = self.stretch() * x.length() + self.slope.length();
        dir.length() * (self.stretch() * off + gamma(8) * sizes)
    }

    /// A bound on the factor by which the second derivative stretches: half
    /// of it, by Frobenius.
    fn stretch(&self) -> f64 {
        let squares: f64 = self.second.to_cols_array().iter().map(|x| x * x).sum();
        squares.sqrt()
    }
}

//! What a glance tells of a ray: floats and a counted bound on what they lose
//! prove that it meets what it should, or nothing is said and 32 digits decide
//! (J. Shewchuk, *Adaptive Precision Floating-Point Arithmetic*, 1997).

use std::cell::Cell;

use nephroid::geometry::{Ray, SurfacePoint};

use crate::{
    along::{DEGREE, Digits, Poly},
    exact::{Dd, Vec3Dd, vec},
    field::Field,
    truth::{Meets, Truth},
};

/// A ray beside a shape, in floats.
pub(crate) struct Sight<'a> {
    truth: &'a Truth,
    ray: &'a Ray,
    along: Vec<Poly<f64>>,
    /// What its start may be off, in metres.
    error: f64,
}

/// How often a stretch is halved before nothing is said.
const HALVINGS: u32 = 10;

/// Around a crossing nothing is proven of the sign but that it changes once:
/// this much of the way to the one before and of that to the start, tried in
/// turn. A short chord, of which the error of the start is a large part, may end
/// far from where a start without an error would have had it.
const AROUND: [[f64; 2]; 5] = [
    [1.0 / 256.0, 1.0 / 256.0],
    [0.3, 0.3],
    [0.3, 8.0],
    [0.3, 1e3],
    [0.3, 1e6],
];

/// A polynomial over a stretch, as a mean of these with weights that are not
/// negative (S. Bernstein), and what each may be off.
struct Bernstein {
    parts: [f64; DEGREE + 1],
    off: [f64; DEGREE + 1],
    degree: usize,
}

const CHOOSE: [[f64; DEGREE + 1]; DEGREE + 1] = [
    [1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0],
];

impl Bernstein {
    fn over(poly: &Poly<f64>, from: f64, to: f64) -> Self {
        let n = poly.degree;
        let (wide, far) = (to - from, from.abs());
        let (mut parts, mut off) = ([0.0; DEGREE + 1], [0.0; DEGREE + 1]);
        // Moved to where it starts, and to a stretch from 0 to 1.
        let (mut terms, mut sizes) = ([0.0; DEGREE + 1], [0.0; DEGREE + 1]);
        let mut power = 1.0;
        for k in 0..=n {
            for i in (k..=n).rev() {
                terms[k] = terms[k] * from + CHOOSE[i][k] * poly.terms[i];
                sizes[k] = sizes[k] * far + CHOOSE[i][k] * poly.sizes[i];
            }
            terms[k] *= power;
            sizes[k] *= power;
            power *= wide;
        }
        for j in 0..=n {
            for k in 0..=j {
                let share = CHOOSE[j][k] / CHOOSE[n][k];
                parts[j] += share * terms[k];
                off[j] += share * sizes[k];
            }
            // Once for the coefficients, once for what was done to them here.
            off[j] *= 2.0 * f64::LOST;
        }
        Self {
            parts,
            off,
            degree: n,
        }
    }

    /// The proven sign over the whole stretch but for its ends, or 0, and the
    /// least magnitude.
    fn sign(&self) -> (i8, f64) {
        let mut least = [f64::INFINITY; 2];
        // Where a ray starts exactly on the surface it is zero there alone.
        let starts_at_zero = self.degree > 0 && self.parts[0] == 0.0 && self.off[0] == 0.0;
        for j in usize::from(starts_at_zero)..=self.degree {
            least[0] = least[0].min(-self.parts[j] - self.off[j]);
            least[1] = least[1].min(self.parts[j] - self.off[j]);
        }
        match least {
            [below, _] if below > 0.0 => (-1, if starts_at_zero { 0.0 } else { below }),
            [_, above] if above > 0.0 => (1, if starts_at_zero { 0.0 } else { above }),
            _ => (0, 0.0),
        }
    }
}

impl<'a> Sight<'a> {
    fn new(truth: &'a Truth, ray: &'a Ray, point: &SurfacePoint) -> Self {
        let mut along: Vec<Poly<f64>> = truth.fields.iter().map(|f| f.along(ray)).collect();
        for (poly, field) in along.iter_mut().zip(&truth.fields) {
            // At the start some are nearly zero: how much, only more digits
            // tell.
            if poly.terms[0].abs() <= 4.0 * f64::LOST * poly.sizes[0] {
                let at: [Poly; 3] = vec(ray.origin).map(Poly::constant);
                let (value, lost) = field.worked_out(&at).at(0.0);
                poly.terms[0] = value;
                poly.sizes[0] = value.abs() + lost / f64::LOST;
            }
        }
        Self {
            truth,
            ray,
            along,
            error: truth.error_of(ray, point),
        }
    }

    /// The same with coefficients that were worked out in 32 digits.
    fn sharpened(self) -> Self {
        let sharp = |field: &Field| {
            let exact: Poly = field.along(self.ray);
            let terms = exact.terms.map(Dd::round);
            let lost = exact.sizes.map(|s| s * (Dd::LOST / f64::LOST));
            Poly {
                terms,
                sizes: std::array::from_fn(|i| terms[i].abs() + lost[i]),
                degree: exact.degree,
            }
        };
        Self {
            along: self.truth.fields.iter().map(sharp).collect(),
            ..self
        }
    }

    /// True if what a ray meets that leaves a point is proven to be right;
    /// false says nothing.
    pub(crate) fn confirms(
        truth: &'a Truth,
        ray: &'a Ray,
        point: &SurfacePoint,
        meets: &Meets,
    ) -> bool {
        let sight = Self::new(truth, ray, point);
        if sight.agrees(meets, AROUND[0]) {
            return true;
        }
        let sight = sight.sharpened();
        AROUND.iter().any(|&around| sight.agrees(meets, around))
    }

    /// Whether it is proven that what is met is what should be, if nothing is
    /// asked of signs around crossings but that they change once.
    fn agrees(&self, meets: &Meets, [before, after]: [f64; 2]) -> bool {
        let end = 3.0 * self.truth.size;
        let &Meets { first, second, .. } = meets;
        if !meets.something {
            return self.holds(0.0, end, false, HALVINGS);
        }
        if first >= end || second <= first {
            return false;
        }
        let second = second.min(end);
        let from = first - before * first.min(second - first);
        let to = first + (after * first).min(before * (second - first));
        let inside = meets.entering;
        if self.truth.open {
            return self.holds(0.0, from, false, HALVINGS)
                && self.crosses_once(first, from, to, true);
        }
        // The shape ends before the hunt does.
        self.holds(0.0, from, !inside, HALVINGS)
            && self.crosses_once(first, from, to, inside)
            && if second < end {
                let far = AROUND[0][0] * (second - first).min(end - second);
                self.holds(to, second - far, inside, HALVINGS)
                    && self.crosses_once(second, second - far, second + far, !inside)
            } else {
                self.holds(to, end, inside, HALVINGS)
            }
    }

    fn sign(&self, field: usize, from: f64, to: f64) -> i8 {
        Bernstein::over(&self.along[field], from, to).sign().0
    }

    /// Whether all of a stretch is proven to be inside, or outside; of an open
    /// surface, that nothing is crossed (`inside` is false then).
    fn holds(&self, from: f64, to: f64, inside: bool, halvings: u32) -> bool {
        let is = if self.truth.open {
            if self.sign(0, from, to) != 0 {
                return true;
            }
            self.is_within(from, to)
        } else {
            self.truth.tree.holds(&|i| self.sign(i, from, to))
        };
        if let Some(is) = is {
            return is == inside;
        }
        let middle = from + 0.5 * (to - from);
        halvings > 0
            && from < middle
            && middle < to
            && self.holds(from, middle, inside, halvings - 1)
            && self.holds(middle, to, inside, halvings - 1)
    }

    /// Whether the tree of an open surface holds over a stretch.
    fn is_within(&self, from: f64, to: f64) -> Option<bool> {
        let sign = |i| if i == 0 { -1 } else { self.sign(i, from, to) };
        self.truth.tree.holds(&sign)
    }

    /// Whether the surface is crossed once in a stretch around a place, and near enough to
    /// it; to the inside or out of it.
    fn crosses_once(&self, t: f64, from: f64, to: f64, inside: bool) -> bool {
        if self.truth.open {
            return self.is_within(from, to) == Some(true)
                && self.changes(0, from, to) != 0
                && self.is_near(0, t, from, to);
        }
        // One field alone decides.
        let unknown = Cell::new((0, 0));
        let mut signs = [0i8; 16];
        for (i, sign) in signs.iter_mut().enumerate().take(self.along.len()) {
            *sign = self.sign(i, from, to);
            if *sign == 0 {
                unknown.set((unknown.get().0 + 1, i));
            }
        }
        let (1, field) = unknown.get() else {
            return false;
        };
        let change = self.changes(field, from, to);
        let after = |s: i8| {
            let sign = |i: usize| if i == field { s } else { signs[i] };
            self.truth.tree.holds(&sign)
        };
        change != 0
            && after(-change) == Some(!inside)
            && after(change) == Some(inside)
            && self.is_near(field, t, from, to)
    }

    /// The proven sign of a field's slope over a stretch.
    fn changes(&self, field: usize, from: f64, to: f64) -> i8 {
        Bernstein::over(&self.along[field].derivative(), from, to)
            .sign()
            .0
    }

    /// Whether a field that is known to grow or fall over a stretch is zero
    /// within the error of a place, or so small there that a start within the
    /// error might have made it so.
    fn is_near(&self, field: usize, t: f64, from: f64, to: f64) -> bool {
        let at = self.place(t);
        let level: Poly = self.truth.fields[field].worked_out(&at.map(Poly::constant));
        let (value, lost) = level.at(0.0);
        let value = value.abs() + lost;
        let derivative = self.along[field].derivative();
        let (_, least) = Bernstein::over(&derivative, from, to).sign();
        let sign = |t| match self.along[field].at(t) {
            (value, lost) if value.abs() > lost => value.signum(),
            _ => 0.0,
        };
        if sign(from) * sign(to) >= 0.0 {
            return false;
        }
        if value <= least * self.error {
            return true;
        }
        let slope = |t| self.truth.fields[field].slope::<f64>(self.place(t));
        let level = slope(0.0);
        if self.along[field].terms[0].abs() <= 0.9 * self.error * level
            && value <= 0.9 * self.error * level
        {
            return true;
        }
        let least = [from, t, to]
            .map(slope)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        to - t <= t && value <= 0.9 * self.error * least
    }

    fn place(&self, t: f64) -> Vec3Dd {
        let (o, d) = (vec(self.ray.origin), vec(self.ray.dir));
        std::array::from_fn(|i| o[i] + d[i] * Dd::of(t))
    }
}

/// A polynomial is nowhere outside of its parts, and these tell its sign.
#[test]
fn stretches_have_the_signs_of_their_parts() {
    let factor = |root: f64| Poly::<f64>::line(Dd::of(-root), Dd::of(1.0));
    let cubic = factor(1.0) * factor(2.0) * factor(3.0);
    let sign = |from, to| Bernstein::over(&cubic, from, to).sign().0;
    assert_eq!(sign(0.0, 0.99), -1);
    assert_eq!(sign(1.01, 1.99), 1);
    assert_eq!(sign(3.01, 90.0), 1);
    for root in [1.0, 2.0, 3.0] {
        assert_eq!(sign(root - 1e-3, root + 1e-3), 0, "{root}");
        assert_eq!(sign(root - 1e-3, root), 0, "{root}");
    }
    let parts = Bernstein::over(&cubic, 0.5, 2.5);
    for i in 0..=20 {
        let (value, _) = cubic.at(0.5 + 0.1 * f64::from(i));
        let inside = |least: f64, most: f64| least <= value && value <= most;
        let most = parts.parts[..=3].iter().copied().fold(f64::MIN, f64::max);
        let least = parts.parts[..=3].iter().copied().fold(f64::MAX, f64::min);
        assert!(inside(least - 1e-13, most + 1e-13), "{i}: {value}");
    }
}

/// What a glance confirms, 32 digits do not deny, also if the surface is taken
/// for one that is larger by less than rays can be told apart by, or by more.
#[test]
fn a_glance_is_not_contradicted() {
    use crate::{
        kinds::KIND_NAMES,
        leaks::{Bag, hunt},
    };
    for name in KIND_NAMES {
        let rays = if name.starts_with("formula") {
            300
        } else {
            3000
        };
        for factor in [1.0, 1.0 + 1e-13, 1.0 + 1e-9] {
            let bag = hunt(name, name, factor, 8, rays, |truth, world, point, dir| {
                let ray = point.spawn(dir);
                let meets = truth.meets(world, &ray);
                let glance = Sight::confirms(truth, &ray, point, &meets);
                let slow = truth.judge_slowly(&ray, point, &meets);
                assert!(
                    !glance || slow.leaks() == 0,
                    "{name}, larger by {factor}: {point:?}, {dir}"
                );
                Bag {
                    glances: u64::from(glance),
                    ..slow
                }
            });
            assert!(
                factor > 1.0 || 10 * bag.glances > 7 * bag.rays,
                "{name}: {bag:?}"
            );
        }
    }
}

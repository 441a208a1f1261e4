//! Polynomials along a ray, with 32 digits or with those of a float, and a
//! bound on what these lose: signs that are proven, and roots between proven
//! signs.

use std::ops::{Add, Mul};

use crate::exact::Dd;

/// As high as a torus needs.
pub(crate) const DEGREE: usize = 4;

/// Numbers that polynomials are made of.
pub(crate) trait Digits: Copy + Add<Output = Self> + Mul<Output = Self> {
    /// What a coefficient may be off, over the sum of the magnitudes of its
    /// terms: 2^7 times what one operation may be, as no coefficient takes more
    /// than 64 of them, nor does a value at one place.
    const LOST: f64;
    fn of(x: Dd) -> Self;
    /// The difference of two floats.
    fn less(self, x: f64) -> Self;
    fn round(self) -> f64;
}

/// Each operation is good to 2^-102.
impl Digits for Dd {
    const LOST: f64 = 1.0 / (1u128 << 95) as f64;
    fn of(x: Dd) -> Self {
        x
    }
    fn less(self, x: f64) -> Self {
        self - Self::of(x)
    }
    fn round(self) -> f64 {
        self.round()
    }
}

impl Digits for f64 {
    const LOST: f64 = 1.0 / (1u64 << 46) as f64;
    fn of(x: Dd) -> Self {
        x.round()
    }
    fn less(self, x: f64) -> Self {
        self - x
    }
    fn round(self) -> f64 {
        self
    }
}

/// A polynomial in the parameter of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Poly<N = Dd> {
    pub(crate) terms: [N; DEGREE + 1],
    /// The same with the magnitudes of all that is added up.
    pub(crate) sizes: [f64; DEGREE + 1],
    pub(crate) degree: usize,
}

impl<N: Digits> Poly<N> {
    pub(crate) fn constant(c: Dd) -> Self {
        Self {
            degree: 0,
            ..Self::line(c, Dd::of(0.0))
        }
    }

    /// `a + b t`.
    pub(crate) fn line(a: Dd, b: Dd) -> Self {
        let mut terms = [N::of(Dd::of(0.0)); DEGREE + 1];
        [terms[0], terms[1]] = [a, b].map(N::of);
        Self {
            terms,
            sizes: terms.map(|c| c.round().abs()),
            degree: 1,
        }
    }

    /// A coordinate of a ray from another place, which is good to a rounding of
    /// the difference.
    pub(crate) fn less(self, place: f64) -> Self {
        let mut moved = self;
        moved.terms[0] = self.terms[0].less(place);
        moved.sizes[0] = moved.terms[0].round().abs();
        moved
    }

    /// The coefficient of `t`.
    pub(crate) fn slope(&self) -> f64 {
        self.terms[1].round()
    }

    pub(crate) fn times(self, factor: Dd) -> Self {
        let mut product = self;
        let (by, size) = (N::of(factor), factor.round().abs());
        for i in 0..=self.degree {
            product.terms[i] = self.terms[i] * by;
            product.sizes[i] = self.sizes[i] * size;
        }
        product
    }

    pub(crate) fn derivative(&self) -> Self {
        let mut d = Self::constant(Dd::of(0.0));
        d.degree = self.degree.saturating_sub(1);
        for i in 1..=self.degree {
            d.terms[i - 1] = self.terms[i] * N::of(Dd::of(i as f64));
            d.sizes[i - 1] = self.sizes[i] * i as f64;
        }
        d
    }

    /// The value, and a bound on what is wrong with it.
    pub(crate) fn at(&self, t: f64) -> (f64, f64) {
        let (x, far) = (N::of(Dd::of(t)), t.abs());
        let (mut value, mut size) = (self.terms[self.degree], self.sizes[self.degree]);
        for i in (0..self.degree).rev() {
            value = value * x + self.terms[i];
            size = size * far + self.sizes[i];
        }
        (value.round(), N::LOST * size)
    }
}

impl Poly {
    /// The sign, 0 where it isn't proven.
    pub(crate) fn sign(&self, t: f64) -> i8 {
        let (value, lost) = self.at(t);
        if value.abs() <= lost {
            return 0;
        }
        if value < 0.0 { -1 } else { 1 }
    }

    /// Adds where in `(from, to)` the polynomial has a root or its slope has
    /// one: between these its sign is one and it grows or falls.
    pub(crate) fn breaks(&self, from: f64, to: f64, found: &mut Vec<f64>) {
        if self.degree == 0 {
            return;
        }
        let mut turns = Vec::new();
        self.derivative().breaks(from, to, &mut turns);
        turns.extend([from, to]);
        turns.sort_by(f64::total_cmp);
        for pair in turns.windows(2) {
            if self.sign(pair[0]) * self.sign(pair[1]) < 0 {
                found.push(self.root(pair[0], pair[1]));
            }
        }
        found.extend(&turns[1..turns.len() - 1]);
    }

    /// The root between places of different proven signs, to a float: Newton's
    /// method, and halving where it leaves the bracket or hardly moves it.
    fn root(&self, mut a: f64, mut b: f64) -> f64 {
        let before = self.sign(a);
        let slope = self.derivative();
        let (mut t, mut last) = (a + 0.5 * (b - a), b - a);
        for _ in 0..2000 {
            let (value, _) = self.at(t);
            if value == 0.0 {
                return t;
            }
            if (value < 0.0) == (before < 0) {
                a = t;
            } else {
                b = t;
            }
            let newton = t - value / slope.at(t).0;
            // False for NaN as well.
            let good = a < newton && newton < b && (newton - t).abs() <= 0.5 * last;
            let next = if good { newton } else { a + 0.5 * (b - a) };
            last = (next - t).abs();
            if next <= a || next >= b {
                return if newton == b { b } else { a };
            }
            t = next;
        }
        t
    }
}

impl<N: Digits> Add for Poly<N> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let (mut sum, other) = if self.degree < o.degree {
            (o, self)
        } else {
            (self, o)
        };
        for i in 0..=other.degree {
            sum.terms[i] = sum.terms[i] + other.terms[i];
            sum.sizes[i] += other.sizes[i];
        }
        sum
    }
}

impl<N: Digits> Mul for Poly<N> {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let mut product = Self::constant(Dd::of(0.0));
        product.degree = self.degree + o.degree;
        for i in 0..=self.degree {
            for j in 0..=o.degree {
                product.terms[i + j] = product.terms[i + j] + self.terms[i] * o.terms[j];
                product.sizes[i + j] += self.sizes[i] * o.sizes[j];
            }
        }
        product
    }
}

/// Roots planted where they nearly meet are told apart, and none is made up.
#[test]
fn planted_roots_are_found() {
    let factor = |root: f64| Poly::line(Dd::of(-root), Dd::of(1.0));
    for gap in [1.0, 1e-6, 1e-12] {
        let roots = [0.25, 0.25 + gap, 2.0, 2.0 + 2.0 * gap];
        let poly = roots
            .map(factor)
            .into_iter()
            .reduce(|a, b| a * b)
            .expect("four");
        let mut found = vec![0.0, 5.0];
        poly.breaks(0.0, 5.0, &mut found);
        found.sort_by(f64::total_cmp);
        let signs: Vec<i8> = found
            .windows(2)
            .map(|pair| poly.sign(0.5 * (pair[0] + pair[1])))
            .collect();
        let changes = signs.windows(2).filter(|pair| pair[0] * pair[1] < 0);
        assert_eq!(changes.count(), 4, "{gap:e}: {signs:?}");
        for root in roots {
            let near = found
                .iter()
                .map(|t| (t - root).abs())
                .fold(f64::INFINITY, f64::min);
            assert!(near <= 8.0 * f64::EPSILON, "{root}, {gap:e}: {near:e}");
        }
    }
    let none = factor(1.0) * factor(1.0) + Poly::constant(Dd::of(1e-25));
    let mut found = Vec::new();
    none.breaks(0.0, 5.0, &mut found);
    assert_eq!(found.len(), 1, "nothing but the turning point: {found:?}");
}

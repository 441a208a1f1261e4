//! Results against exact arithmetic: remainders of single operations, and
//! series in double-double numbers for the library's functions.

use proptest::prelude::*;

use super::*;
use crate::numeric::{two_product, two_sum};

/// The unevaluated sum of two floats, about 32 digits.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Wide(f64, f64);

impl Wide {
    fn plus(self, o: Self) -> Self {
        let (s, e) = two_sum(self.0, o.0);
        let (t, f) = two_sum(self.1, o.1);
        let (s, e) = two_sum(s, e + t);
        let (s, e) = two_sum(s, e + f);
        Self(s, e)
    }

    fn times(self, o: Self) -> Self {
        let (p, e) = two_product(self.0, o.0);
        let (p, e) = two_sum(p, e + (self.0 * o.1 + self.1 * o.0));
        Self(p, e)
    }

    fn over(self, n: f64) -> Self {
        let q = self.0 / n;
        let (p, e) = two_product(q, n);
        let rest = self.plus(Self(-p, -e));
        let (s, e) = two_sum(q, rest.0 / n);
        Self(s, e)
    }

    /// Sum of `x^k / k!` over all k from `first` in steps of `step`, the
    /// sign changing from term to term if `alternate`.
    fn series(self, first: u32, step: u32, alternate: bool) -> Self {
        let mut term = Self(1.0, 0.0);
        let mut sum = if first == 0 { term } else { Self(0.0, 0.0) };
        let mut sign = 1.0;
        for k in 1..60u32 {
            term = term.times(self).over(f64::from(k));
            if k < first || !(k - first).is_multiple_of(step) {
                continue;
            }
            if alternate && k > first {
                sign = -sign;
            }
            sum = sum.plus(Self(sign * term.0, sign * term.1));
        }
        sum
    }

    fn exp(self) -> Self {
        // Halved five times and squared as often.
        let mut y = Self(self.0 / 32.0, self.1 / 32.0).series(0, 1, false);
        for _ in 0..5 {
            y = y.times(y);
        }
        y
    }
}

/// True if the interval holds a number known to 30 digits.
fn holds(x: Interval, truth: Wide) -> bool {
    let beyond = |bound: f64| Wide(bound, 0.0).plus(Wide(-truth.0, -truth.1)).0;
    (x.lo() == f64::NEG_INFINITY || beyond(x.lo()) <= 0.0)
        && (x.hi() == f64::INFINITY || beyond(x.hi()) >= 0.0)
}

/// A function of intervals and of numbers.
type Function = (fn(Interval) -> Interval, fn(f64) -> f64);

/// An interval and a number inside.
fn pair() -> impl Strategy<Value = (Interval, f64)> {
    let number = || {
        prop_oneof![
            -10.0..10.0f64,
            Just(0.0),
            -1e-3..1e-3f64,
            -1e8..1e8f64,
            (-8i32..8).prop_map(f64::from),
        ]
    };
    (number(), number(), 0.0..=1.0f64).prop_map(|(a, b, s)| {
        let x = Interval::new(a.min(b), a.max(b));
        (x, (x.lo() + s * (x.hi() - x.lo())).clamp(x.lo(), x.hi()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn sums_and_products_hold_the_exact_ones((a, x) in pair(), (b, y) in pair()) {
        let (s, e) = two_sum(x, y);
        prop_assert!(holds(a + b, Wide(s, e)));
        let (s, e) = two_sum(x, -y);
        prop_assert!(holds(a - b, Wide(s, e)));
        let (p, e) = two_product(x, y);
        prop_assert!(holds(a * b, Wide(p, e)));
        prop_assert!(holds(-a, Wide(-x, 0.0)));
    }

    #[test]
    fn quotients_and_roots_hold_the_exact_ones((a, x) in pair(), (b, y) in pair()) {
        if y != 0.0 {
            prop_assert!(holds(a / b, Wide(x, 0.0).over(y)), "{a:?} / {b:?} at {x}, {y}");
        }
        if x >= 0.0 {
            // The root's bounds squared enclose the number.
            let r = a.sqrt();
            let (l, h) = (two_product(r.lo(), r.lo()), two_product(r.hi(), r.hi()));
            prop_assert!(Wide(l.0, l.1) <= Wide(x, 0.0) || r.lo() == 0.0);
            prop_assert!(Wide(x, 0.0) <= Wide(h.0, h.1));
        }
        prop_assert_eq!(a.abs().contains(x.abs()), true);
        prop_assert!(a.min(b).contains(x.min(y)) && a.max(b).contains(x.max(y)));
    }

    #[test]
    fn powers_hold_the_exact_ones((a, x) in pair(), n in -5i32..9) {
        prop_assume!(x != 0.0 || n >= 0);
        let mut truth = Wide(1.0, 0.0);
        for _ in 0..n.unsigned_abs() {
            truth = truth.times(Wide(x, 0.0));
        }
        let power = a.powi(n.abs());
        prop_assert!(holds(power, truth) || truth.0.abs() < 1e-280, "{a:?}^{n} at {x}");
        if n < 0 {
            // Between the reciprocals of neighbours of the power.
            prop_assert!(a.powi(n).contains(1.0 / truth.0), "{a:?}^{n} at {x}");
        }
        if n % 2 == 0 && n > 0 {
            prop_assert!(power.lo() >= 0.0);
        }
    }

    /// Truths from series, and from the inverse functions'.
    #[test]
    fn functions_hold_the_true_values(x in -1.0..1.0f64, k in -3.0..3.0f64, turns in -1000i32..1000) {
        let at = Interval::point(x);
        let exp = Wide(k, 0.0).exp();
        prop_assert!(holds(Interval::point(k).exp(), exp));
        let (sin, cos) = (Wide(x, 0.0).series(1, 2, true), Wide(x, 0.0).series(0, 2, true));
        prop_assert!(holds(at.sin(), sin) && holds(at.cos(), cos));
        // sin / cos lies between the bounds of the tangent.
        let tan = at.tan();
        let less = |t: f64, up: bool| {
            let d = Wide(t, 0.0).times(cos).plus(Wide(-sin.0, -sin.1));
            if up { d.0 >= 0.0 } else { d.0 <= 0.0 }
        };
        prop_assert!(less(tan.lo(), false) && less(tan.hi(), true));
        // Growing inverses: the function of the bounds encloses the argument.
        let asin = at.asin();
        let of_sine = |y: f64| Wide(y, 0.0).series(1, 2, true).0;
        prop_assert!(of_sine(asin.lo()) <= x && x <= of_sine(asin.hi()));
        let acos = at.acos();
        let of_cosine = |y: f64| Wide(y, 0.0).series(0, 2, true).0;
        prop_assert!(of_cosine(acos.lo()) >= x && x >= of_cosine(acos.hi()));
        let positive = k.abs() + 1e-3;
        let log = Interval::point(positive).log();
        prop_assert!(Wide(log.lo(), 0.0).exp().0 <= positive);
        prop_assert!(positive <= Wide(log.hi(), 0.0).exp().0);
        let atan = Interval::point(k).atan();
        for (bound, side) in [(atan.lo(), -1.0), (atan.hi(), 1.0)] {
            let (s, c) = (Wide(bound, 0.0).series(1, 2, true), Wide(bound, 0.0).series(0, 2, true));
            let d = s.plus(Wide(-k, 0.0).times(c));
            prop_assert!(d.0 * side >= 0.0);
        }
        // Whole turns leave sine and cosine as they are: pi to 32 digits.
        let n = f64::from(turns);
        let far = x + 2.0 * n * std::f64::consts::PI;
        let pi = Wide(std::f64::consts::PI, 1.2246467991473532e-16);
        let back = Wide(far, 0.0).plus(pi.times(Wide(-2.0 * n, 0.0)));
        prop_assert!(holds(Interval::point(far).sin(), back.series(1, 2, true)));
        prop_assert!(holds(Interval::point(far).cos(), back.series(0, 2, true)));
    }

    /// A wider argument gives a wider result, and what is drawn inside lands
    /// inside.
    #[test]
    fn what_is_inside_lands_inside((a, x) in pair(), c in -3.0..3.0f64) {
        let all: [Function; 9] = [
            (Interval::sin, libm::sin),
            (Interval::cos, libm::cos),
            (Interval::tan, libm::tan),
            (Interval::asin, libm::asin),
            (Interval::acos, libm::acos),
            (Interval::atan, libm::atan),
            (Interval::exp, libm::exp),
            (Interval::log, libm::log),
            (Interval::sqrt, f64::sqrt),
        ];
        for (i, (of_interval, of_number)) in all.into_iter().enumerate() {
            let (image, inner) = (of_interval(a), of_interval(Interval::point(x)));
            let value = of_number(x);
            if value.is_finite() {
                prop_assert!(image.contains(value), "function {i}: {x} in {a:?}, {value} in {image:?}");
                prop_assert_eq!(image.intersection(inner), inner, "function {}: {} in {:?}", i, x, a);
            } else if value.is_nan() {
                prop_assert!(inner.is_empty(), "function {i} at {x}: {inner:?}");
            }
        }
        if x > 0.0 {
            prop_assert!(a.powf(c).contains(libm::pow(x, c)));
        }
    }
}

#[test]
fn hard_places() {
    let (one, all) = (Interval::point(1.0), Interval::ENTIRE);
    let across = Interval::new(-1.0, 2.0);
    assert_eq!(one / across, all);
    assert_eq!(one / Interval::ZERO, Interval::EMPTY);
    assert_eq!(Interval::ZERO * all, Interval::ZERO);
    assert_eq!(Interval::ZERO / across, Interval::ZERO);
    let half = one / Interval::new(0.0, 2.0);
    assert!(half.lo() == 0.5f64.next_down() && half.hi() == f64::INFINITY);
    let half = one / Interval::new(-2.0, 0.0);
    assert!(half.hi() == (-0.5f64).next_up() && half.lo() == f64::NEG_INFINITY);
    assert_eq!(Interval::point(f64::NAN), Interval::EMPTY);
    assert_eq!(Interval::new(2.0, 1.0), Interval::EMPTY);
    assert_eq!(Interval::new(-2.0, -1.0).sqrt(), Interval::EMPTY);
    assert_eq!(Interval::new(-2.0, 0.0).log(), Interval::EMPTY);
    assert_eq!(Interval::new(1.5, 2.0).asin(), Interval::EMPTY);
    assert!(Interval::new(-1.0, 4.0).sqrt().contains(0.0));
    assert_eq!(Interval::new(0.0, 4.0).sqrt().lo(), 0.0);
    assert_eq!(Interval::new(1.0, 2.0).tan(), all);
    assert_eq!(Interval::point(1e300).sin(), Interval::new(-1.0, 1.0));
    assert_eq!(Interval::new(1.0, 2.0).sin().hi(), 1.0);
    assert_eq!(Interval::new(3.0, 4.0).cos().lo(), -1.0);
    assert!((Interval::EMPTY + one).is_empty() && (one * Interval::EMPTY).is_empty());
    // Underflow and overflow are enclosed, too.
    let small = Interval::point(1e-200);
    assert!((small * small).hi() > 0.0 && !(small * small).is_empty());
    let large = Interval::point(1e200);
    assert_eq!((large * large).lo(), f64::MAX);
    assert_eq!((large * large).hi(), f64::INFINITY);
    assert_eq!(large.powi(3).hi(), f64::INFINITY);
    assert!(Interval::point(1000.0).exp().contains(f64::MAX));
    assert_eq!((all - all).sign(), 0);
    assert_eq!(
        Interval::new(-3.0, 2.0).powi(2),
        Interval::new(0.0, 9.0f64.next_up())
    );
}

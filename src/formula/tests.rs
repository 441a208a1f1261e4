//! Formulas against expressions that the tests work out by themselves.

use proptest::prelude::*;

use super::*;

/// An expression that knows its text, its value and its derivatives by
/// differences.
#[derive(Clone, Debug)]
enum Tree {
    Variable(usize),
    Number(f64),
    Sum(Box<Tree>, Box<Tree>),
    Difference(Box<Tree>, Box<Tree>),
    Product(Box<Tree>, Box<Tree>),
    Quotient(Box<Tree>, Box<Tree>),
    Power(Box<Tree>, i32),
    Root(Box<Tree>, f64),
    Negative(Box<Tree>),
    Call(&'static str, Box<Tree>),
    Smaller(Box<Tree>, Box<Tree>),
    Larger(Box<Tree>, Box<Tree>),
}

impl Tree {
    fn text(&self) -> String {
        match self {
            Self::Variable(i) => ["x", "y", "z"][*i].to_owned(),
            Self::Number(n) => format!("{n:?}"),
            Self::Sum(a, b) => format!("({} + {})", a.text(), b.text()),
            Self::Difference(a, b) => format!("({} - {})", a.text(), b.text()),
            Self::Product(a, b) => format!("{} * {}", a.text(), b.text()),
            Self::Quotient(a, b) => format!("({} / ({}))", a.text(), b.text()),
            Self::Power(a, n) => format!("({})^{n}", a.text()),
            Self::Root(a, c) => format!("abs({})^{c}", a.text()),
            Self::Negative(a) => format!("(-{})", a.text()),
            Self::Call(f, a) => format!("{f}({})", a.text()),
            Self::Smaller(a, b) => format!("min({}, {})", a.text(), b.text()),
            Self::Larger(a, b) => format!("max({}, {})", a.text(), b.text()),
        }
    }

    fn value(&self, p: DVec3) -> f64 {
        match self {
            Self::Variable(i) => p[*i],
            Self::Number(n) => *n,
            Self::Sum(a, b) => a.value(p) + b.value(p),
            Self::Difference(a, b) => a.value(p) - b.value(p),
            Self::Product(a, b) => a.value(p) * b.value(p),
            Self::Quotient(a, b) => a.value(p) / b.value(p),
            Self::Power(a, n) => a.value(p).powi(*n),
            Self::Root(a, c) => a.value(p).abs().powf(*c),
            Self::Negative(a) => -a.value(p),
            Self::Call(f, a) => call(f, a.value(p)),
            Self::Smaller(a, b) => smaller(a.value(p), b.value(p)),
            Self::Larger(a, b) => -smaller(-a.value(p), -b.value(p)),
        }
    }
}

/// The minimum, undefined where an operand is.
fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.min(b)
    }
}

/// The standard library's functions: another source than the room's.
fn call(f: &str, x: f64) -> f64 {
    match f {
        "sin" => x.sin(),
        "cos" => x.cos(),
        "tan" => x.tan(),
        "asin" => x.asin(),
        "acos" => x.acos(),
        "atan" => x.atan(),
        "exp" => x.exp(),
        "log" => x.ln(),
        "sqrt" => x.sqrt(),
        _ => x.abs(),
    }
}

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        (0usize..3).prop_map(Tree::Variable),
        (0usize..3).prop_map(Tree::Variable),
        (0.1..3.0f64).prop_map(Tree::Number),
    ];
    leaf.prop_recursive(5, 24, 2, |inner| {
        let b = || inner.clone().prop_map(Box::new);
        prop_oneof![
            (b(), b()).prop_map(|(a, b)| Tree::Sum(a, b)),
            (b(), b()).prop_map(|(a, b)| Tree::Difference(a, b)),
            (b(), b()).prop_map(|(a, b)| Tree::Product(a, b)),
            (b(), b()).prop_map(|(a, b)| Tree::Quotient(a, b)),
            (b(), -3i32..5).prop_map(|(a, n)| Tree::Power(a, n)),
            (b(), 0.3..2.7f64).prop_map(|(a, c)| Tree::Root(a, c)),
            b().prop_map(Tree::Negative),
            (0usize..10, b()).prop_map(|(i, a)| {
                let names = [
                    "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs",
                ];
                Tree::Call(names[i], a)
            }),
            (b(), b()).prop_map(|(a, b)| Tree::Smaller(a, b)),
            (b(), b()).prop_map(|(a, b)| Tree::Larger(a, b)),
        ]
    })
}

fn place() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-2.0..2.0f64).prop_map(DVec3::from_array)
}

/// The central difference of `f` along an axis, and how far those of two
/// widths agree.
fn difference(f: impl Fn(DVec3) -> f64, p: DVec3, axis: usize) -> (f64, f64) {
    let of = |h: f64| {
        let step = DVec3::AXES[axis] * h;
        (f(p + step) - f(p - step)) / (2.0 * h)
    };
    let (near, far) = (of(1e-5), of(2e-5));
    (near, (near - far).abs())
}

/// Whether a range over a box holds that of one of its points. A point's own
/// rounding may reach beyond, by its width: nought times what may be infinite
/// is nought, but a product of finite numbers is rounded outward.
fn holds(wide: Interval, at: Interval) -> bool {
    let slack = at.width();
    wide.intersection(at) == at
        || (slack.is_finite() && wide.lo() <= at.lo() + slack && at.hi() - slack <= wide.hi())
}

/// A factor of nought beside one without a bound.
#[test]
fn nought_times_a_pole_is_nought() {
    let f = Formula::parse("abs(y - y)^0.3 * (0.1 / (z + x))").unwrap();
    let region = [0.0, 0.3, 1.3].map(|size| Interval::new(0.0, size));
    let wide = f.range(region);
    let at = f.range([0.0, 0.0, 0.6].map(Interval::point));
    assert!(!wide.continuous && at.continuous);
    assert!(wide.range.contains(0.0) && at.range.contains(0.0));
    assert!(holds(wide.range, at.range), "{wide:?} {at:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn values_are_those_of_the_expression(t in tree(), p in place()) {
        // Too large a part of numbers alone is refused, rightly.
        let Ok(f) = Formula::parse(&t.text()) else { return Ok(()); };
        let (value, truth) = (f.value(p), t.value(p));
        let bound = f.range(p.to_array().map(Interval::point));
        if bound.continuous {
            prop_assert!(bound.range.contains(value) || !value.is_finite(), "{}: {value} outside {bound:?}", t.text());
            // The standard library rounds elsewhere: by as much, at most.
            let (r, slack) = (bound.range, 8.0 * bound.range.width());
            prop_assert!(!truth.is_finite() || (r.lo() - slack <= truth && truth <= r.hi() + slack), "{}: {truth} outside {bound:?}", t.text());
        } else if truth.is_nan() {
            prop_assert!(value.is_nan() || !bound.continuous);
        }
    }

    #[test]
    fn what_is_inside_a_box_lands_inside(t in tree(), p in place(), size in prop::array::uniform3(0.0..1.5f64), s in prop::array::uniform3(0.0..=1.0f64)) {
        let Ok(f) = Formula::parse(&t.text()) else { return Ok(()); };
        let region: [Interval; 3] = std::array::from_fn(|i| Interval::new(p[i], p[i] + size[i]));
        let q = DVec3::from_array(std::array::from_fn(|i| (p[i] + s[i] * size[i]).clamp(region[i].lo(), region[i].hi())));
        let (wide, slopes) = f.gradient_range(region);
        let (value, gradient) = f.gradient(q);
        let at = f.range(q.to_array().map(Interval::point));
        prop_assert!(holds(wide.range, at.range), "{} at {}", t.text(), q);
        let narrow = f.narrow_range(region);
        // What holds the truth in both ways has it in common.
        prop_assert!(at.range.is_empty() || !narrow.range.intersection(at.range).is_empty(), "{} at {}", t.text(), q);
        if wide.continuous {
            prop_assert!(at.continuous);
            prop_assert!(!value.is_finite() || wide.range.contains(value));
            for i in 0..3 {
                prop_assert!(!gradient[i].is_finite() || slopes[i].contains(gradient[i]), "{}: slope {i} {} outside {:?} at {q}", t.text(), gradient[i], slopes[i]);
            }
        }
        prop_assert_eq!(f.range(region), wide);
    }

    #[test]
    fn what_is_on_a_line_lands_inside(t in tree(), o in place(), d in place(), a in 0.0..1.0f64, w in 0.0..1.0f64, s in 0.0..=1.0f64) {
        let Ok(f) = Formula::parse(&t.text()) else { return Ok(()); };
        let piece = Interval::new(a, a + w);
        let at = (a + s * w).clamp(a, piece.hi());
        let all = f.along_range(o, d, piece);
        let (value, slope) = f.along(o, d, at);
        let truth = f.at(o, d, at);
        prop_assert!(truth.range.is_empty() || !all.value.range.intersection(truth.range).is_empty(), "{}", t.text());
        if all.value.continuous {
            // The mean value form is narrower than rounding may be wide.
            let slack = truth.range.width();
            let r = all.value.range;
            prop_assert!(!value.is_finite() || (r.lo() - slack <= value && value <= r.hi() + slack), "{}: {value} outside {r:?}", t.text());
            prop_assert!(!slope.is_finite() || all.slope.contains(slope), "{}: slope {slope} outside {:?}", t.text(), all.slope);
        }
        // The derivative along the line is that of the gradient.
        let (_, g) = f.gradient(o + d * at);
        let by_gradient = g.dot(d);
        let scale = (g * d).abs().element_sum();
        if scale.is_finite() {
            let exact = f.along_range(o, d, Interval::point(at)).slope;
            let curved = f.curved(o + d * at);
            prop_assert!((slope - by_gradient).abs() <= 1e-9 * (scale + slope.abs()) + 8.0 * exact.width(), "{}: {slope} {by_gradient}", t.text());
            prop_assert!((curved.gradient - g).abs().max_element() <= 1e-9 * g.abs().max_element(), "{}: {g} {}", t.text(), curved.gradient);
        }
    }
}

/// Derivatives against differences, at places where these can be trusted.
#[test]
fn derivatives_are_those_of_differences() {
    use proptest::{strategy::ValueTree, test_runner::TestRunner};
    let mut runner = TestRunner::deterministic();
    let (mut first, mut second) = (0, 0);
    for _ in 0..3000 {
        let t = tree().new_tree(&mut runner).unwrap().current();
        let p = place().new_tree(&mut runner).unwrap().current();
        let Ok(f) = Formula::parse(&t.text()) else {
            continue;
        };
        // No derivative where a root's or a power's own is infinite.
        let c = f.curved(p);
        if !c.gradient.is_finite() || !c.hessian.is_finite() {
            continue;
        }
        for i in 0..3 {
            let (slope, doubt) = difference(|q| t.value(q), p, i);
            let size = 1.0 + slope.abs() + t.value(p).abs();
            if doubt < 1e-7 * size && size < 1e4 {
                let off = (c.gradient[i] - slope).abs();
                assert!(
                    off <= 1e-6 * size,
                    "{} at {p}: {} {slope}",
                    t.text(),
                    c.gradient[i]
                );
                first += usize::from(slope != 0.0);
            }
            for j in 0..3 {
                let (bend, doubt) = difference(|q| f.gradient(q).1[j], p, i);
                let size = 1.0 + bend.abs() + c.gradient.abs().max_element();
                if doubt < 1e-7 * size && size < 1e4 {
                    let off = (c.hessian.col(i)[j] - bend).abs();
                    assert!(
                        off <= 1e-6 * size,
                        "{} at {p}: {} {bend}",
                        t.text(),
                        c.hessian
                    );
                    second += usize::from(bend != 0.0);
                }
            }
        }
    }
    assert!(
        first > 1500 && second > 1500,
        "only {first} and {second} could be compared"
    );
}

#[test]
fn operators_bind_as_they_should() {
    let p = DVec3::new(3.0, 2.0, 0.5);
    for (text, value) in [
        ("-x^2", -9.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2^-1*x", 1.5),
        ("x-y-z", 0.5),
        ("x/y/z", 3.0),
        ("x - -y", 5.0),
        ("-x*y", -6.0),
        ("2*-x", -6.0),
        ("(x+y)*z", 2.5),
        ("x+y*z", 4.0),
        ("x^-2", 1.0 / 9.0),
        ("x^y", 9.000000000000002),
        ("4^z", 2.0),
        ("max(x, y, z, 7)", 7.0),
        ("min(x, y, z)", 0.5),
        ("  1e1 + 2.5E-1+.5 + 1. ", 11.75),
        ("2*e", 2.0 * std::f64::consts::E),
        ("x^0 + y^1", 3.0),
        ("sqrt(x*x)", 3.0),
    ] {
        let f = Formula::parse(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert!(
            (f.value(p) - value).abs() <= 4e-15,
            "{text}: {}",
            f.value(p)
        );
    }
}

#[test]
fn equal_parts_are_one() {
    let steps = |text: &str| Formula::parse(text).unwrap().tape.steps();
    assert_eq!(steps("sin(x+y) * sin(y+x)"), 3);
    assert_eq!(steps("x^2 + x*x"), 2);
    assert_eq!(steps("2*pi/3 - 1"), 0);
    assert_eq!(steps("x^(1+1)"), 1);
}

#[test]
fn mistakes_are_marked() {
    let long = "x+".repeat(10_000) + "x";
    let deep = "(".repeat(100_000);
    for (text, marked, part) in [
        ("", "", "empty"),
        ("   ", "   ", "empty"),
        ("x + ", "+", "too early"),
        ("x + * y", "*", "unexpected `*`"),
        ("x + foo", "foo", "unknown name"),
        ("2x", "x", "missing before `x`"),
        ("2 e", "e", "missing before `e`"),
        ("x y", "y", "missing"),
        ("(x)(y)", "(", "missing"),
        ("x(y)", "(", "missing"),
        ("(x + y", "(", "never closed"),
        ("sin(x", "(", "never closed"),
        ("x)", ")", "never opened"),
        ("sin x", "sin", "without brackets"),
        ("sin(x, y)", "sin", "one argument"),
        ("min(x)", "min", "two or more"),
        ("sin()", ")", "unexpected `)`"),
        ("1.2.3", "1.2", "two points"),
        ("x + .", ".", "without digits"),
        ("1e999", "1e999", "too large"),
        ("x**2", "**", "no operator"),
        ("x²", "²", "unexpected character"),
        ("x = 1", "=", "unexpected character"),
        ("3,5 * x", ",", "unexpected `,`"),
        ("1/0", "/", "no finite value"),
        ("x + log(-1)", "log", "no finite value"),
        ("10^10^10", "^", "no finite value"),
        ("+x", "+", "unexpected `+`"),
        (long.as_str(), "", "too long"),
    ] {
        let e = Formula::parse(text).expect_err(text);
        assert!(e.message.contains(part), "{text}: {e:?}");
        assert_eq!(&text[e.span.clone()], marked, "{text}: {e:?}");
    }
    let e = Formula::parse(&deep[..8000]).unwrap_err();
    assert!(e.message.contains("deeply"));
    let e = Formula::parse(&("2^".repeat(200) + "x")).unwrap_err();
    assert!(e.message.contains("deeply"));
    let many: Vec<String> = (0..600).map(|i| format!("x*{i}")).collect();
    let e = Formula::parse(&many.join("+")).unwrap_err();
    assert!(e.message.contains("too many"));
    assert_eq!(
        Formula::parse("x + tann(y)")
            .unwrap_err()
            .unknown
            .as_deref(),
        Some("tann")
    );
}

#[test]
fn the_largest_formulas_are_worked_out() {
    let many: Vec<String> = (1..120).map(|i| format!("x*{i}.5")).collect();
    let f = Formula::parse(&(many.join("+") + "+y")).unwrap();
    let sum: f64 = (1..120).map(|i| f64::from(i) + 0.5).sum();
    let (value, gradient) = f.gradient(DVec3::new(2.0, 1.0, 0.0));
    assert_eq!(
        (value, gradient),
        (2.0 * sum + 1.0, DVec3::new(sum, 1.0, 0.0))
    );
    let nested = "(".repeat(60) + "x" + &")".repeat(60);
    assert_eq!(Formula::parse(&nested).unwrap().value(DVec3::X), 1.0);
}

#[test]
fn undefined_places_say_so() {
    let at = |text: &str, x: Interval| {
        Formula::parse(text)
            .unwrap()
            .range([x, Interval::ZERO, Interval::ZERO])
    };
    let unit = Interval::new(-1.0, 1.0);
    for text in [
        "1/x",
        "log(x)",
        "sqrt(x)",
        "tan(2*x)",
        "asin(2*x)",
        "x^0.5",
        "x^-1",
        "x^x",
    ] {
        assert!(!at(text, unit).continuous, "{text}");
        let below = at(text, Interval::new(0.2, 0.3));
        assert!(
            below.continuous && below.range.is_bounded(),
            "{text}: {below:?}"
        );
    }
    assert!(at("sqrt(x)", Interval::new(-2.0, -1.0)).range.is_empty());
    assert!(
        at("max(1, sqrt(x))", Interval::new(-2.0, -1.0))
            .range
            .is_empty()
    );
    assert!(at("sqrt(x^2 + y^2)", unit).continuous);
    assert!(at("abs(x) * x", unit).continuous);
    for text in ["min(1, sqrt(x))", "max(sqrt(x), 1)"] {
        let value = Formula::parse(text).unwrap().value(-DVec3::X);
        assert!(value.is_nan(), "{text}: {value}");
    }
}

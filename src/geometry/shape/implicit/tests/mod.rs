//! Implicit surfaces against closed forms, against dense sampling, and
//! against formulas that mean no good.

mod closed_forms;

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};

use super::*;
use crate::{
    geometry::{Instance, Ray, Shape, SurfacePoint, Transform, World},
    sampling::{Purpose, Sequence, Stream, warp},
};

const SPHERE: &str = "x^2 + y^2 + z^2 - 1";
const TORUS: &str = "(x^2 + y^2 + z^2 + 0.84)^2 - 4*(x^2 + y^2)";
/// Intersects itself nowhere; cut by its bounds.
const GYROID: &str = "sin(4*x)*cos(4*y) + sin(4*y)*cos(4*z) + sin(4*z)*cos(4*x)";

const FINDERS: [RootFinder; 3] = [
    RootFinder::Interval,
    RootFinder::March { step: 2e-3 },
    RootFinder::SphereTracing,
];

fn cube(r: f64) -> Aabb {
    Aabb {
        min: DVec3::splat(-r),
        max: DVec3::splat(r),
    }
}

fn implicit(text: &str, r: f64, finder: RootFinder) -> Implicit {
    let formula = Formula::parse(text).unwrap_or_else(|e| panic!("{text}: {e}"));
    Implicit::new(formula, cube(r), finder).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn world(shape: Shape, transform: Option<Transform>) -> World {
    World::new(vec![Instance { shape, transform }])
}

fn of(text: &str, r: f64, finder: RootFinder) -> World {
    world(Shape::Implicit(Arc::new(implicit(text, r, finder))), None)
}

fn stream(i: u64) -> Stream {
    Sequence::new(5, Purpose::Pilot, 0, i).at(0)
}

/// A ray to somewhere in a ball of radius `near` from `far` away.
fn ray(s: &mut Stream, near: f64, far: f64) -> Ray {
    let target = warp::sphere(s.next_2d()) * near * s.next_1d();
    let origin = warp::sphere(s.next_2d()) * far;
    Ray::new(origin, (target - origin).normalize())
}

fn met(world: &World, ray: &Ray) -> Option<(f64, SurfacePoint)> {
    let hit = world.closest(ray, f64::INFINITY)?;
    Some((hit.t, world.surface(ray, &hit)))
}

/// From points of the sphere in every direction, grazing ones included.
#[test]
fn rays_that_leave_meet_what_they_should() {
    for finder in [RootFinder::Interval, RootFinder::SphereTracing] {
        let w = of(SPHERE, 1.2, finder);
        let (mut out, mut through, mut grazing) = (0, 0, 0);
        for i in 0..4000 {
            let mut s = stream(i);
            let Some((_, point)) = met(&w, &ray(&mut s, 0.9, 3.0)) else {
                continue;
            };
            let across = point.ng.any_orthonormal_vector();
            let dir = if i % 4 == 0 {
                // Angles to the surface from 1e-9 to 1.
                let up = libm::pow(10.0, -9.0 * s.next_1d()) * if i % 8 == 0 { 1.0 } else { -1.0 };
                grazing += 1;
                (across + point.ng * up).normalize()
            } else {
                warp::sphere(s.next_2d()).normalize()
            };
            let leaving = point.spawn(dir);
            let cosine = point.ng.dot(dir);
            match met(&w, &leaving) {
                None => {
                    assert!(cosine > -1e-15, "{i}: no way out along {dir}, {cosine:e}");
                    out += 1;
                }
                Some((t, exit)) => {
                    assert!(
                        cosine < 0.0,
                        "{i}: met again at {t} along {dir}, {cosine:e}"
                    );
                    // The start is up to the error beneath the surface, which
                    // makes grazing chords longer by the root of that.
                    let (chord, depth) = (-2.0 * cosine, 2.0 * point.error);
                    let slack = 2.0 * (2.0 * depth).sqrt().min(depth / -cosine) + 1e-14;
                    assert!((t - chord).abs() <= slack, "{t} for {chord}, slack {slack}");
                    assert!(exit.ng.dot(dir) > 0.0);
                    assert!(met(&w, &exit.spawn(dir)).is_none());
                    through += 1;
                }
            }
        }
        assert!(
            out > 1000 && through > 1000 && grazing > 500,
            "{out} {through}"
        );
    }
}

/// Dense samples of signs tell where a first crossing must have been found.
#[test]
fn no_crossing_is_missed() {
    let surfaces = [
        (GYROID, 1.5),
        ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8", 3.0),
        ("max(abs(x) - 0.5, min(x^2 + y^2 - 0.3, sin(9*z)))", 1.5),
        ("1/(x^2+y^2+z^2) + log(2 + x) - 3", 1.5),
        ("sqrt(1.2 - x^2) * exp(y) - 2*z^2 - 1", 1.5),
        ("tan(2*x) - y + atan(z)^3", 1.4),
    ];
    for (text, r) in surfaces {
        let shape = implicit(text, r, RootFinder::Interval);
        let f = shape.formula().clone();
        let (mut hits, mut samples) = (0, 0);
        for i in 0..60 {
            let mut s = stream(i);
            let ray = ray(&mut s, r, 3.0 * r);
            let found = shape.intersect(ray.origin, ray.dir, f64::INFINITY, None);
            let end = found.map_or(6.0 * r, |h| h.t * (1.0 - 1e-9));
            let n = 4000;
            let mut before: Option<(f64, f64)> = None;
            for k in 0..=n {
                let t = end * f64::from(k) / f64::from(n);
                let p = ray.at(t);
                let value = f.value(p);
                if !shape.domain.contains(p) || !value.is_finite() {
                    before = None;
                    continue;
                }
                samples += 1;
                if let Some((u, last)) = before
                    && last * value < 0.0
                {
                    // A pole or jump: the values do not shrink around it.
                    let piece = Interval::new(u, t);
                    let continuous = f.along_range(ray.origin, ray.dir, piece).value.continuous;
                    assert!(
                        !continuous,
                        "{text}: {ray:?} missed one before {t}, {found:?}"
                    );
                }
                before = Some((t, value));
            }
            if let Some(hit) = found {
                hits += 1;
                let near = |t: f64| f.value(ray.at(t));
                let step = 1e-7 * r;
                assert!(
                    near(hit.t - step) * near(hit.t + step) < 0.0,
                    "{text}: no crossing at {}",
                    hit.t
                );
            }
        }
        assert!(
            hits > 10 && samples > 1000,
            "{text}: {hits} hits, {samples} samples"
        );
    }
}

#[test]
fn errors_and_normals_hold_on_a_difficult_surface() {
    let w = of(GYROID, 1.5, RootFinder::Interval);
    let f = Formula::parse(GYROID).unwrap();
    let mut hits = 0;
    for i in 0..400 {
        let mut s = stream(i);
        let ray = ray(&mut s, 1.5, 5.0);
        let Some((_, p)) = met(&w, &ray) else {
            continue;
        };
        hits += 1;
        assert!(p.error < 1e-13);
        // The sign differs within the error, on the side the normal says.
        let sign = |side: f64| {
            let q = p.spawn(p.ng * side).origin;
            f.range(q.to_array().map(Interval::point)).range.sign()
        };
        assert_eq!((sign(1.0), sign(-1.0)), (1, -1), "{p:?}");
    }
    assert!(hits > 200);
}

/// Formulas that are no surfaces are no surfaces, in bounded time.
#[test]
fn hostile_formulas_are_harmless() {
    let none = [
        "1/x",
        "x - x",
        "(x^2 + y^2 + z^2 - 1)^2",
        "abs(x + y + z)",
        "tan(x) * 0 + 1/(y - 0.1)",
        "atan(1/x)",
        "0*x",
        "x^2 + y^2 + z^2",
        "sqrt(-x^2)",
        "(x - y) - (x - y)",
        "exp(900*(x+2))*0",
        "1e300*x*1e300*x - 1e-300*y^2*1e-300",
    ];
    for text in none {
        for finder in FINDERS {
            let formula = Formula::parse(text).unwrap();
            let Ok(shape) = Implicit::new(formula, cube(1.0), finder) else {
                continue;
            };
            for i in 0..6 {
                let ray = ray(&mut stream(i), 0.8, 3.0);
                let hit = shape.intersect(ray.origin, ray.dir, f64::INFINITY, None);
                assert_eq!(hit, None, "{text} {finder:?} {ray:?}");
            }
        }
    }
    // These cross zero often, or hardly: an answer in bounded time.
    for text in [
        "sin(1/x)",
        "x^200 - y^201",
        "sin(1e6*x)*sin(1e6*y)",
        "x^x - y",
        "log(log(x))",
    ] {
        let formula = Formula::parse(text).unwrap();
        let Ok(shape) = Implicit::new(formula, cube(1.0), RootFinder::Interval) else {
            continue;
        };
        for i in 0..6 {
            let ray = ray(&mut stream(i), 0.8, 3.0);
            if let Some(hit) = shape.intersect(ray.origin, ray.dir, f64::INFINITY, None) {
                let p = shape.surface(ray.origin, ray.dir, &hit);
                assert!(p.p.is_finite() && p.ng.is_normalized() && p.error.is_finite());
            }
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let make = |text: &str, finder| {
        Implicit::new(Formula::parse(text).unwrap(), cube(1.0), finder).map(|_| ())
    };
    for text in [
        "x^2 + y^2 + z^2 + 1",
        "sqrt(-1 - x^2)",
        "x - 9",
        "log(x - 2)",
        "1/(x^2+y^2)",
    ] {
        let refused = make(text, RootFinder::Interval);
        assert_eq!(refused, Err(ImplicitError::NoSurface), "{text}");
    }
    for text in ["sqrt(x) - y", "x + 1/y", "tan(2*x) - y"] {
        let refused = make(text, RootFinder::SphereTracing);
        assert_eq!(refused, Err(ImplicitError::UnboundedGradient), "{text}");
        assert_eq!(make(text, RootFinder::Interval), Ok(()), "{text}");
    }
}

#[test]
fn closed_is_what_can_be_proven() {
    for (text, r, closed) in [
        (SPHERE, 1.2, true),
        // It touches its bounds.
        (SPHERE, 1.0, true),
        (SPHERE, 0.9, false),
        (TORUS, 1.5, true),
        ("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16", 1.5, true),
        (GYROID, 1.5, false),
        ("z", 1.0, false),
        // Negative around its pole, at which it jumps nowhere else.
        ("5 - 1/(x^2 + y^2 + z^2)", 1.0, true),
        // Its inside ends at a pole, not at a surface.
        ("max(x^2 + y^2 + z^2 - 1, 1/(x + y))", 1.5, false),
        // Undefined outside.
        ("z^2 - sqrt(1 - x^2 - y^2)", 1.5, false),
    ] {
        let shape = implicit(text, r, RootFinder::Interval);
        assert_eq!(shape.is_closed(), closed, "{text} in {r}");
    }
}

#[test]
fn bounds_are_tight_and_distances_are_bounds() {
    let shape = implicit("x^2 + 4*y^2 + z^2 - 1", 7.0, RootFinder::Interval);
    let b = shape.bounds().unwrap();
    let (size, exact) = (b.max - b.min, DVec3::new(2.0, 1.0, 2.0));
    assert!(
        size.cmpge(exact).all() && (size - exact).max_element() < 0.4,
        "{b:?}"
    );
    let sphere = implicit(SPHERE, 1.5, RootFinder::Interval);
    let (mut near, mut far) = (0, 0);
    for i in 0..2000 {
        let mut s = stream(i);
        let p = warp::sphere(s.next_2d()) * 2.0 * s.next_1d();
        let within = 0.5 * s.next_1d();
        let (bound, truth) = (sphere.distance_bound(p, within), (p.length() - 1.0).abs());
        assert!(bound <= truth + 1e-12, "{p}: {bound} for {truth}");
        near += usize::from(bound > 0.3 * truth.min(within));
        far += usize::from(truth > within && bound < within);
    }
    assert!(near > 1200 && far < 1000, "{near} {far}");
}

/// The axes do not matter: a turned formula is a turned shape.
#[test]
fn under_a_transform_rays_leave_too() {
    let turn = DAffine3::from_scale_rotation_translation(
        DVec3::new(2.0, 0.5, -1.0) * 1e3,
        DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize(),
        DVec3::new(1e4, -2e4, 3e3),
    );
    let shape = Shape::Implicit(Arc::new(implicit(SPHERE, 1.1, RootFinder::Interval)));
    let w = world(shape, Transform::new(turn));
    let mut through = 0;
    for i in 0..1500 {
        let mut s = stream(i);
        let own = ray(&mut s, 0.9, 4.0);
        let origin = turn.transform_point3(own.origin);
        let target = turn.transform_point3(own.at(4.0));
        let Some((_, enter)) = met(&w, &Ray::new(origin, (target - origin).normalize())) else {
            continue;
        };
        let dir = warp::sphere(s.next_2d()).normalize();
        let cosine = enter.ng.dot(dir);
        match met(&w, &enter.spawn(dir)) {
            None => assert!(cosine > -1e-9, "{cosine}"),
            Some((t, exit)) => {
                assert!(cosine < 1e-9, "met again at {t}, {cosine}");
                assert!(exit.ng.dot(dir) > -1e-9 && met(&w, &exit.spawn(dir)).is_none());
                through += 1;
            }
        }
    }
    assert!(through > 500);
}

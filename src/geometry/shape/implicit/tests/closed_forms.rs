//! Spheres, ellipsoids and tori against their closed forms.

use super::*;
use crate::geometry::shape::Sphere;

/// Both worlds answer the same along many rays, but where they graze.
fn agree(a: &World, b: &World, near: f64, rays: u64) {
    let mut hits = 0;
    for i in 0..rays {
        let mut s = stream(i);
        let far = [0.3, 2.0, 5.0, 90.0][(i % 4) as usize];
        let ray = ray(&mut s, near, far);
        let (Some((t, p)), Some((u, q))) = (met(a, &ray), met(b, &ray)) else {
            // One alone: only if both nearly touch it.
            let (one, other) = (met(a, &ray), met(b, &ray));
            let grazing = |m: &Option<(f64, SurfacePoint)>| {
                m.as_ref()
                    .is_none_or(|(_, p)| p.ng.dot(ray.dir).abs() < 0.05)
            };
            assert!(
                grazing(&one) && grazing(&other),
                "{ray:?}: {one:?} {other:?}"
            );
            continue;
        };
        if q.ng.dot(ray.dir).abs() < 0.02 {
            continue;
        }
        hits += 1;
        assert!((t - u).abs() < 1e-9, "{ray:?}: {t} instead of {u}");
        assert!(p.p.distance(q.p) < 1e-9 && p.ng.distance(q.ng) < 1e-9);
        assert!(p.error < 1e-13, "{}", p.error);
        // The turnings of both, along some tangent.
        let of = |w: &World, p: &SurfacePoint| {
            let hit = w.closest(&ray, f64::INFINITY).expect("as before");
            w.turning(&hit, p).of(q.ng.any_orthonormal_vector())
        };
        assert!(of(a, &p).distance(of(b, &q)) < 1e-9, "{:?}", of(a, &p));
    }
    assert!(hits > rays / 4, "only {hits} hits");
}

#[test]
fn spheres_agree_with_the_closed_form() {
    let exact = world(Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)), None);
    for finder in FINDERS {
        agree(&of(SPHERE, 1.0, finder), &exact, 1.2, 1500);
    }
}

#[test]
fn ellipsoids_agree_with_a_sphere_under_a_transform() {
    let axes = DVec3::new(0.8, 1.3, 0.5);
    let map = Transform::new(DAffine3::from_scale(axes)).expect("regular");
    let exact = world(Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)), Some(map));
    let text = "(x/0.8)^2 + (y/1.3)^2 + (z/0.5)^2 - 1";
    agree(&of(text, 1.5, RootFinder::Interval), &exact, 1.2, 1500);
}

/// All roots of a polynomial, ascending, from those of its derivative: it is
/// monotonic between them.
fn roots(c: &[f64], low: f64, high: f64) -> Vec<f64> {
    let value = |t: f64| c.iter().rev().fold(0.0, |v, &k| v * t + k);
    if c.len() == 2 {
        return vec![-c[0] / c[1]];
    }
    let slopes: Vec<f64> = (1..c.len()).map(|k| k as f64 * c[k]).collect();
    let mut places = vec![low];
    places.extend(
        roots(&slopes, low, high)
            .into_iter()
            .filter(|t| (low..high).contains(t)),
    );
    places.push(high);
    let mut found = Vec::new();
    for w in places.windows(2) {
        let (mut a, mut b) = (w[0], w[1]);
        if value(a) * value(b) > 0.0 {
            continue;
        }
        for _ in 0..200 {
            let m = a + 0.5 * (b - a);
            if (value(m) > 0.0) == (value(b) > 0.0) {
                b = m;
            } else {
                a = m;
            }
        }
        found.push(b);
    }
    found
}

/// The torus of radii 1 and 0.4 along a ray, as a quartic in the distance
/// from the point nearest the centre.
fn torus_crossings(ray: &Ray) -> Vec<f64> {
    let shift = -ray.origin.dot(ray.dir);
    let (o, d) = (ray.at(shift), ray.dir);
    // (t^2 + k)^2 = 4 (t^2 a + 2 t h + m), with o and d at a right angle.
    let k = o.length_squared() + 1.0 - 0.16;
    let (a, h, m) = (
        d.x * d.x + d.y * d.y,
        o.x * d.x + o.y * d.y,
        o.x * o.x + o.y * o.y,
    );
    let c = [k * k - 4.0 * m, -8.0 * h, 2.0 * k - 4.0 * a, 0.0, 1.0];
    roots(&c, -3.0, 3.0)
        .into_iter()
        .map(|t| t + shift)
        .collect()
}

#[test]
fn tori_agree_with_the_roots_of_the_quartic() {
    for (text, finder) in [
        (TORUS, RootFinder::Interval),
        (TORUS, RootFinder::SphereTracing),
        ("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16", RootFinder::Interval),
    ] {
        let w = of(text, 1.5, finder);
        let mut hits = 0;
        for i in 0..1500 {
            let mut s = stream(i);
            let ray = ray(&mut s, 1.5, 4.0);
            let truth = torus_crossings(&ray);
            // Where it grazes, two roots are close to each other.
            if truth.windows(2).any(|w| w[1] - w[0] < 1e-3) {
                continue;
            }
            let first = truth.first().copied();
            let found = met(&w, &ray);
            match (first, found) {
                (Some(t), Some((u, _))) => assert!((t - u).abs() < 1e-9, "{ray:?}: {u} for {t}"),
                (None, None) => {}
                other => panic!("{ray:?}: {other:?}"),
            }
            // Through and through: what was met is left again.
            let mut crossings = Vec::new();
            let mut at = ray;
            while let Some((_, p)) = met(&w, &at) {
                crossings.push((p.p - ray.origin).dot(ray.dir));
                at = p.spawn(ray.dir);
                assert!(crossings.len() <= 4);
            }
            assert_eq!(
                crossings.len(),
                truth.len(),
                "{ray:?}: {crossings:?} {truth:?}"
            );
            for (t, u) in truth.iter().zip(&crossings) {
                assert!((t - u).abs() < 1e-9);
            }
            hits += truth.len();
        }
        assert!(hits > 800, "{hits}");
    }
}

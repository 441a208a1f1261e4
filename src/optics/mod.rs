//! Reflection, refraction and Fresnel: pure functions shared by both passes.
//!
//! Conventions: `d` is the direction of travel towards the surface, `n` the
//! unit normal on the side from which `d` comes (`d . n < 0`), `cos_i = -d . n`
//! in `(0, 1]`, and `eta = n_t / n_i`, the index ahead over the index behind.
//! Everything here is about power: how the radiance scale changes at an
//! interface is the business of the transport.

mod fresnel;

pub use fresnel::{Interface, fresnel, pane_transmittance};

use glam::DVec3;

/// Mirrors the direction of travel `d` at a surface of normal `n`.
#[inline]
pub fn reflect(d: DVec3, n: DVec3) -> DVec3 {
    unit_again(d - n * (2.0 * d.dot(n)))
}

/// The refracted direction for an incoming `d`, normal `n` (`d . n < 0`),
/// relative index `eta` and the cosine of the refracted ray as returned by
/// [`fresnel`].
#[inline]
pub fn refract(d: DVec3, n: DVec3, eta: f64, cos_t: f64) -> DVec3 {
    let r = 1.0 / eta;
    unit_again(d * r + n * (r * -d.dot(n) - cos_t))
}

/// A vector of unit length but for roundings, without them: one step of
/// Newton's method for the inverse square root, from one. A squared length of
/// `1 + x` becomes `1 - 3/4 x^2`.
#[inline]
fn unit_again(v: DVec3) -> DVec3 {
    v * (1.5 - 0.5 * v.length_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::trig;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn incoming(angle: f64) -> DVec3 {
        let (s, c) = trig::sin_cos(angle);
        DVec3::new(s, 0.0, -c)
    }

    /// Angle after passing a surface with normal `n`, in radians from `-n`.
    fn pass(d: DVec3, n: DVec3, eta: f64) -> DVec3 {
        match fresnel(-d.dot(n), eta) {
            Interface::Partial { cos_t, .. } => refract(d, n, eta, cos_t),
            Interface::Total => panic!("total reflection"),
        }
    }

    #[test]
    fn normal_incidence() {
        let Interface::Partial {
            cos_t,
            reflectance,
            transmittance,
        } = fresnel(1.0, 1.5)
        else {
            panic!("total")
        };
        assert_eq!(cos_t, 1.0);
        assert!((reflectance - 0.04).abs() < 1e-15);
        assert!((transmittance - 0.96).abs() < 1e-15);
    }

    #[test]
    fn equal_indices_do_nothing() {
        for cos in [1.0, 0.5, 1e-8, 1e-300] {
            let Interface::Partial {
                cos_t,
                reflectance,
                transmittance,
            } = fresnel(cos, 1.0)
            else {
                panic!("total")
            };
            assert_eq!((cos_t, reflectance, transmittance), (cos, 0.0, 1.0));
        }
    }

    #[test]
    fn brewster_angle_reflects_no_parallel_light() {
        for eta in [1.33, 1.5, 2.4, 1.0 / 1.5] {
            // tan(theta) = eta; there R is half of the perpendicular part,
            // ((1 - eta^2) / (1 + eta^2))^2.
            let cos = 1.0 / (1.0f64 + eta * eta).sqrt();
            let Interface::Partial { reflectance, .. } = fresnel(cos, eta) else {
                panic!("total")
            };
            let rs = ((1.0 - eta * eta) / (1.0 + eta * eta)).powi(2);
            assert!((reflectance - 0.5 * rs).abs() < 1e-15, "eta {eta}");
        }
    }

    #[test]
    fn critical_angle_decides() {
        for eta in [1.0 / 1.33, 1.0 / 1.5, 0.1] {
            let c = ((1.0 - eta) * (1.0f64 + eta)).sqrt();
            // sin(theta_c) = eta.
            assert!((trig::asin(eta) - trig::acos(c)).abs() < 1e-15);
            assert_eq!(fresnel(c * (1.0 - 1e-15), eta), Interface::Total);
            let Interface::Partial {
                cos_t,
                transmittance,
                ..
            } = fresnel(c * (1.0 + 1e-12), eta)
            else {
                panic!("must pass just above the critical cosine")
            };
            assert!(cos_t > 0.0 && cos_t < 1e-4 && transmittance > 0.0);
        }
    }

    /// Minimum deviation D of a prism of apex A: n = sin((A + D) / 2) / sin(A / 2).
    #[test]
    fn prism_minimum_deviation() {
        let (apex, n) = (PI / 3.0, 1.5168);
        let (sa, _) = trig::sin_cos(apex / 2.0);
        let expected = 2.0 * trig::asin(n * sa) - apex;
        let face = |sign: f64| {
            // Faces tilted by +-A/2 from the vertical; outward normals.
            let (s, c) = trig::sin_cos(apex / 2.0);
            DVec3::new(sign * c, 0.0, s)
        };
        let deviation = |incidence: f64| {
            let (left, right) = (face(-1.0), face(1.0));
            // A ray meeting the left face from outside at that incidence.
            let base = trig::acos(-left.x);
            let (s, c) = trig::sin_cos(incidence - base);
            let d = DVec3::new(c, 0.0, s);
            assert!((trig::acos(-d.dot(left)) - incidence).abs() < 1e-12);
            let inside = pass(d, left, n);
            let out = pass(inside, -right, 1.0 / n);
            trig::acos(d.dot(out).clamp(-1.0, 1.0))
        };
        let best = f64::midpoint(apex, expected);
        assert!(
            (deviation(best) - expected).abs() < 1e-12,
            "deviation at the symmetric ray"
        );
        for off in [-0.1, -0.01, 0.01, 0.1] {
            assert!(
                deviation(best + off) > expected,
                "minimum at the symmetric ray"
            );
        }
    }

    /// A slab of thickness h shifts a ray by h sin i (1 - cos i / sqrt(n^2 - sin^2 i)).
    #[test]
    fn slab_shift() {
        let (n, h) = (1.5, 2.0);
        for i in [0.1, 0.5, 1.0, 1.5] {
            let d = incoming(i);
            let inside = pass(d, DVec3::Z, n);
            let out = pass(inside, DVec3::Z, 1.0 / n);
            // Snell is conditioned like 1 / cos^2 where the ray grazes.
            let tol = 8.0 * crate::numeric::U / d.z.powi(2);
            assert!(
                (out - d).length() < tol,
                "direction changed by {:e}",
                (out - d).length()
            );
            // Where the ray leaves, against where the straight one would.
            let exit = inside * (h / -inside.z);
            let straight = d * (h / -d.z);
            let shift = (exit - straight).cross(d).length();
            let (s, c) = trig::sin_cos(i);
            let expected = h * s * (1.0 - c / (n * n - s * s).sqrt());
            assert!(
                (shift - expected).abs() < 1e-14,
                "shift {shift} expected {expected}"
            );
        }
    }

    proptest! {
        #[test]
        fn snell_and_energy(angle in 0.0..FRAC_PI_2, eta in 0.3..3.0f64, tilt in 0.0..PI) {
            let n = DVec3::new(trig::sin_cos(tilt).0, trig::sin_cos(tilt).1, 0.0);
            let (t, _) = n.any_orthonormal_pair();
            let (s, c) = trig::sin_cos(angle);
            let d = t * s - n * c;
            let r = reflect(d, n);
            prop_assert!((r - (t * s + n * c)).length() < 1e-14);
            match fresnel(-d.dot(n), eta) {
                Interface::Total => prop_assert!(s >= eta * (1.0 - 1e-12)),
                Interface::Partial { cos_t, reflectance, transmittance } => {
                    prop_assert!((0.0..=1.0).contains(&reflectance) && (0.0..=1.0).contains(&transmittance));
                    prop_assert!((reflectance + transmittance - 1.0).abs() < 1e-14);
                    let w = refract(d, n, eta, cos_t);
                    prop_assert!((w.length() - 1.0).abs() < 1e-15);
                    prop_assert!((w.dot(t) * eta - s).abs() < 1e-13, "Snell");
                    prop_assert!(w.dot(n) <= 0.0, "refracted to the far side");
                    // The way back: same transmittance, same path.
                    if let Interface::Partial { cos_t: back, transmittance: t2, .. } = fresnel(cos_t, 1.0 / eta) {
                        let delta = 1e-9 / cos_t.max(1e-6) ;
                        prop_assert!((back - c).abs() < delta && (t2 - transmittance).abs() < delta);
                    }
                }
            }
        }

        #[test]
        fn pane_limits(cos in 1e-6..1.0f64, ior in 1.0..3.0f64) {
            // The geometric series of a pane's inner reflections, summed term
            // by term.
            let Interface::Partial { reflectance: r, transmittance: t, .. } = fresnel(cos, ior) else { panic!("total") };
            let mut sum = 0.0;
            let mut k = t * t;
            for _ in 0..200_000 {
                sum += k;
                k *= r * r;
                if k < 1e-18 { break; }
            }
            prop_assert!((pane_transmittance(cos, ior) - sum).abs() < 1e-9);
        }
    }
}

//! Fresnel equations of a smooth dielectric interface.

use crate::numeric::difference_of_products;

/// What happens to unpolarised light at an interface; one decision for the
/// branch and the numbers, so that nobody decides again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interface {
    /// Total internal reflection.
    Total,
    /// The light splits.
    Partial {
        /// Cosine of the refracted ray to the normal, above 0.
        cos_t: f64,
        /// Fraction of the power reflected.
        reflectance: f64,
        /// Fraction transmitted, computed directly: at grazing angles
        /// `1 - reflectance` would lose its digits.
        transmittance: f64,
    },
}

/// Fresnel's equations for `cos_i` in `[0, 1]` and `eta = n_t / n_i > 0`.
///
/// The refracted cosine comes from the factored
/// `eta^2 cos_t^2 = cos_i^2 - (1 - eta)(1 + eta)`, which keeps its accuracy
/// near the critical angle. Equal indices reflect nothing at any angle.
#[inline]
pub fn fresnel(cos_i: f64, eta: f64) -> Interface {
    let c = cos_i;
    if eta == 1.0 {
        return Interface::Partial {
            cos_t: c,
            reflectance: 0.0,
            transmittance: 1.0,
        };
    }
    // Into the denser medium both terms are positive and nothing cancels.
    let numerator = if eta > 1.0 {
        c * c + (eta - 1.0) * (eta + 1.0)
    } else {
        difference_of_products(c, c, 1.0 - eta, 1.0 + eta)
    };
    if numerator <= 0.0 {
        return Interface::Total;
    }
    let cos_t = (numerator.sqrt() * (1.0 / eta)).min(1.0);
    let (ds, dp) = (c + eta * cos_t, eta * c + cos_t);
    // One division for both: neither is small, for one of the cosines is not.
    let both = 1.0 / (ds * dp);
    let (per_s, per_p) = (both * dp, both * ds);
    let rs = (c - eta * cos_t) * per_s;
    let rp = (eta * c - cos_t) * per_p;
    Interface::Partial {
        cos_t,
        reflectance: 0.5 * (rs * rs + rp * rp),
        transmittance: 2.0 * eta * c * cos_t * (per_s * per_s + per_p * per_p),
    }
}

/// Fraction of the power that passes a thin parallel pane whose index is `ior`
/// times that around it, with all reflections between its faces added as powers (the pane is
/// thick against the coherence length): `T^2 (1 + R^2 + R^4 + ...) =
/// T^2 / (1 - R^2) = T / (1 + R)` with `R`, `T` of one face for unpolarised
/// light. The rest is reflected.
#[inline]
pub fn pane_transmittance(cos_i: f64, ior: f64) -> f64 {
    match fresnel(cos_i, ior) {
        Interface::Total => 0.0,
        Interface::Partial {
            reflectance: r,
            transmittance: t,
            ..
        } => t / (1.0 + r),
    }
}

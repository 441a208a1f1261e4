//! Pixel filters: how a pixel averages the picture around it.
//!
//! Samples are drawn from the filter itself and weigh the same (M. Ernst,
//! M. Stamminger and G. Greiner, *Filter Importance Sampling*, IEEE Symposium
//! on Interactive Ray Tracing, 2006). A sample belongs to one pixel, so pixels
//! stay independent of each other and of the window that is rendered.

use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, PI};

use crate::numeric::trig;

/// A pixel filter: a density over the film around the pixel's centre, the
/// same along both axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The mean over the pixel's own square.
    #[default]
    Box,
    /// A normal distribution of standard deviation half a pixel, cut off at
    /// 1.5 pixels and renormalised.
    Gaussian,
    /// The four-term Blackman-Harris window, 3 pixels wide (F. Harris, *On
    /// the Use of Windows for Harmonic Analysis with the Discrete Fourier
    /// Transform*, Proceedings of the IEEE 66(1), 1978, section V.I).
    BlackmanHarris,
}

/// Standard deviation of the Gaussian in pixels, before it is cut off.
const SIGMA: f64 = 0.5;

/// Where the wide filters end, in pixels from the centre.
const RADIUS: f64 = 1.5;

/// Coefficients of the Blackman-Harris window about its middle (Harris 1978,
/// table 1, -92 dB); they sum to 1.
const WINDOW: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];

/// More steps of Newton's method than any `u` needs.
const MOST_STEPS: u32 = 100;

impl Filter {
    /// Where a sample lies relative to the pixel's top left corner, in pixels,
    /// for `u` in the unit square.
    pub fn place(self, u: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Box => u,
            Self::Gaussian | Self::BlackmanHarris => u.map(|u| 0.5 + self.quantile(u)),
        }
    }

    /// Distance from the centre, in pixels, beyond which the filter is zero.
    pub fn radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Gaussian | Self::BlackmanHarris => RADIUS,
        }
    }

    /// Density along one axis at `x` pixels from the centre.
    pub fn density(self, x: f64) -> f64 {
        if x.abs() > self.radius() {
            return 0.0;
        }
        match self {
            Self::Box => 1.0,
            Self::Gaussian => {
                let z = x / SIGMA;
                let inside = libm::erf(RADIUS / SIGMA * FRAC_1_SQRT_2);
                libm::exp(-0.5 * z * z) / ((2.0 * PI).sqrt() * SIGMA * inside)
            }
            Self::BlackmanHarris => {
                let terms = (0u32..).zip(WINDOW);
                let sum: f64 = terms
                    .map(|(k, a)| a * trig::sin_cos(f64::from(k) * PI * x / RADIUS).1)
                    .sum();
                sum / (2.0 * RADIUS * WINDOW[0])
            }
        }
    }

    /// Probability along one axis of lying between the centre and `x`,
    /// negative to the left: an odd function that ends at one half.
    pub fn cumulative(self, x: f64) -> f64 {
        let x = x.clamp(-self.radius(), self.radius());
        match self {
            Self::Box => x,
            Self::Gaussian => {
                let part = |x: f64| libm::erf(x / SIGMA * FRAC_1_SQRT_2);
                0.5 * part(x) / part(RADIUS)
            }
            Self::BlackmanHarris => {
                let [a, waves @ ..] = WINDOW;
                let sum: f64 = (1u32..)
                    .zip(waves)
                    .map(|(k, a)| {
                        let k = f64::from(k);
                        a / k * trig::sin_cos(k * PI * x / RADIUS).0
                    })
                    .sum();
                (x / RADIUS + FRAC_1_PI * sum / a) * 0.5
            }
        }
    }

    /// The inverse of the cumulative distribution, `u` in `[0, 1)`.
    fn quantile(self, u: f64) -> f64 {
        let wanted = (u - 0.5).abs();
        // To the right of the centre the density falls, so the distribution
        // is concave and Newton's method climbs from the centre to the
        // solution without passing it, but for rounding: it ends where it no
        // longer climbs.
        let mut x = 0.0;
        for _ in 0..MOST_STEPS {
            let step = (wanted - self.cumulative(x)) / self.density(x);
            let next = (x + step).min(self.radius());
            if next <= x {
                break;
            }
            x = next;
        }
        x.copysign(u - 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: [Filter; 2] = [Filter::Gaussian, Filter::BlackmanHarris];

    /// Midpoint rule over the filter's support; all derivatives that matter
    /// at the ends are small.
    fn integral(filter: Filter, from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
        let n = 20_000;
        let h = (to - from) / f64::from(n);
        (0..n)
            .map(|i| from + h * (f64::from(i) + 0.5))
            .map(|x| f(x) * filter.density(x) * h)
            .sum()
    }

    #[test]
    fn densities_integrate_to_their_distributions() {
        for filter in [Filter::Box, Filter::Gaussian, Filter::BlackmanHarris] {
            let r = filter.radius();
            assert!((integral(filter, -r, r, |_| 1.0) - 1.0).abs() < 1e-8);
            assert!((filter.cumulative(r) - 0.5).abs() < 1e-15);
            for x in [0.05, 0.3, 0.49, 0.8, 1.2, 1.49].map(|x: f64| x.min(r)) {
                let expected = integral(filter, 0.0, x, |_| 1.0);
                assert!((filter.cumulative(x) - expected).abs() < 1e-8, "{filter:?}");
                assert_eq!(filter.cumulative(-x), -filter.cumulative(x));
            }
            assert_eq!(filter.density(1.001 * r), 0.0);
        }
    }

    #[test]
    fn places_invert_the_distribution_and_keep_order() {
        for filter in WIDE {
            let n = 4096;
            let mut last = -filter.radius();
            for i in 0..n {
                let u = f64::from(i) / f64::from(n);
                let [x, y] = filter.place([u, 0.5]);
                assert_eq!(y, 0.5, "{filter:?}: the middle is the centre");
                let x = x - 0.5;
                assert!(x.abs() <= filter.radius() && x >= last, "{filter:?}: {u}");
                // The distribution is known to a few roundings of one half.
                assert!(
                    (filter.cumulative(x) + 0.5 - u).abs() < 1e-15,
                    "{filter:?}: {u}"
                );
                last = x;
            }
            let [end, _] = filter.place([1.0f64.next_down(), 0.5]);
            assert!(end <= 0.5 + filter.radius());
        }
        assert_eq!(Filter::Box.place([0.25, 0.75]), [0.25, 0.75]);
    }

    /// Variances in closed form: of the cut-off normal distribution,
    /// s^2 (1 - 2 c phi(c) / (2 Phi(c) - 1)) with c = r / s; of the window,
    /// `r^2 (1/3 + sum of 2 (-1)^k a_k / (a_0 k^2 pi^2))`.
    #[test]
    fn moments_of_the_samples() {
        let c = RADIUS / SIGMA;
        let phi = libm::exp(-0.5 * c * c) / (2.0 * PI).sqrt();
        let gaussian = SIGMA * SIGMA * (1.0 - 2.0 * c * phi / libm::erf(c * FRAC_1_SQRT_2));
        let [a, b, d, e] = WINDOW;
        let waves = (-b + d / 4.0 - e / 9.0) / a;
        let window = RADIUS * RADIUS * (1.0 / 3.0 + 2.0 * waves / (PI * PI));
        for (filter, variance) in WIDE.into_iter().zip([gaussian, window]) {
            let n = 1 << 16;
            let (mut mean, mut square) = (0.0, 0.0);
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let x = filter.place([0.5, u])[1] - 0.5;
                mean += x / f64::from(n);
                square += x * x / f64::from(n);
            }
            assert!(mean.abs() < 1e-12, "{filter:?}: {mean}");
            assert!(
                (square / variance - 1.0).abs() < 1e-5,
                "{filter:?}: {square} {variance}"
            );
        }
    }
}

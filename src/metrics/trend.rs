//! A power law that is seen through a few estimates, and where it leads.
//!
//! In logarithms a power law is a line. How steep it is, is believed to some
//! extent beforehand, is learned from the estimates, and may change slowly on
//! the way: the slope is a random walk, so that a prediction becomes less
//! certain the further it reaches. Line and slope are followed by a Kalman
//! filter (A. Harvey, *Forecasting, Structural Time Series Models and the Kalman
//! Filter*, Cambridge University Press 1989, section 4.1: the local linear
//! trend).

/// What is believed of a line y(x); see the module's text.
#[derive(Clone, Copy, Debug)]
pub struct Trend {
    /// Where the line was last seen; `None` before it was.
    seen: Option<f64>,
    y: f64,
    slope: f64,
    /// Variance of `y`, their covariance, variance of `slope`.
    variance: [f64; 3],
    drift: f64,
}

impl Trend {
    /// A line of which nothing is known but that its slope is about `slope`,
    /// with a standard deviation of `deviation`; while x grows by 1, the slope
    /// changes by a number of variance `drift`.
    pub fn new(slope: f64, deviation: f64, drift: f64) -> Self {
        Self {
            seen: None,
            y: 0.0,
            slope,
            variance: [0.0, 0.0, deviation * deviation],
            drift,
        }
    }

    /// Takes note of an estimate of y(x), of a variance above zero. Estimates
    /// come by growing x.
    pub fn observe(&mut self, x: f64, y: f64, variance: f64) {
        let Some(seen) = self.seen else {
            (self.seen, self.y) = (Some(x), y);
            self.variance[0] = variance;
            return;
        };
        let [var, covariance, var_slope] = self.variance_after(x - seen);
        let expected = self.y + self.slope * (x - seen);
        let surprise = (y - expected) / (var + variance);
        self.seen = Some(x);
        self.y = expected + var * surprise;
        self.slope += covariance * surprise;
        let kept = variance / (var + variance);
        self.variance = [
            var * kept,
            covariance * kept,
            var_slope - covariance * covariance / (var + variance),
        ];
    }

    /// Expectation and variance of y(x), for an x beyond all estimates;
    /// `None` before the first of them.
    pub fn at(&self, x: f64) -> Option<[f64; 2]> {
        let way = x - self.seen?;
        let [variance, ..] = self.variance_after(way);
        Some([self.y + self.slope * way, variance])
    }

    fn variance_after(&self, way: f64) -> [f64; 3] {
        let [var, covariance, var_slope] = self.variance;
        let drift = self.drift * way;
        [
            var + way * (2.0 * covariance + way * (var_slope + drift / 3.0)),
            covariance + way * (var_slope + drift / 2.0),
            var_slope + drift,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::mix2;

    /// A number of mean 0 and variance 1, nearly normal.
    fn normal(a: u64, b: u64) -> f64 {
        let sum: u64 = (0..12).map(|i| mix2(mix2(a, b), i) >> 11).sum();
        sum as f64 / (1u64 << 53) as f64 - 6.0
    }

    /// With exact estimates the line is theirs, whatever was believed.
    #[test]
    fn a_line_is_found() {
        let mut trend = Trend::new(3.0, 100.0, 0.0);
        assert_eq!(trend.at(1.0), None);
        for x in 1..=4 {
            let x = f64::from(x);
            trend.observe(x, 5.0 - 0.7 * x, 1e-12);
        }
        let [y, variance] = trend.at(10.0).unwrap();
        assert!((y + 2.0).abs() < 1e-5 && variance < 1e-9, "{y} {variance}");
    }

    /// From one estimate on, belief leads: worked by hand.
    #[test]
    fn belief_leads_from_a_single_estimate() {
        let mut trend = Trend::new(-1.0, 0.2, 0.03);
        trend.observe(2.0, 0.5, 0.01);
        let [y, variance] = trend.at(4.0).unwrap();
        assert_eq!(y, -1.5);
        // 0.01 + 2^2 (0.04 + 0.03 x 2 / 3)
        assert!((variance - 0.25).abs() < 1e-12, "{variance}");
    }

    /// Two estimates and a belief are the least squares of a line: the filter
    /// against the normal equations.
    #[test]
    fn without_drift_it_is_least_squares() {
        let (prior, deviation, noise) = (-1.0, 0.3, 0.05);
        let points = [(0.0, 1.0), (0.7, 0.1), (1.5, -0.9), (1.8, -0.8)];
        let mut trend = Trend::new(prior, deviation, 0.0);
        // Weighted sums for the intercept and the slope.
        let (mut a, mut b, mut c) = (0.0, 0.0, 1.0 / (deviation * deviation));
        let (mut u, mut v) = (0.0, prior / (deviation * deviation));
        for (x, y) in points {
            trend.observe(x, y, noise);
            a += 1.0 / noise;
            b += x / noise;
            c += x * x / noise;
            u += y / noise;
            v += x * y / noise;
        }
        let determinant = a * c - b * b;
        let (y0, slope) = ((c * u - b * v) / determinant, (a * v - b * u) / determinant);
        let x = 3.0;
        let [y, variance] = trend.at(x).unwrap();
        assert!((y - y0 - slope * x).abs() < 1e-12, "{y}");
        let expected = (c - 2.0 * b * x + a * x * x) / determinant;
        assert!((variance - expected).abs() < 1e-12, "{variance}");
    }

    /// Laws made to order, with slopes that are drawn from what is believed and
    /// wander as they may: nine of ten intervals at 90 % hold, near and far.
    #[test]
    fn intervals_hold_as_often_as_they_say() {
        let (slope, deviation, drift, noise): (f64, f64, f64, f64) = (-1.0, 0.2, 0.05, 0.01);
        for (seen, ahead) in [(1, 4), (4, 2), (4, 12)] {
            let (laws, mut held) = (2000, 0);
            for law in 0..laws {
                let mut trend = Trend::new(slope, deviation, drift);
                let mut at = slope + deviation * normal(law, 0);
                let (mut y, step) = (0.0, 0.5);
                for i in 1..=seen + ahead {
                    if i > 1 {
                        let before = at;
                        at += (drift * step).sqrt() * normal(law, 2 * i);
                        y += 0.5 * (before + at) * step;
                    }
                    if i <= seen {
                        let estimate = y + noise.sqrt() * normal(law, 2 * i + 1);
                        trend.observe(step * i as f64, estimate, noise);
                    }
                }
                let [mean, variance] = trend.at(step * (seen + ahead) as f64).unwrap();
                held += u32::from((y - mean).abs() <= 1.645 * variance.sqrt());
            }
            // 1800 expected, with a standard deviation of 13.
            assert!((1740..=1860).contains(&held), "{seen} {ahead}: {held}");
        }
    }
}

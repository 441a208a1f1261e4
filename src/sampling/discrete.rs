//! Choosing one of several items with given weights.

/// A discrete distribution over `0..n`, sampled by inverting its cumulative
/// sums, so that strata of the input stay strata of the output.
#[derive(Clone, Debug)]
pub struct Discrete {
    /// Cumulative probabilities; the last is 1.
    cdf: Vec<f64>,
}

impl Discrete {
    /// A distribution proportional to `weights`, which must be finite and not
    /// negative. `None` if there are none or all are zero.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        if !(total > 0.0 && total.is_finite()) || weights.iter().any(|w| *w < 0.0) {
            return None;
        }
        let mut sum = 0.0;
        let mut cdf: Vec<f64> = weights
            .iter()
            .map(|w| {
                sum += w;
                sum / total
            })
            .collect();
        // Items of weight zero at the end must not be reached by rounding.
        let last = weights.iter().rposition(|w| *w > 0.0).unwrap_or(0);
        for c in &mut cdf[last..] {
            *c = 1.0;
        }
        Some(Self { cdf })
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.cdf.len()
    }

    /// Whether there are no items; never true for a distribution that exists.
    pub fn is_empty(&self) -> bool {
        self.cdf.is_empty()
    }

    /// Probability of item `i`.
    #[inline]
    pub fn probability(&self, i: usize) -> f64 {
        self.cdf[i] - if i == 0 { 0.0 } else { self.cdf[i - 1] }
    }

    /// The item that `u` in `[0, 1)` selects. The number is asked for only
    /// where there is a choice.
    #[inline]
    pub fn choose(&self, u: impl FnOnce() -> f64) -> usize {
        if self.cdf.len() == 1 {
            0
        } else {
            self.sample(u()).0
        }
    }

    /// The item that `u` in `[0, 1)` selects, and `u` stretched over the
    /// item's own interval for further use.
    #[inline]
    pub fn sample(&self, u: f64) -> (usize, f64) {
        if self.cdf.len() == 1 {
            return (0, u);
        }
        let i = self
            .cdf
            .partition_point(|c| *c <= u)
            .min(self.cdf.len() - 1);
        let low = if i == 0 { 0.0 } else { self.cdf[i - 1] };
        let rest = (u - low) / (self.cdf[i] - low);
        (i, rest.clamp(0.0, 1.0f64.next_down()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_match_and_zero_weights_never_come() {
        let d = Discrete::new(&[0.0, 1.0, 0.0, 3.0, 0.0]).expect("positive weights");
        let n = 4000;
        let mut counts = [0; 5];
        for k in 0..n {
            let (i, rest) = d.sample(f64::from(k) / f64::from(n));
            assert!((0.0..1.0).contains(&rest));
            counts[i] += 1;
        }
        assert_eq!(counts, [0, 1000, 0, 3000, 0]);
        assert_eq!(d.probability(3), 0.75);
        assert_eq!(d.sample(1.0f64.next_down()).0, 3);
        assert!(Discrete::new(&[]).is_none());
        assert!(Discrete::new(&[0.0, 0.0]).is_none());
    }
}

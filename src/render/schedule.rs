//! How the kernel shrinks from round to round.

/// Independent replicates of the sample sequences; a round holds one pass of
/// each, and the film keeps one sum for each.
pub const REPLICATES: u32 = crate::film::REPLICATES as u32;

/// Exponent of the schedule: with `alpha = 2/3` the mean squared error of the
/// averaged passes falls fastest, like `N^(-2/3)` for independent photons
/// (Kaplanyan and Dachsbacher 2013).
const ALPHA: f64 = 2.0 / 3.0;

/// Kernel scales by round: `s_k^2 = s_0^2 * product over j = 1..=k of
/// (j - 1 + alpha) / j` (Knaus and Zwicker 2011), a function of the round
/// alone.
#[derive(Clone, Copy, Debug)]
pub struct Schedule {
    first: f64,
}

impl Schedule {
    /// A schedule that starts with scale `first`.
    pub fn new(first: f64) -> Self {
        Self { first }
    }

    /// Scale of round `k`.
    pub fn scale(&self, k: u32) -> f64 {
        let squared: f64 = (1..=k)
            .map(|j| (f64::from(j) - 1.0 + ALPHA) / f64::from(j))
            .product();
        self.first * squared.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The product in closed form: Gamma(k + a) / (Gamma(a) k!).
    #[test]
    fn matches_the_closed_form() {
        let s = Schedule::new(2.0);
        assert_eq!(s.scale(0), 2.0);
        for k in [1u32, 2, 10, 100, 5000] {
            let kf = f64::from(k);
            let ln = libm::lgamma(kf + ALPHA) - libm::lgamma(ALPHA) - libm::lgamma(kf + 1.0);
            let expected = 2.0 * (0.5 * ln).exp();
            assert!((s.scale(k) / expected - 1.0).abs() < 1e-10, "round {k}");
        }
        assert!(s.scale(1000) < s.scale(999));
    }
}

//! Logarithmic axes: from numbers to places on paper, and where the ticks are.

use libm::log10;

use super::words::power;

/// Decades of the shortest axis: fewer would make noise look like a trend.
const SHORTEST: f64 = 0.8;
/// Share of the length that stays free at both ends.
const MARGIN: f64 = 0.04;

/// An axis, from decimal logarithms to places in the drawing's units.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogScale {
    /// Logarithms at both ends.
    ends: [f64; 2],
    /// Places of both ends.
    places: [f64; 2],
}

/// A tick: mantissa times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tick {
    /// 1 to 9.
    pub(super) mantissa: u8,
    /// The power of ten.
    pub(super) exponent: i32,
    /// Whether it is written beside the axis.
    pub(super) labelled: bool,
}

impl Tick {
    /// Decimal logarithm of its number.
    pub(super) fn log(self) -> f64 {
        f64::from(self.exponent) + log10(f64::from(self.mantissa))
    }

    /// Its number times ten to the `shift`, in words.
    pub(super) fn words(self, shift: i32) -> String {
        let (mantissa, exponent) = (self.mantissa, self.exponent + shift);
        match exponent {
            0..5 => format!("{mantissa}{}", "0".repeat(exponent as usize)),
            -4..0 => format!("0.{}{mantissa}", "0".repeat((-1 - exponent) as usize)),
            _ => power(&mantissa.to_string(), exponent),
        }
    }
}

impl LogScale {
    /// The axis that shows all `values` that have a logarithm, over `places`;
    /// one decade about 1 if there is none.
    pub(super) fn covering(values: impl Iterator<Item = f64>, places: [f64; 2]) -> Self {
        let logs = values.filter(|v| drawable(*v)).map(log10);
        let around = logs.fold(None, |ends: Option<[f64; 2]>, log| {
            let [low, high] = ends.unwrap_or([log, log]);
            Some([low.min(log), high.max(log)])
        });
        let [low, high] = around.unwrap_or([0.0, 0.0]);
        let middle = f64::midpoint(low, high);
        let half = ((high - low) / 2.0 * (1.0 + 2.0 * MARGIN)).max(SHORTEST / 2.0);
        Self {
            ends: [middle - half, middle + half],
            places,
        }
    }

    /// Where `value` is.
    pub(super) fn place(&self, value: f64) -> f64 {
        self.place_of_log(log10(value))
    }

    /// Where ten to the `log` is.
    pub(super) fn place_of_log(&self, log: f64) -> f64 {
        let ([low, high], [from, to]) = (self.ends, self.places);
        from + (log - low) / (high - low) * (to - from)
    }

    /// Whether `value` lies within the ends.
    pub(super) fn holds(&self, value: f64) -> bool {
        drawable(value) && (self.ends[0]..=self.ends[1]).contains(&log10(value))
    }

    /// Its ticks by growing numbers, with at most about `most` labels.
    pub(super) fn ticks(&self, most: usize) -> Vec<Tick> {
        let [low, high] = self.ends;
        let decades = high - low;
        let stride = (decades / most.max(1) as f64).ceil().max(1.0) as i32;
        let labelled: &[u8] = match most as f64 / decades {
            room if room >= 4.0 => &[1, 2, 3, 5],
            room if room >= 2.0 => &[1, 3],
            _ => &[1],
        };
        let drawn = if decades <= 5.0 { 9 } else { 1 };
        let mut ticks = Vec::new();
        for exponent in low.floor() as i32..=high.ceil() as i32 {
            for mantissa in 1..=drawn {
                let labelled = labelled.contains(&mantissa) && exponent.rem_euclid(stride) == 0;
                let tick = Tick {
                    mantissa,
                    exponent,
                    labelled,
                };
                if (labelled || drawn > 1) && (low..=high).contains(&tick.log()) {
                    ticks.push(tick);
                }
            }
        }
        ticks
    }
}

/// Whether a logarithmic axis has a place for `value`.
pub(super) fn drawable(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64], most: usize) -> Vec<String> {
        let scale = LogScale::covering(values.iter().copied(), [0.0, 100.0]);
        let ticks = scale.ticks(most).into_iter();
        ticks.filter(|t| t.labelled).map(|t| t.words(0)).collect()
    }

    #[test]
    fn labels_are_round_and_few() {
        assert_eq!(labels(&[0.02, 40.0], 6), ["0.1", "1", "10"]);
        assert_eq!(labels(&[1.0, 5.5], 6), ["1", "2", "3", "5"]);
        assert_eq!(labels(&[0.5, 40.0], 5), ["0.5", "1", "3", "10", "30"][1..]);
        assert_eq!(labels(&[], 5), ["0.5", "1", "2"]);
        let huge = labels(&[1e-300, 1e300], 8);
        assert!((6..=9).contains(&huge.len()), "{huge:?}");
        assert!(huge.contains(&"10⁻⁷⁶".to_owned()) || huge.iter().any(|l| l.starts_with("10⁻")));
        let tiny = labels(&[5e-324, f64::NAN, 0.0, -1.0, f64::INFINITY], 5);
        assert!(tiny.iter().all(|l| l.contains("10⁻³²")), "{tiny:?}");
    }

    /// Even ratios are even steps, and the ends keep a margin.
    #[test]
    fn places_follow_logarithms() {
        let scale = LogScale::covering([1e-3, 1e3].into_iter(), [100.0, 0.0]);
        let steps = [-3, -1, 1, 3].map(|k| scale.place(libm::pow(10.0, f64::from(k))));
        let even = steps[0] - steps[1];
        assert!((steps[1] - steps[2] - even).abs() < 1e-9);
        assert!(steps[0] < 97.0 && steps[3] > 3.0, "{steps:?}");
        assert!((scale.place(1.0) - 50.0).abs() < 1e-9);
        assert!(scale.holds(1.0) && !scale.holds(1e4) && !scale.holds(0.0));
    }
}

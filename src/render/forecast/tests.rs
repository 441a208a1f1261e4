use super::*;
use crate::sampling::mix2;

/// A number of mean 0 and variance 1, nearly normal.
fn normal(a: u64, b: u64) -> f64 {
    let sum: u64 = (0..12).map(|i| mix2(mix2(a, b), i) >> 11).sum();
    sum as f64 / (1u64 << 53) as f64 - 6.0
}

/// What a picture states of its noise and bias, certain but for a tenth.
fn figures(noise: f64, bias: f64, order: f64) -> Figures {
    let error = libm::hypot(noise, bias);
    let more = 1.1f64.sqrt();
    let bound = error * error + 0.1 * libm::hypot(noise * noise, bias * bias);
    Figures {
        pixels: 1000,
        error,
        bound: bound.sqrt(),
        noise,
        noise_bound: more * noise,
        bias,
        bias_bound: more * bias,
        bias_order: order,
        error_of_all: error,
        bound_of_all: more * error,
        percentile_95: 2.0 * error,
        percentile_99: 3.0 * error,
        outside: None,
    }
}

/// A picture whose squares fall by power laws.
#[derive(Clone, Copy)]
struct Law {
    noise: [f64; 2],
    bias: [f64; 2],
    order: f64,
    /// Where the slopes drift from the first round on: by which numbers.
    drifts: Option<u64>,
}

/// How far a line has drifted at x = log(passes) because its slope changes in
/// small steps.
fn drifted(seed: u64, drift: f64, x: f64) -> f64 {
    let (step, mut at) = (0.125, log(f64::from(REPLICATES)));
    let (mut slope, mut y, mut i) = (0.0, 0.0, 0);
    while at < x {
        let before = slope;
        slope += (drift * step).sqrt() * normal(seed, i);
        let part = (x - at).min(step);
        y += part * (before + 0.5 * (slope - before) * part / step);
        (at, i) = (at + step, i + 1);
    }
    y
}

impl Law {
    fn squares(self, passes: f64) -> [f64; 2] {
        let law = |[a, slope]: [f64; 2], drift: f64, number: u64| {
            let far = |seed| drifted(mix2(seed, number), drift, log(passes));
            a * libm::pow(passes, slope) * exp(self.drifts.map_or(0.0, far))
        };
        [law(self.noise, NOISE[2], 0), law(self.bias, BIAS[2], 1)]
    }

    fn error(self, passes: f64) -> f64 {
        let [noise, bias] = self.squares(passes);
        (noise + bias).sqrt()
    }

    /// A forecast from statements after these rounds, of which chance makes
    /// more or less; a pass takes a second, the preparations ten.
    fn forecast(self, rounds: &[u32], chance: impl Fn(u64) -> f64) -> Forecast {
        let mut forecast = Forecast::new();
        for (i, passes) in rounds.iter().map(|r| r * REPLICATES).enumerate() {
            for pass in 1..=passes {
                forecast.clock(pass, 10.0 + f64::from(pass));
            }
            let [noise, bias] = self.squares(f64::from(passes));
            let i = 2 * i as u64;
            let noise = noise * exp(STATED[0] * chance(i));
            let bias = bias * exp(STATED[1] * chance(i + 1));
            forecast.observe(passes, &figures(noise.sqrt(), bias.sqrt(), self.order));
        }
        forecast
    }
}

const PLAIN: Law = Law {
    noise: [0.08, NOISE[0]],
    bias: [0.01, 2.0 * BIAS[0]],
    order: 2.0,
    drifts: None,
};

#[test]
fn nothing_is_told_before_anything_is_seen() {
    let forecast = Forecast::default();
    assert_eq!(forecast.error_after(100), None);
    assert_eq!(forecast.error_at(100.0), None);
    assert_eq!(forecast.price(0.05), None);
    // A picture without noise and bias promises nothing either.
    let mut forecast = Forecast::new();
    forecast.observe(8, &figures(0.0, 0.0, 2.0));
    assert_eq!(forecast.error_after(100), None);
}

#[test]
fn a_law_that_is_as_believed_goes_on() {
    let forecast = PLAIN.forecast(&[1, 2, 3, 4, 6, 8], |_| 0.0);
    for passes in [64, 100, 1000, 60_000] {
        let found = forecast.error_after(passes).unwrap();
        let truth = PLAIN.error(f64::from(passes));
        assert!((found.middle / truth - 1.0).abs() < 1e-9, "{passes}");
        assert!(found.low < truth && found.high.unwrap() > truth);
        // As long after the preparations.
        let at = forecast.error_at(10.0 + f64::from(passes)).unwrap();
        assert!((at.middle / truth - 1.0).abs() < 1e-9);
        assert!(at.high >= found.high && at.low <= found.low);
    }
    let near = forecast.error_after(100).unwrap();
    let far = forecast.error_after(10_000).unwrap();
    let width = |i: Interval| i.high.unwrap() / i.low;
    assert!(width(far) > 1.5 * width(near), "further is less certain");
    // What is past is no forecast: the last error.
    let past = forecast.error_after(3).unwrap();
    assert!((past.middle / PLAIN.error(64.0) - 1.0).abs() < 1e-9);
}

#[test]
fn prices_are_rounds_at_which_is_asked() {
    let forecast = PLAIN.forecast(&[1, 2, 3, 4], |_| 0.0);
    // After 32 passes: noise² 0.0025 and bias² 0.00099, or 5.9 %; at most 6.1 %.
    assert_eq!(forecast.price(0.062), Some(Price::Held));
    assert_ne!(forecast.price(0.060), Some(Price::Held));
    let found = |target| match forecast.price(target) {
        Some(Price::Passes { passes, seconds }) => (passes, seconds),
        other => panic!("{target}: {other:?}"),
    };
    let (passes, seconds) = found(0.05);
    // The first round at which is asked with a bound of at most 5 %.
    let bound = |n: f64| {
        let [noise, bias] = PLAIN.squares(n);
        (noise + bias + 0.1 * libm::hypot(noise, bias)).sqrt()
    };
    let mut asked = rounds_asked().map(|r| 8.0 * f64::from(r));
    let expected = asked.find(|&n| bound(n) <= 0.05).unwrap();
    assert_eq!(passes.middle, expected);
    assert!(passes.low < expected && passes.high.unwrap() > expected);
    assert!((seconds.middle - 10.0 - expected).abs() < 1e-9);
    assert!(seconds.low < 10.0 + passes.low && seconds.high > passes.high);
    let (cheaper, _) = found(0.06);
    assert!(cheaper.middle < passes.middle && cheaper.high <= passes.high);
    // Bias alone takes more than a thousand times 32 passes.
    let Some(Price::Beyond { passes, seconds }) = forecast.price(0.001) else {
        panic!("{:?}", forecast.price(0.001));
    };
    assert!(passes > 10_000.0 && seconds > 5_000.0);
}

/// Before a round is complete, errors are guessed and nothing is held.
#[test]
fn what_is_seen_early_holds_no_target() {
    let mut forecast = Forecast::new();
    forecast.clock(4, 14.0);
    forecast.observe(4, &figures(0.1, 0.0, 2.0));
    assert!(forecast.error_after(16).is_some());
    assert!(
        matches!(forecast.price(0.5), Some(Price::Passes { passes, .. })
        if passes.low == 8.0)
    );
    forecast.observe(4, &figures(9.0, 9.0, 2.0));
    let [kept, _] = forecast.squared(4.0, false).unwrap();
    assert!((kept - 2.0 * log(0.1)).abs() < 1e-9, "once is enough");
}

/// Laws drawn from what is believed, stated with the uncertainty that is
/// believed: the intervals of errors and of prices hold the truth in nine of
/// ten cases.
#[test]
fn intervals_hold_as_often_as_they_say() {
    let laws = 1000u64;
    for rounds in [&[1][..], &[1, 2, 3, 4, 6, 8]] {
        let (mut errors, mut prices, mut prices_of) = (0, 0, 0);
        for law in 0..laws {
            let chance = |i: u64| normal(mix2(7, law), 10 + i);
            let own = |i: u64| normal(mix2(7, law), i);
            let order = 1.5;
            let truth = Law {
                noise: [0.08, NOISE[0] + NOISE[1] * own(0)],
                bias: [0.08 * exp(own(1) - 2.0), BIAS[0] * order + BIAS[1] * own(2)],
                order,
                drifts: Some(mix2(8, law)),
            };
            let forecast = truth.forecast(rounds, chance);
            let found = forecast.error_after(2000).unwrap();
            let error = truth.error(2000.0);
            errors += u32::from((found.low..=found.high.unwrap()).contains(&error));
            let Some(Price::Passes { passes, .. }) = forecast.price(0.05) else {
                continue;
            };
            let bound = |n: f64| {
                let [noise, bias] = truth.squares(n);
                (noise + bias + 0.1 * libm::hypot(noise, bias)).sqrt()
            };
            let needed = rounds_asked()
                .map(|r| 8.0 * f64::from(r))
                .find(|&n| bound(n) <= 0.05);
            let needed = needed.unwrap_or(f64::INFINITY);
            prices_of += 1;
            let held = needed >= passes.low && passes.high.is_none_or(|high| needed <= high);
            prices += u32::from(held);
        }
        let share = |held: u32, of: u32| f64::from(held) / f64::from(of);
        let errors = share(errors, laws as u32);
        assert!((0.87..=0.96).contains(&errors), "{rounds:?}: {errors}");
        let prices = share(prices, prices_of);
        // Ends are rounds at which is asked, so these are wider.
        assert!((0.87..=0.995).contains(&prices), "{rounds:?}: {prices}");
    }
}

/// The preparations are no pace, and a pace that changes is followed.
#[test]
fn time_is_the_pace_of_late() {
    let mut pace = Pace::default();
    assert_eq!(pace.seconds_for(10.0, 1.0), None);
    pace.clock(1, 9.0);
    assert_eq!(pace.seconds_for(3.0, 1.0), Some(27.0), "all that is known");
    for pass in 2..=40 {
        pace.clock(pass, 9.0 + 0.5 * f64::from(pass - 1));
    }
    assert!((pace.seconds_for(80.0, 1.0).unwrap() - 48.5).abs() < 1e-9);
    assert!((pace.seconds_for(80.0, 2.0).unwrap() - 68.5).abs() < 1e-9);
    assert!((pace.passes_at(48.5, 1.0).unwrap() - 80.0).abs() < 1e-9);
    assert_eq!(pace.passes_at(1.0, 1.0), Some(40.0), "no way back");
    for pass in 41..=400 {
        pace.clock(pass, 28.5 + f64::from(pass - 40));
    }
    assert!((pace.per_pass().unwrap() - 1.0).abs() < 1e-9);
}

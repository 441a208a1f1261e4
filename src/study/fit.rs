//! Power laws through errors, and what an error costs.

use crate::{
    metrics::{fit_slope, student_quantile},
    numeric::trig::{exp, log, pow},
};

use super::record::{Fit, TimeTo};

/// Confidence of the interval of a slope.
const CONFIDENCE: f64 = 0.9;

/// How far beyond the last point times are told, in its own time.
const FARTHEST: f64 = 4.0;

/// The power law through the points (seconds, error) of several seeds, each by
/// growing time: least squares of the logarithms of all of them. `None` if no
/// seed has three points or an error is not above zero.
///
/// The points of a seed hang together, since a picture goes on from the one
/// before. So the interval of the slope comes from the spread of the seeds' own
/// slopes, with Student's distribution; with fewer than three seeds, from the
/// scatter about the line.
pub fn fit(seeds: &[Vec<(f64, f64)>]) -> Option<Fit> {
    let all: Vec<(f64, f64)> = seeds.concat();
    if seeds.iter().any(|points| points.len() < 3) {
        return None;
    }
    let line = |points: &[(f64, f64)]| {
        let (xs, ys): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        fit_slope(&xs, &ys)
    };
    let whole = line(&all)?;
    let slopes: Option<Vec<f64>> = seeds.iter().map(|s| Some(line(s)?.slope)).collect();
    let slopes = slopes?;
    let (error, freedom) = if slopes.len() < 3 {
        (whole.standard_error, all.len() - 2)
    } else {
        let n = slopes.len() as f64;
        let mean = slopes.iter().sum::<f64>() / n;
        let squares: f64 = slopes.iter().map(|s| (s - mean) * (s - mean)).sum();
        ((squares / (n * (n - 1.0))).sqrt(), slopes.len() - 1)
    };
    let half = student_quantile(CONFIDENCE, freedom as u32) * error;
    Some(Fit {
        factor: exp(whole.intercept),
        slope: whole.slope,
        slope_interval: [whole.slope - half, whole.slope + half],
    })
}

/// The time to the error `target` on a curve of (seconds, error) by growing
/// time: between the two points where it is first reached, on a straight line
/// of the logarithms. Where the first point is better already, its time, of
/// which more is not known. Beyond the last point the curve goes on with the
/// slope of the fit, for at most four times its time.
pub fn time_to(curve: &[(f64, f64)], fit: Option<Fit>, target: f64) -> TimeTo {
    let found = |cpu_seconds, extrapolated| TimeTo {
        error: target,
        cpu_seconds,
        extrapolated,
    };
    let Some(at) = curve.iter().position(|&(_, error)| error <= target) else {
        let seconds = beyond(curve, fit, target);
        return found(seconds, seconds.is_some());
    };
    let (t1, e1) = curve[at];
    if at == 0 {
        return found(Some(t1), false);
    }
    let (t0, e0) = curve[at - 1];
    // e0 > target >= e1 > 0.
    let share = log(e0 / target) / log(e0 / e1);
    found(Some(t0 * pow(t1 / t0, share)), false)
}

/// The time to an error that was not reached.
fn beyond(curve: &[(f64, f64)], fit: Option<Fit>, target: f64) -> Option<f64> {
    let (&(last, error), fit) = (curve.last()?, fit?);
    // A curve that may not fall at all promises nothing.
    if fit.slope_interval[1] >= 0.0 || fit.slope >= 0.0 {
        return None;
    }
    let factor = pow(target / error, 1.0 / fit.slope);
    (factor <= FARTHEST).then_some(last * factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::mix2;

    /// A number with mean 0 and variance 1.
    fn normal(address: u64) -> f64 {
        let sum: u64 = (0..12).map(|i| mix2(address, i) >> 11).sum();
        (sum as f64 / (1u64 << 53) as f64) - 6.0
    }

    #[test]
    fn an_exact_law_is_found() {
        let law = |slope: f64| -> Vec<(f64, f64)> {
            let point = |k: i32| {
                let t = 0.3 * 2f64.powi(k);
                (t, 0.2 * t.powf(slope))
            };
            (0..6).map(point).collect()
        };
        let found = fit(&[law(-0.6), law(-0.6), law(-0.6)]).unwrap();
        assert!((found.slope + 0.6).abs() < 1e-12 && (found.factor - 0.2).abs() < 1e-12);
        let [low, high] = found.slope_interval;
        assert!(high - low < 1e-10, "{found:?}");
        // Three seeds about -0.6: their slopes' mean, and t(2) sd / sqrt(3).
        let found = fit(&[law(-0.5), law(-0.6), law(-0.7)]).unwrap();
        let half = 2.919_986 * 0.1 / 3f64.sqrt();
        assert!((found.slope_interval[1] - found.slope - half).abs() < 1e-6);
        assert!((found.slope + 0.6).abs() < 1e-12);
        assert_eq!(fit(&[law(-0.5)[..2].to_vec()]), None);
        assert_eq!(fit(&[]), None);
        assert_eq!(fit(&[vec![(1.0, 0.1), (2.0, 0.0), (3.0, 0.1)]]), None);
    }

    /// Curves whose points hang together as those of real runs: errors that
    /// are means of squares of a growing sum. The interval holds the slope
    /// about nine times out of ten.
    #[test]
    fn the_interval_holds_the_slope() {
        let (studies, mut hits) = (400, 0);
        for study in 0..studies {
            let seed = |s: u64| -> Vec<(f64, f64)> {
                let pixels = 24;
                let mut sums = vec![0.0; pixels];
                let mut points = Vec::new();
                for pass in 1..=64u64 {
                    for (i, sum) in sums.iter_mut().enumerate() {
                        *sum += normal(mix2(mix2(study, s), mix2(pass, i as u64)));
                    }
                    if pass.is_power_of_two() {
                        let n = pass as f64;
                        let squares: f64 = sums.iter().map(|s| s * s / (n * n)).sum();
                        points.push((n, (squares / pixels as f64).sqrt()));
                    }
                }
                points
            };
            let found = fit(&[seed(0), seed(1), seed(2), seed(3)]).unwrap();
            let [low, high] = found.slope_interval;
            hits += u32::from((low..=high).contains(&-0.5));
        }
        // 360 expected, with a standard deviation of 6.
        assert!((335..=385).contains(&hits), "{hits} of {studies}");
    }

    /// Worked by hand: between (1, 0.4) and (4, 0.1) the error falls like 1 / t.
    #[test]
    fn times_between_points_and_beyond() {
        let curve = [(1.0, 0.4), (4.0, 0.1), (9.0, 0.05)];
        let law = Fit {
            factor: 0.4,
            slope: -1.0,
            slope_interval: [-1.1, -0.9],
        };
        let seconds = |target| time_to(&curve, Some(law), target);
        let found = seconds(0.2);
        assert!((found.cpu_seconds.unwrap() - 2.0).abs() < 1e-12 && !found.extrapolated);
        assert!(
            (seconds(0.1).cpu_seconds.unwrap() - 4.0).abs() < 1e-12,
            "a point"
        );
        assert_eq!(seconds(0.5).cpu_seconds, Some(1.0), "better from the start");
        // On from (9, 0.05) like 1 / t.
        let found = seconds(0.025);
        assert!((found.cpu_seconds.unwrap() - 18.0).abs() < 1e-12 && found.extrapolated);
        let found = seconds(0.05 / 4.1);
        assert_eq!(
            (found.cpu_seconds, found.extrapolated),
            (None, false),
            "too far"
        );
        assert_eq!(time_to(&curve, None, 0.025).cpu_seconds, None, "no fit");
        let flat = Fit {
            slope_interval: [-2.1, 0.1],
            ..law
        };
        assert_eq!(time_to(&curve, Some(flat), 0.04).cpu_seconds, None);
        assert_eq!(time_to(&[], Some(law), 0.1).cpu_seconds, None);
        // A curve that rises again: the first time counts.
        let uneven = [(1.0, 0.4), (4.0, 0.1), (9.0, 0.3), (16.0, 0.05)];
        assert!((time_to(&uneven, None, 0.2).cpu_seconds.unwrap() - 2.0).abs() < 1e-12);
    }
}

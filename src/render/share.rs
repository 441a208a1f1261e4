//! How a pass shares its work between photons and camera samples.
//!
//! A pass of one sample a pixel leaves the variance of the camera samples and
//! that of the photons; more photons make the second smaller and the pass
//! dearer. For a given time the error is least where variance times cost is
//! (both add up over passes, so their product does not depend on how many).
//! Cost is counted work, so that the share is the same on every machine.

/// Cost of a query of the photon map, in rays cast: as all weights here a
/// round number read off the benches `map`, `traverse` and `photons`.
const QUERY: f64 = 1.5;

/// Cost of a photon that a query looks at, in rays cast.
const VISIT: f64 = 0.1;

/// Cost of a photon path, with its place in the map, in rays cast.
pub(super) const PATH: f64 = 7.0;

/// Part of the pilot's samples, those with the largest values, that is left
/// out of each mean: a rare bright path must not decide for the rest.
const TRIMMED: f64 = 0.01;

/// Factor on variance times cost up to which a number of paths stays what it
/// is: a pilot has noise of its own.
const NEARLY: f64 = 1.03;

/// What the pilot found through one pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    /// Radiance of one camera sample with each of two independent sets of
    /// photons.
    pub(super) first: [f64; 2],
    /// Radiance of another camera sample with the second set.
    pub(super) second: f64,
}

/// What the pilot found in all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Survey {
    /// Relative variance of a camera sample that photons have no part in.
    pub(super) camera: f64,
    /// Relative variance of a camera sample that is due to the photons.
    pub(super) photon: f64,
    /// Photon paths of each of the pilot's sets.
    pub(super) paths: u64,
    /// Cost of a camera sample without what grows with the photons.
    pub(super) sample_cost: f64,
    /// What one more photon path a pass costs per camera sample.
    pub(super) path_cost: f64,
}

/// Work of the pilot's camera samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    /// Camera samples.
    pub(super) samples: u64,
    /// Rays cast.
    pub(super) rays: u64,
    /// Queries of the map.
    pub(super) queries: u64,
    /// Photons looked at.
    pub(super) visited: u64,
}

impl Work {
    /// Mean cost of a camera sample, in rays cast.
    pub(super) fn of_sample(&self) -> f64 {
        let all = self.rays as f64 + QUERY * self.queries as f64 + VISIT * self.visited as f64;
        all / self.samples.max(1) as f64
    }
}

impl Survey {
    /// From the pilot's probes and the work of its camera samples; a pass has
    /// `pixels` camera samples.
    pub(super) fn new(probes: &[Probe], paths: u64, work: Work, pixels: u64) -> Self {
        let value = |p: &Probe| (p.first[0] + p.first[1] + p.second) / 3.0;
        let mean = trimmed_mean(probes.iter().map(value));
        // As errors are measured: relative to the pixel, but for dark ones.
        let variance = |pair: fn(&Probe) -> [f64; 2]| {
            trimmed_mean(probes.iter().map(|p| {
                let (value, [a, b]) = (value(p), pair(p));
                // Half the square of a difference has the variance as mean.
                0.5 * (a - b).powi(2) / (value * value + 0.01 * mean * mean)
            }))
        };
        let photon = variance(|p| p.first);
        let both = variance(|p| [p.first[0], p.second]);
        Self {
            camera: (both - photon).max(0.0),
            photon,
            paths,
            // Kernels shrink as photons grow more: as many reach a query.
            sample_cost: work.of_sample(),
            path_cost: photon_cost(1, pixels),
        }
    }

    /// Relative variance that is due to the photons of a pass with `n` paths. With
    /// kernels of the photons' own size as many overlap whatever their number; what
    /// falls is the error that balances noise and blur as kernels shrink with the
    /// rounds, like n^(-2/3).
    pub(super) fn photon_with(&self, n: u64) -> f64 {
        let fewer = libm::cbrt(self.paths as f64 / n.max(1) as f64);
        self.photon * fewer * fewer
    }

    /// Variance times cost of a pass with `n` photon paths.
    fn inefficiency(&self, n: u64) -> f64 {
        let variance = self.camera + self.photon_with(n);
        variance * (self.sample_cost + n as f64 * self.path_cost)
    }

    /// The power of two between `least` and `most` (powers of two) photon
    /// paths with the least variance times cost; the smaller of equals. Those
    /// `before` stay while nearly as good.
    pub(super) fn best_paths(&self, least: u64, most: u64, before: Option<u64>) -> u64 {
        let mut best = least;
        let mut n = least;
        while n < most {
            n *= 2;
            if self.inefficiency(n) < self.inefficiency(best) {
                best = n;
            }
        }
        let good = NEARLY * self.inefficiency(best);
        before
            .filter(|&n| self.inefficiency(n) <= good)
            .unwrap_or(best)
    }
}

/// Cost of a pass's photon paths for every one of its pixels, in rays cast.
pub(super) fn photon_cost(paths: u64, pixels: u64) -> f64 {
    PATH * paths as f64 / pixels.max(1) as f64
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0u32), |(s, n), v| (s + v, n + 1));
    sum / f64::from(count.max(1))
}

/// Mean of what is left without the largest values; what is not finite counts
/// as largest. 0 where nothing is left.
pub(super) fn trimmed_mean(values: impl Iterator<Item = f64>) -> f64 {
    trimmed_by(TRIMMED, values)
}

/// The same, without the given part of them.
pub(super) fn trimmed_by(part: f64, values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let dropped = (sorted.len() as f64 * part).ceil() as usize;
    mean(
        sorted[..sorted.len().saturating_sub(dropped)]
            .iter()
            .copied(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Sequence};

    const SURVEY: Survey = Survey {
        camera: 0.3,
        photon: 0.2,
        paths: 1 << 14,
        sample_cost: 12.0,
        path_cost: 2e-4,
    };

    /// The product has one minimum: where its derivative
    /// `V_cam c n + V_ph (n_0 / n)^(2/3) (c n - 2 C) / 3` is zero. The power of
    /// two that is taken lies next to it.
    #[test]
    fn the_best_is_next_to_the_closed_form() {
        for camera in [0.01, 0.3, 7.0] {
            for path_cost in [2e-5, 2e-4, 3e-3] {
                let survey = Survey {
                    camera,
                    path_cost,
                    ..SURVEY
                };
                let slope = |n: f64| {
                    let photon = survey.photon * (survey.paths as f64 / n).powf(2.0 / 3.0);
                    camera * path_cost * n
                        + photon * (path_cost * n - 2.0 * survey.sample_cost) / 3.0
                };
                let found = survey.best_paths(1, 1 << 40, None) as f64;
                assert!(slope(0.5 * found) < 0.0, "{survey:?}: {found} is too many");
                assert!(slope(2.0 * found) > 0.0, "{survey:?}: {found} is too few");
            }
        }
    }

    #[test]
    fn bounds_and_extremes() {
        let no_photon_noise = Survey {
            photon: 0.0,
            ..SURVEY
        };
        assert_eq!(no_photon_noise.best_paths(1 << 12, 1 << 23, None), 1 << 12);
        let no_camera_noise = Survey {
            camera: 0.0,
            ..SURVEY
        };
        // At c n = 2 C.
        assert_eq!(no_camera_noise.best_paths(1 << 12, 1 << 23, None), 1 << 17);
        assert_eq!(no_camera_noise.best_paths(1 << 12, 1 << 15, None), 1 << 15);
        let nothing = Survey {
            photon: 0.0,
            camera: 0.0,
            ..SURVEY
        };
        assert_eq!(nothing.best_paths(1 << 12, 1 << 23, None), 1 << 12);
    }

    /// What is nearly as good stays, what is not goes.
    #[test]
    fn a_good_number_stays() {
        let best = SURVEY.best_paths(1, 1 << 40, None);
        let found = |before| SURVEY.best_paths(1, 1 << 40, Some(before));
        assert_eq!(found(best), best);
        let near = [best / 2, best * 2].map(|n| SURVEY.inefficiency(n) / SURVEY.inefficiency(best));
        for (n, factor) in [best / 2, best * 2].into_iter().zip(near) {
            assert_eq!(found(n) == n, factor <= NEARLY, "{factor}");
        }
        assert_eq!(found(best * 64), best);
    }

    /// Values with known variances are told apart, whatever the brightness,
    /// and a firefly changes little.
    #[test]
    fn variances_are_told_apart() {
        let uniform = |i: u64| {
            let mut stream = Sequence::new(3, Purpose::Pilot, 0, i).at(0);
            move || (stream.next_1d() - 0.5) * 12f64.sqrt()
        };
        for brightness in [1e-6, 1.0, 1e9] {
            let mut probes: Vec<Probe> = (0..20_000)
                .map(|i| {
                    let mut unit = uniform(i);
                    // Photons (of the two sets, at either place) and samples.
                    let (a, b, c) = (unit(), unit(), unit());
                    let (x, y) = (unit(), unit());
                    let value = |camera, photon| brightness * (1.0 + 0.05 * camera + 0.03 * photon);
                    Probe {
                        first: [value(x, a), value(x, b)],
                        second: value(y, c),
                    }
                })
                .collect();
            probes[7].second = 1e6 * brightness;
            let work = Work {
                samples: 1000,
                rays: 9000,
                queries: 2000,
                visited: 32_000,
            };
            let survey = Survey::new(&probes, 1 << 14, work, 40_000);
            // Trimming takes some of the tails, 4 to 6 % of the variances.
            let close = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 0.12;
            let dark = 1.01;
            assert!(close(survey.photon * dark, 9e-4), "{survey:?}");
            assert!(close(survey.camera * dark, 25e-4), "{survey:?}");
            assert_eq!(survey.sample_cost, 9.0 + QUERY * 2.0 + VISIT * 32.0);
            assert_eq!(survey.path_cost, PATH / 40_000.0);
        }
    }
}

//! Random photons on the floor.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::exact::{Ball, Case, Incidence, Optics, Sheet, Source, frame, landing};

/// Independent random numbers: `SplitMix64` (Steele, Lea and Flood 2014).
pub(super) struct Random {
    state: u64,
}

impl Random {
    /// The numbers of a seed.
    pub(super) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next number in `[0, 1)`.
    pub(super) fn next(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.state;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^= x >> 31;
        (x >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }
}

/// Light where it met the floor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Photon {
    /// Column and row, in pixels from the upper left corner of the window.
    pub(super) at: [f64; 2],
    /// Flux in W for one path emitted, over the area of a pixel in m2.
    pub(super) irradiance: f64,
}

/// Traces one path; `None` if it does not reach the floor.
pub(super) fn photon(case: &Case, random: &mut Random) -> Option<Photon> {
    let (p, flux) = match &case.optics {
        Optics::Ball(ball) => through_ball(ball, random),
        Optics::Sheet(sheet) => Some(through_sheet(sheet, random)),
    }?;
    let per_metre = case.window.per_metre();
    let half = 0.5 * case.window.width;
    Some(Photon {
        at: [(p.x + half) * per_metre, (half - p.y) * per_metre],
        irradiance: flux * per_metre * per_metre,
    })
}

fn through_sheet(sheet: &Sheet, random: &mut Random) -> (DVec2, f64) {
    let side = 2.0 * sheet.half;
    let [x, y] = [random.next(), random.next()].map(|u| side * (u - 0.5));
    let (p, share) = sheet.landing(x, y);
    (p, share * side * side)
}

fn through_ball(ball: &Ball, random: &mut Random) -> Option<(DVec2, f64)> {
    let (cos_axis, h, flux) = match ball.source {
        Source::Parallel => (1.0, random.next().sqrt(), 0.5 * TAU),
        Source::Cone(tan) => {
            let widest = 1.0 / (1.0 + tan * tan).sqrt();
            let cos = 1.0 - random.next() * (1.0 - widest);
            (cos, random.next().sqrt(), TAU / (1.0 + widest))
        }
        Source::Point(up) => {
            // Even over the solid angle of the ball.
            let widest = (1.0 - 1.0 / (up * up)).sqrt();
            let cos = 1.0 - random.next() * (1.0 - widest);
            (cos, up * (1.0 - cos * cos).sqrt(), TAU * (1.0 - widest))
        }
    };
    let incidence = Incidence::new(h.min(1.0));
    let turn = if random.next() < incidence.reflectance {
        incidence.reflected()
    } else {
        let mut reflections = 0;
        while random.next() < incidence.reflectance && reflections < 64 {
            reflections += 1;
        }
        incidence.transmitted(reflections)
    };
    let [dir, x, y] = frame(cos_axis);
    let (sin, cos) = (TAU * random.next()).sin_cos();
    let p = match ball.source {
        // Light from a point leaves the axis in the plane of its azimuth.
        Source::Point(_) => {
            let p = landing(dir, x, h, turn, ball.height)?;
            DVec2::new(cos, sin) * p.x
        }
        Source::Parallel => landing(dir, x * cos + y * sin, h, turn, ball.height)?,
        Source::Cone(_) => {
            let p = landing(dir, x * cos + y * sin, h, turn, ball.height)?;
            // The inclination is to any side.
            DVec2::from_angle(TAU * random.next()).rotate(p)
        }
    };
    Some((p, flux))
}

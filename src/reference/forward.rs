//! How seldom a ray that leaves a lamp in a random direction makes a picture.

use std::f64::consts::PI;

/// A lamp that shines to all sides, an object it lights, and a pixel's opening
/// that sees the object: two discs, each facing what sends rays to it, the
/// object scattering them to all sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forward {
    /// Diameter of the object and its distance from the lamp, in metres.
    pub object: [f64; 2],
    /// Diameter of the opening and its distance from the object, in metres.
    pub pixel: [f64; 2],
}

impl Forward {
    /// Chance that a ray from the lamp meets the object.
    pub fn chance_of_object(&self) -> f64 {
        chance(self.object)
    }

    /// Chance that it then goes into the pixel's opening.
    pub fn chance_of_pixel(&self) -> f64 {
        chance(self.pixel)
    }

    /// Rays from the lamp for one that arrives, on average.
    pub fn rays(&self) -> f64 {
        1.0 / (self.chance_of_object() * self.chance_of_pixel())
    }
}

/// The cone to a disc of diameter D at distance L has the half-angle
/// theta = atan(D / 2L) and the part `2 pi (1 - cos theta) / 4 pi` of all
/// directions.
fn chance([diameter, distance]: [f64; 2]) -> f64 {
    let slope = 0.5 * diameter / distance;
    // 1 - cos(atan(x)) = x^2 / (r (r + 1)), r = sqrt(1 + x^2), without
    // cancellation.
    let r = (1.0 + slope * slope).sqrt();
    2.0 * PI * slope * slope / (r * (r + 1.0)) / (4.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECONDS_PER_RAY: f64 = 1e-4;

    /// The numbers with which a first course in ray tracing compares its two
    /// algorithms: 0.0015 % of the rays meet an object, 0.0000000007 % go on
    /// into a pixel; one of 130 billion rays arrives, 150 days at 0.1 ms a ray,
    /// against two million rays and three minutes from the eye. The first two
    /// are cut off after their last digit.
    #[test]
    fn a_first_course() {
        // An object of 31 cm in 20 m, an opening of 0.285 mm in 10 cm.
        let f = Forward {
            object: [0.31, 20.0],
            pixel: [0.285e-3, 0.1],
        };
        let object = 100.0 * f.chance_of_object();
        let both = object * f.chance_of_pixel();
        assert!((0.0015..0.0016).contains(&object), "{object} %");
        assert!((7e-10..8e-10).contains(&both), "{both} %");
        assert!((1.25e11..1.35e11).contains(&f.rays()), "{}", f.rays());
        let days = 130e9 * SECONDS_PER_RAY / 86_400.0;
        assert!((150.0..151.0).contains(&days), "{days} days");
        let minutes = 2e6 * SECONDS_PER_RAY / 60.0;
        assert!((3.0..4.0).contains(&minutes), "{minutes} minutes");
    }

    /// Half of all directions meet a disc without bounds, and small discs are
    /// met in proportion to their area.
    #[test]
    fn limits() {
        assert!((chance([1e9, 1.0]) - 0.5).abs() < 1e-8);
        let area_over_sphere = (0.5e-6f64 * 0.5e-6) / 4.0;
        assert!((chance([1e-6, 1.0]) / area_over_sphere - 1.0).abs() < 1e-11);
    }
}

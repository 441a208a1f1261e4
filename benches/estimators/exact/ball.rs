//! Light through a ball of index 1.5 and radius 1 m, in closed form.
//!
//! A ray that passes the centre at distance `h` meets every surface at the
//! same angle `i = asin h`, inside `t = asin(h / n)`, and stays in one plane
//! and at distance `h` from the centre. With `k` reflections inside it is
//! turned towards the axis by `2 (i - t) + k (pi - 2 t)` and keeps
//! `(1 - R)^2 R^k` of its power; reflected on the outside it is turned by
//! `2 i - pi` and keeps `R`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    Reference, Window, reflectance,
    rings::{Radial, Rings},
};

use nephroid::metrics::relmse;

/// Index of the ball.
pub(crate) const INDEX: f64 = 1.5;

/// Most reflections inside that are counted. Some 2e-5 of the light is
/// reflected more often, and leaves to all sides; the renderer follows it.
const REFLECTIONS: usize = 16;

/// Nodes over the angle of incidence where there is symmetry about the axis.
const NODES: usize = 1 << 18;

/// Directions and angles of incidence where there is none.
const DIRECTIONS: u64 = 1 << 14;
const ANGLES: usize = 1 << 12;

/// Tasks into which the work is divided.
const TASKS: usize = 64;

/// The ball's light.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source {
    /// Parallel light of irradiance 1 W/m2 along the axis.
    Parallel,
    /// A point on the axis, this far above the centre in metres, of 1 W/sr.
    Point(f64),
    /// Light of even radiance from a cone about the axis, given by the tangent
    /// of its half-angle; its irradiance on a level surface is 1 W/m2.
    Cone(f64),
}

/// The ball above a floor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    /// The light.
    pub(crate) source: Source,
    /// Height of the centre above the floor in metres, above 1.
    pub(crate) height: f64,
}

/// A rotation by an angle, as its cosine and sine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    cos: f64,
    sin: f64,
}

impl Turn {
    fn then(self, next: Self) -> Self {
        Self {
            cos: self.cos * next.cos - self.sin * next.sin,
            sin: self.sin * next.cos + self.cos * next.sin,
        }
    }

    fn half_turn_less(self) -> Self {
        Self {
            cos: -self.cos,
            sin: -self.sin,
        }
    }
}

/// How a ray at a given distance from the centre meets the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Incidence {
    /// Twice the angle outside.
    outside: Turn,
    /// Deviation of the light that goes straight through.
    through: Turn,
    /// Further deviation by one reflection inside.
    reflection: Turn,
    /// Share of the power reflected at each surface.
    pub(crate) reflectance: f64,
}

impl Incidence {
    /// Of a ray that passes the centre at distance `h` in `[0, 1]` metres.
    pub(crate) fn new(h: f64) -> Self {
        let (sin_i, sin_t) = (h, h / INDEX);
        let (cos_i, cos_t) = ((1.0 - h * h).sqrt(), (1.0 - sin_t * sin_t).sqrt());
        let twice = |cos: f64, sin: f64| Turn {
            cos: 1.0 - 2.0 * sin * sin,
            sin: 2.0 * sin * cos,
        };
        let outside = twice(cos_i, sin_i);
        let back = twice(cos_t, -sin_t);
        Self {
            outside,
            through: outside.then(back),
            reflection: back.half_turn_less(),
            reflectance: reflectance(cos_i, cos_t, INDEX),
        }
    }

    /// Deviation by a reflection on the outside.
    pub(crate) fn reflected(&self) -> Turn {
        self.outside.half_turn_less()
    }

    /// Deviation by two refractions with `reflections` between them.
    pub(crate) fn transmitted(&self, reflections: usize) -> Turn {
        let mut turn = self.through;
        for _ in 0..reflections {
            turn = turn.then(self.reflection);
        }
        turn
    }

    /// The ways on which power leaves but the straight one, with their shares.
    fn detours(self) -> impl Iterator<Item = (Turn, f64)> {
        let r = self.reflectance;
        let inside =
            (1..=REFLECTIONS).scan((self.through, (1.0 - r) * (1.0 - r)), move |way, _| {
                *way = (way.0.then(self.reflection), way.1 * r);
                Some(*way)
            });
        std::iter::once((self.reflected(), r)).chain(inside)
    }

    /// The straight way and its share.
    fn straight(self) -> (Turn, f64) {
        let t = 1.0 - self.reflectance;
        (self.through, t * t)
    }
}

/// Where a ray lands on the floor, in metres from the point under the centre:
/// a ray that travelled along `dir`, passed the centre on the side of the unit
/// vector `side`, at distance `h`, and was turned. `None` if it goes up.
pub(crate) fn landing(dir: DVec3, side: DVec3, h: f64, turn: Turn, height: f64) -> Option<DVec2> {
    let out = dir * turn.cos - side * turn.sin;
    let nearest = (side * turn.cos + dir * turn.sin) * h;
    (out.z < 0.0).then(|| (nearest - out * ((height + nearest.z) / out.z)).truncate())
}

/// A direction of travel, inclined to the vertical by an angle of the given
/// cosine towards x, and the side of the rays at azimuth 0 and at a quarter
/// turn.
pub(crate) fn frame(cos: f64) -> [DVec3; 3] {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    [
        DVec3::new(sin, 0.0, -cos),
        DVec3::new(cos, 0.0, sin),
        DVec3::Y,
    ]
}

impl Ball {
    /// Irradiance on the floor.
    pub(crate) fn reference(&self, window: Window) -> Reference {
        match self.source {
            Source::Cone(tan) => {
                let [a, b] = [0.0, 0.5].map(|shift| {
                    let mut rings = self.cone(tan, window, shift, DIRECTIONS, false);
                    // Little light, widely spread: fewer directions will do.
                    rings.merge(&self.cone(tan, window, shift, DIRECTIONS / 16, true));
                    window.image(rings.irradiance())
                });
                Reference::of_halves(&a, &b)
            }
            Source::Parallel | Source::Point(_) => {
                let image = window.image(self.about_axis(window, NODES).irradiance());
                let coarse = window.image(self.about_axis(window, NODES / 2).irradiance());
                Reference {
                    error: relmse(&image, &coarse).unwrap_or(f64::NAN),
                    image,
                }
            }
        }
    }

    /// A source on the axis: every ring of rays becomes a ring on the floor,
    /// so flux is carried over from angles of incidence to radii.
    fn about_axis(&self, window: Window, nodes: usize) -> Rings {
        let step = FRAC_PI_2 / nodes as f64;
        let parts = (0..TASKS).into_par_iter().map(|task| {
            let mut rings = Rings::new(window);
            for node in (task..nodes).step_by(TASKS) {
                let (h, cos) = ((node as f64 + 0.5) * step).sin_cos();
                let ring = TAU * h * cos * step;
                let (sin_axis, flux) = match self.source {
                    // Per steradian, 2 pi sin b db of the angle b to the axis.
                    Source::Point(up) => {
                        let sin = h / up;
                        (sin, ring / (up * up * (1.0 - sin * sin).sqrt()))
                    }
                    Source::Parallel | Source::Cone(_) => (0.0, ring),
                };
                let [dir, side, _] = frame((1.0 - sin_axis * sin_axis).sqrt());
                let incidence = Incidence::new(h);
                let ways = std::iter::once(incidence.straight()).chain(incidence.detours());
                for (turn, share) in ways {
                    if let Some(p) = landing(dir, side, h, turn, self.height) {
                        rings.add(p.x.abs(), flux * share);
                    }
                }
            }
            rings
        });
        let parts: Vec<Rings> = parts.collect();
        let mut all = Rings::new(window);
        for part in &parts {
            all.merge(part);
        }
        all
    }

    /// A cone of directions: parallel light from each, in the same way about
    /// its own axis, met by a floor that is inclined to it. The whole is
    /// symmetric about the vertical, so the inclination is always towards x
    /// and only the distance of the light from the centre is kept. Directions
    /// and azimuths follow the additive sequence of Roberts (2018) for three
    /// dimensions, whose third number shifts the angles of incidence.
    fn cone(&self, tan: f64, window: Window, shift: f64, directions: u64, detours: bool) -> Rings {
        // The root of x^4 = x + 1, which makes the sequence even.
        const ROOT: f64 = 1.220_744_084_605_76;
        let widest = 1.0 / (1.0 + tan * tan).sqrt();
        // Irradiance 1 on the level takes this much on surfaces that face the
        // light.
        let facing = 2.0 / (1.0 + widest);
        let step = FRAC_PI_2 / ANGLES as f64;
        let parts = (0..TASKS as u64).into_par_iter().map(|task| {
            let mut radial = Radial::new(window);
            for k in (task..directions).step_by(TASKS) {
                let coordinate = |power: i32| (shift + (k + 1) as f64 / ROOT.powi(power)).fract();
                let [dir, x, y] = frame(1.0 - coordinate(1) * (1.0 - widest));
                let (sin, cos) = (PI * coordinate(2)).sin_cos();
                let side = x * cos + y * sin;
                for node in 0..ANGLES {
                    let (h, cos_i) = ((node as f64 + coordinate(3)) * step).sin_cos();
                    let flux = facing * TAU * h * cos_i * step / directions as f64;
                    let incidence = Incidence::new(h);
                    let mut add = |(turn, share): (Turn, f64)| {
                        if let Some(p) = landing(dir, side, h, turn, self.height) {
                            radial.add(p.length(), flux * share);
                        }
                    };
                    if detours {
                        incidence.detours().for_each(add);
                    } else {
                        add(incidence.straight());
                    }
                }
            }
            radial
        });
        let parts: Vec<Radial> = parts.collect();
        let mut all = Radial::new(window);
        for part in &parts {
            all.merge(part);
        }
        all.rings()
    }
}

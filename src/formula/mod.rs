//! Formulas in x, y and z: from a text to values, derivatives and bounds.
//!
//! A formula is parsed once ([`Formula::parse`]) into a row of operations in
//! which common parts appear once. The same row answers in several
//! arithmetics, so that value, derivatives and bounds cannot disagree about
//! what the formula is: plain `f64`, first derivatives and second derivatives
//! carried forward by the chain rule (never a finite difference), and
//! intervals rounded outward, with and without derivatives.
//!
//! Contract of the room:
//! - A number in a formula, and the constants `pi` and `e`, mean the nearest
//!   `f64`; an exponent without variables likewise, once it is worked out.
//!   Everything else means the exact operation of real numbers, which
//!   intervals enclose and values approach.
//! - A formula is undefined where an operation in it is: a division by zero,
//!   the root of a negative number, and so on. Values are NaN or infinite
//!   there; intervals speak of the rest, and say so ([`Enclosure`]).
//! - Derivatives at a kink (`abs`, `min`, `max`) are those of one side in
//!   `f64`, zero for `abs`, and the hull of both sides as intervals.
//! - Nothing is allocated after parsing, and no text makes parsing or
//!   evaluation deep or long: [`MAX_BYTES`], [`MAX_NODES`], [`MAX_DEPTH`].

mod bound;
mod dual;
mod error;
mod graph;
mod jet;
mod lexer;
mod operation;
mod parser;
mod plain;
mod tape;

use std::ops::Range;

use glam::{DMat3, DVec3};

use crate::numeric::Interval;

pub use bound::Enclosure;
pub use error::FormulaError;
pub use parser::NAMES;

use dual::Dual;
use jet::Jet;
use tape::Tape;

/// Longest text of a formula, in bytes.
pub const MAX_BYTES: usize = 8192;
/// Most operations, numbers and variables in a formula, common parts counted
/// once.
pub const MAX_NODES: usize = 500;
/// Deepest nesting of brackets, signs and exponents.
pub const MAX_DEPTH: usize = 64;

/// A function of a place.
#[derive(Clone, Debug)]
pub struct Formula {
    tape: Tape,
    first_use: [Option<Range<usize>>; 3],
}

/// A value with its first and second derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curved {
    /// The value.
    pub value: f64,
    /// First derivatives by x, y, z.
    pub gradient: DVec3,
    /// Second derivatives.
    pub hessian: DMat3,
}

/// What is known of a formula all along a piece of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along {
    /// The values; see [`Enclosure`].
    pub value: Enclosure,
    /// The derivatives by the line's parameter, wherever there is one.
    pub slope: Interval,
    /// How wide the value in the middle of the piece is as an interval:
    /// what rounding alone leaves undecided. Zero where it was not needed.
    pub noise: f64,
}

impl Formula {
    /// Reads a formula: variables `x`, `y`, `z`, numbers, `+ - * / ^`,
    /// brackets, and the functions and constants in [`NAMES`]. Powers group
    /// to the right and bind more tightly than signs: `-x^2` is `-(x^2)`.
    ///
    /// # Errors
    /// The first mistake, with its bytes in the text.
    ///
    /// ```
    /// use glam::DVec3;
    /// use nephroid::formula::Formula;
    ///
    /// let f = Formula::parse("x^2 + y^2 - 1").unwrap();
    /// let (value, gradient) = f.gradient(DVec3::new(2.0, 0.0, 5.0));
    /// assert_eq!((value, gradient), (3.0, DVec3::new(4.0, 0.0, 0.0)));
    /// assert_eq!(Formula::parse("x + yy").unwrap_err().span, 4..6);
    /// ```
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        let parsed = parser::parse(text)?;
        Ok(Self {
            tape: Tape::of(&parsed.graph, parsed.root),
            first_use: parsed.first_use,
        })
    }

    /// The bytes of the text where a variable (0, 1, 2 for x, y, z) is first
    /// written; nothing for one that does not occur.
    pub fn first_use(&self, variable: usize) -> Option<Range<usize>> {
        self.first_use[variable].clone()
    }

    /// True if no variable occurs.
    pub fn is_constant(&self) -> bool {
        self.first_use.iter().all(Option::is_none)
    }

    /// The value at a place; NaN or infinite where the formula is undefined
    /// or too large.
    #[inline]
    pub fn value(&self, p: DVec3) -> f64 {
        self.tape
            .run(p.to_array().map(Dual::<f64, 0>::constant))
            .value
    }

    /// The value and its derivatives by x, y and z.
    #[inline]
    pub fn gradient(&self, p: DVec3) -> (f64, DVec3) {
        let f = self.tape.run(Dual::variables(p.to_array(), [1.0; 3]));
        (f.value, DVec3::from_array(f.slopes))
    }

    /// The value with first and second derivatives.
    pub fn curved(&self, p: DVec3) -> Curved {
        let f = self.tape.run(Jet::variables(p.to_array()));
        let [xx, xy, xz, yy, yz, zz] = f.second;
        Curved {
            value: f.value,
            gradient: DVec3::from_array(f.first),
            hessian: DMat3::from_cols_array_2d(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
        }
    }

    /// The value at `origin + dir * t` and its derivative by `t`.
    #[inline]
    pub fn along(&self, origin: DVec3, dir: DVec3, t: f64) -> (f64, f64) {
        let p = origin + dir * t;
        let f = self.tape.run::<Dual<f64, 1>>(std::array::from_fn(|i| Dual {
            value: p[i],
            slopes: [dir[i]],
        }));
        (f.value, f.slopes[0])
    }

    /// All values in a box, given by its interval on each axis.
    #[inline]
    pub fn range(&self, region: [Interval; 3]) -> Enclosure {
        self.tape
            .run(region.map(|x| Dual::<Enclosure, 0>::constant(Enclosure::of(x))))
            .value
    }

    /// All values and all derivatives by x, y and z in a box.
    pub fn gradient_range(&self, region: [Interval; 3]) -> (Enclosure, [Interval; 3]) {
        let one = Interval::point(1.0);
        let f = self
            .tape
            .run(Dual::variables(region.map(Enclosure::of), [one; 3]));
        (f.value, f.slopes)
    }

    /// All values in a box, as narrow as they are easily had: where the
    /// box itself does not decide the sign, the mean value theorem is asked,
    /// too (R. Moore, *Interval Analysis*, 1966).
    pub fn narrow_range(&self, region: [Interval; 3]) -> Enclosure {
        let direct = self.range(region);
        if direct.range.sign() != 0 || direct.range.is_empty() || !direct.continuous {
            return direct;
        }
        let (_, slopes) = self.gradient_range(region);
        let middle = region.map(|x| Interval::point(x.middle()));
        let mut mean = self.range(middle).range;
        for i in 0..3 {
            mean = mean + slopes[i] * (region[i] - middle[i]);
        }
        direct.narrowed(mean)
    }

    /// All values and slopes on `origin + dir * t` for `t` in a bounded
    /// interval. Where the line itself does not decide the sign, the mean
    /// value theorem is asked, too.
    #[inline]
    pub fn along_range(&self, origin: DVec3, dir: DVec3, t: Interval) -> Along {
        let direct = self
            .tape
            .run::<Dual<Enclosure, 1>>(std::array::from_fn(|i| Dual {
                value: Enclosure::of(line(origin[i], dir[i], t)),
                slopes: [Interval::point(dir[i])],
            }));
        let (value, slope) = (direct.value, direct.slopes[0]);
        let decided = value.range.sign() != 0 || slope.sign() != 0;
        if decided || value.range.is_empty() || !value.continuous {
            return Along {
                value,
                slope,
                noise: 0.0,
            };
        }
        let middle = t.middle();
        let there = self.at(origin, dir, middle).range;
        let mean = there + slope * (t - Interval::point(middle));
        Along {
            value: value.narrowed(mean),
            slope,
            noise: there.width(),
        }
    }

    /// The value at `origin + dir * t`, rounding included.
    #[inline]
    pub fn at(&self, origin: DVec3, dir: DVec3, t: f64) -> Enclosure {
        let t = Interval::point(t);
        self.range(std::array::from_fn(|i| line(origin[i], dir[i], t)))
    }
}

/// A coordinate on a line.
#[inline]
fn line(origin: f64, dir: f64, t: Interval) -> Interval {
    Interval::point(origin) + Interval::point(dir) * t
}

#[cfg(test)]
mod tests;

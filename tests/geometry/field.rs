//! Polynomials of place, written once and worked out along any ray with as
//! many digits as are asked for.

use std::{
    cell::RefCell,
    ops::{Add, Mul, Sub},
};

use glam::DVec3;
use nephroid::geometry::Ray;

use crate::{
    along::{Digits, Poly},
    exact::{Dd, Vec3Dd, sub, vec},
};

/// A polynomial of place: negative inside.
pub(crate) struct Field {
    steps: Vec<Step>,
    last: usize,
}

/// What is done to what the steps before have made.
#[derive(Clone, Copy)]
pub(crate) enum Step {
    Axis(usize),
    Less(usize, f64),
    Plus(usize, Dd),
    Times(usize, Dd),
    Sum(usize, usize),
    Product(usize, usize),
}

/// A part of a field that is being written.
#[derive(Clone, Copy)]
pub(crate) enum Term<'a> {
    Constant(Dd),
    Made(&'a RefCell<Vec<Step>>, usize),
}

impl Field {
    /// The field that is a function of the coordinates.
    pub(crate) fn of(written: impl for<'a> FnOnce(&[Term<'a>; 3]) -> Term<'a>) -> Self {
        let steps = RefCell::new((0..3).map(Step::Axis).collect());
        let axes = std::array::from_fn(|i| Term::Made(&steps, i));
        let Term::Made(_, last) = written(&axes) else {
            panic!("a field that is constant");
        };
        let steps = steps.into_inner();
        Self { steps, last }
    }

    /// What it is along a ray.
    pub(crate) fn along<N: Digits>(&self, ray: &Ray) -> Poly<N> {
        let axis = |i: usize| Poly::line(Dd::of(ray.origin[i]), Dd::of(ray.dir[i]));
        self.worked_out(&std::array::from_fn(axis))
    }

    /// What it is where the coordinates are as given.
    pub(crate) fn worked_out<N: Digits>(&self, axes: &[Poly<N>; 3]) -> Poly<N> {
        let mut made: Vec<Poly<N>> = Vec::with_capacity(self.steps.len());
        for &step in &self.steps {
            let next = match step {
                Step::Axis(i) => axes[i],
                Step::Less(i, place) => made[i].less(place),
                Step::Plus(i, c) => made[i] + Poly::constant(c),
                Step::Times(i, c) => made[i].times(c),
                Step::Sum(i, j) => made[i] + made[j],
                Step::Product(i, j) => made[i] * made[j],
            };
            made.push(next);
        }
        made[self.last]
    }

    /// How steep it is at a place.
    pub(crate) fn slope<N: Digits>(&self, at: Vec3Dd) -> f64 {
        let squares = (0..3).map(|axis| {
            let along: [Poly<N>; 3] =
                std::array::from_fn(|i| Poly::line(at[i], Dd::of(f64::from(u8::from(i == axis)))));
            let slope = self.worked_out(&along).slope();
            slope * slope
        });
        squares.sum::<f64>().sqrt()
    }
}

impl<'a> Term<'a> {
    pub(crate) fn constant(c: Dd) -> Self {
        Self::Constant(c)
    }

    pub(crate) fn squared(self) -> Self {
        self * self
    }

    pub(crate) fn times(self, factor: Dd) -> Self {
        match self {
            Self::Constant(c) => Self::Constant(c * factor),
            Self::Made(steps, i) => Self::made(steps, Step::Times(i, factor)),
        }
    }

    /// A coordinate from another place.
    pub(crate) fn less(self, place: f64) -> Self {
        match self {
            Self::Constant(c) => Self::Constant(c - Dd::of(place)),
            Self::Made(steps, i) => Self::made(steps, Step::Less(i, place)),
        }
    }

    fn made(steps: &'a RefCell<Vec<Step>>, step: Step) -> Self {
        let mut list = steps.borrow_mut();
        list.push(step);
        Self::Made(steps, list.len() - 1)
    }
}

impl Add for Term<'_> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        match (self, o) {
            (Self::Constant(a), Self::Constant(b)) => Self::Constant(a + b),
            (Self::Constant(c), Self::Made(steps, i))
            | (Self::Made(steps, i), Self::Constant(c)) => Self::made(steps, Step::Plus(i, c)),
            (Self::Made(steps, i), Self::Made(_, j)) => Self::made(steps, Step::Sum(i, j)),
        }
    }
}

impl Sub for Term<'_> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + o.times(Dd::of(-1.0))
    }
}

impl Mul for Term<'_> {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        match (self, o) {
            (term, Self::Constant(c)) | (Self::Constant(c), term) => term.times(c),
            (Self::Made(steps, i), Self::Made(_, j)) => Self::made(steps, Step::Product(i, j)),
        }
    }
}

/// The squared length of a vector.
pub(crate) fn square<'a>(v: &[Term<'a>; 3]) -> Term<'a> {
    v[0].squared() + v[1].squared() + v[2].squared()
}

/// Coordinates relative to a place.
pub(crate) fn from<'a>(x: &[Term<'a>; 3], place: DVec3) -> [Term<'a>; 3] {
    std::array::from_fn(|i| x[i].less(place[i]))
}

/// The product with a vector.
pub(crate) fn across<'a>(x: &[Term<'a>; 3], v: Vec3Dd) -> Term<'a> {
    x[0].times(v[0]) + x[1].times(v[1]) + x[2].times(v[2])
}

/// What points away from a place along a direction is outside.
pub(crate) fn half_space(place: DVec3, normal: Vec3Dd) -> Field {
    Field::of(|x| across(&from(x, place), normal))
}

/// The vector between two places.
pub(crate) fn between(a: DVec3, b: DVec3) -> Vec3Dd {
    sub(vec(b), vec(a))
}

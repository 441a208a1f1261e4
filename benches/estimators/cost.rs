//! What an answer cost, and how far off it is.

use nephroid::{film::Image, metrics::relmse};

use crate::exact::Reference;

/// Largest number of photons that is tried.
const MOST: u64 = 1 << 36;

/// `first`, and twice as much each time.
pub(crate) fn doublings(first: u64) -> impl Iterator<Item = u64> {
    std::iter::successors(Some(first), |n| (*n < MOST).then_some(2 * n))
}

/// One picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Photon paths emitted.
    pub(crate) photons: u64,
    /// CPU seconds.
    pub(crate) seconds: f64,
    /// relMSE.
    pub(crate) error: f64,
}

impl Row {
    /// Of a picture of irradiances.
    pub(crate) fn of(image: &Image, reference: &Reference, photons: u64, seconds: f64) -> Self {
        Self {
            photons,
            seconds,
            error: relmse(image, &reference.image).unwrap_or(f64::NAN),
        }
    }
}

/// A method's pictures, each with twice the photons of the one before.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// The method.
    pub(crate) name: String,
    /// Its pictures, the cheapest first.
    pub(crate) rows: Vec<Row>,
}

impl Series {
    /// The pictures of a method.
    pub(crate) fn new(name: String, rows: Vec<Row>) -> Self {
        Self { name, rows }
    }

    /// The picture with the least error.
    pub(crate) fn best(&self) -> Option<&Row> {
        self.rows.iter().min_by(|a, b| a.error.total_cmp(&b.error))
    }

    /// CPU seconds and photons after which the error is first at most
    /// `error`, on a straight line between the pictures on log-log paper;
    /// those of the first picture if it is that good already, `None` if none
    /// is.
    pub(crate) fn cost_to(&self, error: f64) -> Option<[f64; 2]> {
        let after = self.rows.iter().position(|r| r.error <= error)?;
        let cost = |row: &Row| [row.seconds, row.photons as f64];
        let b = &self.rows[after];
        let Some(a) = after.checked_sub(1).map(|i| &self.rows[i]) else {
            return Some(cost(b));
        };
        let share = (a.error / error).ln() / (a.error / b.error).ln();
        let between = |i: usize| cost(a)[i] * (cost(b)[i] / cost(a)[i]).powf(share);
        Some([between(0), between(1)])
    }
}

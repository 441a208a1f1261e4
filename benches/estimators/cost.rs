//! What an answer cost, and how far off it is.

use std::{fs, time::Instant};

use nephroid::{film::Image, metrics::relmse};

use crate::exact::Reference;

/// Largest number of photons that is tried.
const MOST: u64 = 1 << 36;

/// `first`, and twice as much each time.
pub(crate) fn doublings(first: u64) -> impl Iterator<Item = u64> {
    std::iter::successors(Some(first), |n| (*n < MOST).then_some(2 * n))
}

/// Measures processor time of all threads; wall time where Linux does not
/// tell it.
pub(crate) struct Clock {
    wall: Instant,
    cpu: Option<f64>,
}

impl Clock {
    /// Starts to measure.
    pub(crate) fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu: cpu_seconds(),
        }
    }

    /// Seconds since the start.
    pub(crate) fn seconds(&self) -> f64 {
        match (self.cpu, cpu_seconds()) {
            (Some(then), Some(now)) => now - then,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// Time that the threads alive have run: the first number of `schedstat`, in
/// nanoseconds, which may be some milliseconds behind. No thread ends while
/// something is measured.
fn cpu_seconds() -> Option<f64> {
    let mut total = 0;
    for task in fs::read_dir("/proc/self/task").ok()? {
        let text = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        total += text.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    Some(total as f64 * 1e-9)
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

    /// CPU seconds after which the error is first at most `error`, on a
    /// straight line between the pictures on log-log paper; those of the
    /// first picture if it is that good already, `None` if none is.
    pub(crate) fn seconds_to(&self, error: f64) -> Option<f64> {
        let after = self.rows.iter().position(|r| r.error <= error)?;
        let b = self.rows[after];
        let Some(a) = after.checked_sub(1).map(|i| self.rows[i]) else {
            return Some(b.seconds);
        };
        let share = (a.error / error).ln() / (a.error / b.error).ln();
        Some(a.seconds * (b.seconds / a.seconds).powf(share))
    }
}

//! What camera samples cost.

use std::ops::AddAssign;

use super::share::Work;

/// What came of a camera sample besides its light.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CameraTally {
    /// Rays cast, to surfaces and to lights.
    pub(super) rays: u64,
    pub(super) truncated: u64,
    /// The part of the work that was done for indirect light, in rays cast.
    pub(super) beyond: f64,
    pub(super) queries: u64,
    pub(super) visited: u64,
    pub(super) tested: u64,
    pub(super) accepted: u64,
}

impl CameraTally {
    /// The work since an earlier state of this tally, in rays cast.
    pub(super) fn work_since(&self, before: &Self) -> f64 {
        let work = Work {
            samples: 1,
            rays: self.rays - before.rays,
            queries: self.queries - before.queries,
            visited: self.visited - before.visited,
        };
        work.of_sample()
    }

    /// The work in all, of so many samples.
    pub(super) fn work(&self, samples: u64) -> Work {
        Work {
            samples,
            rays: self.rays,
            queries: self.queries,
            visited: self.visited,
        }
    }
}

impl AddAssign for CameraTally {
    fn add_assign(&mut self, o: Self) {
        self.rays += o.rays;
        self.truncated += o.truncated;
        self.beyond += o.beyond;
        self.queries += o.queries;
        self.visited += o.visited;
        self.tested += o.tested;
        self.accepted += o.accepted;
    }
}

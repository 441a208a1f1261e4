//! Ctrl-C (and the signals that ask a program to end).
//!
//! The first one asks the render to stop after the pass under way; a later one
//! ends the program at once, with the shells' code for an interrupted program.
//! One that follows within a second is taken for the same wish: what ends a
//! group of processes often reaches each of them twice.
//! While files are being written all of them are ignored: that is soon over,
//! and no half-written file may stay behind.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

/// What the shells report for a program that an interrupt ended: 128 + 2.
const ENDED_AT_ONCE: i32 = 130;

/// Signals closer together than this are one wish.
const ONE_WISH: Duration = Duration::from_secs(1);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Rendering,
    /// Asked to stop, at that time.
    Stopping(Instant),
    Saving,
}

/// The state shared with the signal handler.
#[derive(Clone, Debug)]
pub(crate) struct Interrupt {
    phase: Arc<Mutex<Phase>>,
    /// What the first interrupt brings, in words.
    promise: &'static str,
}

impl Interrupt {
    /// Starts listening; the first interrupt brings what `promise` says. Where
    /// no handler can be set, an interrupt ends the program as it ends any other.
    pub(crate) fn listen(promise: &'static str) -> Self {
        let this = Self {
            phase: Arc::new(Mutex::new(Phase::Rendering)),
            promise,
        };
        let shared = this.clone();
        let _ = ctrlc::set_handler(move || shared.on_signal());
        this
    }

    /// Whether the render should stop.
    pub(crate) fn is_requested(&self) -> bool {
        matches!(*self.phase(), Phase::Stopping(_))
    }

    /// From now on the program writes files and will end by itself.
    pub(crate) fn start_saving(&self) {
        *self.phase() = Phase::Saving;
    }

    fn on_signal(&self) {
        // The lock is held until the end, so that saving cannot begin meanwhile.
        let mut phase = self.phase();
        match *phase {
            Phase::Rendering => {
                *phase = Phase::Stopping(Instant::now());
                super::tell(format_args!(
                    "\ninterrupted: {}; interrupt again to stop at once",
                    self.promise
                ));
            }
            Phase::Stopping(since) if since.elapsed() >= ONE_WISH => {
                std::process::exit(ENDED_AT_ONCE)
            }
            Phase::Stopping(_) | Phase::Saving => {}
        }
    }

    fn phase(&self) -> MutexGuard<'_, Phase> {
        // A phase is valid whatever happened to the thread that wrote it.
        self.phase.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

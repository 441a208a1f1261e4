//! Wall time and processor time of what is worth its price.

use std::time::{Duration, Instant};

/// A clock that runs only while it is told to, so that looking at a picture
/// between two passes costs the render nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stopwatch {
    wall: Duration,
    cpu: f64,
}

impl Stopwatch {
    /// Does `work` and counts the time it takes.
    pub fn time<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), processor_seconds());
        let done = work();
        self.wall += wall.elapsed();
        self.cpu += processor_seconds() - cpu;
        done
    }

    /// Wall time so far.
    pub fn wall(&self) -> Duration {
        self.wall
    }

    /// Processor time of all threads of this program so far, in seconds. Where
    /// the system does not tell it, wall time times threads.
    pub fn cpu_seconds(&self) -> f64 {
        self.cpu
    }
}

/// Seconds that the threads of this program have run, from some time on.
#[cfg(unix)]
fn processor_seconds() -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// The same as if all threads were always at work.
#[cfg(not(unix))]
fn processor_seconds() -> f64 {
    use std::sync::OnceLock;
    static START: OnceLock<Instant> = OnceLock::new();
    let wall = START.get_or_init(Instant::now).elapsed();
    wall.as_secs_f64() * rayon::current_num_threads() as f64
}

#[cfg(test)]
mod tests {
    use std::{hint::black_box, thread::sleep};

    use super::*;

    /// Sleep takes wall time and no processor time, work takes both, and what
    /// happens between does not count. Bounds are generous: they are about
    /// kinds of time, not about speed.
    #[test]
    fn counts_what_it_is_told_to() {
        let mut clock = Stopwatch::default();
        clock.time(|| sleep(Duration::from_millis(30)));
        assert!(clock.wall() >= Duration::from_millis(30));
        let asleep = clock.cpu_seconds();
        let before = clock.wall();
        sleep(Duration::from_millis(20));
        assert_eq!(clock.wall(), before, "nobody asked for that");
        let sum = clock.time(|| (0..3_000_000u64).fold(0, |a, b| black_box(a ^ (b * b))));
        black_box(sum);
        assert!(clock.cpu_seconds() > asleep && clock.wall() > before);
    }
}

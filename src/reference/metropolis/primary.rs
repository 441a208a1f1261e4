//! A point of the primary sample space: the random numbers of one path, which
//! are changed from path to path a little, or drawn anew.

use crate::sampling::Stream;

use super::super::random::Random;

/// Smallest and largest change of a coordinate in a small step: Kelemen and
/// others 2002, section 3.3.
const SMALLEST: f64 = 1.0 / 1024.0;
const LARGEST: f64 = 1.0 / 64.0;

/// A coordinate, and the step at which it was last changed.
#[derive(Clone, Copy, Debug, Default)]
struct Coordinate {
    value: f64,
    changed: u64,
    /// Both as they were before the step under way.
    kept: (f64, u64),
}

/// The random numbers of one path. Coordinates are brought up to date when
/// they are read: those that a path does not need change nothing.
#[derive(Clone, Debug)]
pub(super) struct Primary {
    coordinates: Vec<Coordinate>,
    cursor: usize,
    /// Steps accepted so far, and the one under way.
    step: u64,
    /// The last accepted large step and where its numbers come from.
    last_large: u64,
    base: Stream,
    /// Where the numbers come from if the step under way is a large one.
    large: Option<Stream>,
    /// By how much coordinates are changed.
    changes: Stream,
}

impl Primary {
    /// Begins at the point `base`; `changes` decides on the small steps.
    pub(super) fn new(base: Stream, changes: Stream) -> Self {
        Self {
            coordinates: Vec::new(),
            cursor: 0,
            step: 0,
            last_large: 0,
            base,
            large: None,
            changes,
        }
    }

    /// Proposes a step: to the point `large`, or to one near by.
    pub(super) fn propose(&mut self, large: Option<Stream>) {
        self.step += 1;
        self.large = large;
        self.cursor = 0;
    }

    /// Takes the step that was proposed.
    pub(super) fn accept(&mut self) {
        if let Some(large) = self.large.take() {
            self.last_large = self.step;
            self.base = large;
        }
    }

    /// Returns to where it was.
    pub(super) fn reject(&mut self) {
        for c in &mut self.coordinates {
            if c.changed == self.step {
                (c.value, c.changed) = c.kept;
            }
        }
        self.step -= 1;
        self.large = None;
    }
}

impl Random for Primary {
    fn seek(&mut self, coordinate: u32) {
        self.cursor = coordinate as usize;
    }

    fn next_1d(&mut self) -> f64 {
        let i = self.cursor;
        self.cursor += 1;
        while self.coordinates.len() <= i {
            let value = read(self.base, self.coordinates.len());
            self.coordinates.push(Coordinate {
                value,
                changed: self.last_large,
                kept: (value, self.last_large),
            });
        }
        let c = &mut self.coordinates[i];
        if c.changed == self.step {
            return c.value;
        }
        if c.changed < self.last_large {
            (c.value, c.changed) = (read(self.base, i), self.last_large);
        }
        c.kept = (c.value, c.changed);
        match self.large {
            Some(large) => c.value = read(large, i),
            None => {
                for _ in c.changed..self.step {
                    c.value = changed(c.value, self.changes.next_1d());
                }
            }
        }
        c.changed = self.step;
        c.value
    }
}

/// Coordinate `i` of a stream.
fn read(mut stream: Stream, i: usize) -> f64 {
    stream.seek(i as u32);
    stream.next_1d()
}

/// A small step from `x`, on the unit interval closed to a circle: its length
/// falls off exponentially, either way alike.
fn changed(x: f64, u: f64) -> f64 {
    let (u, sign) = if u < 0.5 {
        (2.0 * u, 1.0)
    } else {
        (2.0 * u - 1.0, -1.0)
    };
    let length = LARGEST * libm::exp(-libm::log(LARGEST / SMALLEST) * u);
    let moved = x + sign * length;
    let wrapped = moved - moved.floor();
    // Just below zero rounds up to one.
    if wrapped < 1.0 { wrapped } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Sequence};

    fn stream(item: u64) -> Stream {
        Sequence::new(5, Purpose::Reference, 0, item).at(0)
    }

    /// What is refused leaves no trace; what is taken stays; a coordinate
    /// that is read late has made all small steps of the others.
    #[test]
    fn steps_are_taken_or_undone() {
        let mut p = Primary::new(stream(0), stream(1));
        let read = |p: &mut Primary| {
            p.seek(0);
            [p.next_1d(), p.next_1d(), p.next_1d()]
        };
        let first = read(&mut p);
        p.propose(None);
        let near = read(&mut p);
        assert!(first.iter().zip(near).all(|(a, b)| *a != b));
        p.reject();
        assert_eq!(read(&mut p), first, "refused");
        p.propose(Some(stream(2)));
        let far = read(&mut p);
        assert_eq!(far[2], super::read(stream(2), 2));
        p.reject();
        assert_eq!(read(&mut p), first, "a large step refused");
        p.propose(None);
        let near = read(&mut p);
        p.accept();
        assert_eq!(read(&mut p), near, "taken");
        p.propose(Some(stream(3)));
        let far = read(&mut p);
        p.accept();
        assert_eq!(read(&mut p), far, "a large step taken");
        p.seek(9);
        assert_eq!(
            p.next_1d(),
            super::read(stream(3), 9),
            "read for the first time after a large step"
        );
    }

    /// Small steps leave the uniform distribution as it is: their law is
    /// symmetric on the circle.
    #[test]
    fn changes_are_symmetric_and_bounded() {
        for k in 0..1000 {
            let u = (f64::from(k) + 0.5) / 2000.0;
            let up = changed(0.5, u) - 0.5;
            let down = 0.5 - changed(0.5, u + 0.5);
            assert!((up - down).abs() < 1e-15, "{up} {down}");
            assert!((SMALLEST - 1e-15..=LARGEST).contains(&up), "{up}");
            for x in [0.0, 1e-17, 1.0f64.next_down()] {
                assert!((0.0..1.0).contains(&changed(x, u)));
                assert!((0.0..1.0).contains(&changed(x, u + 0.5)));
            }
        }
    }
}

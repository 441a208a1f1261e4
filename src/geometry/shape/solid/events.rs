//! Crossings of operands along a ray.

use super::ShapeHit;

/// A crossing of an operand's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    pub(super) t: f64,
    /// The operand and its part.
    pub(super) part: u32,
    pub(super) uv: [f64; 2],
}

impl Event {
    #[inline]
    pub(super) fn hit(&self) -> ShapeHit {
        ShapeHit {
            t: self.t,
            part: self.part,
            uv: self.uv,
        }
    }
}

/// As many crossings as usual solids have are kept in place; only more than
/// these take memory of their own.
const USUAL: usize = 16;

/// A list of crossings.
pub(super) struct Events {
    few: [Event; USUAL],
    count: usize,
    /// All of them, once there are more than usual.
    many: Vec<Event>,
}

impl Events {
    #[inline]
    pub(super) fn new() -> Self {
        let none = Event {
            t: 0.0,
            part: 0,
            uv: [0.0; 2],
        };
        Self {
            few: [none; USUAL],
            count: 0,
            many: Vec::new(),
        }
    }

    #[inline]
    pub(super) fn push(&mut self, event: Event) {
        if self.count < USUAL {
            self.few[self.count] = event;
        } else {
            if self.count == USUAL {
                self.many.extend(self.few);
            }
            self.many.push(event);
        }
        self.count += 1;
    }

    /// In the order of the ray; at one place in that of the parts, so that
    /// nothing depends on who came first.
    pub(super) fn sort(&mut self) {
        let order = |a: &Event, b: &Event| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part));
        if self.count > USUAL {
            self.many.sort_unstable_by(order);
        } else {
            self.few[..self.count].sort_unstable_by(order);
        }
    }

    #[inline]
    pub(super) fn as_slice(&self) -> &[Event] {
        if self.count > USUAL {
            &self.many
        } else {
            &self.few[..self.count]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_events_is_kept_and_sorted() {
        for count in [0u32, 1, 15, 16, 17, 100] {
            let mut events = Events::new();
            for i in 0..count {
                let t = f64::from(i * 37 % 101);
                events.push(Event {
                    t,
                    part: i,
                    uv: [0.0; 2],
                });
            }
            events.sort();
            let sorted = events.as_slice();
            assert_eq!(sorted.len(), count as usize);
            assert!(sorted.is_sorted_by(|a, b| a.t < b.t));
            assert!(sorted.iter().all(|e| e.t == f64::from(e.part * 37 % 101)));
        }
    }
}

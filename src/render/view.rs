//! All that is seen along one ray: the tree of ways through mirrors and glass.

use crate::{
    geometry::Ray,
    sampling::Stream,
    transport::{Context, End, Walker},
};

use super::tally::CameraTally;

/// Ways that may wait to be followed; where they are more, coins decide. The
/// strengths of all ways sum to at most 1, so this many are rare.
const PENDING: usize = 16;

/// Ways that wait to be followed.
struct Pending {
    walkers: [Option<Walker>; PENDING],
    count: usize,
}

impl Pending {
    /// Takes a way if there is room.
    fn take(&mut self, walker: &Walker) -> bool {
        let room = self.count < PENDING;
        if room {
            self.walkers[self.count] = Some(*walker);
            self.count += 1;
        }
        room
    }

    /// The way that was taken last.
    fn next(&mut self) -> Option<Walker> {
        self.count = self.count.checked_sub(1)?;
        self.walkers[self.count].take()
    }
}

/// Follows `ray` to every end that it has: where light divides, both ways
/// at the first surface and while the weaker one is stronger than
/// `split_above`; below, a coin from `coins` decides on one. Strengths sum to at most 1 over all ends, the
/// strongest way comes to its end first.
pub(super) fn view(
    ctx: &Context<'_>,
    ray: Ray,
    split_above: f64,
    mut coins: Stream,
    tally: &mut CameraTally,
    mut on_end: impl FnMut(&Walker, &End, &mut CameraTally),
) {
    let mut pending = Pending {
        walkers: [None; PENDING],
        count: 0,
    };
    let mut next = Some(Walker::from_camera(ctx, ray));
    while let Some(mut walker) = next {
        let before = walker.depth;
        let end = walker.walk(ctx, &mut coins, &mut |other| {
            (other.depth == 1 || other.strength > split_above) && pending.take(other)
        });
        tally.rays += u64::from(walker.depth - before) + 1;
        on_end(&walker, &end, tally);
        next = pending.next();
    }
}

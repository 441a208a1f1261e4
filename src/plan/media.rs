//! The bodies of clear media in which a point lies.

use crate::built;

/// Most bodies that are remembered at once.
pub const MOST_MEDIA: usize = if built::NESTING { 7 } else { 0 };

/// The bodies of clear media in which a point lies, by rank: the one of the
/// highest rank fills the place.
///
/// A small set without allocation, of 16 bytes: paths are copied often. Where more than [`MOST_MEDIA`] bodies
/// overlap, the ones of the lowest ranks are forgotten; a path that leaves a
/// forgotten body and all above it believes to be outside until it meets the
/// body's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media {
    /// Ascending by rank; zero behind the last.
    ranks: [u16; MOST_MEDIA],
    count: u16,
}

/// Ranks are below this.
pub(super) const RANKS: u16 = 1 << 14;

/// Mark of a body whose surface coincides with the one that the path has met:
/// the side of that one on which the path goes on tells whether it is in the
/// body.
const SHARED: u16 = 1 << 15;

/// Beside that mark: the body is on the inner side.
const INNER: u16 = 1 << 14;

impl Media {
    /// Outside of all bodies.
    pub const NONE: Self = Self {
        ranks: [0; MOST_MEDIA],
        count: 0,
    };

    /// The ranks of the bodies, ascending, once it is known on which side of a
    /// surface the path goes on.
    pub fn ranks(&self) -> &[u16] {
        &self.ranks[..self.count as usize]
    }

    /// The highest rank: whose medium is there. `None` outside of all bodies.
    /// A body of which it depends on the side of a surface does not count.
    pub fn top(&self) -> Option<u16> {
        let known = |r: &&u16| **r & SHARED == 0;
        self.ranks().iter().rev().find(known).copied()
    }

    /// Where the path has met a surface with which that of another body
    /// coincides: the body is on the `inner` side of the surface met, or else
    /// on the outer one.
    #[must_use]
    pub(super) fn shared(self, rank: u16, inner: bool) -> Self {
        let mut media = self.with(rank);
        let found = media.ranks[..media.count as usize].iter_mut();
        for r in found.filter(|r| **r == rank) {
            *r |= if inner { SHARED | INNER } else { SHARED };
        }
        media
    }

    /// The bodies on the inner side of the surface met or on its outer one.
    #[must_use]
    pub(super) fn on_side(self, inner: bool) -> Self {
        let shared = |r: &&u16| **r & SHARED != 0;
        let Some(&r) = self.ranks().iter().find(shared) else {
            return self;
        };
        let mut media = self;
        let at = media.position(r & (RANKS - 1));
        media.ranks[at] &= RANKS - 1;
        if (r & INNER != 0) != inner {
            media = media.without(r & (RANKS - 1));
        }
        media.on_side(inner)
    }

    /// How many bodies of lower rank there are.
    fn position(&self, rank: u16) -> usize {
        self.ranks().partition_point(|&r| r & (RANKS - 1) < rank)
    }

    /// Inside the body of a rank, too.
    #[must_use]
    pub fn with(mut self, rank: u16) -> Self {
        let count = self.count as usize;
        let at = self.position(rank);
        if self.ranks().get(at) == Some(&rank) {
            return self;
        }
        if count < MOST_MEDIA {
            self.ranks.copy_within(at..count, at + 1);
            self.ranks[at] = rank;
            self.count += 1;
        } else if at > 0 {
            self.ranks.copy_within(1..at, 0);
            self.ranks[at - 1] = rank;
        }
        self
    }

    /// Outside of the body of a rank.
    #[must_use]
    pub fn without(mut self, rank: u16) -> Self {
        let count = self.count as usize;
        let at = self.position(rank);
        if self.ranks().get(at) == Some(&rank) {
            self.ranks.copy_within(at + 1..count, at);
            self.ranks[count - 1] = 0;
            self.count -= 1;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    /// What is on either side of several surfaces in one place.
    #[test]
    fn shared_surfaces_have_two_sides() {
        let media = Media::NONE.with(1).with(4).with(9);
        let met = media
            .without(4)
            .shared(4, true)
            .shared(2, false)
            .shared(9, true);
        assert_eq!(met.on_side(true), media);
        assert_eq!(met.on_side(false), Media::NONE.with(1).with(2));
        assert_eq!(media.on_side(true), media);
    }

    proptest! {
        /// Against the standard library's set, whose lowest member goes where
        /// there are too many.
        #[test]
        fn a_set_that_forgets_the_lowest(steps in proptest::collection::vec((0u16..12, any::<bool>()), 0..60)) {
            let (mut media, mut set) = (Media::NONE, BTreeSet::new());
            for (rank, enters) in steps {
                if enters {
                    media = media.with(rank);
                    set.insert(rank);
                    if set.len() > MOST_MEDIA {
                        set.pop_first();
                    }
                } else {
                    media = media.without(rank);
                    set.remove(&rank);
                }
                let expected: Vec<u16> = set.iter().copied().collect();
                prop_assert_eq!(media.ranks(), expected.as_slice());
                prop_assert_eq!(media.top(), set.last().copied());
                // No trace of the way remains: equal sets are equal values.
                let afresh = expected.iter().fold(Media::NONE, |m, &r| m.with(r));
                prop_assert_eq!(media, afresh);
            }
        }
    }
}

//! The bodies of clear media in which a point lies.

/// Most bodies that are remembered at once.
pub const MOST_MEDIA: usize = 7;

/// The bodies of clear media in which a point lies, by rank: the one of the
/// highest rank fills the place.
///
/// A small set without allocation, of 16 bytes: paths are copied often. Where more than [`MOST_MEDIA`] bodies
/// overlap, the ones of the lowest ranks are forgotten; a path that leaves a
/// forgotten body and all above it believes to be outside until it meets the
/// body's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media {
    /// Ascending; zero behind the last.
    ranks: [u16; MOST_MEDIA],
    count: u16,
}

impl Media {
    /// Outside of all bodies.
    pub const NONE: Self = Self {
        ranks: [0; MOST_MEDIA],
        count: 0,
    };

    /// The ranks of the bodies, ascending.
    pub fn ranks(&self) -> &[u16] {
        &self.ranks[..self.count as usize]
    }

    /// The highest rank: whose medium is there. `None` outside of all bodies.
    pub fn top(&self) -> Option<u16> {
        self.ranks().last().copied()
    }

    /// Inside the body of a rank, too.
    #[must_use]
    pub fn with(mut self, rank: u16) -> Self {
        let count = self.count as usize;
        let at = self.ranks().partition_point(|&r| r < rank);
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
        let at = self.ranks().partition_point(|&r| r < rank);
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

//! Streams: the address of a path's random numbers.

use std::ops::Range;

use super::{
    DIMENSIONS, mix, mix2,
    sobol::{shuffled, sobol_owen, sobol_owen_4},
};

/// Coordinates of a stream with low discrepancy; later ones are hashed.
pub const LOW_DISCREPANCY: u32 = 4 * DIMENSIONS as u32;

/// What a sequence of samples is used for; part of the address, so that no
/// two uses share numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// Photon paths.
    Photon = 1,
    /// Camera paths.
    Camera = 2,
    /// Pilot runs that learn about the scene.
    Pilot = 3,
    /// Looking for light sources in mirrors and glass.
    Glint = 4,
    /// Further camera paths where neighbouring pixels differ.
    Refinement = 5,
    /// Paths of the reference methods.
    Reference = 6,
}

/// A scrambled sequence; [`Sequence::at`] picks one of its points.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    key: u64,
    independent: bool,
}

impl Sequence {
    /// The sequence of a purpose, replicate and item (the pixel of a camera
    /// sequence; 0 for photons). Different addresses give independent
    /// scramblings.
    pub fn new(seed: u64, purpose: Purpose, replicate: u32, item: u64) -> Self {
        Self {
            key: mix2(mix2(seed, purpose as u64), mix2(u64::from(replicate), item)),
            independent: false,
        }
    }

    /// Random points in place of the sequence's, each independent of the
    /// others: the first point of a scrambling of its own is anywhere with
    /// equal chances.
    #[must_use]
    pub fn independent(self) -> Self {
        Self {
            independent: true,
            ..self
        }
    }

    /// Point `index` of the sequence. Indices beyond 2^32 continue with
    /// another scrambling.
    #[inline]
    pub fn at(self, index: u64) -> Stream {
        if self.independent {
            return Self {
                key: mix2(self.key, index),
                independent: false,
            }
            .at(0);
        }
        Stream {
            key: self.key ^ mix(index >> 32),
            index: index as u32,
            dimension: 0,
            window: [u32::MAX; 2],
            path: index,
        }
    }
}

impl Sequence {
    /// Point `index` in an order that is the sequence's own, for sequences
    /// that are used side by side with others index by index. In the common
    /// order, the point of a pixel in round `k` and the photons of round `k`
    /// would depend on the same bits of `k`, and their errors would add up
    /// instead of averaging out.
    #[inline]
    pub fn at_own_order(self, index: u64) -> Stream {
        let low = shuffled(index as u32, mix(!self.key) as u32);
        self.at((index >> 32 << 32) | u64::from(low))
    }
}

/// One point of a sequence, read coordinate by coordinate.
///
/// The first 64 dimensions are four Owen-scrambled Sobol points of 16
/// dimensions, each point of the sequence in an order of its own but for the
/// first ("padding": Burley 2020, section 5). Later ones are plain hashed
/// numbers, since low-discrepancy gains nothing there.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    key: u64,
    index: u32,
    dimension: u32,
    /// Where the window ends, and where reading goes on then.
    window: [u32; 2],
    path: u64,
}

impl Stream {
    /// The next coordinate, in `[0, 1)`.
    #[allow(
        clippy::inline_always,
        reason = "where the dimension is known, a part of the work is done when compiling"
    )]
    #[inline(always)]
    pub fn next_1d(&mut self) -> f64 {
        if self.dimension == self.window[0] {
            *self = self.window(self.window[1]..u32::MAX, u32::MAX);
        }
        let d = self.dimension;
        self.dimension += 1;
        let seed = self.seed(d);
        if d < LOW_DISCREPANCY {
            let (block, d) = (d as usize / DIMENSIONS, d as usize % DIMENSIONS);
            let index = if block == 0 {
                self.index
            } else {
                shuffled(self.index, mix(self.key ^ block as u64) as u32)
            };
            sobol_owen(index, d, (seed >> 32) as u32)
        } else {
            // The top 53 bits, so that the number stays below 1.
            (mix2(seed, self.path) >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
        }
    }

    /// Passes over the next coordinates: nobody asks for them, but those behind
    /// keep their meaning.
    #[inline]
    pub fn skip(&mut self, count: u32) {
        let left = self.window[0].wrapping_sub(self.dimension);
        if count > left {
            *self = self.window(self.window[1]..u32::MAX, u32::MAX);
            self.dimension += count - left;
        } else {
            self.dimension += count;
        }
    }

    /// The next two coordinates.
    #[inline]
    pub fn next_2d(&mut self) -> [f64; 2] {
        [self.next_1d(), self.next_1d()]
    }

    /// The first four coordinates, which are found together, whatever was read
    /// before. The next one is the fifth.
    #[inline]
    pub fn first_4d(&mut self) -> [f64; 4] {
        self.dimension = 4;
        sobol_owen_4(
            self.index,
            [0, 1, 2, 3].map(|d| (self.seed(d) >> 32) as u32),
        )
    }

    /// The scrambling of a coordinate.
    #[inline]
    fn seed(&self, d: u32) -> u64 {
        mix(self
            .key
            .wrapping_add(u64::from(d).wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// Continues at coordinate `dimension`, so that a decision made earlier
    /// on the path cannot shift the meaning of later coordinates.
    #[inline]
    pub fn seek(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    /// The same point, read through a window: first the coordinates `range`,
    /// then those from `beyond` on.
    #[inline]
    #[must_use]
    pub fn window(&self, range: Range<u32>, beyond: u32) -> Self {
        Self {
            dimension: range.start,
            window: [range.end, beyond],
            ..*self
        }
    }

    /// The coordinate that comes next, unless a window ends here.
    #[inline]
    pub fn dimension(&self) -> u32 {
        self.dimension
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_names_a_number() {
        let s = Sequence::new(7, Purpose::Photon, 3, 0);
        let (mut a, mut b) = (s.at(12345), s.at(12345));
        let first: Vec<f64> = (0..100).map(|_| a.next_1d()).collect();
        b.seek(50);
        assert_eq!(b.next_1d(), first[50]);
        b.seek(99);
        assert_eq!(
            b.next_1d(),
            first[99],
            "hashed coordinates are addressed too"
        );
        b.seek(9);
        assert_eq!(b.first_4d(), first[..4], "four at once");
        assert_eq!(b.next_1d(), first[4]);
        let mut window = a.window(3..5, 70);
        for d in [3, 4, 70, 71] {
            assert_eq!(window.next_1d(), first[d], "through a window");
        }
        for count in 0..5 {
            let mut window = a.window(3..5, 70);
            window.skip(count);
            let next = [3, 4, 70, 71, 72][count as usize];
            assert_eq!(window.next_1d(), first[next], "past {count}");
        }
        let mut c = Sequence::new(7, Purpose::Photon, 4, 0).at(12345);
        assert_ne!(c.next_1d(), first[0], "replicates differ");
        assert!(first.iter().all(|x| (0.0..1.0).contains(x)));
    }

    /// Means of stretches of independent points scatter by 1/(12 n), those of
    /// the sequence by 1/(12 n^3): one point in each n-th part.
    #[test]
    fn independent_points_do_not_fill_evenly() {
        const STRETCH: u64 = 64;
        const STRETCHES: u64 = 500;
        let sequence = Sequence::new(1, Purpose::Photon, 0, 0);
        let scatter = |sequence: Sequence, d: u32| {
            let squares: f64 = (0..STRETCHES)
                .map(|stretch| {
                    let sum: f64 = (stretch * STRETCH..(stretch + 1) * STRETCH)
                        .map(|i| {
                            let mut s = sequence.at_own_order(i);
                            s.seek(d);
                            s.next_1d() - 0.5
                        })
                        .sum();
                    (sum / STRETCH as f64).powi(2)
                })
                .sum();
            12.0 * squares / STRETCHES as f64
        };
        for d in [0, 1, 17, 63, 70] {
            let share = scatter(sequence.independent(), d) * STRETCH as f64;
            // A chi-square of 500 degrees of freedom has a spread of 6.3 %.
            assert!((0.7..1.3).contains(&share), "dimension {d}: {share}");
        }
        let even = scatter(sequence, 0) * (STRETCH * STRETCH * STRETCH) as f64;
        assert!((0.3..1.3).contains(&even), "{even}");
    }

    /// Different items at one index are independent: their mean over items is
    /// that of uniform numbers, and neighbours are uncorrelated.
    #[test]
    fn items_are_independent() {
        for d in [0u32, 1, 5, 63, 64, 200] {
            let n = 20_000u64;
            let xs: Vec<f64> = (0..n)
                .map(|item| {
                    let mut s = Sequence::new(1, Purpose::Camera, 0, item).at(0);
                    s.seek(d);
                    s.next_1d() - 0.5
                })
                .collect();
            let mean = xs.iter().sum::<f64>() / n as f64;
            let corr = xs.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n as f64 * 12.0;
            // Standard errors: 0.2887 / sqrt(n) = 0.002 and 1 / sqrt(n) = 0.007.
            assert!(mean.abs() < 0.0085, "dimension {d}: mean {mean}");
            assert!(corr.abs() < 0.03, "dimension {d}: correlation {corr}");
        }
    }
}

//! Which coordinates of a camera sample's stream decide what.
//!
//! No two decisions of one sample share a coordinate, so none can be the
//! shadow of another; and a decision keeps its coordinates whatever other
//! paths of the sample do, so that neighbouring samples stay strata of the
//! same thing. The low-discrepancy coordinates (the first 64) go to what
//! decides most: the place on the film, then what is done at the strongest
//! end of the view. Where those are used up, hashed ones follow.

use std::ops::Range;

use crate::sampling::{LOW_DISCREPANCY, Stream};

/// The place on the film.
const FILM: Range<u32> = 0..2;

/// Coordinates of the shaded ends, strongest first: the first has room for
/// eight shadow rays beside its bounce.
const SHADING: [Range<u32>; 3] = [2..24, 24..34, 34..44];

/// Coordinates of the first end's path from its bounce on; those of the other
/// ends' paths are hashed.
const BEYOND: Range<u32> = 44..LOW_DISCREPANCY;

/// Hashed coordinates come in blocks of so many: one for the coins of the
/// view, and for every shaded end one for itself and one for its path, whose
/// second half is for the way aside. The longest path, 65,536 interactions, fits
/// into a half, and so do 126 ends; since the
/// strengths of all ends sum to at most 1 and no way below 0.03 is split off but
/// at the first surface, there are at most 35.
const BLOCK: u32 = 1 << 24;

/// Where in the pixel the sample lies.
pub(super) fn film(stream: &Stream) -> [f64; 2] {
    stream.window(FILM, FILM.end).next_2d()
}

/// Where in its pixel a ray looks for sources: among which places, and where there.
pub(super) fn glint(stream: &Stream) -> (f64, [f64; 2]) {
    let mut here = stream.window(FILM.start..FILM.end + 1, FILM.end + 1);
    let within = here.next_2d();
    (here.next_1d(), within)
}

/// The coins of the view, where light divides and one way is not followed.
pub(super) fn coins(stream: &Stream) -> Stream {
    stream.window(LOW_DISCREPANCY..BLOCK, BLOCK)
}

/// What decides at shaded end `k`, at most 125: the bounce, the
/// gathering, the shadow rays.
pub(super) fn shading(stream: &Stream, k: u32) -> Stream {
    let block = (2 * k + 1) * BLOCK;
    let best = SHADING.get(k as usize).cloned().unwrap_or(block..block);
    stream.window(best, block)
}

/// What decides on the path that bounces off shaded end `k`.
pub(super) fn path(stream: &Stream, k: u32) -> Stream {
    let block = (2 * k + 2) * BLOCK;
    let best = if k == 0 { BEYOND } else { block..block };
    stream.window(best, block)
}

/// What decides on the weaker way of that path where light first divides.
pub(super) fn aside(stream: &Stream, k: u32) -> Stream {
    let block = (2 * k + 2) * BLOCK + BLOCK / 2;
    stream.window(block..block, block)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::sampling::{Purpose, Sequence};

    /// Whatever a sample reads, it reads once, and all 64 good coordinates are
    /// given to somebody.
    #[test]
    fn no_coordinate_decides_twice() {
        let stream = Sequence::new(1, Purpose::Camera, 2, 3).at(4);
        let mut seen = HashSet::new();
        let mut read = |mut window: Stream, count: u32| {
            for _ in 0..count {
                window.next_1d();
                let last = window.dimension() - 1;
                assert!(seen.insert(last), "coordinate {last} twice");
            }
        };
        read(stream.window(FILM, FILM.end), 2);
        read(coins(&stream), 1000);
        for k in (0..12).chain([125]) {
            read(shading(&stream, k), 1000);
            read(path(&stream, k), 1000);
            read(aside(&stream, k), 1000);
        }
        assert!((0..LOW_DISCREPANCY).all(|d| seen.contains(&d)));
    }
}

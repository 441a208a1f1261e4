//! What a render needs of memory, and what its budget leaves for photons.

use thiserror::Error;

use crate::{
    film::{Film, PixelSample},
    photon::{BYTES_PER_PHOTON, PHOTONS_PER_PATH},
};

/// Fewest photon paths of a pass that the program chooses, and fewest that
/// any budget must leave room for.
pub(super) const FEWEST_PHOTONS: u64 = 1 << 12;

/// Bytes per pixel for what the picture says about its error, and for the
/// images and layers made at the end.
const ENDING: u64 = 320;

/// Bytes per pixel: the film's sums, and either a pass's samples, which exist
/// twice while rows are joined, or what comes after the pass.
const BYTES_PER_PIXEL: u64 = {
    let samples = 2 * size_of::<PixelSample>() as u64;
    Film::BYTES_PER_PIXEL as u64 + if samples > ENDING { samples } else { ENDING }
};

/// The picture does not fit into the memory budget.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "a film of {} x {} pixels needs {}, but the memory budget is {}; render it in parts (--crop), or raise render.memory",
    size[0], size[1], mebibytes(*.needed), mebibytes(*.budget)
)]
pub struct TooLarge {
    /// Width and height of the window in pixels.
    pub size: [u32; 2],
    /// Bytes that film and smallest photon map need.
    pub needed: u64,
    /// Bytes allowed.
    pub budget: u64,
}

pub(crate) fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", bytes.div_ceil(1 << 20))
}

/// Bytes that the film of a window of `size` pixels takes, with the samples of
/// a pass.
pub(crate) fn film_bytes(size: [u32; 2]) -> u64 {
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    pixels.saturating_mul(BYTES_PER_PIXEL)
}

/// Bytes that a photon path may come to need.
const BYTES_PER_PATH: u64 = BYTES_PER_PHOTON * PHOTONS_PER_PATH;

/// The most photon paths that a pass over a window of `size` pixels may have.
///
/// # Errors
/// If the film alone, with room for a few photons, exceeds the budget.
pub(super) fn photon_budget(size: [u32; 2], budget: u64) -> Result<u64, TooLarge> {
    let film = film_bytes(size);
    let needed = film.saturating_add(FEWEST_PHOTONS * BYTES_PER_PATH);
    if needed > budget {
        return Err(TooLarge {
            size,
            needed,
            budget,
        });
    }
    Ok((budget - film) / BYTES_PER_PATH)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn film_and_photons_share_the_budget() {
        let size = [1920, 1080];
        let film = 1920 * 1080 * BYTES_PER_PIXEL;
        let photons = photon_budget(size, film + 1_000_000 * BYTES_PER_PATH);
        assert_eq!(photons, Ok(1_000_000));
        let refused = photon_budget(size, film).expect_err("no room for photons");
        assert!(
            refused.needed > film && refused.to_string().contains("render.memory"),
            "{refused}"
        );
        assert!(
            photon_budget([u32::MAX, u32::MAX], u64::MAX - 1).is_err(),
            "no overflow"
        );
    }
}

//! Colours for numbers: dark for little, bright for much.

use crate::spectrum::{Rgb, srgb_linear};

/// The colour map *magma* (S. van der Walt, N. Smith, 2015, in matplotlib):
/// even steps of the number are even steps for the eye, also in grey and for
/// the colour-blind. Here are sRGB codes at 17 even steps, a fit of least
/// squares to the published 256; between them codes are interpolated, within
/// two codes of the published ones.
const MAGMA: [[u8; 3]; 17] = [
    [0, 0, 4],
    [9, 8, 33],
    [28, 18, 70],
    [53, 15, 108],
    [81, 17, 125],
    [105, 28, 129],
    [130, 38, 130],
    [156, 46, 128],
    [182, 54, 122],
    [208, 64, 112],
    [231, 80, 99],
    [245, 105, 91],
    [252, 135, 96],
    [254, 165, 112],
    [254, 195, 135],
    [253, 224, 161],
    [252, 253, 191],
];

/// The linear colour for a number in 0..=1, from black over purple and orange
/// to a pale yellow. Numbers outside are clipped; NaN has the colour of 0.
pub fn magma(value: f64) -> Rgb {
    let last = MAGMA.len() - 1;
    let clipped = if value > 0.0 { value.min(1.0) } else { 0.0 };
    let place = clipped * last as f64;
    // Whole steps, the last of which begins one before the end.
    let step = (place as usize).min(last - 1);
    let share = place - step as f64;
    Rgb(std::array::from_fn(|c| {
        let [a, b] = [MAGMA[step][c], MAGMA[step + 1][c]].map(f64::from);
        srgb_linear((a + share * (b - a)) / 255.0)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::srgb_byte;

    /// Entries of the published table (matplotlib 3.11.2).
    #[test]
    fn near_the_published_colours() {
        for (entry, published) in [
            (0, [0, 0, 4]),
            (32, [29, 17, 71]),
            (64, [81, 18, 124]),
            (128, [183, 55, 121]),
            (192, [252, 137, 97]),
            (224, [254, 196, 136]),
            (255, [252, 253, 191]),
        ] {
            let codes = magma(f64::from(entry) / 255.0).0.map(srgb_byte);
            for (code, published) in codes.into_iter().zip(published) {
                assert!(code.abs_diff(published) <= 2, "{entry}: {codes:?}");
            }
        }
    }

    #[test]
    fn more_is_brighter() {
        let luminance = |v: f64| {
            let [r, g, b] = magma(v).0;
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..1000 {
            let v = f64::from(i) / 1000.0;
            assert!(luminance(v) < luminance(v + 1e-3), "{v}");
        }
        assert_eq!(magma(7.0), magma(1.0));
        assert_eq!(magma(-1.0), magma(0.0));
        assert_eq!(magma(f64::NAN), magma(0.0));
    }
}

//! Sums over passes whose bits depend neither on the order of the passes nor on
//! how they were grouped.
//!
//! Every pass belongs to one of eight replicates (pass index modulo 8). The
//! film keeps, per pixel, the total of each replicate and each layer over all
//! replicates: 8 + 4 colours of three 16-byte sums, **576 bytes per pixel**.
//! The replicates are independent estimates of the same picture, so their
//! spread is its noise ([`Film::noise`]).
//!
//! A layer and a total are rounded to the quantum separately: the layers of a
//! picture sum to the picture up to four quanta per pass, which is some 19
//! digits below a typical value.

use rayon::prelude::*;
use thiserror::Error;

use super::{
    image::Image,
    layer::{Layer, PixelSample},
};
use crate::{
    numeric::{ExactSum, exact::Quantum},
    spectrum::Rgb,
};

/// Number of independent sample sequences; pass `i` belongs to number `i % 8`.
pub const REPLICATES: usize = 8;

/// Samples beyond 2^40 times the typical value the quantum was made for are
/// refused: 2^22 of the largest accepted ones fit into a sum before it
/// saturates, and below saturation order cannot matter. The quantum is 2^64
/// times smaller than the typical value.
const RANGE_IN_QUANTA_LOG2: i32 = 64 + 40;

pub(super) type RgbSum = [ExactSum; 3];

/// The sums of a render; see the module's text.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) quantum: Quantum,
    /// Total radiance per pixel, one list per replicate.
    pub(super) replicates: [Vec<RgbSum>; REPLICATES],
    /// Radiance per pixel and layer, over all replicates.
    pub(super) layers: Vec<[RgbSum; 4]>,
    pub(super) passes: [u64; REPLICATES],
    pub(super) refused: u64,
}

/// Two films that do not belong to the same picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MergeError {
    /// The sizes differ.
    #[error("a film of {} x {} pixels cannot take one of {} x {}", .ours[0], .ours[1], .theirs[0], .theirs[1])]
    Size {
        /// Width and height of the film that was to grow.
        ours: [u32; 2],
        /// Width and height of the film that was to be added.
        theirs: [u32; 2],
    },
    /// The sums are counted in different quanta, so they come from different
    /// scenes or settings.
    #[error("the films count light in different quanta: they come from different renders")]
    Quantum,
}

impl Film {
    /// Bytes of state per pixel.
    pub const BYTES_PER_PIXEL: usize = (REPLICATES + Layer::ALL.len()) * size_of::<RgbSum>();

    /// An empty film of `width` x `height` pixels. `quantum` must be the same
    /// for all films that are to be merged, so it is made from the scene.
    pub fn new(width: u32, height: u32, quantum: Quantum) -> Self {
        let n = width as usize * height as usize;
        Self {
            width,
            height,
            quantum,
            replicates: std::array::from_fn(|_| vec![RgbSum::default(); n]),
            layers: vec![Default::default(); n],
            passes: [0; REPLICATES],
            refused: 0,
        }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The unit in which the sums are counted.
    pub fn quantum(&self) -> Quantum {
        self.quantum
    }

    /// Passes added so far, over all replicates.
    pub fn passes(&self) -> u64 {
        self.passes.iter().fold(0, |sum, &n| sum.saturating_add(n))
    }

    /// Passes added so far to each replicate.
    pub fn replicate_passes(&self) -> [u64; REPLICATES] {
        self.passes
    }

    /// Samples that added nothing because a channel was not finite or lay
    /// beyond the range of the sums (2^40 times the quantum's typical value).
    /// A picture with refused samples is too dark where they fell.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Bytes of memory the sums take.
    pub fn bytes(&self) -> usize {
        self.layers.len() * Self::BYTES_PER_PIXEL
    }

    /// Adds pass number `pass_index`; one sample per pixel, row by row from the
    /// top. Rows are added in parallel; no two threads touch the same sum.
    ///
    /// # Panics
    /// If the number of samples is not the number of pixels.
    pub fn add_pass(&mut self, pass_index: u32, samples: &[PixelSample]) {
        assert_eq!(
            samples.len(),
            self.layers.len(),
            "a pass needs one sample per pixel"
        );
        let quantum = self.quantum;
        let limit = libm::ldexp(quantum.unit(), RANGE_IN_QUANTA_LOG2);
        let replicate = pass_index as usize % REPLICATES;
        let width = self.width.max(1) as usize;
        let refused: u64 = self.replicates[replicate]
            .par_chunks_mut(width)
            .zip(self.layers.par_chunks_mut(width))
            .zip(samples.par_chunks(width))
            .map(|((totals, layers), samples)| {
                let mut refused = 0;
                for ((total, layers), sample) in totals.iter_mut().zip(layers).zip(samples) {
                    if is_in_range(sample, limit) {
                        add_sample(total, layers, sample, quantum);
                    } else {
                        refused += 1;
                    }
                }
                refused
            })
            .sum();
        self.refused += refused;
        self.passes[replicate] += 1;
    }

    /// Adds all passes of `other`. The result is the film that would have taken
    /// both films' passes one after the other, to the bit. That the passes are
    /// different ones is for the caller to know.
    ///
    /// # Errors
    /// If the films differ in size or quantum; `self` is then unchanged.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        let (ours, theirs) = ([self.width, self.height], [other.width, other.height]);
        if ours != theirs {
            return Err(MergeError::Size { ours, theirs });
        }
        if self.quantum != other.quantum {
            return Err(MergeError::Quantum);
        }
        for (ours, theirs) in self.replicates.iter_mut().zip(&other.replicates) {
            for (ours, theirs) in ours.iter_mut().zip(theirs) {
                merge_rgb(ours, theirs);
            }
        }
        for (ours, theirs) in self.layers.iter_mut().zip(&other.layers) {
            for (ours, theirs) in ours.iter_mut().zip(theirs) {
                merge_rgb(ours, theirs);
            }
        }
        for (ours, theirs) in self.passes.iter_mut().zip(other.passes) {
            *ours = ours.saturating_add(theirs);
        }
        self.refused = self.refused.saturating_add(other.refused);
        Ok(())
    }

    /// The picture: the mean over all passes, black before the first.
    pub fn image(&self) -> Image {
        let passes = self.passes();
        self.collect(|i| {
            let mut sum = RgbSum::default();
            for replicate in &self.replicates {
                merge_rgb(&mut sum, &replicate[i]);
            }
            self.mean(&sum, passes)
        })
    }

    /// One layer of the picture: the mean over all passes.
    pub fn layer_image(&self, layer: Layer) -> Image {
        let passes = self.passes();
        self.collect(|i| self.mean(&self.layers[i][layer as usize], passes))
    }

    /// The picture as replicate `index` alone sees it, black before its first
    /// pass.
    ///
    /// # Panics
    /// If `index` is not below [`REPLICATES`].
    pub fn replicate_image(&self, index: usize) -> Image {
        self.collect(|i| self.mean(&self.replicates[index][i], self.passes[index]))
    }

    /// The standard error of [`Film::image`] per pixel and channel, from the
    /// spread of the replicates; `None` while fewer than two have passes.
    ///
    /// With equally many passes in each of `r` replicates this is the usual
    /// sqrt(sum (`m_i` - `m`)^2 / (r (r - 1))). Otherwise the squares are weighted
    /// by the passes of each replicate, which assumes that the variance of a
    /// replicate's mean falls with its passes. The estimate has r - 1 degrees
    /// of freedom (seven from the first full round on).
    pub fn noise(&self) -> Option<Image> {
        let used: Vec<usize> = (0..REPLICATES).filter(|&r| self.passes[r] > 0).collect();
        if used.len() < 2 {
            return None;
        }
        let passes = self.passes() as f64;
        let freedom = (used.len() - 1) as f64;
        let mean = self.image();
        Some(self.collect(|i| {
            let mut squares = Rgb::BLACK;
            for &r in &used {
                let difference =
                    self.mean(&self.replicates[r][i], self.passes[r]) - mean.pixels()[i];
                squares += difference * difference * self.passes[r] as f64;
            }
            (squares / (freedom * passes)).map(f64::sqrt)
        }))
    }

    fn mean(&self, sum: &RgbSum, passes: u64) -> Rgb {
        Rgb(sum.map(|s| s.value(self.quantum))) / passes.max(1) as f64
    }

    fn collect(&self, pixel: impl Fn(usize) -> Rgb + Send + Sync) -> Image {
        let pixels = (0..self.layers.len()).into_par_iter().map(pixel).collect();
        Image::new(self.width, self.height, pixels)
    }
}

/// Whether all channels of all layers, and their total, are finite and at most
/// `limit`.
#[inline]
fn is_in_range(sample: &PixelSample, limit: f64) -> bool {
    // NaN compares as false and infinity exceeds every limit.
    let fits = |c: &Rgb| c.0.iter().all(|x| x.abs() <= limit);
    sample.layers.iter().all(fits) && fits(&sample.total())
}

#[inline]
fn add_sample(
    total: &mut RgbSum,
    layers: &mut [RgbSum; 4],
    sample: &PixelSample,
    quantum: Quantum,
) {
    add_rgb(total, sample.total(), quantum);
    for (sum, &value) in layers.iter_mut().zip(&sample.layers) {
        // Most layers of most pixels are empty.
        if !value.is_black() {
            add_rgb(sum, value, quantum);
        }
    }
}

#[inline]
fn add_rgb(sum: &mut RgbSum, value: Rgb, quantum: Quantum) {
    for (s, c) in sum.iter_mut().zip(value.0) {
        s.add(c, quantum);
    }
}

#[inline]
fn merge_rgb(sum: &mut RgbSum, other: &RgbSum) {
    for (s, &o) in sum.iter_mut().zip(other) {
        s.merge(o);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantum() -> Quantum {
        Quantum::for_typical(1.0)
    }

    fn grey(v: f64) -> PixelSample {
        let mut s = PixelSample::default();
        s[Layer::Direct] = Rgb::grey(v);
        s
    }

    #[test]
    fn bytes_are_what_the_text_says() {
        assert_eq!(Film::BYTES_PER_PIXEL, 576);
        assert_eq!(Film::new(5, 3, quantum()).bytes(), 15 * 576);
    }

    #[test]
    fn means_are_over_the_right_passes() {
        let mut film = Film::new(1, 1, quantum());
        assert_eq!(film.image().pixel(0, 0), Rgb::BLACK);
        film.add_pass(0, &[grey(1.0)]);
        film.add_pass(8, &[grey(3.0)]);
        film.add_pass(3, &[grey(8.0)]);
        assert_eq!(film.passes(), 3);
        assert_eq!(film.replicate_passes(), [2, 0, 0, 1, 0, 0, 0, 0]);
        assert_eq!(film.image().pixel(0, 0), Rgb::grey(4.0));
        assert_eq!(film.layer_image(Layer::Direct).pixel(0, 0), Rgb::grey(4.0));
        assert_eq!(film.layer_image(Layer::Caustic).pixel(0, 0), Rgb::BLACK);
        assert_eq!(film.replicate_image(0).pixel(0, 0), Rgb::grey(2.0));
        assert_eq!(film.replicate_image(1).pixel(0, 0), Rgb::BLACK);
        assert_eq!(film.replicate_image(3).pixel(0, 0), Rgb::grey(8.0));
    }

    #[test]
    fn noise_is_the_standard_error_of_the_replicates() {
        let mut film = Film::new(1, 1, quantum());
        assert!(film.noise().is_none());
        film.add_pass(0, &[grey(1.0)]);
        film.add_pass(8, &[grey(1.0)]);
        assert!(film.noise().is_none(), "one replicate has no spread");
        // Replicate means 1, 2, .., 8: sample variance 6, over eight of them.
        let mut film = Film::new(1, 1, quantum());
        for i in 0..8u32 {
            film.add_pass(i, &[grey(f64::from(i))]);
            film.add_pass(i + 8, &[grey(f64::from(i) + 2.0)]);
        }
        let noise = film.noise().unwrap().pixel(0, 0);
        assert!((noise.0[1] - (6.0f64 / 8.0).sqrt()).abs() < 1e-14);
        // Unequal: means 1 (two passes) and 4 (one), mean 2:
        // (2 * 1 + 1 * 4) / 1 / 3 = 2.
        let mut film = Film::new(1, 1, quantum());
        for (pass, v) in [(0, 1.0), (8, 1.0), (1, 4.0)] {
            film.add_pass(pass, &[grey(v)]);
        }
        let noise = film.noise().unwrap().pixel(0, 0);
        assert!((noise.0[0] - 2.0f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn samples_out_of_range_add_nothing_and_are_counted() {
        let mut bad = grey(1.0);
        bad[Layer::Emission] = Rgb::new(0.0, f64::NAN, 0.0);
        let mut film = Film::new(4, 1, quantum());
        let beyond = grey(libm::ldexp(1.0, 41));
        film.add_pass(0, &[bad, grey(f64::INFINITY), beyond, grey(2.0)]);
        assert_eq!(film.refused(), 3);
        for x in 0..3 {
            assert_eq!(film.image().pixel(x, 0), Rgb::BLACK);
            assert_eq!(film.layer_image(Layer::Direct).pixel(x, 0), Rgb::BLACK);
        }
        assert_eq!(film.image().pixel(3, 0), Rgb::grey(2.0));
        film.add_pass(8, &[grey(libm::ldexp(1.0, 40)); 4]);
        assert_eq!(film.refused(), 3, "the edge of the range is inside");
    }

    #[test]
    fn films_of_different_pictures_do_not_merge() {
        let mut film = Film::new(2, 1, quantum());
        let before = film.clone();
        let mut other = Film::new(1, 2, quantum());
        other.add_pass(0, &[grey(1.0); 2]);
        assert_eq!(
            film.merge(&other),
            Err(MergeError::Size {
                ours: [2, 1],
                theirs: [1, 2]
            })
        );
        let mut other = Film::new(2, 1, Quantum::for_typical(5.0));
        other.add_pass(0, &[grey(1.0); 2]);
        assert_eq!(film.merge(&other), Err(MergeError::Quantum));
        assert_eq!(film, before);
    }
}

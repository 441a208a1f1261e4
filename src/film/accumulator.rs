//! Sums over passes whose bits depend neither on the order of the passes nor on
//! how they were grouped.
//!
//! Every pass belongs to one of eight replicates (pass index modulo 8). The
//! film keeps, per pixel, the total of each replicate and each layer over all
//! replicates: 8 + 4 colours of three 16-byte sums, eight sums of what
//! narrower kernels find otherwise, and 24 of 8 bytes and a count of 4 for the
//! sheets of light ([`sheets`](super::sheets)): **904 bytes per pixel**. The replicates
//! are independent estimates of the same picture, so their spread is its noise
//! ([`Film::noise`]). The differences of kernels are summed ([`blur_weight`]) for
//! four groups of replicates apart: the product of two independent estimates of a
//! number has the number's square as its mean, whatever their noise ([`Film::blur`]).
//!
//! A layer and a total are rounded to the quantum separately: the layers of a
//! picture sum to the picture up to four quanta per pass, which is some 19
//! digits below a typical value.

use rayon::prelude::*;
use thiserror::Error;

use super::{
    image::Image,
    layer::{Layer, PixelSample},
    sheets::Sheets,
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

/// Groups of replicates whose differences of kernels are summed apart: two that
/// follow each other make one.
pub(super) const GROUPS: usize = 4;

/// Replicates of a group.
const GROUP: usize = REPLICATES / GROUPS;

/// The group of a replicate.
pub(super) const fn group_of(replicate: usize) -> usize {
    replicate / GROUP
}

/// Rounds of which every pass tells how narrower kernels differ.
const TELLING_ROUNDS: u32 = 6;

/// How often [`PixelSample::blur`] of a pass counts: once in the first six
/// rounds, when little is known of it. Later, one replicate of each group
/// counts twice and need not be asked in the other, where it is 0: a
/// round counts as before, for half the work.
pub const fn blur_weight(pass_index: u32) -> f64 {
    if pass_index < TELLING_ROUNDS * REPLICATES as u32 {
        1.0
    } else if pass_index.is_multiple_of(GROUP as u32) {
        2.0
    } else {
        0.0
    }
}

/// Sums of [`PixelSample::blur`], one for each group of replicates.
type BlurSum = [[ExactSum; 2]; GROUPS];

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
    /// What narrower kernels find otherwise, per pixel.
    pub(super) blur: Vec<BlurSum>,
    /// How many sheets of light there are, per pixel.
    pub(super) sheets: Vec<Sheets>,
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
    pub const BYTES_PER_PIXEL: usize = (REPLICATES + Layer::ALL.len()) * size_of::<RgbSum>()
        + size_of::<BlurSum>()
        + size_of::<Sheets>();

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
            blur: vec![BlurSum::default(); n],
            sheets: vec![Sheets::default(); n],
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
        let weight = blur_weight(pass_index);
        let width = self.width.max(1) as usize;
        let refused: u64 = self.replicates[replicate]
            .par_chunks_mut(width)
            .zip(self.layers.par_chunks_mut(width))
            .zip(self.blur.par_chunks_mut(width))
            .zip(self.sheets.par_chunks_mut(width))
            .zip(samples.par_chunks(width))
            .map(|((((totals, layers), blur), sheets), samples)| {
                let mut refused = 0;
                let sums = totals.iter_mut().zip(layers).zip(blur).zip(sheets);
                for ((((total, layers), blur), sheets), sample) in sums.zip(samples) {
                    if is_in_range(sample, limit) {
                        add_sample(total, layers, sample, quantum);
                        sheets.add(replicate, sample, weight);
                        let group = &mut blur[group_of(replicate)];
                        // Where no photon comes there is none.
                        if weight > 0.0 && sample.blur != [0.0; 2] {
                            for (sum, step) in group.iter_mut().zip(sample.blur) {
                                sum.add(weight * step, quantum);
                            }
                        }
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
        for (ours, theirs) in self.blur.iter_mut().zip(&other.blur) {
            for (ours, theirs) in ours
                .as_flattened_mut()
                .iter_mut()
                .zip(theirs.as_flattened())
            {
                ours.merge(*theirs);
            }
        }
        for (ours, theirs) in self.sheets.iter_mut().zip(&other.sheets) {
            ours.merge(theirs);
        }
        for (ours, theirs) in self.passes.iter_mut().zip(other.passes) {
            *ours = ours.saturating_add(theirs);
        }
        self.refused = self.refused.saturating_add(other.refused);
        Ok(())
    }

    /// The picture: the mean over all passes without what the sheets of light tell to
    /// be there by chance ([`sheets`](super::sheets)), black before the first pass.
    pub fn image(&self) -> Image {
        let passes = self.passes();
        self.collect(|i| {
            let mut sum = RgbSum::default();
            for replicate in &self.replicates {
                merge_rgb(&mut sum, &replicate[i]);
            }
            self.mean(&sum, passes) - self.by_chance(i)
        })
    }

    /// One layer of the picture: what is there by chance is part of
    /// [`Layer::Caustic`].
    pub fn layer_image(&self, layer: Layer) -> Image {
        let passes = self.passes();
        self.collect(|i| {
            let mean = self.mean(&self.layers[i][layer as usize], passes);
            match layer {
                Layer::Caustic => mean - self.by_chance(i),
                _ => mean,
            }
        })
    }

    /// What [`Film::image`] leaves out of a pixel.
    fn by_chance(&self, pixel: usize) -> Rgb {
        self.excess(pixel).map_or(Rgb::BLACK, |excess| excess.mean)
    }

    /// The mean over the passes of replicate `index` alone, as they were gathered,
    /// black before the first.
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
        if self.passes.iter().filter(|&&n| n > 0).count() < 2 {
            return None;
        }
        Some(self.collect(|i| self.spread_at(i).1.map(f64::sqrt)))
    }

    /// What each replicate alone sees at one pixel, given by its number row by
    /// row, without what is there by chance, black before its first pass; and the
    /// square of [`Film::noise`] there, black while fewer than two replicates have
    /// passes.
    ///
    /// # Panics
    /// Outside the film.
    pub fn spread_at(&self, pixel: usize) -> ([Rgb; REPLICATES], Rgb) {
        let weights = self.passes.map(|n| n as f64);
        let mut replicates: [Rgb; REPLICATES] =
            std::array::from_fn(|r| self.mean_of(&self.replicates[r][pixel], weights[r]));
        let passes = self.passes().max(1) as f64;
        let mean_of = |replicates: &[Rgb; REPLICATES]| {
            let weighted = replicates.iter().zip(weights);
            weighted.fold(Rgb::BLACK, |sum, (&r, n)| sum + r * n) / passes
        };
        let mut mean = mean_of(&replicates);
        if let Some(excess) = self.excess(pixel) {
            mean = mean - excess.mean;
            let seen = replicates.iter_mut().zip(excess.replicates).zip(weights);
            for ((replicate, by_chance), _) in seen.filter(|(_, n)| *n > 0.0) {
                *replicate = mean + (*replicate - by_chance - mean) * excess.widening;
            }
        }
        let mut squares = Rgb::BLACK;
        for (&replicate, n) in replicates.iter().zip(weights) {
            // Those without passes have no weight.
            let difference = replicate - mean;
            squares += difference * difference * n;
        }
        let used = weights.iter().filter(|&&n| n > 0.0).count();
        let variance = if used > 1 {
            squares / ((used - 1) as f64 * passes)
        } else {
            Rgb::BLACK
        };
        (replicates, variance)
    }

    /// The means of [`PixelSample::blur`] over the passes of each group of
    /// replicates that has any, weighted by [`blur_weight`]: row by row. After an
    /// even number of a group's passes the weights are on average one, in between
    /// one more or less of all its passes. The groups are independent estimates of
    /// one thing. What chance brings into a pixel, it brings into narrower kernels,
    /// too: what the picture is without ([`Film::image`]) is none of the difference.
    pub fn blur(&self) -> Vec<Vec<[f64; 2]>> {
        let per_sheet = |pixel| self.excess(pixel).map_or(0.0, |excess| excess.per_sheet);
        let pixels = (0..self.blur.len()).into_par_iter();
        let per_sheet: Vec<f64> = pixels.map(per_sheet).collect();
        let of_group = |group: usize| {
            let passes: u64 = self.passes[group * GROUP..][..GROUP].iter().sum();
            let mean = |((sums, sheets), &per_sheet): ((&BlurSum, &Sheets), &f64)| {
                let sums = sums[group].map(|s| s.value(self.quantum));
                let by_chance = sheets.steps_by_chance(group, per_sheet);
                [0, 1].map(|step| (sums[step] - by_chance[step]) / passes as f64)
            };
            let pixels = self.blur.par_iter().zip(&self.sheets).zip(&per_sheet);
            (passes > 0).then(|| pixels.map(mean).collect())
        };
        (0..GROUPS).filter_map(of_group).collect()
    }

    pub(super) fn mean(&self, sum: &RgbSum, passes: u64) -> Rgb {
        self.mean_of(sum, passes as f64)
    }

    #[inline]
    pub(super) fn mean_of(&self, sum: &RgbSum, passes: f64) -> Rgb {
        Rgb(sum.map(|s| s.value(self.quantum))) / passes.max(1.0)
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
mod tests;

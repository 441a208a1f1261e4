//! The parts a picture is made of, and one pixel's share of a pass.

use std::ops::{AddAssign, Div, Index, IndexMut};

use crate::spectrum::Rgb;

/// A part of the light, by the kind of path that carried it. The parts sum to
/// the picture: every path belongs to exactly one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Light that comes straight from a light source to a finite lobe.
    Direct,
    /// Light gathered from the photon map.
    Caustic,
    /// Light that met two or more diffuse surfaces.
    Indirect,
    /// Light sources seen by the camera, directly or through mirrors and glass.
    Emission,
}

impl Layer {
    /// Every layer, in the order in which they are stored.
    pub const ALL: [Self; 4] = [Self::Direct, Self::Caustic, Self::Indirect, Self::Emission];

    /// The name in files: `direct`, `caustic`, `indirect`, `emission`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Caustic => "caustic",
            Self::Indirect => "indirect",
            Self::Emission => "emission",
        }
    }
}

/// What one pass found for one pixel: radiance per layer, in W/m2/sr.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSample {
    /// One entry per [`Layer`], in the order of [`Layer::ALL`].
    pub layers: [Rgb; 4],
    /// How much less light narrower kernels find of the same photons, mean
    /// over the channels: when all kernels shrink to half their area, and again
    /// when these shrink to half of theirs. Zero where nothing is gathered, and in
    /// passes that do not count ([`blur_weight`](super::blur_weight)).
    pub blur: [f64; 2],
    /// How many sheets of light lie over what is seen, times a weight, and that
    /// weight: in the pixel and, summed, in those around. The weight is 0 where that is
    /// not told. See [`Gathered::sheets`](crate::photon::Gathered::sheets).
    pub sheets: [[f64; 2]; 2],
    /// How many fewer sheets narrower kernels find, as [`Self::blur`] has it for the
    /// light, times the weight of [`Self::sheets`] in the pixel.
    pub sheet_steps: [f64; 2],
}

impl PixelSample {
    /// The sum of the layers, in the order of [`Layer::ALL`].
    #[inline]
    pub fn total(&self) -> Rgb {
        let [a, b, c, d] = self.layers;
        a + b + c + d
    }
}

impl AddAssign for PixelSample {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        for (sum, more) in self.layers.iter_mut().zip(other.layers) {
            *sum += more;
        }
        for (sum, more) in self.blur.iter_mut().zip(other.blur) {
            *sum += more;
        }
        let more = other.sheets.as_flattened();
        for (sum, &more) in self.sheets.as_flattened_mut().iter_mut().zip(more) {
            *sum += more;
        }
        for (sum, more) in self.sheet_steps.iter_mut().zip(other.sheet_steps) {
            *sum += more;
        }
    }
}

impl Div<f64> for PixelSample {
    type Output = Self;
    #[inline]
    fn div(self, by: f64) -> Self {
        Self {
            layers: self.layers.map(|l| l / by),
            blur: self.blur.map(|b| b / by),
            sheets: self.sheets.map(|s| s.map(|x| x / by)),
            sheet_steps: self.sheet_steps.map(|s| s / by),
        }
    }
}

impl Index<Layer> for PixelSample {
    type Output = Rgb;
    #[inline]
    fn index(&self, layer: Layer) -> &Rgb {
        &self.layers[layer as usize]
    }
}

impl IndexMut<Layer> for PixelSample {
    #[inline]
    fn index_mut(&mut self, layer: Layer) -> &mut Rgb {
        &mut self.layers[layer as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_indexes_its_own_entry() {
        for (i, layer) in Layer::ALL.into_iter().enumerate() {
            let mut s = PixelSample::default();
            s[layer] = Rgb::grey(2.0);
            assert_eq!(s.layers[i], Rgb::grey(2.0), "{}", layer.name());
            assert_eq!(s.total(), Rgb::grey(2.0));
        }
    }
}

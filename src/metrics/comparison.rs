//! All measures of two pictures at once, for the whole and for regions.
//!
//! Pixels are measured in the whole picture, with its mean, its exposures and
//! the neighbours beyond a region's edge; a region's score is taken over its
//! pixels. So the scores of regions do not depend on how they were cut, and
//! means over parts add up to the mean over the whole.

use super::{
    flip::flip,
    hdr_flip::{Exposures, hdr_flip},
    image_error::{
        SizeMismatch, absolute_errors, check_sizes, relative_errors, squared_errors, trimmed_mean,
    },
    plane::{Plane, Region, mean},
    ssim::Ssim,
};
use crate::{film::Image, spectrum::Rgb};

/// Share of the worst pixels that the trimmed relMSE leaves out.
const TRIMMED: f64 = 0.001;

/// A measure of the difference between a picture and a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// Root of the mean squared difference; see [`super::rmse`].
    Rmse,
    /// Mean absolute difference; see [`super::mae`].
    Mae,
    /// Relative mean squared error; see [`super::relmse`].
    RelMse,
    /// The same without the worst 0.1 % of the pixels.
    RelMseTrimmed,
    /// Mean over mean of the reference; see [`super::mean_ratio`].
    MeanRatio,
    /// Structural similarity; see [`Ssim`].
    Ssim,
    /// Mean of LDR-FLIP; see [`super::flip`](fn@super::flip).
    Flip,
    /// Mean of HDR-FLIP; see [`super::hdr_flip`](fn@super::hdr_flip).
    HdrFlip,
}

impl Metric {
    /// Every metric, in the order in which they are shown.
    pub const ALL: [Self; 8] = [
        Self::Rmse,
        Self::Mae,
        Self::RelMse,
        Self::RelMseTrimmed,
        Self::MeanRatio,
        Self::Ssim,
        Self::Flip,
        Self::HdrFlip,
    ];

    /// Its name on the command line and in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rmse => "rmse",
            Self::Mae => "mae",
            Self::RelMse => "relmse",
            Self::RelMseTrimmed => "relmse-trimmed",
            Self::MeanRatio => "mean-ratio",
            Self::Ssim => "ssim",
            Self::Flip => "flip",
            Self::HdrFlip => "hdr-flip",
        }
    }
}

/// What the values of pictures mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// What a screen shows: linear, 0..=1.
    Display,
    /// Linear radiance without bound.
    Radiance {
        /// The factor by which SSIM and LDR-FLIP expose both pictures before
        /// they clip them to what a screen shows.
        exposure: f64,
    },
}

/// A number for every pixel that a picture can be made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// Mean absolute difference of the channels, in the unit of the pictures.
    Abs,
    /// Root of the mean squared relative error of the channels: 0.05 is 5 %.
    RelMse,
    /// LDR-FLIP.
    Flip,
    /// HDR-FLIP.
    HdrFlip,
}

/// The value of a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// The metric.
    pub metric: Metric,
    /// None where it is not defined: HDR-FLIP of what a screen shows or against
    /// a reference without light, SSIM where no window fits, the ratio of
    /// means where the reference is black.
    pub value: Option<f64>,
}

/// The errors of one picture against a reference, pixel by pixel.
#[derive(Clone, Debug)]
pub struct Comparison {
    metrics: Vec<Metric>,
    squared: Plane,
    absolute: Plane,
    relative: Plane,
    means: [Plane; 2],
    ssim: Option<Ssim>,
    flip: Option<Plane>,
    hdr_flip: Option<Plane>,
}

impl Comparison {
    /// Measures `image` against `reference`: all that `metrics` and `map` need.
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn new(
        image: &Image,
        reference: &Image,
        light: Light,
        metrics: &[Metric],
        map: Option<Map>,
    ) -> Result<Self, SizeMismatch> {
        check_sizes(image, reference)?;
        let wants = |metric| metrics.contains(&metric);
        let shown = [image, reference].map(|picture| display(picture, light));
        let [a, b] = &shown;
        let ssim = wants(Metric::Ssim).then(|| Ssim::new(a, b)).transpose()?;
        let wants_flip = wants(Metric::Flip) || map == Some(Map::Flip);
        let flip = wants_flip.then(|| flip(a, b)).transpose()?;
        let wants_hdr = wants(Metric::HdrFlip) || map == Some(Map::HdrFlip);
        let hdr_flip = match light {
            Light::Radiance { .. } if wants_hdr => high_range(image, reference)?,
            _ => None,
        };
        Ok(Self {
            metrics: metrics.to_vec(),
            squared: squared_errors(image, reference)?,
            absolute: absolute_errors(image, reference)?,
            relative: relative_errors(image, reference)?,
            means: [image, reference].map(|picture| Plane::of(picture, Rgb::mean)),
            ssim,
            flip,
            hdr_flip,
        })
    }

    /// The metrics that were asked for, over the pixels of `region`.
    ///
    /// # Panics
    /// If the region has no pixels or does not lie inside.
    pub fn scores(&self, region: Region) -> Vec<Score> {
        let score = |&metric: &Metric| Score {
            metric,
            value: self.value(metric, region),
        };
        self.metrics.iter().map(score).collect()
    }

    fn value(&self, metric: Metric, region: Region) -> Option<f64> {
        let over = |plane: &Plane| mean(&plane.values_in(region));
        match metric {
            Metric::Rmse => Some(over(&self.squared).sqrt()),
            Metric::Mae => Some(over(&self.absolute)),
            Metric::RelMse => Some(over(&self.relative)),
            Metric::RelMseTrimmed => Some(trimmed_mean(self.relative.values_in(region), TRIMMED)),
            Metric::MeanRatio => {
                let ratio = over(&self.means[0]) / over(&self.means[1]);
                ratio.is_finite().then_some(ratio)
            }
            Metric::Ssim => self.ssim.as_ref()?.mean_in(region),
            Metric::Flip => self.flip.as_ref().map(over),
            Metric::HdrFlip => self.hdr_flip.as_ref().map(over),
        }
    }

    /// The map that was asked for, pixel by pixel; none for a FLIP that was not
    /// asked for or is not defined.
    pub fn map(&self, map: Map) -> Option<Plane> {
        match map {
            Map::Abs => Some(self.absolute.clone()),
            Map::RelMse => Some(Plane::join(&self.relative, &self.relative, |e, _| e.sqrt())),
            Map::Flip => self.flip.clone(),
            Map::HdrFlip => self.hdr_flip.clone(),
        }
    }
}

/// The picture as SSIM and LDR-FLIP see it.
fn display(picture: &Image, light: Light) -> Image {
    let factor = match light {
        Light::Display => 1.0,
        Light::Radiance { exposure } => exposure,
    };
    let pixels = picture.pixels().iter().map(|&p| p * factor);
    Image::new(picture.width(), picture.height(), pixels.collect())
}

/// HDR-FLIP, where the reference has light to expose for or nothing differs.
fn high_range(image: &Image, reference: &Image) -> Result<Option<Plane>, SizeMismatch> {
    match Exposures::of(reference) {
        Some(exposures) => hdr_flip(image, reference, exposures).map(Some),
        None if image == reference => Ok(Some(Plane::of(image, |_| 0.0))),
        None => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics;

    const LIGHT: Light = Light::Radiance { exposure: 0.25 };

    /// Two pictures with errors everywhere, worst in one corner.
    fn pictures() -> [Image; 2] {
        let value = |x: u32, y: u32| f64::from(1 + (7 * x + 5 * y) % 11);
        let reference = Image::from_fn(24, 20, |x, y| Rgb::new(value(x, y), value(y, x), 0.5));
        let image = Image::from_fn(24, 20, |x, y| {
            let error = if x < 2 && y < 2 {
                2.0
            } else {
                1.0 + 0.01 * value(x, y)
            };
            reference.pixel(x, y) * error
        });
        [image, reference]
    }

    fn region(x: u32, y: u32, width: u32, height: u32) -> Region {
        Region {
            origin: [x, y],
            size: [width, height],
        }
    }

    fn value(scores: &[Score], metric: Metric) -> Option<f64> {
        let score = scores.iter().find(|score| score.metric == metric);
        score.expect("it was asked for").value
    }

    #[test]
    fn the_whole_is_what_the_functions_say() {
        let [a, b] = pictures();
        let found = Comparison::new(&a, &b, LIGHT, &Metric::ALL, None).unwrap();
        let scores = found.scores(Region::whole(&a));
        let shown = [&a, &b].map(|picture| display(picture, LIGHT));
        let exposures = Exposures::of(&b).unwrap();
        for (metric, expected) in [
            (Metric::Rmse, metrics::rmse(&a, &b).unwrap()),
            (Metric::Mae, metrics::mae(&a, &b).unwrap()),
            (Metric::RelMse, metrics::relmse(&a, &b).unwrap()),
            (
                Metric::RelMseTrimmed,
                metrics::relmse_trimmed(&a, &b, TRIMMED).unwrap(),
            ),
            (Metric::Flip, flip(&shown[0], &shown[1]).unwrap().mean()),
            (Metric::HdrFlip, hdr_flip(&a, &b, exposures).unwrap().mean()),
        ] {
            assert_eq!(value(&scores, metric), Some(expected), "{metric:?}");
        }
        // Summed in another order.
        let ratio = value(&scores, Metric::MeanRatio).unwrap();
        assert!((ratio - metrics::mean_ratio(&a, &b).unwrap()).abs() < 1e-13);
    }

    /// The mean over the whole is that over its halves.
    #[test]
    fn regions_add_up() {
        let [a, b] = pictures();
        let found = Comparison::new(&a, &b, LIGHT, &Metric::ALL, None).unwrap();
        let whole = found.scores(Region::whole(&a));
        let halves = [region(0, 0, 24, 10), region(0, 10, 24, 10)].map(|r| found.scores(r));
        for metric in [Metric::Mae, Metric::RelMse, Metric::Flip, Metric::HdrFlip] {
            let [top, bottom] = halves.each_ref().map(|h| value(h, metric).unwrap());
            let both = value(&whole, metric).unwrap();
            assert!((0.5 * (top + bottom) - both).abs() < 1e-14, "{metric:?}");
            assert!(top > bottom, "the bad corner is at the top: {metric:?}");
        }
    }

    #[test]
    fn what_is_not_defined_has_no_value() {
        let [a, b] = pictures();
        let found = Comparison::new(&a, &b, Light::Display, &Metric::ALL, None).unwrap();
        let scores = found.scores(region(0, 0, 5, 5));
        assert_eq!(value(&scores, Metric::HdrFlip), None);
        assert_eq!(value(&scores, Metric::Ssim), None, "no window fits");
        let black = Image::from_fn(24, 20, |_, _| Rgb::BLACK);
        let found = Comparison::new(&a, &black, LIGHT, &Metric::ALL, None).unwrap();
        let scores = found.scores(Region::whole(&a));
        assert_eq!(value(&scores, Metric::HdrFlip), None);
        assert_eq!(value(&scores, Metric::MeanRatio), None);
        assert_eq!(value(&scores, Metric::RelMse), Some(f64::INFINITY));
        let same = Comparison::new(&black, &black, LIGHT, &Metric::ALL, None).unwrap();
        let scores = same.scores(Region::whole(&a));
        assert_eq!(value(&scores, Metric::HdrFlip), Some(0.0));
        assert_eq!(value(&scores, Metric::RelMse), Some(0.0));
    }

    #[test]
    fn maps_have_the_metrics_as_means() {
        let [a, b] = pictures();
        let map = |kind| {
            let found = Comparison::new(&a, &b, LIGHT, &[], Some(kind)).unwrap();
            found.map(kind).unwrap()
        };
        assert_eq!(map(Map::Abs).mean(), metrics::mae(&a, &b).unwrap());
        let squares: f64 = map(Map::RelMse).values().iter().map(|e| e * e).sum();
        let relmse = metrics::relmse(&a, &b).unwrap();
        assert!((squares / 480.0 - relmse).abs() < 1e-13 * relmse);
        let exposures = Exposures::of(&b).unwrap();
        assert_eq!(map(Map::HdrFlip), hdr_flip(&a, &b, exposures).unwrap());
        assert!(map(Map::Flip).mean() > 0.0);
    }
}

//! Scenes whose caustic is known exactly, pixel by pixel.
//!
//! A reference holds everything that the renderer's `caustic` layer holds:
//! for the ball also the light that is reflected on its outside and the light
//! that is reflected within, as often as matters. It is the irradiance on the
//! floor, averaged over each of the pixels of a square window.

mod ball;
mod case;
mod rings;
mod waves;

pub(crate) use ball::{Ball, Incidence, Source, frame, landing};
pub(crate) use case::{CASES, Case, Optics};
pub(crate) use waves::Sheet;

use nephroid::{film::Image, metrics::relmse, spectrum::Rgb};

/// A square on the floor, centred under the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    /// Width in metres.
    pub(crate) width: f64,
    /// Pixels along a side, an even number.
    pub(crate) pixels: u32,
}

impl Window {
    /// Pixels to a metre.
    pub(crate) fn per_metre(self) -> f64 {
        f64::from(self.pixels) / self.width
    }

    /// The pixel in which a point of the floor lies.
    pub(crate) fn pixel(self, x: f64, y: f64) -> Option<usize> {
        let half = 0.5 * self.width;
        let column = (x + half) * self.per_metre();
        // Rows run downwards.
        let row = (half - y) * self.per_metre();
        let inside = 0.0..f64::from(self.pixels);
        (inside.contains(&column) && inside.contains(&row))
            .then(|| row as usize * self.pixels as usize + column as usize)
    }

    /// The picture of a list of irradiances, one a pixel.
    pub(crate) fn image(self, irradiance: impl Iterator<Item = f64>) -> Image {
        let pixels = irradiance.map(Rgb::grey).collect();
        Image::new(self.pixels, self.pixels, pixels)
    }
}

/// What is known of a scene.
pub(crate) struct Reference {
    /// Irradiance on the floor in W/m2.
    pub(crate) image: Image,
    /// Its own error: relMSE against the same with half the work.
    pub(crate) error: f64,
}

impl Reference {
    /// The mean of two estimates with half the work each. Their difference is
    /// twice the error of the mean where the errors are independent.
    fn of_halves(a: &Image, b: &Image) -> Self {
        let image = Image::from_fn(a.width(), a.height(), |x, y| {
            (a.pixel(x, y) + b.pixel(x, y)) * 0.5
        });
        Self {
            error: 0.25 * relmse(a, b).unwrap_or(f64::NAN),
            image,
        }
    }
}

/// Reflectance of an interface for unpolarised light, from the cosines on the
/// side of the light and beyond, and the index there over the index here
/// (Fresnel's equations; Born and Wolf 1999, section 1.5.2).
pub(crate) fn reflectance(cos_i: f64, cos_t: f64, index: f64) -> f64 {
    let s = (cos_i - index * cos_t) / (cos_i + index * cos_t);
    let p = (index * cos_i - cos_t) / (index * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

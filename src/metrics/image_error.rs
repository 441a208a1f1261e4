//! Errors of a picture against a reference.
//!
//! relMSE is the mean over pixels and channels of
//! (x - ref)^2 / (ref^2 + 0.01 mean(ref)^2),
//! where mean(ref) is one number, over all pixels and channels. The second term
//! keeps dark pixels from deciding alone: below a tenth of the mean an error
//! counts as if the pixel were that bright.

use thiserror::Error;

use super::plane::{Plane, mean};
use crate::{film::Image, spectrum::Rgb};

/// Weight of the squared mean in the denominator of relMSE.
const MEAN_WEIGHT: f64 = 0.01;

/// Two images of different sizes cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the images differ in size: {} x {} and {} x {}", .image[0], .image[1], .reference[0], .reference[1])]
pub struct SizeMismatch {
    /// Width and height of the image.
    pub image: [u32; 2],
    /// Width and height of the reference.
    pub reference: [u32; 2],
}

/// Relative mean squared error of `image` against `reference`; see the
/// module's text. Zero where they agree, even in the dark; not a number for
/// images without pixels, infinite for a black reference that is not met.
///
/// # Errors
/// If the sizes differ.
pub fn relmse(image: &Image, reference: &Image) -> Result<f64, SizeMismatch> {
    Ok(relative_errors(image, reference)?.mean())
}

/// As [`relmse`], without the worst pixels: the squared relative errors are
/// averaged over the channels of each pixel, sorted, and the largest `fraction`
/// of them is dropped (0.001 is the custom here). At least one pixel stays.
///
/// # Errors
/// If the sizes differ.
pub fn relmse_trimmed(
    image: &Image,
    reference: &Image,
    fraction: f64,
) -> Result<f64, SizeMismatch> {
    let errors = relative_errors(image, reference)?;
    Ok(trimmed_mean(errors.values().to_vec(), fraction))
}

/// Root of the mean squared difference over pixels and channels, in the unit of
/// the images.
///
/// # Errors
/// If the sizes differ.
pub fn rmse(image: &Image, reference: &Image) -> Result<f64, SizeMismatch> {
    Ok(squared_errors(image, reference)?.mean().sqrt())
}

/// Mean absolute difference over pixels and channels, in the unit of the
/// images.
///
/// # Errors
/// If the sizes differ.
pub fn mae(image: &Image, reference: &Image) -> Result<f64, SizeMismatch> {
    Ok(absolute_errors(image, reference)?.mean())
}

/// Mean of `image` over mean of `reference`, both over pixels and channels: 1
/// where no light is lost or made.
///
/// # Errors
/// If the sizes differ.
pub fn mean_ratio(image: &Image, reference: &Image) -> Result<f64, SizeMismatch> {
    check_sizes(image, reference)?;
    Ok(image.mean().mean() / reference.mean().mean())
}

/// Each pixel's squared relative error, averaged over its channels: the mean of
/// the plane is [`relmse`].
///
/// # Errors
/// If the sizes differ.
pub fn relative_errors(image: &Image, reference: &Image) -> Result<Plane, SizeMismatch> {
    let mean = reference.mean().mean();
    let floor = MEAN_WEIGHT * mean * mean;
    by_pixel(image, reference, |x, r| {
        // Where both are black, a black reference would divide nought by nought.
        if x == r {
            0.0
        } else {
            (x - r) * (x - r) / (r * r + floor)
        }
    })
}

/// Each pixel's squared difference, averaged over its channels.
///
/// # Errors
/// If the sizes differ.
pub fn squared_errors(image: &Image, reference: &Image) -> Result<Plane, SizeMismatch> {
    by_pixel(image, reference, |x, r| (x - r) * (x - r))
}

/// Each pixel's absolute difference, averaged over its channels.
///
/// # Errors
/// If the sizes differ.
pub fn absolute_errors(image: &Image, reference: &Image) -> Result<Plane, SizeMismatch> {
    by_pixel(image, reference, |x, r| (x - r).abs())
}

fn by_pixel(
    image: &Image,
    reference: &Image,
    error: impl Fn(f64, f64) -> f64,
) -> Result<Plane, SizeMismatch> {
    check_sizes(image, reference)?;
    let both = image.pixels().iter().zip(reference.pixels());
    let values = both.map(|(x, r)| {
        let channels: [f64; 3] = std::array::from_fn(|c| error(x[c], r[c]));
        Rgb(channels).mean()
    });
    let (width, height) = (image.width() as usize, image.height() as usize);
    Ok(Plane::new(width, height, values.collect()))
}

/// The mean without the largest `fraction` of the values; at least one stays.
pub(super) fn trimmed_mean(mut values: Vec<f64>, fraction: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    // Rounded down, as the definition has it.
    let kept = (values.len() as f64 * (1.0 - fraction)) as usize;
    values.truncate(kept.max(1));
    mean(&values)
}

pub(super) fn check_sizes(image: &Image, reference: &Image) -> Result<(), SizeMismatch> {
    let sizes = SizeMismatch {
        image: [image.width(), image.height()],
        reference: [reference.width(), reference.height()],
    };
    if sizes.image == sizes.reference {
        Ok(())
    } else {
        Err(sizes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[[f64; 3]]) -> Image {
        let pixels = values.iter().map(|&v| Rgb(v)).collect();
        Image::new(values.len() as u32, 1, pixels)
    }

    fn close(value: f64, expected: f64) {
        assert!(
            (value - expected).abs() <= 1e-14 * expected.abs(),
            "{value} is not {expected}"
        );
    }

    /// Reference 1, 2, 3 | 0, 0, 6: mean 2, floor 0.04.
    const REFERENCE: [[f64; 3]; 2] = [[1.0, 2.0, 3.0], [0.0, 0.0, 6.0]];

    #[test]
    fn hand_computed_values() {
        let reference = row(&REFERENCE);
        let image = row(&[[2.0, 2.0, 3.0], [0.2, 0.0, 3.0]]);
        let [a, b, c] = [1.0 / 1.04, 0.04 / 0.04, 9.0 / 36.04];
        close(relmse(&image, &reference).unwrap(), (a + b + c) / 6.0);
        close(
            relmse_trimmed(&image, &reference, 0.5).unwrap(),
            (a / 3.0).min((b + c) / 3.0),
        );
        // A fraction too small for this few pixels still drops one, since the
        // kept number is rounded down.
        close(
            relmse_trimmed(&image, &reference, 0.001).unwrap(),
            (a / 3.0).min((b + c) / 3.0),
        );
        close(
            relmse_trimmed(&image, &reference, 0.0).unwrap(),
            relmse(&image, &reference).unwrap(),
        );
        close(
            rmse(&image, &reference).unwrap(),
            ((1.0 + 0.04 + 9.0) / 6.0f64).sqrt(),
        );
        close(mae(&image, &reference).unwrap(), (1.0 + 0.2 + 3.0) / 6.0);
        close(mean_ratio(&image, &reference).unwrap(), 10.2 / 12.0);
    }

    #[test]
    fn a_black_reference_can_be_met() {
        let black = row(&[[0.0; 3]; 2]);
        assert_eq!(relmse(&black, &black), Ok(0.0));
        let glint = row(&[[0.0; 3], [0.0, 1e-9, 0.0]]);
        assert_eq!(relmse(&glint, &black), Ok(f64::INFINITY));
    }

    #[test]
    fn one_pixel_always_stays() {
        let reference = row(&[[1.0; 3]]);
        let image = row(&[[2.0; 3]]);
        close(relmse_trimmed(&image, &reference, 0.9).unwrap(), 1.0 / 1.01);
    }

    #[test]
    fn relmse_does_not_know_the_unit() {
        let reference = row(&REFERENCE);
        let image = row(&[[2.0, 2.5, 3.0], [0.2, 0.1, 3.0]]);
        let scaled = |i: &Image| {
            let pixels = i.pixels().iter().map(|&p| p * 1e6).collect();
            Image::new(i.width(), i.height(), pixels)
        };
        close(
            relmse(&scaled(&image), &scaled(&reference)).unwrap(),
            relmse(&image, &reference).unwrap(),
        );
    }

    #[test]
    fn sizes_must_agree() {
        let wide = row(&[[1.0; 3]; 2]);
        let high = Image::new(1, 2, vec![Rgb::WHITE; 2]);
        let expected = Err(SizeMismatch {
            image: [2, 1],
            reference: [1, 2],
        });
        assert_eq!(relmse(&wide, &high), expected);
        assert_eq!(relmse_trimmed(&wide, &high, 0.1), expected);
        assert_eq!(rmse(&wide, &high), expected);
        assert_eq!(mae(&wide, &high), expected);
        assert_eq!(mean_ratio(&wide, &high), expected);
    }
}

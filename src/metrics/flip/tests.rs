use super::*;
use crate::{
    metrics::{
        Ssim,
        hdr_flip::{Exposures, hdr_flip},
        plane::Region,
    },
    spectrum::srgb_linear,
};

const SIZE: [u32; 2] = [67, 45];

/// A busy pattern of codes 0..=255, in whole numbers, so that whoever repeats
/// it has the very same picture.
fn texture(x: i64, y: i64) -> [i64; 3] {
    let wave = |a: i64, b: i64, k: i64| (x * a + y * b + x * y / k).rem_euclid(256);
    [wave(3, 5, 7), wave(2, 7, 11), wave(7, 1, 5)]
}

/// Noise of -20..=20.
fn noise(x: i64, y: i64) -> i64 {
    (x * 73 + y * 151 + x * y % 17 * 29) % 41 - 20
}

fn picture(f: impl Fn(i64, i64) -> Rgb) -> Image {
    Image::from_fn(SIZE[0], SIZE[1], |x, y| f(i64::from(x), i64::from(y)))
}

/// A picture from sRGB codes.
fn coded(codes: impl Fn(i64, i64) -> [i64; 3]) -> Image {
    picture(|x, y| Rgb(codes(x, y).map(|code| srgb_linear(code as f64 / 255.0))))
}

fn plain() -> Image {
    coded(texture)
}

/// Shifted by a pixel to the right, round the edge.
fn shifted() -> Image {
    coded(|x, y| texture((x - 1).rem_euclid(67), y))
}

/// Inverted in a rectangle.
fn boxed() -> Image {
    coded(|x, y| {
        let inside = (20..35).contains(&x) && (10..30).contains(&y);
        texture(x, y).map(|c| if inside { 255 - c } else { c })
    })
}

fn noisy() -> Image {
    coded(|x, y| texture(x, y).map(|c| (c + noise(x, y)).clamp(0, 255)))
}

fn grey() -> Image {
    coded(|_, _| [100; 3])
}

fn dotted() -> Image {
    coded(|x, y| [if (x, y) == (30, 20) { 255 } else { 100 }; 3])
}

fn ramp(tint: i64) -> Image {
    coded(|x, _| [3 * x, 3 * x, 3 * x + tint])
}

/// The published tool computes in single precision. Its values are good to
/// about 1e-5 of themselves; where hardly anything differs, a lightness of 100 is
/// rounded by 4e-6, and the exponent of 0.7 raises what that makes.
fn near(value: f64, published: f64, what: &str) {
    assert!(
        (value - published).abs() <= 1e-5 * published + 4e-6,
        "{what}: {value}, published {published}"
    );
}

/// Mean, maximum, and the value of the pixel (30, 20), from `flip-evaluator`
/// 1.7 (the authors' package), called as LDR with its defaults.
#[test]
fn agrees_with_the_published_tool() {
    for (name, image, reference, mean, largest, inside) in [
        (
            "shift",
            shifted(),
            plain(),
            0.267272323,
            0.981725,
            0.3789638,
        ),
        ("box", boxed(), plain(), 0.141977206, 0.984780, 0.9678852),
        ("noise", noisy(), plain(), 0.085809380, 0.219516, 0.1222506),
        ("dot", dotted(), grey(), 0.001852799, 0.468655, 0.4686546),
        ("tint", ramp(20), ramp(0), 0.193057761, 0.275165, 0.1971629),
    ] {
        let found = flip(&image, &reference).unwrap();
        near(found.mean(), mean, name);
        near(
            found.values().iter().copied().fold(0.0, f64::max),
            largest,
            name,
        );
        near(found.row(20)[30], inside, name);
    }
}

/// From `scikit-image` 0.26.0 for the same luma: `structural_similarity` with
/// `gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
/// data_range=1`.
#[test]
fn ssim_agrees_with_a_published_one() {
    for (name, image, reference, expected) in [
        ("shift", shifted(), plain(), 0.829353153066772),
        ("box", boxed(), plain(), 0.698675047285022),
        ("noise", noisy(), plain(), 0.846974904588086),
        ("dot", dotted(), grey(), 0.976004906441734),
        ("tint", ramp(20), ramp(0), 0.999608366399351),
    ] {
        let found = Ssim::new(&image, &reference).unwrap();
        let found = found.mean_in(Region::whole(&image)).unwrap();
        // Differences of squares of order one, over constants of 1e-4.
        assert!((found - expected).abs() < 1e-11, "{name}: {found}");
    }
}

/// Radiances up to 512 about a bright disc.
fn bright() -> Image {
    picture(|x, y| {
        let disc = (x - 40) * (x - 40) + (y - 22) * (y - 22) < 50;
        let factor = if disc { 2.0 } else { 1.0 / 32.0 };
        Rgb(texture(x, y).map(|c| (c + 1) as f64 * factor))
    })
}

fn scaled(image: &Image, factor: f64) -> Image {
    let pixels = image.pixels().iter().map(|&p| p * factor);
    Image::new(image.width(), image.height(), pixels.collect())
}

/// As above, called as HDR: mean, maximum, and the pixels (30, 20) and
/// (40, 22), the middle of the disc.
#[test]
fn high_range_agrees_with_the_published_tool() {
    let plain = bright();
    let noisy = Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let noise = noise(x.into(), y.into()) as f64 / 64.0;
        plain
            .pixel(x, y)
            .map(|c| if c > 2.0 { c + noise } else { c })
    });
    // Mostly black: the median is, so the exposures go on to the last.
    let dark = Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        if x < 10 {
            plain.pixel(x, y)
        } else {
            Rgb::BLACK
        }
    });
    for (name, image, reference, [mean, largest, outside, inside]) in [
        (
            "bright",
            scaled(&plain, 1.25),
            &plain,
            [0.279044092, 0.345615, 0.2645842, 0.2672582],
        ),
        (
            "noise",
            noisy,
            &plain,
            [0.029290635, 0.105466, 0.0355836, 0.0016808],
        ),
        (
            "dark",
            scaled(&dark, 1.5),
            &dark,
            [0.060084101, 0.487777, 0.0, 0.0],
        ),
    ] {
        let exposures = Exposures::of(reference).unwrap();
        let found = hdr_flip(&image, reference, exposures).unwrap();
        near(found.mean(), mean, name);
        near(
            found.values().iter().copied().fold(0.0, f64::max),
            largest,
            name,
        );
        near(found.row(20)[30], outside, name);
        near(found.row(22)[40], inside, name);
    }
}

/// No exposure and no unit: a picture and a reference in another unit have the
/// same exposures on the screen, hence the same HDR-FLIP.
#[test]
fn high_range_does_not_know_the_unit() {
    let [image, reference] = [scaled(&bright(), 1.25), bright()];
    let value = |unit: f64| {
        let [a, b] = [&image, &reference].map(|picture| scaled(picture, unit));
        let exposures = Exposures::of(&b).unwrap();
        hdr_flip(&a, &b, exposures).unwrap().mean()
    };
    assert!((value(1.0) - value(3e4)).abs() < 1e-12);
}

#[test]
fn equal_pictures_do_not_differ() {
    for image in [plain(), grey()] {
        let map = flip(&image, &image).unwrap();
        assert!(map.values().iter().all(|&v| v == 0.0));
        let ssim = Ssim::new(&image, &image).unwrap();
        assert_eq!(ssim.mean_in(Region::whole(&image)), Some(1.0));
    }
    let exposures = Exposures::of(&bright()).unwrap();
    let map = hdr_flip(&bright(), &bright(), exposures).unwrap();
    assert!(map.values().iter().all(|&v| v == 0.0));
}

/// As the authors state of LDR-FLIP and of SSIM.
#[test]
fn order_does_not_matter() {
    let (a, b) = (noisy(), plain());
    assert_eq!(flip(&a, &b).unwrap(), flip(&b, &a).unwrap());
    let whole = Region::whole(&a);
    let ssim = |a, b| Ssim::new(a, b).unwrap().mean_in(whole);
    assert_eq!(ssim(&a, &b), ssim(&b, &a));
}

/// Evenly green against evenly blue is the largest difference there is.
#[test]
fn the_largest_difference_is_one() {
    let [green, blue] = [[0, 255, 0], [0, 0, 255]].map(|c| coded(move |_, _| c));
    for value in flip(&green, &blue).unwrap().values() {
        assert!((value - 1.0).abs() < 1e-12, "{value}");
    }
}

/// SSIM of even greys has its luminance term alone.
#[test]
fn ssim_of_even_greys() {
    let [a, b] = [51, 102].map(|c| coded(move |_, _| [c; 3]));
    let ssim = Ssim::new(&a, &b).unwrap();
    let expected = (2.0 * 0.2 * 0.4 + 1e-4) / (0.04 + 0.16 + 1e-4);
    let found = ssim.mean_in(Region::whole(&a)).unwrap();
    assert!((found - expected).abs() < 1e-11, "{found}");
}

/// The wider the blur, the larger the difference.
#[test]
fn blur_is_seen() {
    let sharp = plain();
    let blurred = |sigma: f64| {
        let weights = gaussian(8, sigma);
        let channel = |c: usize| convolve(&Plane::of(&sharp, |p| p[c]), &weights, &weights);
        let [r, g, b] = [0, 1, 2].map(channel);
        let pixels = (0..sharp.pixels().len())
            .map(|i| Rgb::new(r.values()[i], g.values()[i], b.values()[i]));
        Image::new(SIZE[0], SIZE[1], pixels.collect())
    };
    let pictures = [0.3, 0.6, 1.2, 2.4].map(blurred);
    let whole = Region::whole(&sharp);
    let flips = pictures.each_ref().map(|p| flip(p, &sharp).unwrap().mean());
    let ssims = pictures
        .each_ref()
        .map(|p| Ssim::new(p, &sharp).unwrap().mean_in(whole).unwrap());
    assert!(
        flips.is_sorted_by(|a, b| a < b) && flips[0] > 0.0,
        "{flips:?}"
    );
    assert!(
        ssims.is_sorted_by(|a, b| a > b) && ssims[0] < 1.0,
        "{ssims:?}"
    );
}

#[test]
fn sizes_from_none_to_small() {
    let one = Image::new(1, 1, vec![Rgb::grey(0.2)]);
    let other = Image::new(1, 1, vec![Rgb::grey(0.8)]);
    assert!(flip(&one, &other).unwrap().mean() > 0.1);
    let none = Image::new(0, 0, Vec::new());
    assert!(flip(&none, &none).unwrap().values().is_empty());
    assert!(flip(&one, &none).is_err());
    assert!(Ssim::new(&one, &none).is_err());
    let ssim = Ssim::new(&one, &other).unwrap();
    assert_eq!(ssim.mean_in(Region::whole(&one)), None);
}

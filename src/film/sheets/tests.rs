use super::*;
use crate::{
    film::PixelSample,
    numeric::exact::Quantum,
    sampling::{Purpose, Sequence},
};

/// The light of one sheet and beside it, and the sheets' mean number, of one pixel.
#[derive(Clone, Copy)]
struct Pixel {
    sheet: f64,
    beside: f64,
    number: f64,
    /// Relative deviation of a pass by chance, and that which only the light has.
    chance: f64,
    own: f64,
}

const EVEN: Pixel = Pixel {
    sheet: 2.0,
    beside: 0.5,
    number: 1.0,
    chance: 0.15,
    own: 0.0,
};

/// Numbers of mean 0 and variance 1, independent of each other.
fn draws(seed: u64) -> impl FnMut() -> f64 {
    let mut i = 0;
    move || {
        i += 1;
        let sequence = Sequence::new(seed, Purpose::Pilot, 0, i);
        (sequence.at(0).next_1d() - 0.5) * 12f64.sqrt()
    }
}

/// A film of one pixel, of passes that see a number of sheets that varies, and as
/// much light.
fn film(pixel: Pixel, passes: u32, seed: u64) -> Film {
    let mut film = Film::new(1, 1, Quantum::for_typical(1.0));
    let mut draw = draws(seed);
    for pass in 0..passes {
        let number = pixel.number * (1.0 + pixel.chance * draw());
        let mut sample = PixelSample::default();
        let light = pixel.sheet * (number + pixel.own * draw());
        sample[Layer::Caustic] = Rgb::new(light, 0.5 * light, 0.0);
        sample[Layer::Direct] = Rgb::grey(pixel.beside);
        sample.sheets = [[0.3 * number, 0.3], [25.0 * number, 25.0]];
        film.add_pass(pass, &[sample]);
    }
    film
}

/// Squared error of the picture's first channel over what it is without any
/// correction, the mean of many films, whose light is to be that.
fn gain(pixel: Pixel, passes: u32) -> f64 {
    let truth = pixel.sheet * pixel.number + pixel.beside;
    let (mut with, mut without) = (0.0, 0.0);
    for seed in 0..400 {
        let film = film(pixel, passes, seed);
        let raw: f64 = (0..REPLICATES)
            .map(|r| film.replicate_image(r).pixel(0, 0)[0] * film.replicate_passes()[r] as f64)
            .sum::<f64>()
            / f64::from(passes);
        with += (film.image().pixel(0, 0)[0] - truth).powi(2);
        without += (raw - truth).powi(2);
    }
    with / without
}

/// Where the light follows the sheets, most of its chance is taken off (what is left
/// is in those pixels whose sheets look least like whole ones, since they are furthest
/// off); where it has some of its own, that is left, too. Two sheets are as good as one.
#[test]
fn light_that_follows_the_sheets_has_little_noise() {
    let even = gain(EVEN, 16);
    assert!(even < 0.25, "{even}");
    let two = gain(
        Pixel {
            number: 2.0,
            chance: 0.08,
            ..EVEN
        },
        16,
    );
    assert!(two < 0.25, "{two}");
    let own = gain(Pixel { own: 0.1, ..EVEN }, 16);
    assert!((0.3..0.75).contains(&own), "{own}");
}

/// Light that does not follow them stays as it is, but for what eight replicates
/// take for a connection.
#[test]
fn light_of_its_own_stays() {
    let apart = Pixel {
        chance: 0.05,
        own: 0.5,
        ..EVEN
    };
    let left = gain(apart, 16);
    assert!((left - 1.0).abs() < 0.15, "{left}");
}

/// A half-shadow has no whole number of sheets. One that is within some standard
/// errors of it is taken for it, until there are more passes: 1.05 is four away, whose
/// square would be 16 if there were no doubt.
#[test]
fn fractions_are_left_alone() {
    for (number, most) in [
        (1.5, 1.0 + 1e-9),
        (0.4, 1.0 + 1e-9),
        (1.2, 1.5),
        (1.05, 12.5),
    ] {
        let left = gain(
            Pixel {
                number,
                chance: 0.1,
                ..EVEN
            },
            64,
        );
        assert!(left <= most, "{number}: {left}");
    }
    let later = gain(
        Pixel {
            number: 1.05,
            chance: 0.1,
            ..EVEN
        },
        2048,
    );
    assert!((later - 1.0).abs() < 0.05, "{later}");
    let exact = film(
        Pixel {
            number: 1.5,
            ..EVEN
        },
        64,
        3,
    );
    assert_eq!(exact.excess(0), None);
}

/// Few replicates tell nothing, nor does a pixel of which a pass knows nothing.
#[test]
fn without_knowledge_nothing_is_corrected() {
    assert_eq!(film(EVEN, 3, 1).excess(0), None);
    assert!((1..9).any(|seed| film(EVEN, 4, seed).excess(0).is_some()));
    let mut blind = film(EVEN, 16, 1);
    assert!(blind.excess(0).is_some());
    blind.add_pass(16, &[PixelSample::default()]);
    assert_eq!(blind.excess(0), None);
}

/// The picture is the sum of its layers and the mean of its replicates, and its
/// noise is what is left: about what the error is in truth.
#[test]
fn all_that_is_told_of_a_picture_agrees() {
    for (own, most) in [(0.02, 1.5), (0.1, 1.4), (0.3, 1.4)] {
        agrees(Pixel { own, ..EVEN }, most);
    }
}

fn agrees(pixel: Pixel, most: f64) {
    let (mut squares, mut variances) = (0.0, 0.0);
    for seed in 0..400 {
        let film = film(pixel, 19, seed);
        let picture = film.image().pixel(0, 0);
        let layers = Layer::ALL.map(|layer| film.layer_image(layer).pixel(0, 0));
        let (replicates, variance) = film.spread_at(0);
        let weighted = replicates.iter().zip(film.replicate_passes());
        let mean = weighted.fold(Rgb::BLACK, |sum, (&r, n)| sum + r * n as f64) / 19.0;
        for c in 0..3 {
            let sum: f64 = layers.iter().map(|l| l[c]).sum();
            assert!((picture[c] - sum).abs() < 1e-12);
            assert!((picture[c] - mean[c]).abs() < 1e-12);
        }
        squares += (picture[0] - 2.5).powi(2);
        variances += variance[0];
    }
    let ratio = variances / squares;
    assert!((0.7..most).contains(&ratio), "{}: {ratio}", pixel.own);
}

/// Kernels drawn in find more or less light by chance, as far as they find more or
/// fewer sheets: that is no blur. What they find beside it is.
#[test]
fn chance_in_narrower_kernels_is_no_blur() {
    const BLUR: f64 = 0.03;
    const FILMS: u32 = 400;
    let (mut chance, mut told, mut mean) = (0.0, 0.0, 0.0);
    for seed in 0..FILMS {
        let mut film = Film::new(1, 1, Quantum::for_typical(1.0));
        let mut draw = draws(seed.into());
        let mut by_chance = 0.0;
        for pass in 0..16 {
            let number = 1.0 + 0.1 * draw();
            let steps = [0.1 * draw(), 0.2 * draw()];
            let mut sample = PixelSample::default();
            sample[Layer::Caustic] = Rgb::grey(2.0 * number);
            sample.blur = [2.0 * steps[0] + BLUR, 2.0 * steps[1] + 0.5 * BLUR];
            sample.sheets = [[0.3 * number, 0.3], [25.0 * number, 25.0]];
            sample.sheet_steps = steps.map(|step| 0.3 * step);
            by_chance += 2.0 * steps[0] / 16.0;
            film.add_pass(pass, &[sample]);
        }
        let groups = film.blur();
        let first = groups.iter().map(|group| group[0][0]).sum::<f64>() / groups.len() as f64;
        chance += by_chance * by_chance / f64::from(FILMS);
        told += (first - BLUR).powi(2) / f64::from(FILMS);
        mean += first / f64::from(FILMS);
    }
    assert!(told < 0.05 * chance, "{told} {chance}");
    assert!((mean / BLUR - 1.0).abs() < 0.05, "{mean}");
}

/// The order of passes and their grouping leave no trace.
#[test]
fn films_of_parts_are_the_film_of_all() {
    let sample = |pass: u32| {
        let mut sample = PixelSample::default();
        let number = 0.8 + 0.1 * f64::from(pass * 7 % 5);
        sample[Layer::Caustic] = Rgb::grey(number);
        sample.sheets = [[number, 1.0], [number / 3.0, 1.0 / 3.0]];
        sample.sheet_steps = [0.1 * number - 0.09, 0.01];
        sample
    };
    let of = |passes: &[u32]| {
        let mut film = Film::new(1, 1, Quantum::for_typical(1.0));
        for &pass in passes {
            film.add_pass(pass, &[sample(pass)]);
        }
        film
    };
    let whole = of(&(0..16).collect::<Vec<_>>());
    let mut parts = of(&[9, 3, 15, 1, 0, 12]);
    parts
        .merge(&of(&[14, 2, 4, 5, 13, 6, 7, 8, 11, 10]))
        .unwrap();
    assert_eq!(whole, parts);
    assert!(whole.excess(0).is_some());
    assert_eq!(whole.image(), parts.image());
}

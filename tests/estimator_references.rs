//! The exact pictures with which the `estimators` bench compares: they must
//! hold the light that the renderer's own photons bring, in the whole, in
//! coarse squares and pixel by pixel. So must the random photons of the
//! methods that the renderer is compared with.
//!
//! The photons are counted pixel by pixel without any kernel, so nothing
//! blurs the comparison.

mod common;

#[path = "../benches/estimators/exact/mod.rs"]
mod exact;
#[path = "../benches/estimators/rivals/photons.rs"]
mod photons;

use common::{Estimate, render, renderer, scene};
use exact::{CASES, Case, Optics, Reference};
use nephroid::{
    film::{Image, Layer},
    metrics::{mean_ratio, relmse},
    photon::shoot,
    render::REPLICATES,
    sampling::{Purpose, Sequence},
};
use photons::Random;

/// Photon paths of each replicate.
const PHOTONS: u64 = 1 << 19;

/// Pixels along a side of a coarse square.
const BLOCK: usize = 20;

/// What the photons of a scene say.
struct Counted {
    /// Irradiance per replicate and pixel.
    replicates: Vec<Vec<f64>>,
    /// Irradiance that one photon is, were all of one strength.
    one: f64,
}

/// Photons of the renderer that no guide draws to the picture: the most even
/// ones.
fn count(case: &Case) -> Counted {
    let mut scene = scene(&case.text());
    scene.settings.photons = Some(PHOTONS);
    let renderer = renderer(&scene);
    let ctx = renderer.context();
    let emitter = renderer.emitter().expect("a caster");
    let per_area = case.window.per_metre() * case.window.per_metre() / PHOTONS as f64;
    Counted::new(case, |replicate| {
        let sequence = Sequence::new(scene.settings.seed, Purpose::Photon, replicate, 0);
        let photons = shoot(&ctx, emitter, sequence, 0, PHOTONS).photons;
        let land = |photon: nephroid::photon::Photon| {
            let pixel = case.window.pixel(photon.position.x, photon.position.y)?;
            Some((pixel, photon.flux[1] * per_area))
        };
        photons.into_iter().filter_map(land)
    })
}

impl Counted {
    /// Adds up the photons of every replicate: the pixel of each and what it
    /// brings there.
    fn new<P: Iterator<Item = (usize, f64)>>(case: &Case, photons: impl Fn(u32) -> P) -> Self {
        let pixels = (case.window.pixels * case.window.pixels) as usize;
        let (mut sum, mut squares) = (0.0, 0.0);
        let replicates = (0..REPLICATES).map(|replicate| {
            let mut irradiance = vec![0.0; pixels];
            for (pixel, flux) in photons(replicate) {
                irradiance[pixel] += flux;
                sum += flux;
                squares += flux * flux;
            }
            irradiance
        });
        let replicates = replicates.collect();
        Self {
            replicates,
            one: squares / sum,
        }
    }

    /// The light of a part of the pixels.
    fn of(&self, pixels: impl Fn(usize) -> bool) -> Estimate {
        let sum = |r: &Vec<f64>| -> f64 {
            let part = r.iter().enumerate().filter(|(i, _)| pixels(*i));
            part.map(|(_, v)| v).sum()
        };
        Estimate::of(&self.replicates.iter().map(sum).collect::<Vec<_>>())
    }

    /// Mean over pixels of the squared difference over what independent
    /// photons would leave: at most one, since Sobol points are more even
    /// than that.
    fn against(&self, reference: &Image) -> f64 {
        let one = self.one / f64::from(REPLICATES);
        let squares = reference.pixels().iter().enumerate().map(|(i, expected)| {
            let sum: f64 = self.replicates.iter().map(|r| r[i]).sum();
            let difference = sum / f64::from(REPLICATES) - expected[1];
            difference * difference / (expected[1] * one)
        });
        squares.sum::<f64>() / reference.pixels().len() as f64
    }
}

fn sum_of(reference: &Image, pixels: impl Fn(usize) -> bool) -> f64 {
    let part = reference.pixels().iter().enumerate();
    part.filter(|(i, _)| pixels(*i)).map(|(_, p)| p[1]).sum()
}

/// Photons of the other methods, in batches for replicates.
fn random(case: &Case) -> Counted {
    let side = f64::from(case.window.pixels);
    Counted::new(case, |replicate| {
        let mut random = Random::new(u64::from(replicate) << 40);
        (0..PHOTONS).filter_map(move |_| {
            let photon = photons::photon(case, &mut random)?;
            if !photon.at.iter().all(|c| (0.0..side).contains(c)) {
                return None;
            }
            let [column, row] = photon.at.map(|c| c as usize);
            let pixel = row * case.window.pixels as usize + column;
            Some((pixel, photon.irradiance / PHOTONS as f64))
        })
    })
}

fn agrees(name: &str) {
    let case = Case::named(name).expect("a scene of the bench");
    assert_eq!(case.name, name);
    let reference = case.reference();
    assert!(reference.error < 1e-6, "{name}: {:e}", reference.error);
    let total = sum_of(&reference.image, |_| true);

    let counted = count(&case);
    counted.of(|_| true).assert_is(total, 1e-4, name);
    let ratio = counted.of(|_| true).mean / total;
    assert!((ratio - 1.0).abs() < 1e-4, "{name}: mean ratio {ratio}");
    let misfit = counted.against(&reference.image);
    assert!(misfit < 1.02, "{name}: misfit {misfit}");
    squares_agree(&counted, &reference, name);

    let random = random(&case);
    random.of(|_| true).assert_is(total, 2e-3, name);
    let misfit = random.against(&reference.image);
    // A mean over pixels, of which the brightest few weigh no more than any.
    assert!(
        (misfit - 1.0).abs() < 0.05,
        "{name}: random misfit {misfit}"
    );
    squares_agree(&random, &reference, name);
}

/// Compares the light in coarse squares.
fn squares_agree(counted: &Counted, reference: &Reference, name: &str) {
    let image = &reference.image;
    let side = image.width() as usize;
    for block in 0..(side / BLOCK) * (side / BLOCK) {
        let inside = |i: usize| {
            let (column, row) = (i % side / BLOCK, i / side / BLOCK);
            row * (side / BLOCK) + column == block
        };
        let (found, expected) = (counted.of(inside), sum_of(image, inside));
        // Student's t with 7 degrees of freedom is beyond 8 once in 10,000
        // times; there are 100 squares.
        let slack = 8.0 * found.error + 1e-4 * expected;
        assert!(
            (found.mean - expected).abs() < slack,
            "{name}, square {block}: {found:?}, expected {expected}"
        );
    }
}

#[test]
fn before_the_focus() {
    agrees("before");
}

#[test]
fn in_the_focus() {
    agrees("focus");
}

#[test]
fn after_the_focus() {
    agrees("after");
}

#[test]
fn light_from_a_point() {
    agrees("point");
}

#[test]
fn light_from_a_cone() {
    agrees("sun");
}

#[test]
fn waves() {
    agrees("bumpy");
}

/// The comparison sees a floor that is off by a thousandth of its distance.
#[test]
fn what_is_wrong_is_seen() {
    let case = Case::named("before").expect("a scene of the bench");
    let counted = count(&case);
    let mut lower = case.clone();
    if let Optics::Ball(ball) = &mut lower.optics {
        ball.height *= 1.001;
    }
    let misfit = counted.against(&lower.reference().image);
    assert!(misfit > 1.1, "misfit {misfit}");
    assert_eq!(CASES.len(), 6, "every scene has its test");
}

/// The bench reads the right layer in the right unit: the renderer's picture
/// of a smooth caustic is the reference, but for the blur of its kernel, which
/// carries some light over the window's border.
#[test]
fn the_picture_is_the_reference() {
    let case = Case::named("after").expect("a scene of the bench");
    let mut scene = scene(&case.text());
    scene.settings.passes = 64;
    let radiance = render(&scene).film.layer_image(Layer::Caustic);
    let irradiance = Image::from_fn(radiance.width(), radiance.height(), |x, y| {
        radiance.pixel(x, y) * std::f64::consts::PI
    });
    let reference = case.reference().image;
    let ratio = mean_ratio(&irradiance, &reference).expect("same size");
    assert!((ratio - 1.0).abs() < 5e-3, "mean ratio {ratio}");
    let error = relmse(&irradiance, &reference).expect("same size");
    assert!(error < 0.01, "relMSE {error}");
}

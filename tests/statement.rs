//! What pictures say about their own error holds: on films whose noise and bias
//! are made to order, on a caustic with a closed form, and as the reason to
//! stop a render.

mod common;

use std::{f64::consts::TAU, ops::ControlFlow};

use common::{ball, independent, renderer, scene, scene_of};
use nephroid::{
    film::{Film, Image, Layer, PixelSample, REPLICATES},
    metrics::{Statement, relative_errors},
    numeric::exact::Quantum,
    render::{Job, run},
    sampling::Stream,
    spectrum::Rgb,
};

const SIZE: u32 = 64;

/// How a sample of a pass differs from the mean over passes.
#[derive(Clone, Copy)]
enum Noise {
    Normal,
    /// Light that comes once in twenty samples, and then all at once.
    Sparse,
    /// Logarithms are normal, with a standard deviation of one.
    Heavy,
}

impl Noise {
    /// A number of mean zero and variance one, about.
    fn draw(self, s: &mut Stream) -> f64 {
        let normal = normal(s);
        match self {
            Self::Normal => normal,
            Self::Sparse => {
                let often = 0.05;
                let one = if s.next_1d() < often { 1.0 } else { 0.0 };
                (one - often) / libm::sqrt(often * (1.0 - often))
            }
            Self::Heavy => {
                let [mean, variance] = [libm::exp(0.5), libm::exp(2.0) - libm::exp(1.0)];
                (libm::exp(normal) - mean) / variance.sqrt()
            }
        }
    }
}

/// Box and Muller.
fn normal(s: &mut Stream) -> f64 {
    let [a, b] = s.next_2d();
    (-2.0 * libm::log(1.0 - a)).sqrt() * libm::cos(TAU * b)
}

/// A picture made to order: 64 x 64 pixels, brighter to the right.
#[derive(Clone, Copy)]
struct Order {
    noise: Noise,
    /// Standard deviation of a sample over the truth.
    size: f64,
    /// Amplitude of the bias over the truth, in waves of 16 pixels.
    bias: f64,
    /// Ratio of the steps between kernels.
    ratio: f64,
    /// Noise of the steps over that of the sample.
    steps: f64,
}

const PLAIN: Order = Order {
    noise: Noise::Normal,
    size: 0.1,
    bias: 0.0,
    ratio: 0.5,
    steps: 0.7,
};

impl Order {
    fn truth(x: u32) -> f64 {
        1.0 + f64::from(x) / 16.0
    }

    fn bias(self, x: u32, y: u32) -> f64 {
        let wave = |v: u32| libm::sin(TAU * f64::from(v) / 16.0);
        self.bias * Self::truth(x) * wave(x) * wave(y)
    }

    /// The film after one round.
    fn film(self, seed: u64) -> Film {
        self.film_of(REPLICATES as u32, seed)
    }

    /// The film after some passes.
    fn film_of(self, passes: u32, seed: u64) -> Film {
        self.film_in(1.0, passes, seed)
    }

    /// The same with light so many times as strong.
    fn film_in(self, unit: f64, passes: u32, seed: u64) -> Film {
        let mut film = Film::new(SIZE, SIZE, Quantum::for_typical(unit));
        for pass in 0..passes {
            let sample = |i: u32| {
                let (x, y) = (i % SIZE, i / SIZE);
                let number = u64::from(pass * SIZE * SIZE + i);
                let mut s = independent(seed, number);
                let spread = self.size * Self::truth(x);
                let bias = self.bias(x, y);
                let mut sample = PixelSample::default();
                let value = Self::truth(x) + bias + spread * self.noise.draw(&mut s);
                sample[Layer::Caustic] = Rgb::grey(value * unit);
                let step = (1.0 - self.ratio) * bias;
                // Differences of kernels are noisy, too.
                sample.blur = [step, self.ratio * step];
                for step in &mut sample.blur {
                    *step += self.steps * spread * self.noise.draw(&mut s);
                    *step *= unit;
                }
                sample
            };
            let samples: Vec<PixelSample> = (0..SIZE * SIZE).map(sample).collect();
            film.add_pass(pass, &samples);
        }
        film
    }

    fn image() -> Image {
        Image::from_fn(SIZE, SIZE, |x, _| Rgb::grey(Self::truth(x)))
    }
}

/// Of the lit pixels: the part that keeps within their bounds, and the true
/// error without the worst 0.1 %.
fn truly(film: &Film, statement: &Statement, truth: &Image) -> [f64; 2] {
    let errors = relative_errors(&film.image(), truth).expect("of one size");
    let pixels = errors.values().iter().zip(statement.bound.values());
    let lit = pixels.zip(&statement.lit).filter(|(_, lit)| **lit);
    let (mut squares, mut kept) = (Vec::new(), 0.0);
    for ((&square, bound), _) in lit {
        squares.push(square);
        kept += f64::from(u8::from(square <= bound * bound));
    }
    let count = squares.len();
    squares.sort_by(f64::total_cmp);
    squares.truncate(count * 999 / 1000);
    let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    [kept / count as f64, error]
}

/// Coverage, true error over stated error, true error over its bound: means
/// over some films; and how often the bound held.
fn over_films(order: Order, films: u64) -> [f64; 4] {
    let truth = Order::image();
    let mut sums = [0.0; 4];
    for seed in 0..films {
        let film = order.film(seed);
        let statement = Statement::of(&film, None).expect("a whole round");
        let [within, error] = truly(&film, &statement, &truth);
        let found = [
            within,
            error / statement.whole.error,
            error / statement.whole.bound,
            f64::from(u8::from(error <= statement.whole.bound)),
        ];
        for (sum, value) in sums.iter_mut().zip(found) {
            *sum += value / films as f64;
        }
    }
    sums
}

#[test]
fn noise_of_every_kind_keeps_within_what_is_stated() {
    let orders = [
        ("normal", PLAIN, 0.05, 0.96),
        // Two pixels of three have seen none of the light, and say so.
        (
            "sparse",
            Order {
                noise: Noise::Sparse,
                size: 0.3,
                ..PLAIN
            },
            0.1,
            0.995,
        ),
        (
            "heavy",
            Order {
                noise: Noise::Heavy,
                size: 0.3,
                ..PLAIN
            },
            0.1,
            0.97,
        ),
    ];
    for (name, order, precision, most) in orders {
        let [within, ratio, to_bound, held] = over_films(order, 8);
        assert!((0.86..=most).contains(&within), "{name}: {within} within");
        assert!((ratio - 1.0).abs() < precision, "{name}: {ratio}");
        assert!(
            to_bound > 0.7,
            "{name}: a bound of everything says nothing: {to_bound}"
        );
        assert!(held >= 0.6, "{name}: the bound held in {held}");
    }
}

#[test]
fn bias_is_found_by_size_and_sign() {
    for ratio in [0.4, 0.5, 0.7] {
        let order = Order {
            bias: 0.15,
            size: 0.03,
            ratio,
            ..PLAIN
        };
        let [within, to_stated, ..] = over_films(order, 4);
        // Where smooth blur rules, bounds are wider than need be.
        assert!(within >= 0.86, "{ratio}: {within} within");
        assert!((to_stated - 1.0).abs() < 0.15, "{ratio}: {to_stated}");
        let film = order.film(9);
        let statement = Statement::of(&film, None).expect("a whole round");
        // Two sines.
        let expected = 0.15 * 0.5;
        let found = statement.whole.bias;
        assert!(
            (found / expected - 1.0).abs() < 0.2,
            "{ratio}: bias {found}"
        );
        let wrong = (0..SIZE * SIZE).filter(|i| {
            let (x, y) = (i % SIZE, i / SIZE);
            let true_one = order.bias(x, y) / Order::truth(x);
            let stated = statement.bias.pixel(x, y)[1];
            true_one.abs() > 0.1 && stated * true_one <= 0.0
        });
        assert!(wrong.count() < 40, "{ratio}: signs");
    }
}

#[test]
fn noise_of_the_kernels_is_not_taken_for_bias() {
    let mut squares = 0.0;
    for seed in 20..26 {
        let statement = Statement::of(&PLAIN.film(seed), None).expect("a whole round");
        squares += statement.whole.bias * statement.whole.bias / 6.0;
    }
    // The first step has a standard error of 0.07 / 8^(1/2), or 0.025, and
    // would count twice.
    assert!(squares.sqrt() < 0.012, "{}", squares.sqrt());
}

/// Relative errors do not know how strong the light is.
#[test]
fn any_unit_of_light_serves() {
    let order = Order { bias: 0.1, ..PLAIN };
    let of = |unit: f64| Statement::of(&order.film_in(unit, 8, 3), None).expect("a round");
    let (usual, caustics) = (of(1.0).whole, of(1.0).caustics);
    for exponent in [-400, -140, 140, 400] {
        let there = of(libm::ldexp(1.0, exponent));
        assert_eq!(there.whole, usual, "2^{exponent}");
        assert_eq!(there.caustics, caustics, "2^{exponent}");
    }
}

#[test]
fn little_is_said_of_little() {
    let film = Order {
        steps: 0.0,
        ..PLAIN
    }
    .film(1);
    let mut part = Film::new(1, 1, Quantum::for_typical(1.0));
    assert!(Statement::of(&part, None).is_none(), "no pass");
    for pass in 0..7 {
        part.add_pass(pass, &[PixelSample::default()]);
    }
    assert!(Statement::of(&part, None).is_none(), "not a whole round");
    part.add_pass(7, &[PixelSample::default()]);
    assert!(Statement::of(&part, None).is_none(), "black");
    let with = Statement::of(&film, Some(0.05))
        .expect("a whole round")
        .whole;
    let without = Statement::of(&film, None).expect("a whole round").whole;
    assert_eq!(without.outside, None);
    // A standard error of 0.1 / 8^(1/2): 5 % is 1.41 of it.
    let outside = with.outside.expect("a target");
    assert!((outside - 0.157).abs() < 0.03, "{outside}");
    assert_eq!((with.error, with.pixels), (without.error, 64 * 64));
    let [p95, p99] = [with.percentile_95, with.percentile_99];
    assert!((p95 / (1.96 * 0.0354) - 1.0).abs() < 0.1, "{p95}");
    assert!((p99 / (2.58 * 0.0354) - 1.0).abs() < 0.1, "{p99}");
}

/// Inside a round some replicates have a pass more than others: what is said
/// is said of the picture as it is.
#[test]
fn a_picture_inside_a_round_is_known_as_well() {
    let truth = Order::image();
    let (mut kept, mut ratio, films) = (0.0, 0.0, 6);
    for seed in 40..40 + films {
        let film = PLAIN.film_of(13, seed);
        let statement = Statement::of(&film, None).expect("a round and a half");
        let [within, error] = truly(&film, &statement, &truth);
        kept += within / films as f64;
        ratio += error / statement.whole.error / films as f64;
    }
    assert!((0.86..=0.96).contains(&kept), "{kept} within");
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
}

/// Half a round states nothing, but tells about as much as it can.
#[test]
fn half_a_round_lets_suppose() {
    assert!(Statement::early(&PLAIN.film_of(3, 1)).is_none());
    let film = PLAIN.film_of(4, 1);
    assert!(Statement::of(&film, None).is_none());
    let found = Statement::early(&film).expect("four replicates");
    assert_eq!(found.pixels, 64 * 64);
    assert!((found.noise / 0.05 - 1.0).abs() < 0.03, "{}", found.noise);
    assert!(found.bias < 0.02, "{}", found.bias);
    // Whole rounds say the same both ways.
    let film = PLAIN.film(1);
    let stated = Statement::of(&film, None).expect("a whole round").whole;
    assert_eq!(Statement::early(&film), Some(stated));
    let half = Order {
        bias: 0.15,
        size: 0.03,
        ..PLAIN
    };
    let found = Statement::early(&half.film_of(4, 2)).expect("four replicates");
    assert!((found.bias / 0.075 - 1.0).abs() < 0.2, "{}", found.bias);
}

#[test]
fn a_black_background_does_not_flatter() {
    let noisy = PLAIN.film(3);
    let mut wide = Film::new(SIZE, 2 * SIZE, Quantum::for_typical(1.0));
    for pass in 0..8 {
        let replicate = noisy.replicate_image(pass);
        let sample = |&v: &Rgb| {
            let mut s = PixelSample::default();
            s[Layer::Caustic] = v;
            s
        };
        let mut samples: Vec<PixelSample> = replicate.pixels().iter().map(sample).collect();
        samples.resize(2 * samples.len(), PixelSample::default());
        wide.add_pass(pass as u32, &samples);
    }
    let alone = Statement::of(&noisy, None).expect("a whole round").whole;
    let beside = Statement::of(&wide, None).expect("a whole round").whole;
    // The neighbours of the border are lit, too.
    assert_eq!(beside.pixels, alone.pixels + 2 * SIZE as usize);
    assert!((beside.noise / alone.noise - 1.0).abs() < 0.03);
}

/// The caustic of a ball lens with its fold, against the closed form.
#[test]
fn a_caustic_keeps_within_what_is_stated() {
    let (plane, beam, window, pixels) = (1.3, 0.95, 1.4, 64);
    let irradiance = ball::irradiance(plane, beam, window, pixels);
    let text = ball::scene_text(plane, beam, window, pixels, "photons: 8192");
    let scene = scene(&text);
    let renderer = renderer(&scene);
    let mut film = Film::new(pixels, pixels, Quantum::for_typical(1.0));
    for pass in 0..16 {
        film.add_pass(pass, &renderer.pass(pass).samples);
    }
    let statement = Statement::of(&film, None).expect("two rounds");
    let [kept, error] = truly(&film, &statement, &irradiance);
    // Folds fill a third of so few pixels.
    assert!((0.82..=0.97).contains(&kept), "{kept} within");
    let ratio = statement.whole.error / error;
    assert!(
        (0.75..=1.25).contains(&ratio),
        "stated over true: {ratio}, {error}"
    );
    assert!(
        statement.whole.noise < 0.85 * error,
        "a scene without bias shows nothing: {} of {error}",
        statement.whole.noise
    );
    // All but the rim, which is lit by what lies within.
    let caustics = statement.caustics.expect("nothing else is there").pixels;
    let lit = statement.whole.pixels;
    assert!(
        (0.8..=1.0).contains(&(caustics as f64 / lit as f64)),
        "{caustics} of {lit}"
    );
}

/// A render ends at the first round, of those at which it is asked, whose
/// statement is good enough; however many threads there are.
#[test]
fn a_render_ends_when_the_error_is_reached() {
    let scene = scene_of(
        "eye: (0, -3, 2), look_at: (0, 0, 0), fov: 40",
        [24, 24],
        "(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\"),
         (shape: Sphere(center: (0, 0, 0.6), radius: 0.4), material: \"glass\")",
        "Sphere(center: (1, 0, 3), radius: 0.3, radiance: 10)",
        "photons: 2048, passes: 8",
    );
    let renderer = renderer(&scene);
    let mut film = Film::new(24, 24, nephroid::plan::film_quantum(&scene));
    let mut bounds = Vec::new();
    for pass in 0..6 * 8 {
        film.add_pass(pass, &renderer.pass(pass).samples);
        if [8, 16, 24, 32, 48].contains(&(pass + 1)) {
            let statement = Statement::of(&film, None).expect("whole rounds");
            bounds.push((pass + 1, statement.whole.bound));
        }
    }
    // What the fourth asking holds, if none before it does.
    let target = 1.001 * bounds[3].1;
    let (passes, _) = *bounds.iter().find(|b| b.1 <= target).expect("the fourth");
    assert!(passes > 8, "the first asking is too easy: {bounds:?}");
    let mut job = Job::of(&scene);
    job.error = Some(target);
    let ends = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| run(&scene, &job, &mut |_| ControlFlow::Continue(())))
    };
    let outcome = ends(3);
    assert_eq!(u64::from(passes), outcome.film.passes());
    assert!(outcome.reaches(target) && !outcome.interrupted);
    let stated = outcome.statement.expect("whole rounds");
    assert_eq!(outcome.report.error.expect("stated").lit, stated.whole);
    let alone = ends(1).statement.expect("whole rounds");
    assert_eq!((stated.whole, stated.bound), (alone.whole, alone.bound));
    assert_eq!((stated.noise, stated.bias), (alone.noise, alone.bias));
}

//! What the film costs: per pixel of a pass, per merge, and per file.

use divan::{Bencher, counter::ItemsCount};
use nephroid::{
    film::{Film, Image, Layer, PixelSample, Window, encode_exr, encode_png},
    numeric::exact::Quantum,
    spectrum::Rgb,
};

const WIDTH: u32 = 512;
const HEIGHT: u32 = 384;
const PIXELS: u32 = WIDTH * HEIGHT;

fn main() {
    divan::main();
}

/// Smooth light with a bright line through it, and grain, so that compression
/// meets what it meets in earnest.
fn sample(i: u32) -> PixelSample {
    let (x, y) = (f64::from(i % WIDTH), f64::from(i / WIDTH));
    let grain = f64::from(i.wrapping_mul(2_654_435_761) >> 20) / 4096.0;
    let mut sample = PixelSample::default();
    sample[Layer::Direct] = Rgb::new(0.3, 0.2, 0.1) * (1.0 + x / 512.0);
    sample[Layer::Caustic] = Rgb::grey(grain / (1.0 + (x - y).abs()));
    sample
}

fn samples() -> Vec<PixelSample> {
    (0..PIXELS).map(sample).collect()
}

fn film() -> Film {
    let mut film = Film::new(WIDTH, HEIGHT, Quantum::for_typical(0.3));
    film.add_pass(0, &samples());
    film
}

#[divan::bench]
fn add_pass(bencher: Bencher) {
    let samples = samples();
    let mut film = film();
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| film.add_pass(0, divan::black_box(&samples)));
}

/// The limit of `add_pass`: the same sums in plain floating point.
#[divan::bench]
fn add_pass_inexact(bencher: Bencher) {
    let samples = samples();
    let mut sums = vec![[Rgb::BLACK; 5]; samples.len()];
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| {
        for (sums, sample) in sums.iter_mut().zip(divan::black_box(&samples)) {
            sums[4] += sample.total();
            for (sum, &layer) in sums.iter_mut().zip(&sample.layers) {
                *sum += layer;
            }
        }
    });
}

/// The film as bytes, as a checkpoint holds it, and back.
#[divan::bench]
fn write_state(bencher: Bencher) {
    let film = film();
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| divan::black_box(&film).write_state(&mut std::io::sink()));
}

#[divan::bench]
fn read_state(bencher: Bencher) {
    let mut bytes = Vec::new();
    let written = film().write_state(&mut bytes);
    written.expect("memory takes all");
    let length = bytes.len() as u64;
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| Film::read_state(&mut divan::black_box(&bytes[..]), length));
}

#[divan::bench]
fn merge(bencher: Bencher) {
    let other = film();
    let mut film = film();
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| film.merge(divan::black_box(&other)));
}

#[divan::bench]
fn picture(bencher: Bencher) {
    let film = film();
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| film.image());
}

fn encoded(bencher: Bencher, encode: impl Fn(&[(&str, &Image)]) -> usize) {
    let film = film();
    let mut images = vec![("", film.image())];
    images.extend(Layer::ALL.map(|layer| (layer.name(), film.layer_image(layer))));
    let layers: Vec<(&str, &Image)> = images.iter().map(|(n, i)| (*n, i)).collect();
    bencher
        .counter(ItemsCount::new(PIXELS))
        .bench_local(|| encode(divan::black_box(&layers)));
}

#[divan::bench]
fn exr(bencher: Bencher) {
    encoded(bencher, |layers| {
        let window = Window::whole(WIDTH, HEIGHT);
        encode_exr(layers, window, &[]).map_or(0, |bytes| bytes.len())
    });
}

#[divan::bench]
fn png(bencher: Bencher) {
    encoded(bencher, |layers| {
        encode_png(layers[0].1, None).map_or(0, |bytes| bytes.len())
    });
}

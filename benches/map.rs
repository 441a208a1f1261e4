//! The photon map: building it, and asking it, beside a plain loop.
//!
//! Photons lie on a plane, uniform but for a tenth that is crowded into a
//! hundredth of the area, as in a caustic. `query` asks at photon positions
//! with radii that hold so many photons on average.

use divan::{Bencher, black_box, counter::ItemsCount};
use glam::DVec3;
use nephroid::{
    photon::{Photon, PhotonMap},
    sampling::{Purpose, Sequence},
    spectrum::Rgb,
};

fn main() {
    divan::main();
}

const QUERIES: usize = 1000;

fn photons(count: u64) -> Vec<Photon> {
    let sequence = Sequence::new(0, Purpose::Pilot, 0, 0);
    (0..count)
        .map(|i| {
            let [x, y] = sequence.at(i).next_2d();
            let scale = if i % 10 == 0 { 0.1 } else { 1.0 };
            Photon {
                position: DVec3::new(scale * (x - 0.5), scale * (y - 0.5), 0.0),
                normal: DVec3::Z,
                flux: Rgb::WHITE,
                bounced: false,
            }
        })
        .collect()
}

#[divan::bench(args = [10_000, 100_000, 1_000_000], sample_count = 10)]
fn build(bencher: Bencher, count: u64) {
    let photons = photons(count);
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| PhotonMap::new(black_box(&photons), count));
}

#[divan::bench(args = [4, 16, 64, 256], consts = [100_000, 1_000_000], sample_count = 20)]
fn query<const COUNT: u64>(bencher: Bencher, held: u64) {
    let photons = photons(COUNT);
    let map = PhotonMap::new(&photons, COUNT);
    let radius = (held as f64 / (COUNT as f64 * std::f64::consts::PI)).sqrt();
    let step = photons.len() / QUERIES;
    bencher.counter(ItemsCount::new(QUERIES)).bench_local(|| {
        photons
            .iter()
            .step_by(step)
            .map(|p| {
                map.irradiance(p.position, DVec3::Z, radius, |_| true)
                    .irradiance[0]
            })
            .sum::<f64>()
    });
}

#[divan::bench(sample_count = 5)]
fn query_by_plain_loop(bencher: Bencher) {
    let photons = photons(100_000);
    let radius = (16.0 / (100_000.0 * std::f64::consts::PI)).sqrt();
    bencher.counter(ItemsCount::new(10usize)).bench_local(|| {
        photons
            .iter()
            .step_by(10_000)
            .map(|q| {
                let near = |p: &&Photon| p.position.distance_squared(q.position) < radius * radius;
                black_box(&photons)
                    .iter()
                    .filter(near)
                    .map(|p| p.flux[0])
                    .sum::<f64>()
            })
            .sum::<f64>()
    });
}

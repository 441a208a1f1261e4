//! The photon map: building it, and asking it, beside a plain loop and a grid.
//!
//! Photons lie on a plane, uniform but for a tenth that is crowded into a
//! hundredth of the area with smaller kernels, as in a caustic. `query` asks at
//! photon positions where kernels hold so many photons; `pass` builds and asks
//! once for every pixel of a picture of the plane (compare with
//! `RAYON_NUM_THREADS=1`: the grid knows no threads).

#[path = "common/grid.rs"]
mod grid;

use divan::{Bencher, black_box, counter::ItemsCount};
use glam::DVec3;
use grid::Grid;
use nephroid::{
    photon::{Footprint, Kernels, Photon, PhotonMap, Query, Vicinity},
    sampling::{Purpose, Sequence},
    spectrum::Rgb,
};

fn main() {
    divan::main();
}

const QUERIES: usize = 1000;

/// Photons whose kernels hold `held` others where light is even.
fn photons(count: u64, held: u64) -> Vec<Photon> {
    let radius = (held as f64 / (count as f64 * std::f64::consts::PI)).sqrt();
    let sequence = Sequence::new(0, Purpose::Pilot, 0, 0);
    (0..count)
        .map(|i| {
            let [x, y] = sequence.at(i).next_2d();
            let scale = if i % 10 == 0 { 0.1 } else { 1.0 };
            Photon {
                position: DVec3::new(scale * (x - 0.5), scale * (y - 0.5), 0.0),
                normal: DVec3::Z,
                flux: Rgb::WHITE,
                footprint: Some(Footprint {
                    major: DVec3::X * (scale * radius),
                    minor: scale * radius,
                    fold: f64::INFINITY,
                }),
                bounced: false,
                sheet: 0.0,
            }
        })
        .collect()
}

#[divan::bench(args = [10_000, 100_000, 1_000_000], sample_count = 10)]
fn build(bencher: Bencher, count: u64) {
    let photons = photons(count, 16);
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| PhotonMap::new(black_box(&photons), count, 1.0));
}

#[divan::bench(args = [4, 16, 64, 256], consts = [100_000, 1_000_000], sample_count = 20)]
fn query<const COUNT: u64>(bencher: Bencher, held: u64) {
    let photons = photons(COUNT, held);
    let map = PhotonMap::new(&photons, COUNT, 1.0);
    let step = photons.len() / QUERIES;
    bencher.counter(ItemsCount::new(QUERIES)).bench_local(|| {
        photons
            .iter()
            .step_by(step)
            .map(|p| {
                map.irradiance(&ask(p.position, 0.0), |_, _| [1.0; 3])
                    .irradiance[0]
            })
            .sum::<f64>()
    });
}

fn ask(p: DVec3, spacing: f64) -> Query {
    Query {
        p,
        n: DVec3::Z,
        kernels: Kernels {
            least: 0.0,
            most: 1.0,
            most_bounced: 1.0,
            blind: 0.0,
            caustics: true,
            spacing,
        },
    }
}

/// The middles of the pixels of a picture of the plane, tile by tile.
fn pixels() -> impl Iterator<Item = DVec3> {
    const TILES: u32 = WIDTH / TILE;
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(WIDTH) - 0.5;
    (0..WIDTH * WIDTH).map(move |i| {
        let (tile, i) = (i / (TILE * TILE), i % (TILE * TILE));
        let x = tile % TILES * TILE + i % TILE;
        let y = tile / TILES * TILE + i / TILE;
        DVec3::new(middle(x), middle(y), 0.0)
    })
}

const WIDTH: u32 = 200;
const TILE: u32 = 8;

#[divan::bench(args = [32_768, 131_072], sample_count = 10)]
fn pass(bencher: Bencher, count: u64) {
    let photons = photons(count, 16);
    bencher.bench_local(|| {
        let map = PhotonMap::new(black_box(&photons), count, 1.0);
        let mut vicinity = Vicinity::new(&map);
        let spacing = 1.0 / f64::from(WIDTH);
        pixels()
            .map(|p| vicinity.irradiance(&ask(p, spacing), || f64::INFINITY, |_, _| [1.0; 3]))
            .map(|found| found.irradiance[0])
            .sum::<f64>()
    });
}

#[divan::bench(args = [32_768, 131_072], sample_count = 10)]
fn pass_by_grid(bencher: Bencher, count: u64) {
    let photons = photons(count, 16);
    bencher.bench_local(|| {
        let grid = Grid::new(black_box(&photons));
        pixels().map(|p| grid.irradiance(p)[0]).sum::<f64>()
    });
}

#[divan::bench(sample_count = 5)]
fn query_by_plain_loop(bencher: Bencher) {
    let photons = photons(100_000, 16);
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

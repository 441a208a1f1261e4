//! Photon paths per second on the canonical scenes, all threads; the items of
//! the table are paths.

mod common;

use divan::{Bencher, counter::ItemsCount};
use nephroid::render::{Job, Renderer};

fn main() {
    divan::main();
}

#[divan::bench(args = common::CANONICAL, sample_count = 10)]
fn trace(bencher: Bencher, name: &str) {
    let scene = common::load(name);
    let mut settings = Job::of(&scene).settings;
    settings.photons = Some(1 << 17);
    let [w, h] = scene.resolution;
    let renderer = Renderer::new(&scene, &settings, scene.resolution, [0, 0, w, h]);
    let mut pass = 0;
    bencher
        .counter(ItemsCount::new(1u64 << 17))
        .bench_local(|| {
            pass += 1;
            renderer.shoot(pass, 0)
        });
}

//! One whole pass of each canonical scene, all threads.

mod common;

use divan::Bencher;
use nephroid::render::{Job, Renderer};

fn main() {
    divan::main();
}

#[divan::bench(args = common::CANONICAL, sample_count = 8)]
fn pass(bencher: Bencher, name: &str) {
    let scene = common::load(name);
    let [w, h] = scene.resolution;
    let renderer = Renderer::new(
        &scene,
        &Job::of(&scene).settings,
        scene.resolution,
        [0, 0, w, h],
    );
    let mut index = 0;
    bencher.bench_local(|| {
        index += 1;
        renderer.pass(index)
    });
}

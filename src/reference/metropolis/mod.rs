//! Metropolis light transport in primary sample space (C. Kelemen, L.
//! Szirmay-Kalos, G. Antal and F. Csonka, *A Simple and Robust Mutation
//! Strategy for the Metropolis Light Transport Algorithm*, Computer Graphics
//! Forum 21(3), 2002; after E. Veach and L. Guibas, *Metropolis Light
//! Transport*, SIGGRAPH 1997).
//!
//! Owns what bidirectional path tracing owns, which makes its paths. Once a
//! chain has found a path that brings much light, it stays near it. Every
//! third step is a large one, to a path drawn anew; the large steps of the
//! chains of a pass are one stratified set, those of one chain are
//! independent. Both states of a step are counted, with the chances that the
//! chain is in them.
//!
//! A pass is an estimate of its own, with as many steps as the film has pixels,
//! and free of bias: its chains start at paths chosen from the pass's pilot in
//! proportion to their light, and count with the pilot's mean (Veach 1997,
//! section 11.3.1).
//!
//! For: light that finds its way through narrow openings.

mod primary;

use glam::DVec2;

use crate::{film::PixelSample, sampling::Discrete};

use super::{
    bdpt,
    random::Random,
    setup::{Contribution, Setup, Shares},
};

use primary::Primary;

/// Chains of a pass: at least the first number, and so many that none is
/// longer than the second.
const LEAST_CHAINS: u64 = 128;
const LONGEST: u64 = 4096;

/// A thread works on one chain.
const SHARES: Shares = Shares {
    chunk: 1,
    batch: 16,
};

/// One of so many steps is a large one.
const LARGE_EVERY: u64 = 3;

/// Paths of a pass's pilot: at least the first number, and one for so many
/// pixels.
const LEAST_PILOT: u64 = 1024;
const PIXELS_PER_PILOT: u64 = 4;

/// Items of the sequences of the pilot, of the start of chains, of their
/// decisions, and, from the last one on, of their large steps.
const PILOT: u64 = 0;
const START: u64 = 2;
const DECISIONS: u64 = 3;
const LARGE: u64 = 8;

/// One pass of Metropolis light transport.
pub(super) fn pass(setup: &Setup<'_>, replicate: u32, round: u32) -> Vec<PixelSample> {
    let pilot = Pilot::new(setup, replicate, round);
    let Some(choice) = &pilot.choice else {
        return setup.by_sample(0, SHARES, |_, _| {});
    };
    let pixels = setup.film_pixels();
    let steps = pixels.div_ceil(pilot.chains);
    // Samples that cover the film with one a pixel count as they are.
    let unit = pilot.mean * pixels as f64 / (pilot.chains * steps) as f64;
    setup.by_sample(pilot.chains, SHARES, |chain, found| {
        let mut start = setup.sequence(replicate, START).at(u64::from(round));
        let u = (chain as f64 + start.next_1d()) / pilot.chains as f64;
        let first = choice.choose(|| u);
        pilot.follow(chain, steps, first as u64, unit, found);
    })
}

/// Chains of a pass over a film of so many pixels.
fn chains(pixels: u64) -> u64 {
    let chains = pixels.div_ceil(LONGEST).max(LEAST_CHAINS);
    chains.next_power_of_two()
}

/// States whose contributions are kept at once: two for each step of the
/// chains that are followed together.
pub(super) fn states(pixels: u64) -> u64 {
    2 * SHARES.chunk * SHARES.batch * pixels.div_ceil(chains(pixels))
}

/// The paths of a pass's pilot, and what its chains need.
struct Pilot<'a> {
    setup: &'a Setup<'a>,
    replicate: u32,
    round: u32,
    count: u64,
    chains: u64,
    /// Paths by their light; `None` if all are black.
    choice: Option<Discrete>,
    /// Mean light of a path.
    mean: f64,
}

impl<'a> Pilot<'a> {
    fn new(setup: &'a Setup<'a>, replicate: u32, round: u32) -> Self {
        let count = (setup.film_pixels() / PIXELS_PER_PILOT)
            .max(LEAST_PILOT)
            .next_power_of_two();
        let mut pilot = Self {
            setup,
            replicate,
            round,
            count,
            chains: chains(setup.film_pixels()),
            choice: None,
            mean: 0.0,
        };
        let lights = pilot.lights();
        pilot.mean = lights.iter().sum::<f64>() / count as f64;
        pilot.choice = Discrete::new(&lights);
        pilot
    }

    /// The light of every path of the pilot.
    fn lights(&self) -> Vec<f64> {
        use rayon::prelude::*;
        let light = |i| {
            let [mut camera, mut light] = self.start(i);
            let mut found = Vec::new();
            look(self.setup, &mut camera, &mut light, &mut found)
        };
        (0..self.count).into_par_iter().map(light).collect()
    }

    /// The numbers of a path of the pilot, for its two ends.
    fn start(&self, i: u64) -> [crate::sampling::Stream; 2] {
        let index = u64::from(self.round) * self.count + i;
        [0, 1].map(|lane| self.setup.sequence(self.replicate, PILOT + lane).at(index))
    }

    /// Follows a chain from path `first` of the pilot.
    fn follow(&self, chain: u64, steps: u64, first: u64, unit: f64, found: &mut Vec<Contribution>) {
        let address = u64::from(self.round) * self.chains + chain;
        let sequence = |item| self.setup.sequence(self.replicate, item).at(address);
        let [camera, light] = self.start(first);
        let mut camera = Primary::new(camera, sequence(DECISIONS));
        let mut light = Primary::new(light, sequence(DECISIONS + 1));
        let mut decisions = sequence(DECISIONS + 2);
        let mut now = Vec::new();
        let mut bright = look(self.setup, &mut camera, &mut light, &mut now);
        for step in 0..steps {
            let large = step % LARGE_EVERY == 0;
            let item = LARGE + 2 * (step / LARGE_EVERY);
            camera.propose(large.then(|| sequence(item)));
            light.propose(large.then(|| sequence(item + 1)));
            let mut next = Vec::new();
            let next_bright = look(self.setup, &mut camera, &mut light, &mut next);
            let chance = if bright > 0.0 {
                (next_bright / bright).min(1.0)
            } else {
                1.0
            };
            count(&now, bright, unit * (1.0 - chance), found);
            count(&next, next_bright, unit * chance, found);
            if decisions.next_1d() < chance {
                camera.accept();
                light.accept();
                (now, bright) = (next, next_bright);
            } else {
                camera.reject();
                light.reject();
            }
        }
    }
}

/// What a state brings, by its share in the chain.
fn count(state: &[Contribution], bright: f64, share: f64, found: &mut Vec<Contribution>) {
    if bright > 0.0 && share > 0.0 {
        found.extend(state.iter().map(|c| Contribution {
            value: c.value * (share / bright),
            ..*c
        }));
    }
}

/// The light of the path that two sets of numbers make: where it is seen goes
/// to `found`, its sum over the film is returned.
fn look(
    setup: &Setup<'_>,
    camera: &mut impl Random,
    light: &mut impl Random,
    found: &mut Vec<Contribution>,
) -> f64 {
    let (corner, [width, height]) = setup.film();
    let size = DVec2::new(f64::from(width), f64::from(height));
    camera.seek(0);
    let film = corner + DVec2::from_array(camera.next_2d()) * size;
    bdpt::sample(setup, film, setup.film_pixels(), camera, light, found);
    found.retain(|c| {
        let at = c.film - corner;
        c.value.is_finite() && at.min_element() >= 0.0 && at.cmplt(size).all()
    });
    found.iter().map(|c| c.value.mean()).sum()
}

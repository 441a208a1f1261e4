//! Radiosity: finite elements for light between diffuse surfaces (C. Goral, K.
//! Torrance, D. Greenberg and B. Battaile, *Modeling the Interaction of Light
//! Between Diffuse Surfaces*, SIGGRAPH 1984), solved by shooting (M. Cohen, S.
//! Chen, J. Wallace and D. Greenberg, *A Progressive Refinement Approach to
//! Fast Radiosity Image Generation*, SIGGRAPH 1988), with form factors found by
//! rays (L. Neumann et al., *The Stochastic Ray Method for Radiosity*,
//! Eurographics Workshop on Rendering 1995).
//!
//! Owns L D* E, crossing panes in straight lines. Mirrors and glass are black
//! to it, whether the eye or the light meets them.
//!
//! Diffuse surfaces are divided into elements, cells of equal size in a grid on
//! each part of a shape; both sides of each hold light of their own. A pass
//! shoots the power of the lights onto them, then again and again what each has
//! received and not yet sent on: rays leave evenly from all of an element,
//! spread by the cosine, and where they land, a part of its power does. The
//! share of an element's rays that meets another one is an estimate of their
//! form factor. The steps end when little is left to be shot.
//!
//! The picture is no picture of the elements. What is seen directly is lit by
//! shadow rays, and a gathering ray looks up the element that it meets: so the
//! surface that is seen shades smoothly, and elements show only in the light
//! that they send. Passes are independent; their mean is that of exact form
//! factors between the elements. What stays is what is lost by taking the light
//! on an element for constant: it falls with the size of the elements.
//!
//! For: what is computed where no surface is specular.

mod chart;
mod elements;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::{
    film::{Layer, PixelSample},
    geometry::Ray,
    numeric::Frame,
    sampling::{Stream, warp},
    scene::Scene,
    spectrum::Rgb,
};

use super::{
    eye::{first_seen, lit},
    flight::{Flight, Met, landing},
    light,
    random::{Layout, Random},
    setup::Setup,
};

use elements::Elements;
pub(super) use elements::{BYTES_PER_ELEMENT, count, obstacle};

/// The shooting ends when this part of the lights' power is left.
const SETTLED: f64 = 1e-4;

/// Fewest rays of a step.
const FEWEST_RAYS: u64 = 64;

/// Rays on which one thread works at a time, and such shares whose landings
/// are kept at once.
const CHUNK: u64 = 1024;
const BATCH: u64 = 64;

/// Bytes of the landings that are kept.
pub(super) const BYTES_OF_LANDINGS: u64 = CHUNK * BATCH * size_of::<Landing>() as u64;

/// Power that lands on a side of an element.
type Landing = (usize, Rgb);

/// A radiosity solver.
pub(super) struct Solver<'a> {
    elements: Elements<'a>,
}

/// The irradiance of every side of every element.
pub(super) struct Solution(Vec<Rgb>);

impl<'a> Solver<'a> {
    /// Divides the scene's diffuse surfaces into elements; see
    /// [`Options::patches`](super::Options::patches).
    pub(super) fn new(scene: &'a Scene, patches: u32) -> Self {
        Self {
            elements: Elements::new(scene, patches),
        }
    }

    /// One pass of a replicate.
    pub(super) fn pass(&self, setup: &Setup<'_>, replicate: u32, round: u32) -> Vec<PixelSample> {
        let solution = if setup.allows(2) {
            self.solve(setup, replicate, round)
        } else {
            Solution(Vec::new())
        };
        setup.by_pixel(replicate, round, |film, mut stream| {
            self.radiance(setup, &solution, setup.camera.ray(film), &mut stream)
        })
    }

    /// What is seen along a camera ray.
    fn radiance(
        &self,
        setup: &Setup<'_>,
        solution: &Solution,
        ray: Ray,
        random: &mut impl Random,
    ) -> PixelSample {
        let ctx = setup.context();
        let mut sample = PixelSample::default();
        let mut flight = Flight::from_camera(&ctx, ray);
        let Some(at) = first_seen(setup, &mut flight, random, false, &mut sample) else {
            return sample;
        };
        let (seen, depth) = (flight.throughput, flight.depth);
        if setup.allows(2)
            && flight.bounce(&ctx, &at, random)
            && let Met::Diffuse(next) = flight.next(&ctx, random)
            && let Some(side) = self.side(&next)
        {
            let radiosity = next.reflectance * solution.0[side];
            sample[Layer::Indirect] += flight.throughput * radiosity * std::f64::consts::FRAC_1_PI;
        }
        random.seek(Layout::light(depth));
        sample[Layer::Direct] += seen * lit(&ctx, &setup.sources(), &at, random, |_, _| 1.0);
        sample
    }

    /// The side of an element on which a point lies: twice its number, and one
    /// more behind the geometric normal.
    fn side(&self, at: &crate::transport::DiffusePoint) -> Option<usize> {
        let behind = at.ng.dot(at.point.ng) < 0.0;
        Some(2 * self.elements.at(&at.point)? + usize::from(behind))
    }

    /// Shoots until the light has settled.
    fn solve(&self, setup: &Setup<'_>, replicate: u32, round: u32) -> Solution {
        let ctx = setup.context();
        let paths = setup.light_paths();
        let sides = 2 * self.elements.all().len();
        let sequence = setup.light_sequence(replicate);
        let mut arrived = vec![Rgb::BLACK; sides];
        let lights = |i: u64| {
            let mut stream = sequence.at_own_order(u64::from(round) * paths + i);
            let mut flight = light::start(setup, &mut stream)?;
            self.landing(setup, &mut flight, &mut stream)
        };
        land(paths, &lights, &mut arrived);
        for flux in &mut arrived {
            *flux = *flux / paths as f64;
        }

        let mut total = arrived.clone();
        let mut first_power = None;
        for step in 1..ctx.max_depth {
            let shots = Shots::new(&self.elements, &arrived);
            let first = *first_power.get_or_insert(shots.power);
            if shots.power <= SETTLED * first {
                break;
            }
            // As many for each unit of power as in the first step.
            let share = shots.power / first;
            let rays = ((paths as f64 * share).ceil() as u64).max(FEWEST_RAYS);
            let sequence = setup.sequence(replicate, u64::MAX - u64::from(step));
            let shift = sequence.at_own_order(u64::from(round)).next_1d();
            arrived.fill(Rgb::BLACK);
            let shoot = |i: u64| {
                let mut stream = sequence.at_own_order((u64::from(round) + 1) << 32 | i);
                let (side, flux) = shots.shot((i as f64 + shift) / rays as f64)?;
                let (mut flight, weight) = self.leaving(side, flux, &mut stream)?;
                flight.throughput *= weight / rays as f64;
                self.landing(setup, &mut flight, &mut stream)
            };
            land(rays, &shoot, &mut arrived);
            for (total, arrived) in total.iter_mut().zip(&arrived) {
                *total += *arrived;
            }
        }
        for (side, flux) in total.iter_mut().enumerate() {
            *flux = *flux / self.elements.all()[side / 2].area;
        }
        Solution(total)
    }

    /// A ray from a side of an element, and the weight of its place.
    fn leaving(&self, side: usize, flux: Rgb, stream: &mut Stream) -> Option<(Flight, f64)> {
        let [place, direction] = [stream.next_2d(), stream.next_2d()];
        let (point, weight) = self.elements.point(side / 2, place)?;
        let normal = if side % 2 == 1 { -point.ng } else { point.ng };
        let local = warp::cosine_hemisphere(direction);
        let dir = Frame::around(normal).to_world(local).normalize();
        // A direction along the surface may be rounded to its other side.
        (dir.dot(normal) > 0.0).then(|| (Flight::from_surface(point.spawn(dir), flux), weight))
    }

    /// Where the power of a flight lands, if on a diffuse surface.
    fn landing(
        &self,
        setup: &Setup<'_>,
        flight: &mut Flight,
        random: &mut impl Random,
    ) -> Option<Landing> {
        let Met::Diffuse(at) = flight.next(&setup.context(), random) else {
            return None;
        };
        let flux = flight.throughput * landing(&at, flight.ray.dir);
        Some((self.side(&at)?, flux))
    }
}

/// What is to be shot in a step.
struct Shots {
    /// Power that each side sends.
    flux: Vec<Rgb>,
    /// Sums of the powers up to each side.
    sums: Vec<f64>,
    /// Power of all sides, mean of the channels.
    power: f64,
}

impl Shots {
    /// The part of the power that has arrived on each side which is reflected.
    fn new(elements: &Elements<'_>, arrived: &[Rgb]) -> Self {
        let flux: Vec<Rgb> = (0..)
            .zip(arrived)
            .map(|(side, flux)| elements.reflectance(side / 2) * *flux)
            .collect();
        let mut power = 0.0;
        let add = |flux: &Rgb| {
            power += flux.mean();
            power
        };
        let sums = flux.iter().map(add).collect();
        Self { flux, sums, power }
    }

    /// The side whose turn it is at `u` in `[0, 1)`, each as often as it has
    /// power, and what is sent then over the chance of it.
    fn shot(&self, u: f64) -> Option<(usize, Rgb)> {
        let target = u * self.power;
        let side = self.sums.partition_point(|sum| *sum <= target);
        let flux = *self.flux.get(side)?;
        Some((side, flux * (self.power / flux.mean())))
    }
}

/// Adds up where `count` rays land, in their order, whichever threads worked
/// on them.
fn land(count: u64, ray: &(impl Fn(u64) -> Option<Landing> + Sync), arrived: &mut [Rgb]) {
    let chunks = count.div_ceil(CHUNK);
    for first in (0..chunks).step_by(BATCH as usize) {
        let found: Vec<Vec<Landing>> = (first..(first + BATCH).min(chunks))
            .into_par_iter()
            .map(|c| {
                (c * CHUNK..((c + 1) * CHUNK).min(count))
                    .filter_map(ray)
                    .collect()
            })
            .collect();
        for (side, flux) in found.into_iter().flatten() {
            arrived[side] += flux;
        }
    }
}

//! Whether bounces are aimed: a pilot.
//!
//! Aimed paths tell the variance of those that are not. If p is the density of
//! mixed directions and q that by the cosine, a path's light x, drawn and weighed
//! by p, would have the second moment mean(x² p / q) by the cosine, and
//! the cost mean(c q / p).

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    geometry::Ray,
    material::Material,
    photon::{Emitter, Vicinity, shoot},
    sampling::{Purpose, Sequence, Stream},
    transport::{DiffusePoint, End, Walker},
};

use super::{Bounces, density};
use crate::render::{
    Renderer,
    camera_walk::{Gather, SPLIT_ABOVE},
    coordinates,
    learn::PILOT_PHOTONS,
    share::trimmed_mean,
    tally::CameraTally,
    view::view,
};

/// Pixels at which the pilot looks, and paths through each.
const PIXELS: u64 = 512;
const PATHS: u64 = 4;

/// Numbers of its sequences among those of pilots: places, paths, and
/// photons.
const SEQUENCES: [u32; 3] = [10, 11, 12];

/// Factor on variance times cost that aiming has to bring: mixed directions are
/// stratified less well than one look all around, which is not seen here.
const WORTH: f64 = 0.9;

/// What a path found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Look {
    /// Light that came straight to the point seen, and by way of the bounce.
    pub(super) light: [f64; 2],
    /// The density of aimed directions over that by the cosine.
    pub(super) ratio: Option<f64>,
    /// Work up to the bounce and from there on, in rays cast.
    pub(super) work: [f64; 2],
}

impl Renderer<'_> {
    /// How paths bounce from the first diffuse surface, by a pilot over the whole
    /// picture.
    pub(in crate::render) fn find_bounces(&self, emitter: Option<&Emitter>) -> Bounces {
        let trial = Bounces::aimed(self.scene);
        if !self.called_for().plan.indirect() || trial.targets.is_empty() {
            return Bounces::EVEN;
        }
        let pilot =
            |k: usize, item| Sequence::new(self.settings.seed, Purpose::Pilot, SEQUENCES[k], item);
        let map = emitter.map(|emitter| {
            let shot = shoot(&self.called_for(), emitter, pilot(2, 0), 0, PILOT_PHOTONS);
            self.map(&shot, 0)
        });
        let gather = self.scout(map.as_ref(), 0);
        let places = pilot(0, 0);
        let [width, height] = self.resolution.map(f64::from);
        let looks: Vec<[Look; PATHS as usize]> = (0..PIXELS)
            .into_par_iter()
            .map(|i| {
                let [u, v] = places.at(i).next_2d();
                let [x, y] = [(u * width).floor(), (v * height).floor()];
                let paths = pilot(1, i);
                let mut near = gather.vicinity();
                std::array::from_fn(|j| {
                    let stream = paths.at(j as u64);
                    let [s, t] = coordinates::film(&stream);
                    let ray = self.camera.ray(DVec2::new(x + s, y + t));
                    look(&gather, &mut near, &trial, ray, &stream)
                })
            })
            .collect();
        if is_worth_it(&looks) {
            trial
        } else {
            Bounces::EVEN
        }
    }
}

/// What is seen through a place on the film, and a bounce off the first diffuse
/// surface.
fn look(
    gather: &Gather<'_>,
    near: &mut Option<Vicinity<'_>>,
    trial: &Bounces,
    ray: Ray,
    stream: &Stream,
) -> Look {
    let mut found = Look::default();
    let (mut tally, mut beyond) = (CameraTally::default(), CameraTally::default());
    let mut ends = 0;
    view(
        &gather.ctx,
        ray,
        SPLIT_ABOVE,
        coordinates::coins(stream),
        &mut tally,
        |walker, end, tally| {
            let Some(at) = diffuse(walker, end) else {
                return;
            };
            let mut here = coordinates::shading(stream, ends);
            let u = here.next_2d();
            found.light[0] += gather.seen(walker, &at, &mut here, near, tally).mean();
            if ends == 0
                && let Some(bounce) = trial.direction(&at, u)
            {
                let path = Walker {
                    throughput: walker.throughput * at.reflectance,
                    strength: at.reflectance.max(),
                    ..*walker
                };
                let streams = [coordinates::path(stream, 0), coordinates::aside(stream, 0)];
                let (light, _) = gather.indirect(path, &at, &bounce, streams, near, &mut beyond);
                found.light[1] = light.mean();
                found.ratio = bounce.ratio;
            }
            ends += 1;
        },
    );
    found.work = [tally, beyond].map(|t| t.work(1).of_sample());
    found
}

/// The diffuse point at the end of a walk.
fn diffuse(path: &Walker, end: &End) -> Option<DiffusePoint> {
    match *end {
        End::Surface {
            point,
            material: Material::Diffuse { reflectance },
        } => Some(DiffusePoint::new(
            point,
            path.ray.dir,
            reflectance,
            path.media,
        )),
        _ => None,
    }
}

/// Whether aimed bounces leave less variance for their cost.
pub(super) fn is_worth_it<const N: usize>(looks: &[[Look; N]]) -> bool {
    let by_cosine = |l: &Look| density(l.ratio);
    inefficiency(looks, |_| 1.0) < WORTH * inefficiency(looks, by_cosine)
}

/// Relative variance times cost of bounces whose density was that of the looks over
/// `as_if`.
fn inefficiency<const N: usize>(looks: &[[Look; N]], as_if: impl Fn(&Look) -> f64) -> f64 {
    let n = N as f64;
    let sum = |pixel: &[Look; N], f: &dyn Fn(&Look) -> f64| pixel.iter().map(f).sum::<f64>();
    let light = |pixel: &[Look; N]| sum(pixel, &|l| l.light[0] + l.light[1]) / n;
    let mean = trimmed_mean(looks.iter().map(light));
    // Light k of a pixel: its mean square if paths are as many as said, less the
    // square of its mean, from pairs of different paths; relative to the pixel.
    let variance = |pixel: &[Look; N], k: usize, as_if: &dyn Fn(&Look) -> f64| {
        let total = sum(pixel, &|l| l.light[k]);
        let squares = sum(pixel, &|l| l.light[k].powi(2));
        let second = sum(pixel, &|l| l.light[k].powi(2) * as_if(l)) / n;
        let squared = (total * total - squares) / (n * (n - 1.0));
        (second - squared) / (light(pixel).powi(2) + 0.01 * mean * mean)
    };
    // Further samples go where neighbours differ, which tells of edges; errors
    // there are what such sharing leaves. It tells little of rare paths.
    let edges = trimmed_mean(
        looks
            .iter()
            .map(|p| variance(p, 0, &|_| 1.0).max(0.0).sqrt()),
    );
    let rare = trimmed_mean(looks.iter().map(|p| variance(p, 1, &as_if))).max(0.0);
    let work = |pixel: &[Look; N]| sum(pixel, &|l| l.work[0] + l.work[1] / as_if(l));
    (edges * edges + rare) * looks.iter().map(work).sum::<f64>()
}

//! The camera half of a pass: a sample of every pixel, then more where
//! neighbours differ.

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    built,
    film::{Layer, PixelSample},
    geometry::Ray,
    sampling::{Purpose, Sequence, Stream},
    spectrum::Rgb,
};

use super::{
    Renderer,
    camera_walk::Gather,
    coordinates,
    glints::{self, Glinting, Glints, Places},
    learn::Weighed,
    pilot,
    refine::{REACH, Refinement},
    share,
    tally::CameraTally,
};

/// Places at which the pilot looks at a pixel's neighbours: one for so many pixels,
/// but no fewer and no more than these. Thin bright lines hold few pixels and much
/// of the error: with a hundred places chance decides whether they are seen.
const PIXELS_PER_PLACE: u64 = 128;
const PILOT_PLACES: [u64; 2] = [96, 1024];

/// Pixels along a tile, whose pixels are sampled one after the other.
const TILE: u32 = 8;

/// Pixels along a stretch of tiles that is worked on at once: a whole number of
/// tiles, so few that all threads end at nearly the same time.
const STRETCH: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy)]
struct Window {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Window {
    /// The pixels within `REACH` of this window, as far as there are any.
    fn grown(self, [width, height]: [u32; 2]) -> Self {
        let (x, y) = (self.x.saturating_sub(REACH), self.y.saturating_sub(REACH));
        Self {
            x,
            y,
            width: (self.x + self.width + REACH).min(width) - x,
            height: (self.y + self.height + REACH).min(height) - y,
        }
    }

    fn index(self, x: u32, y: u32) -> usize {
        (y - self.y) as usize * self.width as usize + (x - self.x) as usize
    }

    /// What `pixel` makes of every pixel, given by rows. Stretches of tiles are
    /// worked on in parallel; `of_stretch` makes what the pixels of one share.
    fn map<T: Clone + Default + Send, B>(
        self,
        of_stretch: impl Fn() -> B + Sync,
        pixel: impl Fn(u32, u32, &mut B, &mut CameraTally) -> T + Sync,
    ) -> (Vec<T>, CameraTally) {
        let row = self.width as usize;
        // The first to touch new memory waits for it: all threads do.
        let pixels = row * self.height as usize;
        let mut all: Vec<T> = rayon::iter::repeat_n(T::default(), pixels).collect();
        let bands = all.chunks_mut((row * TILE as usize).max(1)).enumerate();
        let stretches: Vec<_> = bands
            .flat_map(|(band, pixels)| {
                let top = band as u32 * TILE;
                stretches(pixels, row).map(move |(left, rows)| (left, top, rows))
            })
            .collect();
        let tally = stretches
            .into_par_iter()
            // They differ in work: none waits behind another.
            .with_max_len(1)
            .map(|(left, top, mut rows)| {
                let (mut tally, mut shared) = (CameraTally::default(), of_stretch());
                let (end, height) = (rows[0].len() as u32, rows.len() as u32);
                for first in (0..end).step_by(TILE as usize) {
                    for [x, y] in from_the_middle(TILE.min(end - first), height) {
                        let x = first + x;
                        let [px, py] = [self.x + left + x, self.y + top + y];
                        rows[y as usize][x as usize] = pixel(px, py, &mut shared, &mut tally);
                    }
                }
                tally
            })
            .reduce(CameraTally::default, |mut a, b| {
                a += b;
                a
            });
        (all, tally)
    }

    /// The indices of a pixel and those around.
    fn around(self, x: u32, y: u32) -> impl Iterator<Item = usize> {
        let rows = y.saturating_sub(REACH).max(self.y)..(y + REACH + 1).min(self.y + self.height);
        let columns = x.saturating_sub(REACH).max(self.x)..(x + REACH + 1).min(self.x + self.width);
        rows.flat_map(move |ny| columns.clone().map(move |nx| self.index(nx, ny)))
    }

    /// Radiances of the pixels around one.
    fn neighbours(self, radiance: &[f64], x: u32, y: u32) -> ([f64; MOST_NEIGHBOURS], usize) {
        let mut found = [0.0; MOST_NEIGHBOURS];
        let mut count = 0;
        let own = self.index(x, y);
        for i in self.around(x, y).filter(|&i| i != own) {
            found[count] = radiance[i];
            count += 1;
        }
        (found, count)
    }

    /// Sheets of light over what is seen in a pixel and those around, as
    /// [`PixelSample::sheets`] has them.
    fn sheets_around(self, samples: &[PixelSample], x: u32, y: u32) -> [f64; 2] {
        self.around(x, y).fold([0.0; 2], |[sheets, weight], i| {
            let own = samples[i].sheets[0];
            [sheets + own[0], weight + own[1]]
        })
    }
}

/// The stretches of a band of tiles, each with its first column and the part of
/// every row that belongs to it.
fn stretches<T>(band: &mut [T], row: usize) -> impl Iterator<Item = (u32, Vec<&mut [T]>)> {
    let mut rows: Vec<_> = band
        .chunks_mut(row.max(1))
        .map(|row| row.chunks_mut(STRETCH as usize))
        .collect();
    (0..row as u32).step_by(STRETCH as usize).map(move |left| {
        let parts = rows.iter_mut().filter_map(Iterator::next).collect();
        (left, parts)
    })
}

/// The pixels of a tile, the one in the middle first: what is searched for it
/// lies around all of them.
fn from_the_middle(width: u32, height: u32) -> impl Iterator<Item = [u32; 2]> {
    let count = width * height;
    let middle = height / 2 * width + width / 2;
    (0..count).map(move |i| {
        let i = (i + middle) % count;
        [i % width, i / width]
    })
}

const MOST_NEIGHBOURS: usize = ((2 * REACH + 1) * (2 * REACH + 1) - 1) as usize;

impl Renderer<'_> {
    /// The number of a pixel in the whole picture, so that a crop shows the
    /// same samples.
    fn item(&self, px: u32, py: u32) -> u64 {
        u64::from(py) * u64::from(self.resolution[0]) + u64::from(px)
    }

    /// The ray of a stream through a pixel.
    pub(super) fn ray(&self, px: u32, py: u32, stream: &Stream) -> Ray {
        self.ray_at(px, py, coordinates::film(stream))
    }

    /// The ray through a pixel that belongs to a place of the unit square.
    fn ray_at(&self, px: u32, py: u32, place: [f64; 2]) -> Ray {
        let [x, y] = self.scene.filter.place(place);
        self.camera
            .ray(DVec2::new(f64::from(px) + x, f64::from(py) + y))
    }

    fn window(&self) -> Window {
        let [x, y, width, height] = self.crop;
        Window {
            x,
            y,
            width,
            height,
        }
    }

    /// Where sources may glint in a round, by pixels of the window and of what is sampled
    /// around it; found when it is first asked for, which must not be from within a
    /// parallel loop.
    pub(super) fn glinting(&self, round: u32) -> &Glinting {
        let closer = round >= glints::CLOSER_ROUND;
        self.glinting[usize::from(closer)].get_or_init(|| self.find_glints(closer))
    }

    fn find_glints(&self, closer: bool) -> Glinting {
        if !self.plan().glints() {
            return Vec::new();
        }
        let window = self.window().grown(self.resolution);
        let glints = Glints::new(self.scene);
        let mut gather = self.scout(None, 0);
        gather.ctx.max_depth = gather.ctx.max_depth.min(glints::PILOT_DEPTH);
        let (found, _) = window.map(
            || (),
            |px, py, (), _| {
                let item = self.item(px, py);
                let places = Places::search(closer, |j, cell| {
                    let stream = glints::pilot_stream(self.settings.seed, item, j);
                    let ray = self.ray_at(px, py, cell.place(coordinates::film(&stream)));
                    gather.distances_to(&glints, ray, &stream)
                });
                places.map(Box::new)
            },
        );
        found
    }

    /// Where further samples pay, by a pilot over the whole picture that looks at
    /// pixels with their neighbours. `weighed` is what an epoch knows of its photons,
    /// with the number of paths that it launches a pass; `None` without photons.
    pub(super) fn find_refinement(
        &self,
        weighed: Option<(&Weighed, u64)>,
        epoch: Option<usize>,
    ) -> Refinement {
        let (round, number) = (pilot::round(epoch), pilot::sequence(epoch) + 4);
        let pilot =
            |k: u32, item| Sequence::new(self.settings.seed, Purpose::Pilot, number + k, item);
        let gather = self.scout(weighed.map(|(w, _)| &w.map), round);
        let [width, height] = self.resolution;
        let pixels = u64::from(width) * u64::from(height);
        let count = (pixels / PIXELS_PER_PLACE).clamp(PILOT_PLACES[0], PILOT_PLACES[1]);
        let places = pilot(0, 0);
        let found: Vec<(Vec<f64>, CameraTally)> = (0..count)
            .into_par_iter()
            .map(|i| {
                let [u, v] = places.at(i).next_2d();
                let place = Window {
                    x: (u * f64::from(width)) as u32,
                    y: (v * f64::from(height)) as u32,
                    width: 1,
                    height: 1,
                };
                let around = place.grown(self.resolution);
                let mut tally = CameraTally::default();
                let mut near = gather.vicinity();
                let mut radiances = Vec::with_capacity(MOST_NEIGHBOURS + 1);
                for y in around.y..around.y + around.height {
                    for x in around.x..around.x + around.width {
                        let stream = pilot(1, self.item(x, y)).at(i);
                        let ray = self.ray(x, y, &stream);
                        let sample = gather.sample(ray, &stream, &mut near, &mut tally);
                        radiances.push(sample.total().mean());
                    }
                }
                (radiances, tally)
            })
            .collect();
        let all: Vec<f64> = found.iter().flat_map(|(r, _)| r).copied().collect();
        let mean = share::trimmed_mean(all.iter().copied());
        let variances: Vec<f64> = found
            .iter()
            .map(|(radiances, _)| super::refine::variance(radiances, super::refine::floor(mean)))
            .collect();
        let mut tally = CameraTally::default();
        for (_, t) in found {
            tally += t;
        }
        let sample_cost = tally.work(all.len() as u64).of_sample();
        let (noise, cost) = weighed.map_or((0.0, 0.0), |(w, paths)| {
            let cost = share::photon_cost(paths, pixels);
            (w.survey.photon_with(paths), cost / sample_cost)
        });
        Refinement::new(mean, &variances, noise, cost)
    }

    /// The camera half of a pass.
    pub(super) fn gather(
        &self,
        gather: &Gather<'_>,
        round: u32,
        replicate: u32,
    ) -> (Vec<PixelSample>, CameraTally) {
        let whole = self.window().grown(self.resolution);
        let (first, mut tally) = whole.map(
            || gather.vicinity(),
            |px, py, near, tally| {
                let sequence = self.sequence(Purpose::Camera, replicate, self.item(px, py));
                let stream = sequence.at_own_order(u64::from(round));
                gather.sample(self.ray(px, py, &stream), &stream, near, tally)
            },
        );
        let (refinement, glinting) = (self.refinement_of(round), self.glinting(round));
        let radiance: Vec<f64> = first.par_iter().map(|s| s.total().mean()).collect();
        let (samples, further) = self.window().map(
            || gather.vicinity(),
            |px, py, near, tally| {
                let (neighbours, count) = whole.neighbours(&radiance, px, py);
                let n = refinement.further(&neighbours[..count]);
                let i = whole.index(px, py);
                let mut sample = first[i];
                if sample.sheets[0][1] > 0.0 {
                    sample.sheets[1] = whole.sheets_around(&first, px, py);
                }
                if n > 0 {
                    // Every number of samples has a sequence of its own, of which
                    // each round takes the next part.
                    let item = self.item(px, py) | u64::from(n) << 48;
                    let sequence = self.sequence(Purpose::Refinement, replicate, item);
                    for j in 0..n {
                        let index = u64::from(round) * u64::from(n) + u64::from(j);
                        let stream = sequence.at_own_order(index);
                        let more = gather.sample(self.ray(px, py, &stream), &stream, near, tally);
                        sample += more;
                    }
                    sample = sample / f64::from(n + 1);
                }
                if built::GLINTS
                    && let Some(Some(places)) = glinting.get(i)
                {
                    let sequence = self.sequence(Purpose::Glint, replicate, self.item(px, py));
                    let first = u64::from(round) * glints::RAYS;
                    let streams = (first..first + glints::RAYS).map(|j| sequence.at(j));
                    sample[Layer::Emission] = self.glints(gather, places, streams, [px, py], tally);
                }
                sample
            },
        );
        tally += further;
        (samples, tally)
    }

    /// The sources in a pixel where they may glint.
    fn glints(
        &self,
        gather: &Gather<'_>,
        places: &Places,
        streams: impl Iterator<Item = Stream>,
        [px, py]: [u32; 2],
        tally: &mut CameraTally,
    ) -> Rgb {
        let mut sum = Rgb::BLACK;
        for stream in streams {
            let (place, weight) = places.draw(coordinates::glint(&stream));
            sum += gather.sources(self.ray_at(px, py, place), &stream, tally) * weight;
        }
        sum / glints::RAYS as f64
    }
}

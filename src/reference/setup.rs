//! What all passes of one render by a reference method share, and how
//! samples become pixels.

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    camera::{Camera, Filter},
    film::{Layer, PixelSample},
    geometry::BoundingSphere,
    plan::Plan,
    sampling::{Purpose, Sequence, Stream},
    scene::{Scene, Settings},
    spectrum::Rgb,
    transport::{Context, LightPicker},
};

use super::{Method, sources::Sources};

/// How samples are shared out. The picture does not depend on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    /// Samples on which one thread works at a time.
    pub(super) chunk: u64,
    /// Chunks whose contributions are kept at once.
    pub(super) batch: u64,
}

impl Shares {
    /// For samples that are single paths.
    pub(super) const PATHS: Self = Self {
        chunk: 512,
        batch: 64,
    };
}

/// One part of what a sample brought: radiance at a place on the film, to be
/// weighed by the pixels' filters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    /// In pixels of the whole picture.
    pub(super) film: DVec2,
    pub(super) layer: Layer,
    /// Radiance, where the samples of a pass cover the film with one a pixel.
    pub(super) value: Rgb,
}

/// Pixels that a filter reaches beyond its own.
fn margin(filter: Filter) -> u32 {
    (filter.radius() - 0.5).ceil() as u32
}

/// Pixels of the film that the pixels of a window look at.
pub(super) fn film_pixels(filter: Filter, [_, _, width, height]: [u32; 4]) -> u64 {
    let along = |pixels: u32| u64::from(pixels) + 2 * u64::from(margin(filter));
    along(width) * along(height)
}

/// The layer of a path that meets `diffuse` diffuse surfaces; `bent` tells
/// whether its light was reflected or refracted before it came to the first.
pub(super) fn layer_of(diffuse: u32, bent: bool) -> Layer {
    match diffuse {
        0 => Layer::Emission,
        1 if bent => Layer::Caustic,
        1 => Layer::Direct,
        _ => Layer::Indirect,
    }
}

/// The scene and the view.
pub(super) struct Setup<'a> {
    pub(super) scene: &'a Scene,
    plan: Plan,
    picker: LightPicker,
    max_depth: u32,
    seed: u64,
    /// First radius of a density estimate, in pixel footprints.
    first_radius: f64,
    light_paths: u64,
    /// Keeps the random numbers of the methods apart.
    family: u32,
    pub(super) camera: Camera,
    filter: Filter,
    /// x, y, width, height in pixels.
    window: [u32; 4],
    around: Option<BoundingSphere>,
}

impl<'a> Setup<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        settings: &Settings,
        method: Method,
        resolution: [u32; 2],
        window: [u32; 4],
        light_paths: u64,
    ) -> Self {
        Self {
            scene,
            plan: Plan::new(scene, settings),
            picker: LightPicker::new(scene),
            max_depth: settings.max_depth,
            seed: settings.seed,
            first_radius: settings.radius,
            light_paths,
            family: match method {
                // Both look through the same places of the film.
                Method::Path | Method::Whitted => 0,
                Method::Light => 1,
                Method::LightNaive => 2,
                Method::Bdpt => 3,
                Method::Metropolis => 4,
                Method::PhotonMap => 5,
                Method::Sppm => 6,
                Method::Radiosity => 7,
            },
            camera: scene.camera.with_resolution(resolution),
            filter: scene.filter,
            window,
            around: scene.world.bounds().map(|b| b.bounding_sphere()),
        }
    }

    pub(super) fn context(&self) -> Context<'_> {
        Context {
            scene: self.scene,
            plan: &self.plan,
            picker: &self.picker,
            max_depth: self.max_depth,
        }
    }

    pub(super) fn sources(&self) -> Sources<'_> {
        Sources::new(self.context(), self.around)
    }

    /// Whether a path may meet this many diffuse surfaces.
    pub(super) fn allows(&self, diffuse: u32) -> bool {
        diffuse <= 1 || self.plan.indirect
    }

    /// A family of sample points for one replicate; `item` keeps apart what
    /// must be independent within a pass.
    pub(super) fn sequence(&self, replicate: u32, item: u64) -> Sequence {
        let family = self.family << 8 | replicate;
        Sequence::new(self.seed, Purpose::Reference, family, item)
    }

    /// Pixels that the window's filters reach beyond it.
    fn margin(&self) -> u32 {
        margin(self.filter)
    }

    /// The film that the pixels of the window look at: its top left corner
    /// and its size in pixels.
    pub(super) fn film(&self) -> (DVec2, [u32; 2]) {
        let [x, y, w, h] = self.window.map(f64::from);
        let m = self.margin();
        let corner = DVec2::new(x - f64::from(m), y - f64::from(m));
        (corner, [w as u32 + 2 * m, h as u32 + 2 * m])
    }

    /// Pixels of [`film`](Self::film).
    pub(super) fn film_pixels(&self) -> u64 {
        film_pixels(self.filter, self.window)
    }

    /// A pass in which every pixel is worked on by itself: `look` gets a
    /// place on the film, drawn from the pixel's filter with the first two
    /// coordinates of a stream, and that stream.
    pub(super) fn by_pixel(
        &self,
        replicate: u32,
        round: u32,
        look: impl Fn(DVec2, Stream) -> PixelSample + Sync,
    ) -> Vec<PixelSample> {
        let mut nothing = vec![(); self.window_pixels()];
        self.by_pixel_with(replicate, round, &mut nothing, |(), film, stream| {
            look(film, stream)
        })
    }

    /// The same where every pixel of the window has something of its own that
    /// lasts from pass to pass, row by row.
    pub(super) fn by_pixel_with<T: Send>(
        &self,
        replicate: u32,
        round: u32,
        own: &mut [T],
        look: impl Fn(&mut T, DVec2, Stream) -> PixelSample + Sync,
    ) -> Vec<PixelSample> {
        let [x0, y0, width, _] = self.window;
        let mut pixels = vec![PixelSample::default(); self.window_pixels()];
        let row = width.max(1) as usize;
        let rows = pixels.par_chunks_mut(row).zip(own.par_chunks_mut(row));
        rows.enumerate().for_each(|(row, (pixels, own))| {
            for (column, (pixel, own)) in pixels.iter_mut().zip(own).enumerate() {
                let (x, y) = (x0 + column as u32, y0 + row as u32);
                let item = u64::from(y) << 32 | u64::from(x);
                let mut stream = self.sequence(replicate, item).at(u64::from(round));
                let [dx, dy] = self.filter.place(stream.next_2d());
                let film = DVec2::new(f64::from(x) + dx, f64::from(y) + dy);
                *pixel = look(own, film, stream);
            }
        });
        pixels
    }

    /// Pixels of the window.
    pub(super) fn window_pixels(&self) -> usize {
        let [_, _, width, height] = self.window;
        width as usize * height as usize
    }

    /// Kernel radius with which a progressive estimate begins, in pixel
    /// footprints.
    pub(super) fn first_radius(&self) -> f64 {
        self.first_radius
    }

    /// Light paths of a pass.
    pub(super) fn light_paths(&self) -> u64 {
        self.light_paths
    }

    /// The address of the paths from the lights, apart from all pixels.
    pub(super) fn light_sequence(&self, replicate: u32) -> Sequence {
        self.sequence(replicate, u64::MAX)
    }

    /// A pass in which samples bring light to any place: `bring` makes the
    /// contributions of sample `i` of `count`. They are added in the order of
    /// the samples, whichever threads worked on them.
    pub(super) fn by_sample(
        &self,
        count: u64,
        Shares { chunk, batch }: Shares,
        bring: impl Fn(u64, &mut Vec<Contribution>) + Sync,
    ) -> Vec<PixelSample> {
        let mut pixels = vec![PixelSample::default(); self.window_pixels()];
        let chunks = count.div_ceil(chunk);
        for first in (0..chunks).step_by(batch as usize) {
            let found: Vec<Vec<Contribution>> = (first..(first + batch).min(chunks))
                .into_par_iter()
                .map(|c| {
                    let mut found = Vec::new();
                    for i in c * chunk..((c + 1) * chunk).min(count) {
                        bring(i, &mut found);
                    }
                    found
                })
                .collect();
            for contribution in found.iter().flatten() {
                self.splat(contribution, &mut pixels);
            }
        }
        pixels
    }

    /// Adds a contribution to the pixels whose filters reach it.
    fn splat(&self, contribution: &Contribution, pixels: &mut [PixelSample]) {
        let Contribution { film, layer, value } = *contribution;
        let [x0, y0, width, height] = self.window.map(i64::from);
        // Far outside `as` saturates, and so is the pixel.
        let [column, row] = [film.x, film.y].map(|v| v.floor() as i64);
        let reach = i64::from(self.margin());
        for y in (row - reach).max(y0)..=(row + reach).min(y0 + height - 1) {
            for x in (column - reach).max(x0)..=(column + reach).min(x0 + width - 1) {
                let weight = if reach == 0 {
                    1.0
                } else {
                    self.filter.density(film.x - x as f64 - 0.5)
                        * self.filter.density(film.y - y as f64 - 0.5)
                };
                pixels[((y - y0) * width + x - x0) as usize][layer] += value * weight;
            }
        }
    }
}

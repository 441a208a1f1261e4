//! Pictures for the reader: what a method has to show after equal times and at
//! equal errors.

use std::{fs, path::Path};

use crate::{
    film::{Image, OutputError, write_png},
    metrics::{Plane, magma, relative_errors},
    spectrum::Rgb,
};

use super::{
    fault::Fault,
    record::{Picture, Point},
    run::Finished,
    store::{Store, slug},
    truth::Yardstick,
};

/// The relative error that has the brightest colour in the maps of errors, by
/// pixel: root of the mean of the channels' squares.
pub const MAP_TOP: f64 = 0.5;

/// Most pictures of a curve.
const MOST_OF_CURVE: usize = 5;
/// Most bytes that the pictures of a scene may take, uncompressed; each curve
/// has one picture even so.
const MOST_BYTES: usize = 64 << 20;
/// How far from an equal time or error a picture may be, as a factor.
const NEAR: f64 = 1.5;

/// The directory of pictures, beside the report.
const DIRECTORY: &str = "pictures";

/// Writes pictures below a directory, all of one scene with one exposure.
pub(super) struct Gallery<'a> {
    directory: &'a Path,
    scene: &'a str,
    /// The factor that exposes all pictures.
    exposure: f64,
    /// Pictures of each curve.
    most: usize,
}

impl<'a> Gallery<'a> {
    /// For a scene with so many curves of pictures of `size` pixels.
    ///
    /// # Errors
    /// If the directory cannot be made.
    pub(super) fn new(
        directory: &'a Path,
        scene: &'a str,
        exposure: f64,
        curves: usize,
        size: [u32; 2],
    ) -> Result<Self, OutputError> {
        let path = directory.join(DIRECTORY);
        fs::create_dir_all(&path).map_err(|source| OutputError::Io {
            path,
            action: "making the directory",
            source,
        })?;
        // A picture and its map, three bytes a pixel each.
        let bytes = 6 * size[0] as usize * size[1] as usize * curves.max(1);
        Ok(Self {
            directory,
            scene,
            exposure,
            most: (MOST_BYTES / bytes).clamp(1, MOST_OF_CURVE),
        })
    }

    /// Writes a picture; its path relative to the report.
    pub(super) fn hang(&self, name: &str, image: &Image) -> Result<String, OutputError> {
        let factor = self.exposure;
        let pixels = image.pixels().iter().map(|&p| p * factor);
        let exposed = Image::new(image.width(), image.height(), pixels.collect());
        self.write(name, &exposed)
    }

    fn write(&self, name: &str, image: &Image) -> Result<String, OutputError> {
        let file = format!("{DIRECTORY}/{}-{}.png", slug(self.scene), slug(name));
        write_png(&self.directory.join(&file), image, Some(0.0))?;
        Ok(file)
    }

    /// Writes the pictures of a curve's first seed that are worth to be seen:
    /// the last, those near the times `times`, and those near the errors
    /// `errors`, as far as there is room.
    ///
    /// # Errors
    /// If a file cannot be written, or the run's pictures are gone.
    pub(super) fn show(
        &self,
        label: &str,
        run: &Finished,
        points: &[Point],
        yardstick: &Yardstick,
        store: &Store,
        [times, errors]: [&[f64]; 2],
    ) -> Result<Vec<Picture>, Fault> {
        let places: Vec<(f64, f64)> = points
            .iter()
            .map(|p| (p.runs[0].cpu_seconds, p.runs[0].relmse.sqrt()))
            .collect();
        let chosen = choose(&places, times, errors, self.most);
        if chosen.is_empty() {
            return Ok(Vec::new());
        }
        let all = run.pictures(store)?;
        let mut shown = Vec::new();
        for i in chosen {
            let point = &points[i];
            let look = run.snapshots.iter().position(|s| s.passes == point.passes);
            let Some(image) = look.and_then(|look| all.get(look)) else {
                continue;
            };
            let name = format!("{label}-passes{}", point.passes);
            let errors = relative_errors(image, &yardstick.picture)
                .map_err(|e| Fault::Invalid(e.to_string()))?;
            shown.push(Picture {
                passes: point.passes,
                seed: run.seed,
                cpu_seconds: places[i].0,
                error: places[i].1,
                file: self.hang(&name, image)?,
                map: self.write(&format!("{name}-error"), &map(&errors))?,
            });
        }
        Ok(shown)
    }
}

/// The colours of squared errors.
fn map(errors: &Plane) -> Image {
    let (width, height) = (errors.width() as u32, errors.height() as u32);
    Image::from_fn(width, height, |x, y| -> Rgb {
        magma(errors.row(y as usize)[x as usize].sqrt() / MAP_TOP)
    })
}

/// Which of the places (seconds, error) to show, in their order: the last,
/// those nearest to the times, then those nearest to the errors, `most` in all.
fn choose(places: &[(f64, f64)], times: &[f64], errors: &[f64], most: usize) -> Vec<usize> {
    let mut chosen: Vec<usize> = places.len().checked_sub(1).into_iter().collect();
    let nearest = |of: fn(&(f64, f64)) -> f64, wanted: f64| {
        let far = |i: &usize| libm::log(of(&places[*i]) / wanted).abs();
        let best = (0..places.len()).min_by(|a, b| far(a).total_cmp(&far(b)))?;
        (far(&best) <= libm::log(NEAR)).then_some(best)
    };
    let by_time = times.iter().map(|&t| nearest(|p| p.0, t));
    let by_error = errors.iter().map(|&e| nearest(|p| p.1, e));
    for i in by_time.chain(by_error).flatten() {
        if chosen.len() < most && !chosen.contains(&i) {
            chosen.push(i);
        }
    }
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_times_come_before_equal_errors() {
        let places: Vec<(f64, f64)> = (0..8)
            .map(|k| (2f64.powi(k), 0.5 * 0.6f64.powi(k)))
            .collect();
        let show = |times: &[f64], errors: &[f64], most| choose(&places, times, errors, most);
        assert_eq!(show(&[], &[], 5), [7], "the last");
        assert_eq!(show(&[15.0, 2.2], &[], 5), [1, 4, 7]);
        assert_eq!(show(&[15.0, 2.2], &[0.3, 0.1], 5), [1, 3, 4, 7]);
        assert_eq!(show(&[15.0, 2.2], &[0.1], 2), [4, 7]);
        assert_eq!(show(&[1e6], &[1e-9], 5), [7], "nothing near");
        assert_eq!(choose(&[], &[1.0], &[], 5), [0usize; 0]);
    }
}

//! What pictures are judged by.

use std::{collections::HashMap, path::Path};

use crate::{
    film::{Image, Layer, read_exr_layers},
    spectrum::Rgb,
};

use super::{
    fault::Fault,
    record::{Truth, TruthKind},
    request::{Source, Subject},
    run::sum,
    sight::Sight,
    split::{blur, lone_share, mean, variance},
};

/// The most that single runs may contribute to the variance of a reference
/// whose spread can be believed; half-way from normal noise to rare paths.
const MOST_ALONE: f64 = 0.65;

/// How many times smaller than what it judges the error of a reference has to
/// be. Its share in what is measured is then at most a ninth in the square,
/// and that is taken off, too.
pub(super) const MARGIN: f64 = 3.0;

/// Four layers, in the order of [`Layer::ALL`].
pub(super) type Layers = [Image; 4];

/// What is known about a scene's picture.
pub(super) enum Knowledge {
    /// The picture alone.
    Picture(Image),
    /// Its layers.
    Layers(Box<Layers>),
    /// Layers by independent seeds, whose mean it is.
    Seeds {
        own: Vec<Layers>,
        /// Others with circles of twice the width; none of a method without
        /// blur.
        wide: Vec<Layers>,
    },
}

/// A truth, ready to judge.
pub(super) struct Known {
    /// What is said of it; without its picture.
    pub(super) record: Truth,
    pub(super) knowledge: Knowledge,
}

/// What one curve is judged by.
#[derive(Clone, Debug)]
pub(super) struct Yardstick {
    /// The picture.
    pub(super) picture: Image,
    /// Its own relative variance; 0 where none is known.
    pub(super) variance: f64,
    /// Bound on the square of its relative blur; 0 where there is none.
    pub(super) blur: f64,
    /// The part of it that comes from single runs; see [`lone_share`].
    lone: f64,
}

impl Yardstick {
    /// Whether it can judge a picture at that relMSE: the error without its
    /// own share is at least three times its own.
    pub(super) fn can_judge(&self, relmse: f64) -> bool {
        relmse - self.variance >= MARGIN * MARGIN * (self.variance + self.blur)
    }

    /// Its own error, noise and blur together.
    pub(super) fn error(&self) -> f64 {
        libm::sqrt(self.variance + self.blur)
    }

    /// The mean of pictures by independent seeds, with `wide` ones where the
    /// method has blur.
    pub(super) fn of(seeds: &[Image], wide: &[Image]) -> Self {
        let picture = mean(seeds).unwrap_or_else(|| seeds[0].clone());
        let single = variance(seeds, &picture).unwrap_or(0.0);
        Self {
            variance: single / seeds.len() as f64,
            blur: blur(seeds, wide, &picture).unwrap_or(0.0),
            lone: lone_share(seeds, &picture).unwrap_or(0.0),
            picture,
        }
    }

    /// Whether its variance can be believed: it is not made by rare paths, of
    /// which there may be more that nobody has found.
    pub(super) fn is_settled(&self) -> bool {
        self.lone <= MOST_ALONE
    }
}

impl Known {
    /// What pictures of these layers are judged by.
    pub(super) fn yardstick(&self, sight: &Sight) -> Yardstick {
        let exact = |picture| Yardstick {
            picture,
            variance: 0.0,
            blur: 0.0,
            lone: 0.0,
        };
        match &self.knowledge {
            Knowledge::Picture(picture) => exact(picture.clone()),
            Knowledge::Layers(layers) => exact(joined(layers, sight)),
            Knowledge::Seeds { own, wide } => {
                let seen = |seeds: &[Layers]| -> Vec<Image> {
                    seeds.iter().map(|s| joined(s, sight)).collect()
                };
                Yardstick::of(&seen(own), &seen(wide))
            }
        }
    }

    /// A truth that needs no render: a formula or a picture.
    ///
    /// # Errors
    /// [`Fault::Invalid`] for a picture that is missing, has another size, is
    /// not finite or black.
    pub(super) fn given(
        subject: &Subject<'_>,
        [width, height]: [u32; 2],
    ) -> Result<Option<Self>, Fault> {
        let (kind, words, knowledge) = match subject.truth {
            Source::Make => return Ok(None),
            Source::ClosedForm { words, radiance } => {
                let layer =
                    |layer: Layer| Image::from_fn(width, height, |x, y| radiance(x, y)[layer]);
                let layers = Box::new(Layer::ALL.map(layer));
                (
                    TruthKind::ClosedForm,
                    words.to_owned(),
                    Knowledge::Layers(layers),
                )
            }
            Source::Given(path) => {
                let name = path.file_name().unwrap_or(path.as_os_str()).display();
                let words =
                    format!("A picture that was given, {name}; its own error is not known.");
                (TruthKind::Given, words, read(path, [width, height])?)
            }
        };
        let record = Truth {
            kind,
            words,
            method: None,
            seeds: 0,
            passes: 0,
            error: None,
            cpu_seconds: None,
            picture: None,
        };
        let known = Self { record, knowledge };
        let light = known.yardstick(&Sight::whole()).picture.mean();
        if !(light.is_finite() && light.mean() > 0.0) {
            return Err(Fault::Invalid(format!(
                "{}: the truth is black or not finite; there is nothing to be judged by",
                subject.name
            )));
        }
        Ok(Some(known))
    }
}

/// The sum of the layers that are seen.
pub(super) fn joined(layers: &Layers, sight: &Sight) -> Image {
    let seen = sight.layers().iter().map(|&l| layers[l as usize].clone());
    seen.reduce(|a, b| sum(&a, &b))
        .unwrap_or_else(|| Image::from_fn(layers[0].width(), layers[0].height(), |_, _| Rgb::BLACK))
}

/// The picture and, if it has them all, the layers of a file.
fn read(path: &Path, size: [u32; 2]) -> Result<Knowledge, Fault> {
    let refuse = |what: String| Fault::Invalid(format!("{}: {what}", path.display()));
    let mut found: HashMap<String, Image> = read_exr_layers(path)
        .map_err(|e| Fault::Invalid(e.to_string()))?
        .into_iter()
        .collect();
    let Some(picture) = found.remove("") else {
        return Err(refuse("it has no channels R, G, B".to_owned()));
    };
    if [picture.width(), picture.height()] != size {
        let [width, height] = size;
        return Err(refuse(format!(
            "it has {} x {} pixels and the study {width} x {height}; render it in that size or use --resolution",
            picture.width(),
            picture.height()
        )));
    }
    let layers = Layer::ALL.map(|layer| found.remove(layer.name()));
    let fits = |image: &Image| [image.width(), image.height()] == size;
    let is_finite = |image: &Image| image.pixels().iter().all(|p| p.is_finite());
    if !is_finite(&picture) || !layers.iter().flatten().all(is_finite) {
        return Err(refuse("it has pixels that are not finite".to_owned()));
    }
    Ok(match layers {
        [Some(a), Some(b), Some(c), Some(d)] if [&a, &b, &c, &d].into_iter().all(fits) => {
            Knowledge::Layers(Box::new([a, b, c, d]))
        }
        _ => Knowledge::Picture(picture),
    })
}

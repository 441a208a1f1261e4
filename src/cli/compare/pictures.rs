//! The pictures of a comparison: read, and found fit to be compared.

use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

use nephroid::film::{Image, read_exr_layers, read_png};

use crate::cli::{Failure, args::CompareArgs};

/// What kind of file a picture came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Exr,
    Png,
}

/// A picture as it stands in a file.
pub(super) struct Picture {
    pub(super) path: PathBuf,
    pub(super) kind: Kind,
    /// Colour layers by name; the picture itself has none.
    layers: Vec<(String, Image)>,
}

/// All pictures of a comparison: of one kind, each with every layer that is
/// compared, of one size, and finite.
pub(super) struct Pictures {
    /// One or two that are judged.
    pub(super) judged: Vec<Picture>,
    pub(super) reference: Picture,
    /// The layers that are compared, at least one.
    pub(super) layers: Vec<String>,
}

impl Pictures {
    pub(super) fn load(typed: &CompareArgs) -> Result<Self, Failure> {
        let (judged, reference) = match &typed.reference {
            Some(reference) => (vec![&typed.a, &typed.b], reference),
            None => (vec![&typed.a], &typed.b),
        };
        let judged: Result<Vec<_>, _> = judged.into_iter().map(|path| read(path)).collect();
        let mut pictures = Self {
            judged: judged?,
            reference: read(reference)?,
            layers: Vec::new(),
        };
        pictures.check_kinds()?;
        pictures.layers = pictures.choose_layers(typed)?;
        pictures.check_sizes()?;
        pictures.check_values()?;
        Ok(pictures)
    }

    pub(super) fn kind(&self) -> Kind {
        self.reference.kind
    }

    /// Width and height of what is compared.
    pub(super) fn size(&self) -> [u32; 2] {
        size(self.reference.layer(&self.layers[0]))
    }

    fn all(&self) -> impl Iterator<Item = &Picture> {
        self.judged.iter().chain([&self.reference])
    }

    fn check_kinds(&self) -> Result<(), Failure> {
        if self.judged.iter().all(|p| p.kind == self.kind()) {
            return Ok(());
        }
        Err(Failure::bad_input(
            "an EXR holds radiance and a PNG what a screen shows of it; compare files of one kind",
        ))
    }

    fn choose_layers(&self, typed: &CompareArgs) -> Result<Vec<String>, Failure> {
        if typed.layers {
            let everywhere = |name: &String| self.all().all(|p| p.find(name).is_some());
            let names = self.reference.layers.iter().map(|(name, _)| name);
            let common: Vec<String> = names.filter(|name| everywhere(name)).cloned().collect();
            if common.is_empty() {
                return Err(Failure::bad_input(
                    "the files have no colour layer in common",
                ));
            }
            return Ok(common);
        }
        let mut wanted = typed.layer.clone();
        if wanted.is_empty() {
            wanted.push(String::new());
        }
        for name in &wanted {
            if let Some(picture) = self.all().find(|p| p.find(name).is_none()) {
                return Err(Failure::bad_input(picture.lacks(name)));
            }
        }
        Ok(wanted)
    }

    fn check_sizes(&self) -> Result<(), Failure> {
        let [width, height] = self.size();
        for picture in self.all() {
            for layer in &self.layers {
                let [w, h] = size(picture.layer(layer));
                if [w, h] != [width, height] {
                    return Err(Failure::bad_input(format!(
                        "{} has {w} x {h} pixels and {} {width} x {height}; \
                         only pictures of one size can be compared",
                        picture.path.display(),
                        self.reference.path.display(),
                    )));
                }
            }
        }
        Ok(())
    }

    /// What is not finite has no error; each file with such pixels is named.
    fn check_values(&self) -> Result<(), Failure> {
        let mut complaints = Vec::new();
        for picture in self.all() {
            for layer in &self.layers {
                complaints.extend(picture.broken_pixels(layer));
            }
        }
        if complaints.is_empty() {
            Ok(())
        } else {
            Err(Failure::bad_input(complaints.join("\nerror: ")))
        }
    }
}

impl Picture {
    fn find(&self, layer: &str) -> Option<&Image> {
        let mut layers = self.layers.iter();
        layers
            .find(|(name, _)| name == layer)
            .map(|(_, image)| image)
    }

    /// A layer that is compared.
    pub(super) fn layer(&self, layer: &str) -> &Image {
        self.find(layer).expect("checked when it was loaded")
    }

    /// The picture itself or, in a file without one, `layer`.
    pub(super) fn itself_or(&self, layer: &str) -> &Image {
        self.find("").unwrap_or_else(|| self.layer(layer))
    }

    fn lacks(&self, layer: &str) -> String {
        let path = self.path.display();
        let named: Vec<&str> = self.layers.iter().map(|(name, _)| name.as_str()).collect();
        let named: Vec<&str> = named.into_iter().filter(|name| !name.is_empty()).collect();
        let remedy = match (self.kind, named.is_empty()) {
            (Kind::Png, _) => "a PNG has none".to_owned(),
            (Kind::Exr, true) => "it has none".to_owned(),
            (Kind::Exr, false) => format!("it has {}", named.join(", ")),
        };
        if layer.is_empty() {
            format!("{path} has no channels R, G, B; name a layer with --layer ({remedy})")
        } else {
            format!("{path} has no layer {layer}; {remedy}")
        }
    }

    fn broken_pixels(&self, layer: &str) -> Option<String> {
        let image = self.layer(layer);
        let broken = || {
            image
                .pixels()
                .iter()
                .enumerate()
                .filter(|(_, p)| !p.is_finite())
        };
        let (first, _) = broken().next()?;
        let width = image.width() as usize;
        let place = if layer.is_empty() {
            String::new()
        } else {
            format!(" in its layer {layer}")
        };
        Some(format!(
            "{} has pixels that are not finite{place}: {} of {}, the first in column {} of row {}",
            self.path.display(),
            broken().count(),
            image.pixels().len(),
            first % width,
            first / width,
        ))
    }
}

fn size(image: &Image) -> [u32; 2] {
    [image.width(), image.height()]
}

/// Reads a picture; what it is, its first bytes say, not its name.
fn read(path: &Path) -> Result<Picture, Failure> {
    const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
    const PNG: [u8; 4] = [0x89, b'P', b'N', b'G'];
    let cannot =
        |reason: &str| Failure::bad_input(format!("cannot read {}: {reason}", path.display()));
    let mut start = Vec::new();
    File::open(path)
        .and_then(|file| file.take(4).read_to_end(&mut start))
        .map_err(|e| cannot(&e.to_string()))?;
    let (kind, layers) = if start == EXR {
        (Kind::Exr, read_exr_layers(path))
    } else if start == PNG {
        let picture = read_png(path).map(|image| vec![(String::new(), image)]);
        (Kind::Png, picture)
    } else {
        return Err(cannot("it is neither an EXR nor a PNG file"));
    };
    Ok(Picture {
        path: path.to_owned(),
        kind,
        layers: layers.map_err(Failure::bad_input)?,
    })
}

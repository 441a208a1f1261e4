//! The pictures of a study, as far as they fit into the page.

use std::{
    collections::BTreeMap,
    fs,
    io::Read,
    path::{Component, Path},
};

use base64::{Engine, engine::general_purpose::STANDARD};

use super::{
    levels::{Alike, levels},
    words::escape,
};
use crate::study::{SceneStudy, Study};

/// Bytes of PNG files that a page holds at most: with a third more for the
/// letters that they are written in, what most mail servers let through.
pub(super) const BUDGET: u64 = 15 << 20;

/// What a PNG begins with.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// How a picture comes to the page.
enum Source {
    /// Within it.
    Embedded(String),
    /// As a file beside it, since the page is full.
    Linked,
    /// Not at all, for a reason.
    Missing(&'static str),
}

/// The pictures of a scene by their files.
pub(super) struct Gallery {
    scene: usize,
    size: [u32; 2],
    shots: BTreeMap<String, (usize, Source)>,
}

impl Gallery {
    /// Reads the pictures of every scene from `directory`. Each scene may fill
    /// its share of the page, and what those before it left.
    pub(super) fn load_all(study: &Study, directory: &Path) -> Vec<Self> {
        let mut left = BUDGET;
        let count = study.scenes.len();
        let mut galleries = Vec::with_capacity(count);
        for (index, scene) in study.scenes.iter().enumerate() {
            let mut share = left / (count - index) as u64;
            left -= share;
            galleries.push(Self::load(index, scene, directory, &mut share));
            left += share;
        }
        galleries
    }

    fn load(index: usize, scene: &SceneStudy, directory: &Path, budget: &mut u64) -> Self {
        let mut shots = BTreeMap::new();
        for file in by_weight(scene) {
            let number = shots.len();
            shots
                .entry(file.to_owned())
                .or_insert_with(|| (number, source(directory, file, budget)));
        }
        let size = scene.resolution.map(|n| n.max(1));
        Self {
            scene: index,
            size,
            shots,
        }
    }

    /// The width and height of the scene's pictures.
    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The name under which the page knows the picture in `file`; the reason if
    /// it has none.
    pub(super) fn id(&self, file: &str) -> Result<String, &'static str> {
        match self.shots.get(file) {
            Some((_, Source::Missing(reason))) => Err(reason),
            Some((number, _)) => Ok(format!("p{}-{number}", self.scene)),
            None => Err("was not asked for"),
        }
    }

    /// How many pictures are in the page, beside it, and missing.
    pub(super) fn counts(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for (_, source) in self.shots.values() {
            counts[match source {
                Source::Embedded(_) => 0,
                Source::Linked => 1,
                Source::Missing(_) => 2,
            }] += 1;
        }
        counts
    }

    /// The pictures, for elements elsewhere in the page to use as often as they
    /// like.
    pub(super) fn definitions(&self) -> String {
        let [width, height] = self.size;
        let mut out = "<svg class=\"store\" width=\"0\" height=\"0\" aria-hidden=\"true\"><defs>\n"
            .to_owned();
        for (file, (number, source)) in &self.shots {
            let address = match source {
                Source::Embedded(text) => format!("data:image/png;base64,{text}"),
                Source::Linked => escape(&address(file)),
                Source::Missing(_) => continue,
            };
            out += &format!(
                "<image id=\"p{}-{number}\" width=\"{width}\" height=\"{height}\" href=\"{address}\"/>\n",
                self.scene
            );
        }
        out + "</defs></svg>\n"
    }
}

/// A scene's files, those that matter most first.
fn by_weight(scene: &SceneStudy) -> Vec<&str> {
    let mut files: Vec<&str> = scene.truth.picture.iter().map(String::as_str).collect();
    let mut shown = Vec::new();
    for alike in [Alike::Time, Alike::Error] {
        let (mut levels, first) = levels(scene, alike);
        if !levels.is_empty() {
            levels.swap(0, first);
        }
        shown.extend(levels.into_iter().flat_map(|level| level.shots));
    }
    for (_, _, picture) in shown {
        files.extend([picture.file.as_str(), &picture.map]);
    }
    for picture in scene.series.iter().flat_map(|s| &s.pictures) {
        files.extend([picture.file.as_str(), &picture.map]);
    }
    files.retain(|file| !file.is_empty());
    files
}

/// Reads a file if it is a PNG within the directory, and if it fits.
fn source(directory: &Path, file: &str, budget: &mut u64) -> Source {
    let relative = Path::new(file);
    // A record may come from anywhere; it cannot make the page show other files.
    if !relative
        .components()
        .all(|c| matches!(c, Component::Normal(_)))
    {
        return Source::Missing("lies outside the report’s directory");
    }
    let path = directory.join(relative);
    let Ok(about) = fs::metadata(&path) else {
        return Source::Missing("is not there");
    };
    let open = if about.is_file() {
        fs::File::open(&path).ok()
    } else {
        None
    };
    let Some(mut opened) = open else {
        return Source::Missing("cannot be read");
    };
    let mut head = [0; SIGNATURE.len()];
    if opened.read_exact(&mut head).is_err() || head != SIGNATURE {
        return Source::Missing("is not a PNG");
    }
    if about.len() > *budget {
        return Source::Linked;
    }
    let mut bytes = head.to_vec();
    // The file may have grown since.
    if opened.take(*budget).read_to_end(&mut bytes).is_err() {
        return Source::Missing("cannot be read");
    }
    match budget.checked_sub(bytes.len() as u64) {
        Some(left) => {
            *budget = left;
            Source::Embedded(STANDARD.encode(bytes))
        }
        None => Source::Linked,
    }
}

/// A relative path as an address: what is not a plain letter is written as its
/// bytes.
pub(super) fn address(path: &str) -> String {
    let mut address = String::new();
    for byte in path.replace('\\', "/").bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' => {
                address.push(byte as char);
            }
            _ => address += &format!("%{byte:02X}"),
        }
    }
    address
}

//! The JSON part: lists of objects that name each other by index. Each list
//! is kept as slices of the text and an object understood when it is asked
//! for, so that a text costs memory in proportion to its length, and so that
//! mistakes have a place.

use serde::Deserialize;
use serde_json::value::RawValue;

use crate::scene::mesh_file::Fault;

/// The file as a whole.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Root<'a> {
    asset: Asset,
    scene: Option<usize>,
    #[serde(default)]
    extensions_required: Vec<String>,
    #[serde(borrow, default)]
    scenes: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    nodes: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    meshes: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    materials: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    accessors: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    buffer_views: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    buffers: Vec<&'a RawValue>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

/// The lists of a file.
#[derive(Clone, Copy, Debug)]
pub(super) enum List {
    Scenes,
    Nodes,
    Meshes,
    Materials,
    Accessors,
    BufferViews,
    Buffers,
}

/// How the JSON text stands in its file.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Form {
    Text,
    Binary,
}

pub(super) struct Document<'a> {
    text: &'a str,
    /// Bytes of the file before the text.
    offset: usize,
    form: Form,
    root: Root<'a>,
}

impl<'a> Document<'a> {
    pub(super) fn read(bytes: &'a [u8], offset: usize, form: Form) -> Result<Self, Fault> {
        let text = std::str::from_utf8(bytes)
            .map_err(|e| Fault::byte(offset + e.valid_up_to(), "the JSON text is not UTF-8"))?;
        let root: Root = serde_json::from_str(text).map_err(|e| {
            let at = offset_of(text, &e);
            fault(
                form,
                offset + at,
                &format!("not a glTF document: {}", reason(&e)),
            )
        })?;
        let document = Self {
            text,
            offset,
            form,
            root,
        };
        document.check_version()?;
        Ok(document)
    }

    fn check_version(&self) -> Result<(), Fault> {
        let version = &self.root.asset.version;
        if version.split('.').next() != Some("2") {
            let shown: String = version.chars().take(20).collect();
            return Err(Fault::file(format!(
                "version {shown:?} of glTF; only 2.0 is known"
            )));
        }
        // What changes how things look, not where they are.
        let is_harmless = |name: &&String| {
            name.as_str() == "KHR_mesh_quantization"
                || [
                    "KHR_materials_",
                    "KHR_texture_",
                    "EXT_texture_",
                    "KHR_lights_",
                ]
                .iter()
                .any(|prefix| name.starts_with(prefix))
        };
        match self
            .root
            .extensions_required
            .iter()
            .find(|n| !is_harmless(n))
        {
            None => Ok(()),
            Some(name) => {
                let shown: String = name.chars().take(60).collect();
                Err(Fault::file(format!(
                    "the file needs the extension {shown}, which is not known; \
                     export it without (such as without compression)"
                )))
            }
        }
    }

    fn list(&self, list: List) -> (&'static str, &[&'a RawValue]) {
        let root = &self.root;
        match list {
            List::Scenes => ("scenes", &root.scenes),
            List::Nodes => ("nodes", &root.nodes),
            List::Meshes => ("meshes", &root.meshes),
            List::Materials => ("materials", &root.materials),
            List::Accessors => ("accessors", &root.accessors),
            List::BufferViews => ("bufferViews", &root.buffer_views),
            List::Buffers => ("buffers", &root.buffers),
        }
    }

    /// How many entries a list has.
    pub(super) fn count(&self, list: List) -> usize {
        self.list(list).1.len()
    }

    /// The scene to show, if the file names one.
    pub(super) fn default_scene(&self) -> Option<usize> {
        self.root.scene
    }

    /// An entry of a list.
    pub(super) fn get<T: Deserialize<'a>>(&self, list: List, index: usize) -> Result<T, Fault> {
        let (name, entries) = self.list(list);
        let Some(raw) = entries.get(index) else {
            return Err(Fault::file(format!(
                "{name}[{index}] is asked for, but `{name}` has {} entries, counted from 0",
                entries.len()
            )));
        };
        serde_json::from_str(raw.get()).map_err(|e| {
            let at = self.start_of(raw) + offset_of(raw.get(), &e);
            fault(
                self.form,
                self.offset + at,
                &format!("{name}[{index}]: {}", reason(&e)),
            )
        })
    }

    /// A mistake in an entry of a list.
    pub(super) fn fault(&self, list: List, index: usize, message: &str) -> Fault {
        let (name, entries) = self.list(list);
        let message = format!("{name}[{index}]: {message}");
        match entries.get(index) {
            Some(raw) => fault(self.form, self.offset + self.start_of(raw), &message),
            None => Fault::file(message),
        }
    }

    /// Where in the text an entry starts: it is a slice of it.
    fn start_of(&self, raw: &RawValue) -> usize {
        raw.get().as_ptr() as usize - self.text.as_ptr() as usize
    }
}

fn fault(form: Form, offset: usize, message: &str) -> Fault {
    match form {
        Form::Text => Fault::text(offset..offset + 1, message, "here"),
        Form::Binary => Fault::byte(offset, message),
    }
}

/// The byte before which a mistake was noticed; at most the last one.
fn offset_of(text: &str, error: &serde_json::Error) -> usize {
    let lines = text.split_inclusive('\n');
    let start: usize = lines
        .take(error.line().saturating_sub(1))
        .map(str::len)
        .sum();
    (start + error.column().saturating_sub(1)).min(text.len().saturating_sub(1))
}

/// The words of an error without its place, which is told otherwise.
fn reason(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let end = text.rfind(" at line ").unwrap_or(text.len());
    text[..end].chars().take(200).collect()
}

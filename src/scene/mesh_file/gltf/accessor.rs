//! From accessors to numbers: buffers, views into them, elements in these.

use std::{borrow::Cow, collections::HashMap, ops::Range, path::Path, rc::Rc};

use serde::{Deserialize, de::IgnoredAny};

use super::document::{Document, List};
use crate::scene::{
    Inputs,
    mesh_file::{Fault, MAX_MESH_BYTES, read_bytes},
};

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor<'a> {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    normalized: bool,
    count: usize,
    #[serde(rename = "type", borrow)]
    kind: Cow<'a, str>,
    sparse: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Buffer<'a> {
    #[serde(borrow)]
    uri: Option<Cow<'a, str>>,
    byte_length: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value of `size()` bytes, zero-padded to four.
    fn value(self, b: [u8; 4]) -> f64 {
        match self {
            Self::I8 => f64::from(i8::from_le_bytes([b[0]])),
            Self::U8 => f64::from(b[0]),
            Self::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
            Self::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 => f64::from(u32::from_le_bytes(b)),
            Self::F32 => f64::from(f32::from_le_bytes(b)),
        }
    }

    /// A normalised integer as a fraction (section 3.11 of the format).
    fn fraction(self, value: f64) -> f64 {
        match self {
            Self::I8 => (value / 127.0).max(-1.0),
            Self::U8 => value / 255.0,
            Self::I16 => (value / 32767.0).max(-1.0),
            Self::U16 => value / 65535.0,
            Self::U32 | Self::F32 => value,
        }
    }
}

/// Bytes of a buffer.
#[derive(Clone)]
enum Bytes<'a> {
    InFile(&'a [u8]),
    Own(Rc<Vec<u8>>),
}

impl Bytes<'_> {
    fn get(&self) -> &[u8] {
        match self {
            Self::InFile(bytes) => bytes,
            Self::Own(bytes) => bytes,
        }
    }
}

/// The elements of an accessor; all of them lie within the buffer.
#[derive(Clone)]
pub(super) struct Elements<'a> {
    bytes: Bytes<'a>,
    start: usize,
    stride: usize,
    pub(super) count: usize,
    component: Component,
    normalized: bool,
}

impl Elements<'_> {
    fn component(&self, element: usize, k: usize) -> f64 {
        let size = self.component.size();
        let at = self.start + element * self.stride + k * size;
        let mut b = [0; 4];
        b[..size].copy_from_slice(&self.bytes.get()[at..at + size]);
        self.component.value(b)
    }

    /// A vector; the elements were asked for as `VEC3`.
    pub(super) fn vector(&self, element: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let value = self.component(element, k);
            if self.normalized {
                self.component.fraction(value)
            } else {
                value
            }
        })
    }

    /// An index; the elements were asked for as indices.
    pub(super) fn index(&self, element: usize) -> u32 {
        self.component(element, 0) as u32
    }
}

/// What the elements of an accessor are wanted for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wanted {
    Vector,
    Index,
}

/// The buffers of a file, read when first asked for.
pub(super) struct Buffers<'a, 'd> {
    document: &'d Document<'a>,
    bin: Option<&'a [u8]>,
    folder: &'d Path,
    inputs: &'d Inputs,
    by_uri: HashMap<String, Bytes<'a>>,
    by_index: HashMap<usize, Bytes<'a>>,
    elements: HashMap<usize, Elements<'a>>,
    /// Bytes that may still be read from other files.
    left: u64,
}

impl<'a, 'd> Buffers<'a, 'd> {
    pub(super) fn new(
        document: &'d Document<'a>,
        bin: Option<&'a [u8]>,
        folder: &'d Path,
        inputs: &'d Inputs,
    ) -> Self {
        Self {
            document,
            bin,
            folder,
            inputs,
            by_uri: HashMap::new(),
            by_index: HashMap::new(),
            elements: HashMap::new(),
            left: MAX_MESH_BYTES,
        }
    }

    /// The elements of an accessor.
    pub(super) fn elements(&mut self, index: usize, wanted: Wanted) -> Result<Elements<'a>, Fault> {
        let accessor: Accessor = self.document.get(List::Accessors, index)?;
        let fault = |message: &str| self.document.fault(List::Accessors, index, message);
        let kind = match wanted {
            Wanted::Vector => "VEC3",
            Wanted::Index => "SCALAR",
        };
        if accessor.kind != kind {
            let found: String = accessor.kind.chars().take(20).collect();
            return Err(fault(&format!(
                "`type` is {found:?} where {kind:?} is needed"
            )));
        }
        let component = Component::of(accessor.component_type)
            .ok_or_else(|| fault("`componentType` is none that the format has"))?;
        let is_unsigned = matches!(component, Component::U8 | Component::U16 | Component::U32);
        if wanted == Wanted::Index && !is_unsigned {
            return Err(fault("indices must be unsigned integers"));
        }
        if accessor.sparse.is_some() {
            return Err(fault("sparse accessors are not known; export without them"));
        }
        if let Some(known) = self.elements.get(&index) {
            return Ok(known.clone());
        }
        let view_index = accessor
            .buffer_view
            .ok_or_else(|| fault("there is no `bufferView`, hence no data"))?;
        let view: BufferView = self.document.get(List::BufferViews, view_index)?;
        let (bytes, range) = self.view(&view, view_index)?;
        let size = component.size() * if wanted == Wanted::Vector { 3 } else { 1 };
        let stride = view.byte_stride.unwrap_or(size);
        if stride < size {
            let message = format!("`byteStride` is {stride}, but an element has {size} bytes");
            return Err(self.document.fault(List::BufferViews, view_index, &message));
        }
        let fault = |message: &str| self.document.fault(List::Accessors, index, message);
        let last = accessor
            .count
            .checked_sub(1)
            .ok_or_else(|| fault("`count` is 0"))?;
        let end = last
            .checked_mul(stride)
            .and_then(|n| n.checked_add(size))
            .and_then(|n| n.checked_add(accessor.byte_offset));
        if end.is_none_or(|end| end > range.len()) {
            return Err(fault(&format!(
                "{} elements do not fit into bufferViews[{view_index}] of {} bytes",
                accessor.count,
                range.len()
            )));
        }
        let elements = Elements {
            bytes,
            start: range.start + accessor.byte_offset,
            stride,
            count: accessor.count,
            component,
            normalized: accessor.normalized,
        };
        self.elements.insert(index, elements.clone());
        Ok(elements)
    }

    /// A buffer and the part of it that a view shows.
    fn view(
        &mut self,
        view: &BufferView,
        index: usize,
    ) -> Result<(Bytes<'a>, Range<usize>), Fault> {
        let bytes = self.buffer(view.buffer)?;
        let length = bytes.get().len();
        match view.byte_offset.checked_add(view.byte_length) {
            Some(end) if end <= length => Ok((bytes, view.byte_offset..end)),
            _ => {
                let message = format!("the view does not fit into its buffer of {length} bytes");
                Err(self.document.fault(List::BufferViews, index, &message))
            }
        }
    }

    /// A buffer, as long as the document says.
    fn buffer(&mut self, index: usize) -> Result<Bytes<'a>, Fault> {
        if let Some(bytes) = self.by_index.get(&index) {
            return Ok(bytes.clone());
        }
        let buffer: Buffer = self.document.get(List::Buffers, index)?;
        let fault = |message: &str| self.document.fault(List::Buffers, index, message);
        let bytes = match (buffer.uri.as_deref(), self.bin) {
            (None, Some(bin)) if index == 0 => Bytes::InFile(bin),
            (None, _) => return Err(fault("there is no `uri`, hence no data")),
            (Some(uri), _) => match self.by_uri.get(uri) {
                Some(bytes) => bytes.clone(),
                None => {
                    let own = self.fetch(uri).map_err(|message| fault(&message))?;
                    let bytes = Bytes::Own(Rc::new(own));
                    if !uri.starts_with("data:") {
                        self.left = self.left.saturating_sub(bytes.get().len() as u64);
                        self.by_uri.insert(uri.to_owned(), bytes.clone());
                    }
                    bytes
                }
            },
        };
        let length = bytes.get().len();
        if length < buffer.byte_length {
            let message = format!(
                "`byteLength` is {}, but there are {length} bytes",
                buffer.byte_length
            );
            return Err(self.document.fault(List::Buffers, index, &message));
        }
        self.by_index.insert(index, bytes.clone());
        Ok(bytes)
    }

    /// The bytes that a URI holds or names.
    fn fetch(&self, uri: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, text) = data
                .split_once(',')
                .ok_or("`uri` holds data without a comma before them")?;
            if !kind.ends_with(";base64") {
                return Err("`uri` holds data that are not base64".to_owned());
            }
            return base64(text.as_bytes()).ok_or("`uri` holds broken base64".to_owned());
        }
        if uri.contains(':') || uri.starts_with('/') {
            return Err("`uri` must be the path of a file, seen from this one".to_owned());
        }
        let path = self.folder.join(percent_decoded(uri)?);
        let bytes =
            read_bytes(&path).map_err(|message| format!("{}: {message}", path.display()))?;
        if bytes.len() as u64 > self.left {
            return Err(format!(
                "the buffers are larger than {} GiB together",
                MAX_MESH_BYTES >> 30
            ));
        }
        self.inputs.add(&path, &bytes);
        Ok(bytes)
    }
}

/// The bytes behind base64 text (RFC 4648, section 4); the padding may be
/// missing.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let end = text.iter().rposition(|&b| b != b'=').map_or(0, |i| i + 1);
    let text = &text[..end];
    if text.len() % 4 == 1 {
        return None;
    }
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0u32;
        for i in 0..4 {
            let digit = group.get(i).map_or(Some(0), |&b| sextet(b))?;
            bits = bits << 6 | u32::from(digit);
        }
        let [_, three @ ..] = bits.to_be_bytes();
        bytes.extend_from_slice(&three[..group.len() - 1]);
    }
    Some(bytes)
}

fn sextet(digit: u8) -> Option<u8> {
    Some(match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    })
}

/// A path in which `%20` and the like stand for bytes (RFC 3986, 2.1).
fn percent_decoded(uri: &str) -> Result<String, String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let hex = tail.get(..2).and_then(|t| std::str::from_utf8(t).ok());
        match hex
            .filter(|_| first == b'%')
            .map(|t| u8::from_str_radix(t, 16))
        {
            Some(Ok(byte)) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).map_err(|_| "`uri` is not UTF-8".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_as_in_its_definition() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
            ("Zm9vYmE", "fooba"),
        ] {
            assert_eq!(base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(base64(b"+/+/"), Some(vec![0xfb, 0xff, 0xbf]));
        for text in ["Z", "Zm9v!", "Zm=v", "Zm9vY"] {
            assert_eq!(base64(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn percent_signs_are_bytes() {
        assert_eq!(percent_decoded("a%20b%C3%A9%2").as_deref(), Ok("a bé%2"));
        assert!(percent_decoded("%ff").is_err());
    }
}

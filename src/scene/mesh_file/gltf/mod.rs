//! glTF 2.0 (Khronos Group, *glTF 2.0 Specification*, 2021; ISO/IEC
//! 12113:2022), as JSON with buffers beside it or within, or as one binary
//! file: the triangles of the default scene, placed by its nodes.
//!
//! Skins, morph targets, cameras, lights and textures are skipped; material,
//! node and mesh give names. The format's up is `y`, ours is `z`: everything
//! is turned by a quarter about `x`.

mod accessor;
mod document;
mod nodes;

use std::path::Path;

use self::{
    accessor::Buffers,
    document::{Document, Form},
    nodes::Assembler,
};
use super::{Fault, MeshData};
use crate::scene::Inputs;

pub(super) fn parse_text(bytes: &[u8], folder: &Path, inputs: &Inputs) -> Result<MeshData, Fault> {
    let document = Document::read(bytes, 0, Form::Text)?;
    assemble(&document, None, folder, inputs)
}

const MAGIC: u32 = u32::from_le_bytes(*b"glTF");
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

pub(super) fn parse_binary(
    bytes: &[u8],
    folder: &Path,
    inputs: &Inputs,
) -> Result<MeshData, Fault> {
    let word = |at: usize| {
        let b: Option<[u8; 4]> = bytes.get(at..at + 4).and_then(|b| b.try_into().ok());
        b.map(u32::from_le_bytes)
            .ok_or_else(|| Fault::byte(bytes.len(), "the file ends in the middle of its header"))
    };
    if word(0)? != MAGIC {
        return Err(Fault::byte(
            0,
            "not a binary glTF file: it does not start with `glTF`",
        ));
    }
    let version = word(4)?;
    if version != 2 {
        let message = format!("version {version} of binary glTF; only 2 is known");
        return Err(Fault::byte(4, message));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        let message = format!(
            "the file says it has {length} bytes, but it has {}",
            bytes.len()
        );
        return Err(Fault::byte(8, message));
    }
    let mut at = 12;
    let mut chunk = |name: &str, kind: u32| {
        let (size, found) = (word(at)? as usize, word(at + 4)?);
        if found != kind {
            return Err(Fault::byte(at + 4, format!("this is not the {name} chunk")));
        }
        let start = at + 8;
        let body = bytes[..length]
            .get(start..)
            .and_then(|rest| rest.get(..size))
            .ok_or_else(|| {
                Fault::byte(
                    at,
                    format!("the {name} chunk of {size} bytes does not fit into the file"),
                )
            })?;
        at = start + size;
        Ok((start, body))
    };
    let (start, json) = chunk("JSON", JSON)?;
    let document = Document::read(json, start, Form::Binary)?;
    let is_last = start + json.len() == length;
    let bin = if is_last {
        None
    } else {
        Some(chunk("BIN", BIN)?.1)
    };
    assemble(&document, bin, folder, inputs)
}

fn assemble(
    document: &Document,
    bin: Option<&[u8]>,
    folder: &Path,
    inputs: &Inputs,
) -> Result<MeshData, Fault> {
    let buffers = Buffers::new(document, bin, folder, inputs);
    Assembler::new(document, buffers).scene()
}

#[cfg(test)]
mod tests;

//! The body of a PLY file: one item after the other.

use std::ops::Range;

use super::header::{ElementKind, Format, Property, Role, Scalar};
use crate::scene::mesh_file::Fault;

/// One vertex or face.
pub(super) struct Item {
    pub(super) position: [f64; 3],
    pub(super) normal: Option<[f64; 3]>,
}

/// The data after the header.
pub(super) struct Body<'b> {
    pub(super) bytes: &'b [u8],
    pub(super) at: usize,
    pub(super) format: Format,
}

impl Body<'_> {
    /// Reads one item; a face's corners are put into `corners`. Every item
    /// has at least one property, hence takes at least one byte.
    pub(super) fn item(
        &mut self,
        element: &ElementKind,
        corners: &mut Vec<u32>,
    ) -> Result<Item, Fault> {
        let mut item = Item {
            position: [0.0; 3],
            normal: None,
        };
        for property in &element.properties {
            if let Some(length) = property.length {
                self.list(property, length, corners)?;
                continue;
            }
            let value = self.scalar(property.scalar)?;
            match property.role {
                Role::Position(i) => item.position[i] = value,
                Role::Normal(i) => item.normal.get_or_insert([0.0; 3])[i] = value,
                Role::Corners | Role::Skipped => {}
            }
        }
        Ok(item)
    }

    fn list(
        &mut self,
        property: &Property,
        length: Scalar,
        corners: &mut Vec<u32>,
    ) -> Result<(), Fault> {
        let start = self.at;
        let count = self.scalar(length)?;
        if count < 0.0 || count.fract() != 0.0 {
            return Err(self.fault(start..self.at, "a list's length is not a whole number"));
        }
        let is_face = property.role == Role::Corners;
        if is_face {
            corners.clear();
            if count < 3.0 {
                return Err(self.fault(start..self.at, &format!("a face with {count} corners")));
            }
        }
        for _ in 0..count as u64 {
            let start = self.at;
            let value = self.scalar(property.scalar)?;
            if is_face {
                if value.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&value) {
                    return Err(
                        self.fault(start..self.at, &format!("{value} is not a vertex index"))
                    );
                }
                corners.push(value as u32);
            }
        }
        Ok(())
    }

    fn scalar(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        if self.format == Format::Ascii {
            return self.word();
        }
        let size = scalar.size();
        let Some(raw) = self.bytes.get(self.at..self.at + size) else {
            return Err(Fault::byte(
                self.bytes.len(),
                "the file ends in the middle of its data",
            ));
        };
        let mut b = [0; 8];
        b[..size].copy_from_slice(raw);
        if self.format == Format::Big {
            b[..size].reverse();
        }
        self.at += size;
        Ok(scalar.value(b))
    }

    /// The next number of an ASCII body.
    fn word(&mut self) -> Result<f64, Fault> {
        let rest = &self.bytes[self.at..];
        let skip = rest
            .iter()
            .position(|b| !b.is_ascii_whitespace())
            .unwrap_or(rest.len());
        let start = self.at + skip;
        let length = rest[skip..]
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len() - skip);
        if length == 0 {
            let last = self.bytes.trim_ascii_end().len();
            let mark = last.saturating_sub(1)..last;
            return Err(Fault::text(
                mark,
                "the file ends before its last element",
                "more numbers were announced",
            ));
        }
        self.at = start + length;
        let parsed = std::str::from_utf8(&self.bytes[start..self.at])
            .ok()
            .and_then(|t| t.parse().ok());
        parsed.ok_or_else(|| self.fault(start..self.at, "this is not a number"))
    }

    pub(super) fn fault(&self, span: Range<usize>, message: &str) -> Fault {
        match self.format {
            Format::Ascii => {
                // The span may start with the white space before a number.
                let skip = self.bytes[span.clone()]
                    .iter()
                    .take_while(|b| b.is_ascii_whitespace())
                    .count();
                Fault::text(span.start + skip..span.end, message, "here")
            }
            Format::Little | Format::Big => Fault::byte(span.start, message),
        }
    }
}

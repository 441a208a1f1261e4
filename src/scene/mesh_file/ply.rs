//! Stanford PLY: ASCII and binary of both byte orders, any elements and
//! properties in any order; what isn't a position, a normal or a face is
//! skipped.

use std::ops::Range;

use super::{Fault, MeshData, fill_normals, position, push_fan, unit_normal};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of `size()` little-endian bytes, zero-padded to eight.
    fn value(self, b: [u8; 8]) -> f64 {
        let [b0, b1, b2, b3, ..] = b;
        match self {
            Self::I8 => f64::from(b0 as i8),
            Self::U8 => f64::from(b0),
            Self::I16 => f64::from(i16::from_le_bytes([b0, b1])),
            Self::U16 => f64::from(u16::from_le_bytes([b0, b1])),
            Self::I32 => f64::from(i32::from_le_bytes([b0, b1, b2, b3])),
            Self::U32 => f64::from(u32::from_le_bytes([b0, b1, b2, b3])),
            Self::F32 => f64::from(f32::from_le_bytes([b0, b1, b2, b3])),
            Self::F64 => f64::from_le_bytes(b),
        }
    }
}

/// What a property means to us.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    /// A coordinate of the position: 0, 1 or 2.
    Position(usize),
    /// A coordinate of the normal.
    Normal(usize),
    /// A face's list of vertices.
    Corners,
    Skipped,
}

struct Property {
    /// Type of a list's length, for lists.
    length: Option<Scalar>,
    scalar: Scalar,
    role: Role,
}

struct ElementKind {
    name: Vec<u8>,
    count: u64,
    properties: Vec<Property>,
    /// Where the header declares it.
    span: Range<usize>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<MeshData, Fault> {
    let (format, elements, body) = header(bytes)?;
    check_elements(&elements)?;
    let mut reader = Body {
        bytes,
        at: body,
        format,
    };
    let mut mesh = MeshData::default();
    let mut normals = Vec::new();
    let mut corners = Vec::new();
    for element in &elements {
        for _ in 0..element.count {
            let start = reader.at;
            let item = reader.item(element, &mut corners)?;
            match element.name.as_slice() {
                b"vertex" => {
                    let p = position(item.position).ok_or_else(|| {
                        reader.fault(start..reader.at, "a vertex is not finite or too far away")
                    })?;
                    mesh.vertices.push(p);
                    if let Some(n) = item.normal {
                        normals.push(unit_normal(n).ok_or_else(|| {
                            reader.fault(start..reader.at, "a normal is not finite")
                        })?);
                    }
                }
                b"face" => push_fan(&mut mesh.triangles, &corners),
                _ => {}
            }
        }
    }
    check_indices(&mesh)?;
    if !normals.is_empty() {
        fill_normals(&mesh.vertices, &mesh.triangles, &mut normals);
        mesh.normals = Some(normals);
    }
    Ok(mesh)
}

fn check_indices(mesh: &MeshData) -> Result<(), Fault> {
    let count = mesh.vertices.len();
    for (i, t) in mesh.triangles.iter().enumerate() {
        if let Some(index) = t.iter().find(|&&v| v as usize >= count) {
            let message =
                format!("triangle {i} names vertex {index}, but there are {count}, counted from 0");
            return Err(Fault::file(message));
        }
    }
    Ok(())
}

/// Reads the header: the format, the elements, and where the body starts.
fn header(bytes: &[u8]) -> Result<(Format, Vec<ElementKind>, usize), Fault> {
    let mut at = 0;
    let mut format = None;
    let mut elements: Vec<ElementKind> = Vec::new();
    let mut is_first = true;
    loop {
        let Some(length) = bytes[at..].iter().position(|&b| b == b'\n') else {
            return Err(if is_first {
                Fault::file("not a PLY file: it does not start with a line `ply`")
            } else {
                Fault::file("the header never ends: `end_header` is missing")
            });
        };
        let tokens = tokens_of(bytes, at..at + length);
        at += length + 1;
        let words: Vec<&[u8]> = tokens.iter().map(|t| &bytes[t.clone()]).collect();
        match words.as_slice() {
            [b"ply"] if is_first => {}
            _ if is_first => {
                return Err(Fault::file(
                    "not a PLY file: it does not start with a line `ply`",
                ));
            }
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", kind, ..] => format = Some(format_named(kind, &tokens[1])?),
            [b"element", name, count] => {
                elements.push(element(
                    name,
                    count,
                    tokens[0].start..tokens[2].end,
                    &tokens[2],
                )?);
            }
            [b"property", rest @ ..] => {
                let Some(element) = elements.last_mut() else {
                    return Err(Fault::text(
                        tokens[0].clone(),
                        "a property before any element",
                        "",
                    ));
                };
                let property = property(&element.name, rest, &tokens)?;
                element.properties.push(property);
            }
            [b"end_header"] => break,
            _ => {
                let span = tokens[0].start..tokens[tokens.len() - 1].end;
                let label = "expected `format`, `element`, `property`, `comment` or `end_header`";
                return Err(Fault::text(span, "unknown line in the header", label));
            }
        }
        is_first = false;
    }
    let format = format.ok_or_else(|| Fault::file("the header has no `format` line"))?;
    Ok((format, elements, at))
}

fn tokens_of(bytes: &[u8], line: Range<usize>) -> Vec<Range<usize>> {
    let mut tokens = Vec::new();
    let mut at = line.start;
    while at < line.end {
        let length = bytes[at..line.end]
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(line.end - at);
        if length > 0 {
            tokens.push(at..at + length);
        }
        at += length + 1;
    }
    tokens
}

fn format_named(name: &[u8], span: &Range<usize>) -> Result<Format, Fault> {
    match name {
        b"ascii" => Ok(Format::Ascii),
        b"binary_little_endian" => Ok(Format::Little),
        b"binary_big_endian" => Ok(Format::Big),
        _ => Err(Fault::text(
            span.clone(),
            "unknown format",
            "expected `ascii`, `binary_little_endian` or `binary_big_endian`",
        )),
    }
}

fn element(
    name: &[u8],
    count: &[u8],
    span: Range<usize>,
    count_span: &Range<usize>,
) -> Result<ElementKind, Fault> {
    let parsed: Option<u64> = std::str::from_utf8(count).ok().and_then(|t| t.parse().ok());
    let count = parsed.ok_or_else(|| {
        Fault::text(
            count_span.clone(),
            "this is not a count",
            "expected a whole number",
        )
    })?;
    Ok(ElementKind {
        name: name.to_vec(),
        count,
        properties: vec![],
        span,
    })
}

fn property(element: &[u8], words: &[&[u8]], tokens: &[Range<usize>]) -> Result<Property, Fault> {
    let scalar = |i: usize| {
        Scalar::named(words[i]).ok_or_else(|| {
            let label = "expected a type such as `float`, `double`, `uchar` or `int`";
            Fault::text(tokens[i + 1].clone(), "unknown type", label)
        })
    };
    match words {
        [b"list", _, _, name] => {
            let is_corners =
                element == b"face" && matches!(*name, b"vertex_indices" | b"vertex_index");
            let role = if is_corners {
                Role::Corners
            } else {
                Role::Skipped
            };
            let (length, item) = (scalar(1)?, scalar(2)?);
            let is_fraction = |s: Scalar| matches!(s, Scalar::F32 | Scalar::F64);
            if is_fraction(length) || (is_corners && is_fraction(item)) {
                let label = "expected an integer type";
                return Err(Fault::text(
                    tokens[0].clone(),
                    "a list counted or indexed by fractions",
                    label,
                ));
            }
            Ok(Property {
                length: Some(length),
                scalar: item,
                role,
            })
        }
        [_, name] => {
            let role = match *name {
                b"x" => Role::Position(0),
                b"y" => Role::Position(1),
                b"z" => Role::Position(2),
                b"nx" => Role::Normal(0),
                b"ny" => Role::Normal(1),
                b"nz" => Role::Normal(2),
                _ => Role::Skipped,
            };
            let role = if element == b"vertex" {
                role
            } else {
                Role::Skipped
            };
            Ok(Property {
                length: None,
                scalar: scalar(0)?,
                role,
            })
        }
        _ => Err(Fault::text(
            tokens[0].clone(),
            "a property needs a type and a name",
            "expected `property float x` or `property list uchar int vertex_indices`",
        )),
    }
}

fn check_elements(elements: &[ElementKind]) -> Result<(), Fault> {
    for wanted in [b"vertex".as_slice(), b"face"] {
        let name = String::from_utf8_lossy(wanted);
        let mut matching = elements.iter().filter(|e| e.name == wanted);
        let element = matching
            .next()
            .ok_or_else(|| Fault::file(format!("the header has no element `{name}`")))?;
        if let Some(second) = matching.next() {
            return Err(Fault::text(
                second.span.clone(),
                format!("a second element `{name}`"),
                "",
            ));
        }
        let roles: Vec<Role> = element.properties.iter().map(|p| p.role).collect();
        let complete = if wanted == b"face" {
            roles.contains(&Role::Corners)
        } else {
            (0..3).all(|i| roles.contains(&Role::Position(i)))
        };
        if !complete {
            let label = if wanted == b"face" {
                "needs a list `vertex_indices`"
            } else {
                "needs `x`, `y` and `z`"
            };
            return Err(Fault::text(
                element.span.clone(),
                format!("the element `{name}` lacks a property"),
                label,
            ));
        }
    }
    // Items without properties take no bytes: their count would be free.
    for e in elements {
        if e.properties.is_empty() && e.count > 0 {
            return Err(Fault::text(
                e.span.clone(),
                "an element without properties",
                "",
            ));
        }
    }
    Ok(())
}

/// One vertex or face.
struct Item {
    position: [f64; 3],
    normal: Option<[f64; 3]>,
}

/// The data after the header.
struct Body<'b> {
    bytes: &'b [u8],
    at: usize,
    format: Format,
}

impl Body<'_> {
    /// Reads one item; a face's corners are put into `corners`. Every item
    /// has at least one property, hence takes at least one byte.
    fn item(&mut self, element: &ElementKind, corners: &mut Vec<u32>) -> Result<Item, Fault> {
        let mut item = Item {
            position: [0.0; 3],
            normal: None,
        };
        for property in &element.properties {
            match property.length {
                Some(length) => self.list(property, length, corners)?,
                None => {
                    let value = self.scalar(property.scalar)?;
                    match property.role {
                        Role::Position(i) => item.position[i] = value,
                        Role::Normal(i) => item.normal.get_or_insert([0.0; 3])[i] = value,
                        Role::Corners | Role::Skipped => {}
                    }
                }
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

    fn fault(&self, span: Range<usize>, message: &str) -> Fault {
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const HEADER: &str = "element vertex 4\nproperty float x\nproperty double y\nproperty short z\n\
        property uchar red\nproperty list uchar float weights\nelement edge 1\nproperty int a\n\
        element face 1\nproperty list uint ushort vertex_indices\nend_header\n";

    fn square() -> MeshData {
        let vertices = [
            (0.5, 0.25, 0.0),
            (1.0, 0.0, 0.0),
            (1.0, 1.0, -2.0),
            (0.0, 1.0, 0.0),
        ];
        MeshData {
            vertices: vertices.map(DVec3::from).to_vec(),
            normals: None,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    #[test]
    fn ascii_with_strangers_between() {
        let text = format!(
            "ply\r\nformat ascii 1.0\r\ncomment x\n{HEADER}\
            0.5 0.25 0 7 0\n1 0 0 7 2 0.5 0.5\n1 1 -2 7 0\n0 1 0 7 0\n9\n4 0 1 2 3\n"
        );
        assert_eq!(parse(text.as_bytes()).unwrap(), square());
    }

    #[test]
    fn binary_of_both_byte_orders() {
        for (name, little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
            let mut bytes = format!("ply\nformat {name} 1.0\n{HEADER}").into_bytes();
            let mut put = |mut raw: Vec<u8>| {
                if !little {
                    raw.reverse();
                }
                bytes.extend(raw);
            };
            for v in square().vertices {
                put((v.x as f32).to_le_bytes().to_vec());
                put(v.y.to_le_bytes().to_vec());
                put((v.z as i16).to_le_bytes().to_vec());
                put(vec![7]);
                put(vec![1]);
                put(0.5f32.to_le_bytes().to_vec());
            }
            put(9i32.to_le_bytes().to_vec());
            put(4u32.to_le_bytes().to_vec());
            for i in 0..4u16 {
                put(i.to_le_bytes().to_vec());
            }
            assert_eq!(parse(&bytes).unwrap(), square(), "{name}");
            let cut = parse(&bytes[..bytes.len() - 1]).unwrap_err();
            assert!(cut.message.contains("ends"), "{cut:?}");
        }
    }

    #[test]
    fn claimed_counts_cost_nothing() {
        let text = format!(
            "ply\nformat binary_little_endian 1.0\n{}",
            HEADER.replace("vertex 4", "vertex 18446744073709551615")
        );
        assert!(parse(text.as_bytes()).is_err());
        let text = text
            .replace("edge 1", "edge 99999999999")
            .replace("property int a\n", "");
        assert!(
            parse(text.as_bytes())
                .unwrap_err()
                .message
                .contains("without properties")
        );
    }
}

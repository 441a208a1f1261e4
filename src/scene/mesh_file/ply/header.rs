//! The header of a PLY file: what the body holds, in which order and format.

use std::ops::Range;

use crate::scene::mesh_file::Fault;

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Format {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
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
    pub(super) fn named(name: &[u8]) -> Option<Self> {
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

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of `size()` little-endian bytes, zero-padded to eight.
    pub(super) fn value(self, b: [u8; 8]) -> f64 {
        let [b0, b1, b2, b3, ..] = b;
        match self {
            Self::I8 => f64::from(i8::from_le_bytes([b0])),
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
pub(super) enum Role {
    /// A coordinate of the position: 0, 1 or 2.
    Position(usize),
    /// A coordinate of the normal.
    Normal(usize),
    /// A face's list of vertices.
    Corners,
    Skipped,
}

pub(super) struct Property {
    /// Type of a list's length, for lists.
    pub(super) length: Option<Scalar>,
    pub(super) scalar: Scalar,
    pub(super) role: Role,
}

pub(super) struct ElementKind {
    pub(super) name: Vec<u8>,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// Where the header declares it.
    pub(super) span: Range<usize>,
}

/// Reads the header: the format, the elements, and where the body starts.
pub(super) fn read(bytes: &[u8]) -> Result<(Format, Vec<ElementKind>, usize), Fault> {
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

pub(super) fn check_elements(elements: &[ElementKind]) -> Result<(), Fault> {
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

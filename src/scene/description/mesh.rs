//! Meshes as written: files, lists of vertices, generators.

use std::fmt;

use serde::{
    Deserialize, Deserializer,
    de::{Error, SeqAccess, Visitor},
};

use super::{HeightField, Number, Pair, Triple, value::finite};

/// Where a mesh comes from.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "mesh")]
pub enum MeshSource {
    /// `File("lens.ply")`.
    File(String),
    /// `Mesh(file: ..)` or `Mesh(vertices: .., triangles: ..)`; the name may
    /// be left out in the `meshes` section.
    Mesh(MeshFields),
    /// A sheet of waves.
    Waves(Waves),
    /// A torus knot.
    TorusKnot(TorusKnot),
    /// A height field.
    HeightField(HeightField),
}

/// The fields of a mesh: exactly one of `file`, `named` and `vertices`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Mesh")]
pub struct MeshFields {
    /// Path of a mesh file, relative to the scene file.
    pub file: Option<String>,
    /// Name of an entry of `meshes`.
    pub named: Option<String>,
    /// Vertex positions.
    pub vertices: Option<Vec<Triple>>,
    /// Vertex indices, counted from 0.
    pub triangles: Option<Vec<[u32; 3]>>,
    /// One normal per vertex.
    pub normals: Option<Vec<Triple>>,
    /// Which normals shade it.
    pub smooth: Option<Smooth>,
}

/// What `smooth` says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smooth {
    /// `true`: round; `false`: faceted.
    Flag(bool),
    /// Round where faces meet at no more than this angle in degrees.
    Angle(Number),
}

/// `Waves(..)`: a height field that is a sum of sine waves.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Waves")]
pub struct Waves {
    /// Extent along x in metres.
    pub x: Pair,
    /// Extent along y in metres.
    pub y: Pair,
    /// Height of the undisturbed surface in metres.
    #[serde(default = "zero")]
    pub level: Number,
    /// Grid cells along x and y.
    #[serde(default = "Waves::cells")]
    pub cells: Cells,
    /// The waves whose heights are added.
    pub waves: Vec<Wave>,
}

/// One sine wave: `amplitude * sin(k . (x, y) + phase)`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Wave")]
pub struct Wave {
    /// Largest height in metres.
    pub amplitude: Number,
    /// Wave vector in radians per metre.
    pub k: Pair,
    /// Phase in radians.
    #[serde(default = "zero")]
    pub phase: Number,
}

impl Waves {
    fn cells() -> Cells {
        Cells([256, 256])
    }
}

/// A number of cells, or one per axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cells(pub [u32; 2]);

/// `TorusKnot(..)`: a tube around a curve that winds around a torus.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "TorusKnot")]
pub struct TorusKnot {
    /// Turns around the torus' axis.
    pub p: u32,
    /// Turns around the torus' ring.
    pub q: u32,
    /// Centre in metres.
    pub center: Triple,
    /// Metres per unit of the curve.
    pub scale: Number,
    /// Radius of the torus' ring in units of the curve, whose own winding has
    /// radius 1.
    pub ring: Number,
    /// Stretch of the curve along z.
    pub height: Number,
    /// Radius of the tube in metres.
    pub tube: Number,
    /// Vertices along the curve.
    pub segments: u32,
    /// Vertices around the tube.
    pub sides: u32,
}

impl Default for TorusKnot {
    fn default() -> Self {
        Self {
            p: 2,
            q: 3,
            center: Triple([0.0; 3]),
            scale: Number(0.27),
            ring: Number(2.0),
            height: Number(1.2),
            tube: Number(0.15),
            segments: 1024,
            sides: 64,
        }
    }
}

fn zero() -> Number {
    Number(0.0)
}

impl<'de> Deserialize<'de> for Smooth {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct V;
        impl Visitor<'_> for V {
            type Value = Smooth;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("`true`, `false` or an angle in degrees")
            }
            fn visit_bool<E: Error>(self, v: bool) -> Result<Smooth, E> {
                Ok(Smooth::Flag(v))
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<Smooth, E> {
                finite(v).map(|v| Smooth::Angle(Number(v)))
            }
            fn visit_u64<E: Error>(self, v: u64) -> Result<Smooth, E> {
                Ok(Smooth::Angle(Number(v as f64)))
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<Smooth, E> {
                Ok(Smooth::Angle(Number(v as f64)))
            }
        }
        deserializer.deserialize_any(V)
    }
}

impl<'de> Deserialize<'de> for Cells {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Cells;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number, or two as `(nx, ny)`")
            }
            fn visit_u64<E: Error>(self, v: u64) -> Result<Cells, E> {
                let n = u32::try_from(v).map_err(|_| E::custom("too many cells"))?;
                Ok(Cells([n, n]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Cells, A::Error> {
                let mut cells = [0; 2];
                for (i, n) in cells.iter_mut().enumerate() {
                    let next = seq.next_element()?;
                    *n = next.ok_or_else(|| A::Error::invalid_length(i, &self))?;
                }
                Ok(Cells(cells))
            }
        }
        deserializer.deserialize_any(V)
    }
}

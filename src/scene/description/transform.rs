//! Placements as written.

use std::fmt;

use serde::{
    Deserialize, Deserializer,
    de::{self, Error, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer},
};

use super::{Number, Triple};

/// `(scale: .., rotate: .., translate: ..)`: applied in this order, whatever
/// the order of writing.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Transform")]
pub struct TransformStep {
    /// Factor, or one per axis.
    pub scale: Option<Scale>,
    /// Rotations about axes through the origin.
    pub rotate: Option<Rotations>,
    /// Shift in metres.
    pub translate: Option<Triple>,
}

/// One step, or a list of them applied in order.
#[derive(Clone, Debug)]
pub struct Steps(pub Vec<TransformStep>);

/// Factors along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(pub [f64; 3]);

/// `(axis: .., degrees: ..)`, right-handed about the axis.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Rotation")]
pub struct Rotation {
    /// Direction of the axis.
    pub axis: Triple,
    /// Angle in degrees.
    pub degrees: Number,
}

/// One rotation, or a list of them applied in order.
#[derive(Clone, Debug)]
pub struct Rotations(pub Vec<Rotation>);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Scale;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or one per axis as `(x, y, z)`")
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<Scale, E> {
                let unexpected = de::Unexpected::Other("a number that is not finite");
                let finite = v.is_finite().then_some(Scale([v; 3]));
                finite.ok_or_else(|| E::invalid_value(unexpected, &self))
            }
            fn visit_u64<E: Error>(self, v: u64) -> Result<Scale, E> {
                Ok(Scale([v as f64; 3]))
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<Scale, E> {
                Ok(Scale([v as f64; 3]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Scale, A::Error> {
                let mut scale = [0.0; 3];
                for (i, s) in scale.iter_mut().enumerate() {
                    let next: Option<Number> = seq.next_element()?;
                    *s = next.ok_or_else(|| A::Error::invalid_length(i, &self))?.0;
                }
                Ok(Scale(scale))
            }
        }
        deserializer.deserialize_any(V)
    }
}

impl<'de> Deserialize<'de> for Rotations {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Rotations;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("`(axis: (x, y, z), degrees: a)`, or a list of such rotations")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Rotations, A::Error> {
                Rotation::deserialize(MapAccessDeserializer::new(map)).map(|r| Rotations(vec![r]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Rotations, A::Error> {
                let mut list = vec![];
                while let Some(rotation) = seq.next_element()? {
                    list.push(rotation);
                }
                Ok(Rotations(list))
            }
        }
        deserializer.deserialize_any(V)
    }
}

impl<'de> Deserialize<'de> for Steps {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Steps;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("`(scale: .., rotate: .., translate: ..)`, or a list of such steps")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Steps, A::Error> {
                TransformStep::deserialize(MapAccessDeserializer::new(map)).map(|s| Steps(vec![s]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Steps, A::Error> {
                let mut list = vec![];
                while let Some(step) = seq.next_element()? {
                    list.push(step);
                }
                Ok(Steps(list))
            }
        }
        deserializer.deserialize_any(V)
    }
}

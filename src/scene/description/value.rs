//! Numbers, triples and colours as they are written. All numbers are finite.

use std::fmt;

use glam::DVec3;
use serde::{
    Deserialize, Deserializer,
    de::{Error, SeqAccess, Visitor},
};

/// A finite number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number(pub f64);

/// Refuses what RON accepts as a number but nobody means.
pub(super) fn finite<E: Error>(value: f64) -> Result<f64, E> {
    if value.is_finite() {
        Ok(value)
    } else if value.is_nan() {
        Err(E::custom("NaN is not a number to compute with"))
    } else {
        Err(E::custom(
            "this number is infinite, or too large for a double",
        ))
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        finite(f64::deserialize(deserializer)?).map(Self)
    }
}

/// Three finite numbers: a point, a direction, ...
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triple(pub [f64; 3]);

impl From<Triple> for DVec3 {
    fn from(t: Triple) -> Self {
        Self::from_array(t.0)
    }
}

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        <[Number; 3]>::deserialize(deserializer).map(|n| Self(n.map(|n| n.0)))
    }
}

/// Two finite numbers: a size, a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair(pub [f64; 2]);

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        <[Number; 2]>::deserialize(deserializer).map(|n| Self(n.map(|n| n.0)))
    }
}

/// A colour as written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Colour {
    /// The same in all channels.
    Grey(f64),
    /// Linear sRGB coefficients.
    Linear([f64; 3]),
    /// The eight-bit sRGB values of `"#rrggbb"`.
    Hex([u8; 3]),
}

impl Colour {
    /// One in each channel.
    pub fn white() -> Self {
        Self::Grey(1.0)
    }
}

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ColourVisitor)
    }
}

struct ColourVisitor;

impl<'de> Visitor<'de> for ColourVisitor {
    type Value = Colour;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number (a grey), `(r, g, b)` or \"#rrggbb\"")
    }

    fn visit_f64<E: Error>(self, v: f64) -> Result<Colour, E> {
        finite(v).map(Colour::Grey)
    }

    fn visit_u64<E: Error>(self, v: u64) -> Result<Colour, E> {
        Ok(Colour::Grey(v as f64))
    }

    fn visit_i64<E: Error>(self, v: i64) -> Result<Colour, E> {
        Ok(Colour::Grey(v as f64))
    }

    fn visit_str<E: Error>(self, v: &str) -> Result<Colour, E> {
        hex(v).map(Colour::Hex).ok_or_else(|| {
            E::custom(format!(
                "`{}` is not a colour",
                v.chars().take(20).collect::<String>()
            ))
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Colour, A::Error> {
        let mut channels = [0.0; 3];
        for (i, channel) in channels.iter_mut().enumerate() {
            let next: Option<Number> = seq.next_element()?;
            *channel = next.ok_or_else(|| A::Error::invalid_length(i, &self))?.0;
        }
        Ok(Colour::Linear(channels))
    }
}

/// The three bytes of `#rrggbb`.
fn hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let value = u32::from_str_radix(digits, 16).ok()?;
    Some([(value >> 16) as u8, (value >> 8) as u8, value as u8])
}

/// A number, or a text that says more.
#[derive(Clone, Debug)]
pub(super) enum NumberOrText {
    Number(f64),
    Text(String),
}

impl<'de> Deserialize<'de> for NumberOrText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct V;
        impl Visitor<'_> for V {
            type Value = NumberOrText;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a text")
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<NumberOrText, E> {
                finite(v).map(NumberOrText::Number)
            }
            fn visit_u64<E: Error>(self, v: u64) -> Result<NumberOrText, E> {
                Ok(NumberOrText::Number(v as f64))
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<NumberOrText, E> {
                Ok(NumberOrText::Number(v as f64))
            }
            fn visit_str<E: Error>(self, v: &str) -> Result<NumberOrText, E> {
                Ok(NumberOrText::Text(v.to_owned()))
            }
        }
        deserializer.deserialize_any(V)
    }
}

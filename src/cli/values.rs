//! How the values of options are written.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
    time::Duration,
};

use clap::{
    ValueEnum,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};
use nephroid::{
    metrics::{Map, Metric},
    reference,
};

/// Largest picture side that is understood; far beyond what memory allows, and
/// small enough for every format.
const LONGEST_SIDE: u32 = 1 << 20;

/// A file to write and what to put into it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Output {
    pub(crate) path: PathBuf,
    pub(crate) format: Format,
}

/// The kinds of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Exr,
    Png,
}

/// A rectangle of the picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crop {
    /// Column and row of the top left pixel.
    pub(crate) origin: [u32; 2],
    /// Width and height.
    pub(crate) size: [u32; 2],
}

/// How a picture is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Method {
    /// By the renderer.
    #[default]
    Photons,
    /// By a reference method.
    Reference(reference::Method),
}

impl Method {
    /// The name that is typed, and what it means.
    fn known() -> Vec<(Self, &'static str, &'static str)> {
        let mut all = vec![(Self::Photons, "photons", "the photon map: the renderer")];
        let references =
            reference::Method::ALL.map(|m| (Self::Reference(m), m.name(), m.summary()));
        all.extend(references);
        all
    }
}

/// Understands the name of a method.
pub(crate) fn method() -> impl TypedValueParser<Value = Method> {
    let known = Method::known();
    let names = known
        .into_iter()
        .map(|(_, name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(names).try_map(|text| {
        let mut known = Method::known().into_iter();
        known
            .find(|(_, name, _)| *name == text)
            .map(|(method, ..)| method)
            .ok_or("no such method")
    })
}

/// A path that ends in `.exr` or `.png`, in any case.
pub(crate) fn output(text: &str) -> Result<Output, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().and_then(OsStr::to_str);
    let format = match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("exr") => Format::Exr,
        Some("png") => Format::Png,
        Some(_) => return Err("unknown kind of picture; use .exr or .png".to_owned()),
        None => return Err("the name must end in .exr or .png".to_owned()),
    };
    Ok(Output { path, format })
}

/// The files written when none is named: the scene's name with both
/// extensions, in the current directory.
pub(crate) fn default_outputs(scene: &Path) -> Vec<Output> {
    let stem = scene.file_stem().unwrap_or(OsStr::new("picture"));
    let with = |extension: &str, format| {
        let mut name = stem.to_owned();
        name.push(extension);
        let path = name.into();
        Output { path, format }
    };
    vec![with(".exr", Format::Exr), with(".png", Format::Png)]
}

/// A length of time: numbers with units `h`, `m`, `s`, `ms`, each unit at most
/// once and the large ones first, such as `1h30m` or `0.5s`.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    const UNITS: [(&str, f64); 4] = [("h", 3600.0), ("m", 60.0), ("s", 1.0), ("ms", 0.001)];
    let mut rest = text;
    let mut seconds = 0.0;
    let mut allowed = &UNITS[..];
    while !rest.is_empty() {
        let split = |s: &str, ends: fn(char) -> bool| s.find(ends).unwrap_or(s.len());
        let (number, tail) = rest.split_at(split(rest, |c| !c.is_ascii_digit() && c != '.'));
        let (unit, tail) = tail.split_at(split(tail, |c| c.is_ascii_digit() || c == '.'));
        let value: f64 = number.parse().map_err(|_| explain(text))?;
        let place = allowed.iter().position(|(name, _)| *name == unit);
        let place = place.ok_or_else(|| explain(text))?;
        seconds += value * allowed[place].1;
        allowed = &allowed[place + 1..];
        rest = tail;
    }
    match Duration::try_from_secs_f64(seconds) {
        Ok(time) if !time.is_zero() => Ok(time),
        _ => Err(explain(text)),
    }
}

fn explain(text: &str) -> String {
    if text.parse::<f64>().is_ok_and(|v| v > 0.0) {
        format!("a unit is missing; did you mean {text}s?")
    } else {
        "expected a time above zero such as 30s, 2m, 1h30m or 500ms".to_owned()
    }
}

/// A picture size such as `800x600`.
pub(crate) fn resolution(text: &str) -> Result<[u32; 2], String> {
    let expected = || "expected a size in pixels such as 800x600".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side = |text: &str| {
        let value = text.trim().parse::<u32>().map_err(|_| expected())?;
        if value == 0 {
            Err("a picture has at least one pixel in each direction".to_owned())
        } else if value > LONGEST_SIDE {
            Err(format!("no side may be longer than {LONGEST_SIDE} pixels"))
        } else {
            Ok(value)
        }
    };
    Ok([side(width)?, side(height)?])
}

/// A number of metres.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    between(text, 1e-6, 1e6, "a length in metres such as 0.3")
}

/// How many times larger a picture is than its lens.
pub(crate) fn magnification(text: &str) -> Result<f64, String> {
    between(text, 0.01, 100.0, "a factor such as 1.5")
}

/// An index of refraction that refracts.
pub(crate) fn index(text: &str) -> Result<f64, String> {
    between(text, 1.01, 10.0, "an index of refraction such as 1.5")
}

/// A least brightness.
pub(crate) fn darkest(text: &str) -> Result<f64, String> {
    between(
        text,
        0.005,
        1.0,
        "a part of the greatest brightness such as 0.05",
    )
}

fn between(text: &str, least: f64, most: f64, what: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (least..=most).contains(&value) => Ok(value),
        _ => Err(format!("expected {what}, from {least} to {most}")),
    }
}

/// A rectangle such as `100,50,320x240`.
pub(crate) fn crop(text: &str) -> Result<Crop, String> {
    let expected = || {
        "expected column, row and size in pixels such as 100,50,320x240 (the first row is the top)"
            .to_owned()
    };
    let mut parts = text.splitn(3, ',');
    let mut next = || parts.next().map(str::trim).ok_or_else(expected);
    let [x, y, size] = [next()?, next()?, next()?];
    let place = |text: &str| text.parse::<u32>().map_err(|_| expected());
    Ok(Crop {
        origin: [place(x)?, place(y)?],
        size: resolution(size)?,
    })
}

/// A rectangle such as `100,50,320x240` or `100,50,320,240`.
pub(crate) fn region(text: &str) -> Result<Crop, String> {
    match text.rsplit_once(',') {
        Some((front, height)) if text.matches(',').count() == 3 => {
            crop(&format!("{front}x{height}"))
        }
        _ => crop(text),
    }
}

/// A metric and the value that it may reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bound {
    pub(crate) metric: Metric,
    pub(crate) value: f64,
}

/// The name of a metric.
pub(crate) fn metric(text: &str) -> Result<Metric, String> {
    let mut all = Metric::ALL.into_iter();
    all.find(|metric| metric.name() == text).ok_or_else(|| {
        let names = Metric::ALL.map(Metric::name).join(", ");
        format!("there is no such metric; use one of {names}")
    })
}

/// A bound such as `relmse=0.0025`.
pub(crate) fn bound(text: &str) -> Result<Bound, String> {
    let expected = || "expected a metric and a number such as relmse=0.0025".to_owned();
    let (name, value) = text.split_once('=').ok_or_else(expected)?;
    Ok(Bound {
        metric: metric(name.trim())?,
        value: finite(value.trim()).map_err(|_| expected())?,
    })
}

/// A finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|v| v.is_finite());
    value.ok_or_else(|| "expected a number".to_owned())
}

/// A finite number above zero.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let value = finite(text).ok().filter(|v| *v > 0.0);
    value.ok_or_else(|| "expected a number above zero".to_owned())
}

/// The errors that can be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MapKind {
    /// What a screen shows, as the eye sees it (LDR-FLIP)
    Flip,
    /// The same over all exposures (HDR-FLIP; EXR only)
    HdrFlip,
    /// Root of the squared relative error: 0.05 is 5 %
    Relmse,
    /// Absolute difference
    Abs,
}

impl From<MapKind> for Map {
    fn from(kind: MapKind) -> Self {
        match kind {
            MapKind::Flip => Self::Flip,
            MapKind::HdrFlip => Self::HdrFlip,
            MapKind::Relmse => Self::RelMse,
            MapKind::Abs => Self::Abs,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        for (text, millis) in [
            ("30s", 30_000),
            ("2m", 120_000),
            ("1h30m", 5_400_000),
            ("500ms", 500),
            ("1m0.5s", 60_500),
            ("1h2m3s4ms", 3_723_004),
        ] {
            assert_eq!(duration(text), Ok(Duration::from_millis(millis)), "{text}");
        }
        for text in [
            "",
            "s",
            "0s",
            "-1s",
            "1x",
            "1s1s",
            "30m1h",
            "1 s",
            "1..2s",
            "inf s",
            "1e400s",
            "99999999999999999h",
        ] {
            assert!(duration(text).is_err(), "{text}");
        }
        assert!(duration("30").unwrap_err().contains("30s"));
    }

    #[test]
    fn outputs() {
        let kind = |text| output(text).map(|o| o.format);
        assert_eq!(kind("a/b.exr"), Ok(Format::Exr));
        assert_eq!(kind("b.c.PNG"), Ok(Format::Png));
        for text in ["b.jpg", "b", ".exr", "exr", "b.exr.gz", ""] {
            assert!(kind(text).is_err(), "{text}");
        }
        let defaults = default_outputs(Path::new("scenes/two.lenses.ron"));
        let paths: Vec<_> = defaults.iter().map(|o| o.path.to_str().unwrap()).collect();
        assert_eq!(paths, ["two.lenses.exr", "two.lenses.png"]);
    }

    #[test]
    fn numbers_have_limits() {
        assert_eq!(length("0.3"), Ok(0.3));
        assert_eq!(magnification("2"), Ok(2.0));
        for text in ["0", "-1", "nan", "inf", "1e9", "0.3m", ""] {
            assert!(length(text).is_err(), "{text}");
            assert!(index(text).is_err(), "{text}");
            assert!(darkest(text).is_err(), "{text}");
        }
        assert!(darkest("0.004").unwrap_err().contains("0.005"));
    }

    #[test]
    fn sizes_and_crops() {
        assert_eq!(resolution("800x600"), Ok([800, 600]));
        for text in [
            "800",
            "800x",
            "0x5",
            "5x0",
            "-1x5",
            "1.5x2",
            "8x8x8",
            "1048577x1",
        ] {
            assert!(resolution(text).is_err(), "{text}");
        }
        let expected = Crop {
            origin: [10, 0],
            size: [3, 4],
        };
        assert_eq!(crop("10,0,3x4"), Ok(expected));
        for text in ["10,0", "10,0,3", "10,0,3x0", "-1,0,3x3", "1,2,3x4,5", ""] {
            assert!(crop(text).is_err(), "{text}");
        }
    }

    #[test]
    fn regions_are_crops_in_either_notation() {
        let expected = crop("10,0,3x4");
        assert!(expected.is_ok());
        assert_eq!(region("10,0,3x4"), expected);
        assert_eq!(region("10,0,3,4"), expected);
        for text in [
            "10,0,3",
            "10,0,3,0",
            "1,2,3,4,5",
            "1,2,3x4,5",
            "a,0,3,4",
            "",
        ] {
            assert!(region(text).is_err(), "{text}");
        }
    }

    #[test]
    fn bounds() {
        for metric in Metric::ALL {
            let text = format!("{}=-1e-3", metric.name());
            let value = -1e-3;
            assert_eq!(bound(&text), Ok(Bound { metric, value }));
        }
        for text in [
            "rmse", "rmse=", "rmse=x", "rmse=nan", "rmse=inf", "=1", "rms=1", "",
        ] {
            assert!(bound(text).is_err(), "{text}");
        }
        assert!(bound("rms=1").unwrap_err().contains("hdr-flip"));
        assert!(positive("0").is_err() && positive("-1").is_err() && positive("inf").is_err());
    }
}

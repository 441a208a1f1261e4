//! How the values of options are written.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
    time::Duration,
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
}

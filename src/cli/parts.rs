//! How parts of pictures are written: which passes, and what is made of them.

use std::{ffi::OsStr, path::PathBuf};

use super::values::{Output, output};

/// What `merge` makes of parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Merged {
    Picture(Output),
    /// A larger part, which can be merged and gone on from.
    Part(PathBuf),
}

/// A path that ends in `.exr`, `.png` or `.ckpt`, in any case.
pub(crate) fn merged(text: &str) -> Result<Merged, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().and_then(OsStr::to_str);
    if extension.is_some_and(|e| e.eq_ignore_ascii_case("ckpt")) {
        return Ok(Merged::Part(path));
    }
    let picture = output(text).map(Merged::Picture);
    picture.map_err(|_| "the name must end in .exr, .png or .ckpt".to_owned())
}

/// Passes to render: those from `first` up to, but without, `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Passes {
    pub(crate) first: u32,
    pub(crate) end: u32,
}

/// A number of passes such as `64`, or a range of them such as `64..128`.
pub(crate) fn passes(text: &str) -> Result<Passes, String> {
    let number = |text: &str| {
        let expected = "expected a number such as 64, or a range such as 64..128";
        text.parse::<u32>().map_err(|_| expected.to_owned())
    };
    let (first, end) = match text.split_once("..") {
        Some((first, end)) => (number(first)?, number(end)?),
        None => (0, number(text)?),
    };
    if first < end {
        Ok(Passes { first, end })
    } else if first == 0 {
        Err("a picture needs at least one pass".to_owned())
    } else {
        Err("the range is empty; its end is the first pass that is not rendered".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_numbers_or_ranges() {
        let range = |first, end| Ok(Passes { first, end });
        assert_eq!(passes("64"), range(0, 64));
        assert_eq!(passes("0..64"), range(0, 64));
        assert_eq!(passes("64..128"), range(64, 128));
        for text in [
            "0",
            "0..0",
            "5..5",
            "9..3",
            "5..",
            "..5",
            "-1",
            "1.5",
            "1...5",
            "",
            "4294967296",
        ] {
            assert!(passes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn merged_files() {
        assert_eq!(merged("a.CKPT"), Ok(Merged::Part("a.CKPT".into())));
        assert_eq!(merged("a.exr"), output("a.exr").map(Merged::Picture));
        assert!(merged("a.jpg").unwrap_err().contains(".ckpt") && output("a.ckpt").is_err());
    }
}

//! The film's promises end to end: exact sums, files that hold what was
//! rendered, and files that are whole or absent.

use std::{collections::HashMap, fs, io, path::Path};

use exr::prelude::{AttributeValue, MetaData};
use nephroid::{
    film::{
        Attribute, Film, Image, Layer, OutputError, PixelSample, Provenance, Window, atomic,
        encode_exr, encode_png, read_exr, srgb_byte, write_film, write_png,
    },
    numeric::exact::Quantum,
    spectrum::Rgb,
};
use proptest::prelude::*;

/// Samples of one pass that depend on nothing but its index; magnitudes from
/// 1e-12 to 1e12, where floating-point sums would depend on the order.
fn pass(index: u32, pixels: usize) -> Vec<PixelSample> {
    let mut state = u64::from(index).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let unit = (state >> 11) as f64 / (1u64 << 53) as f64;
        libm::pow(10.0, 24.0 * unit - 12.0)
    };
    let mut sample = || PixelSample {
        sheets: [[0.0; 2]; 2],
        sheet_steps: [0.0; 2],
        layers: std::array::from_fn(|_| Rgb::new(next(), next(), next())),
        blur: [next(), -next()],
    };
    (0..pixels).map(|_| sample()).collect()
}

fn film_of(indices: &[u32]) -> Film {
    let mut film = Film::new(7, 5, Quantum::for_typical(2.0));
    for &i in indices {
        film.add_pass(i, &pass(i, 35));
    }
    film
}

fn provenance() -> Provenance {
    Provenance {
        scene_hash: "0123abcd".to_owned(),
        seed: u64::MAX,
        photons: 123_456_789_012,
        render_seconds: 12.5,
        further: vec![
            ("note".to_owned(), Attribute::Text("caustic".to_owned())),
            ("kernelScale".to_owned(), Attribute::Number(0.125)),
        ],
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Shuffled, and summed in parts that are merged in any order: equal films,
    /// hence equal bytes.
    #[test]
    fn order_and_grouping_leave_no_trace(
        order in Just((0..20u32).collect::<Vec<_>>()).prop_shuffle(),
        cuts in (0usize..=20, 0usize..=20),
    ) {
        let whole = film_of(&(0..20).collect::<Vec<_>>());
        let (a, b) = (cuts.0.min(cuts.1), cuts.0.max(cuts.1));
        let mut merged = film_of(&order[b..]);
        for part in [&order[..a], &order[a..b]] {
            merged.merge(&film_of(part)).unwrap();
        }
        prop_assert_eq!(&whole, &merged);
        prop_assert_eq!(&whole, &film_of(&order));
    }
}

#[test]
fn thread_count_leaves_no_trace() {
    let one = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| film_of(&[0, 1, 2, 9]))
    };
    assert_eq!(one(1), one(2));
    assert_eq!(one(1), one(7));
}

#[test]
fn layers_sum_to_the_picture() {
    let film = film_of(&(0..16).collect::<Vec<_>>());
    let total = film.image();
    let layers = Layer::ALL.map(|layer| film.layer_image(layer));
    for (i, &t) in total.pixels().iter().enumerate() {
        let sum = layers
            .iter()
            .fold(Rgb::BLACK, |s, image| s + image.pixels()[i]);
        for c in 0..3 {
            assert!((sum[c] - t[c]).abs() <= 1e-14 * t[c], "{} {}", sum[c], t[c]);
        }
    }
}

fn as_single(image: &Image) -> Image {
    let pixels = image
        .pixels()
        .iter()
        .map(|p| p.map(|c| f64::from(c as f32)));
    Image::new(image.width(), image.height(), pixels.collect())
}

#[test]
fn an_exr_holds_the_layers() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture.exr");
    let film = film_of(&[0, 1, 2]);
    write_film(&path, &film, Window::whole(7, 5), &provenance()).unwrap();
    assert_eq!(read_exr(&path, "").unwrap(), as_single(&film.image()));
    for layer in Layer::ALL {
        assert_eq!(
            read_exr(&path, layer.name()).unwrap(),
            as_single(&film.layer_image(layer)),
            "{}",
            layer.name()
        );
    }
    let error = read_exr(&path, "volume").unwrap_err().to_string();
    assert!(
        error.contains("volume.R") && error.contains("caustic.G"),
        "{error}"
    );
}

#[test]
fn an_exr_says_how_it_came_about() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture.exr");
    let window = Window {
        full: [640, 480],
        origin: [100, 200],
    };
    write_film(&path, &film_of(&[0, 1, 2]), window, &provenance()).unwrap();
    let meta = MetaData::read_from_file(&path, true).unwrap();
    assert_eq!(meta.headers.len(), 1, "one part");
    let header = &meta.headers[0];
    assert_eq!(header.compression, exr::prelude::Compression::ZIP16);
    assert_eq!(
        header.own_attributes.layer_position,
        exr::prelude::Vec2(100, 200)
    );
    assert_eq!(header.layer_size, exr::prelude::Vec2(7, 5));
    assert_eq!(
        header.shared_attributes.display_window.size,
        exr::prelude::Vec2(640, 480)
    );
    let software = header.own_attributes.software_name.as_ref().unwrap();
    assert_eq!(
        software.to_string(),
        concat!("nephroid ", env!("CARGO_PKG_VERSION"))
    );
    let found: HashMap<String, &AttributeValue> = header
        .own_attributes
        .other
        .iter()
        .map(|(name, value)| (name.to_string(), value))
        .collect();
    let text = |t: &str| AttributeValue::Text(t.into());
    for (name, value) in [
        ("sceneHash", text("0123abcd")),
        ("seed", text("18446744073709551615")),
        ("passes", AttributeValue::F64(3.0)),
        ("photons", AttributeValue::F64(123_456_789_012.0)),
        ("renderSeconds", AttributeValue::F64(12.5)),
        ("note", text("caustic")),
        ("kernelScale", AttributeValue::F64(0.125)),
    ] {
        assert_eq!(found.get(name), Some(&&value), "{name}");
    }
}

#[test]
fn equal_pictures_have_equal_bytes() {
    let image = film_of(&[4]).image();
    let attributes: Vec<_> = (0..12)
        .map(|i| (format!("a{i}"), Attribute::Number(f64::from(i))))
        .collect();
    let mut backwards = attributes.clone();
    backwards.reverse();
    let encode =
        |attributes: &[_]| encode_exr(&[("", &image)], Window::whole(7, 5), attributes).unwrap();
    assert_eq!(encode(&attributes), encode(&backwards));
}

#[test]
fn what_an_exr_cannot_hold_is_refused() {
    let small = Image::new(1, 1, vec![Rgb::WHITE]);
    let large = Image::new(2, 1, vec![Rgb::WHITE; 2]);
    let window = Window::whole(2, 1);
    assert!(encode_exr(&[], window, &[]).is_err());
    assert!(encode_exr(&[("", &small), ("x", &large)], window, &[]).is_err());
    assert!(encode_exr(&[("", &Image::new(0, 0, vec![]))], window, &[]).is_err());
    let own = [("compression".to_owned(), Attribute::Number(1.0))];
    assert!(encode_exr(&[("", &large)], window, &own).is_err());
    let far = Window {
        full: [2, 1],
        origin: [u32::MAX, 0],
    };
    assert!(encode_exr(&[("", &large)], far, &[]).is_err());
}

#[test]
fn an_exr_holds_no_infinity() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("bright.exr");
    let image = Image::new(1, 1, vec![Rgb::new(1e300, -1e300, 1.0)]);
    nephroid::film::write_exr(&path, &[("", &image)], Window::whole(1, 1), &[]).unwrap();
    let max = f64::from(f32::MAX);
    let read = read_exr(&path, "").unwrap();
    assert_eq!(read.pixel(0, 0), Rgb::new(max, -max, 1.0));
}

#[test]
fn half_precision_is_read() {
    use exr::prelude::*;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("half.exr");
    let picture = SpecificChannels::rgb(|p: Vec2<usize>| {
        let v = |i: usize| f16::from_f32(i as f32 * 0.25);
        (v(p.0), v(p.1), v(9))
    });
    exr::prelude::Image::from_channels((3, 2), picture)
        .write()
        .to_file(&path)
        .unwrap();
    let read = read_exr(&path, "").unwrap();
    assert_eq!((read.width(), read.height()), (3, 2));
    assert_eq!(read.pixel(2, 1), Rgb::new(0.5, 0.25, 2.25));
}

#[test]
fn broken_exr_files_are_errors() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("broken.exr");
    assert!(read_exr(&path, "").is_err(), "missing");
    let image = film_of(&[4]).image();
    let whole = encode_exr(&[("", &image)], Window::whole(7, 5), &[]).unwrap();
    for bytes in [
        &b""[..],
        b"not a picture",
        &whole[..whole.len() / 2],
        &whole[..40],
    ] {
        fs::write(&path, bytes).unwrap();
        let error = read_exr(&path, "").unwrap_err().to_string();
        assert!(error.contains("broken.exr"), "{error}");
    }
}

#[test]
fn a_png_holds_the_srgb_codes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture.png");
    let image = Image::from_fn(3, 2, |x, y| {
        Rgb::new(f64::from(x) * 0.2, f64::from(y) * 0.4, 5.0)
    });
    write_png(&path, &image, Some(-1.0)).unwrap();
    let read = image::open(&path).unwrap().into_rgb8();
    assert_eq!(read.dimensions(), (3, 2));
    for (x, y, pixel) in read.enumerate_pixels() {
        let expected = image.pixel(x, y).0.map(|c| srgb_byte(c * 0.5));
        assert_eq!(pixel.0, expected, "{x} {y}");
    }
    assert_eq!(read.get_pixel(2, 1).0, [124, 124, 255]);
    assert!(encode_png(&Image::new(0, 3, vec![]), None).is_err());
}

/// The names in a directory, sorted.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let name = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

#[test]
fn a_failed_write_leaves_everything_as_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture.png");
    for existing in [None, Some("old")] {
        if let Some(text) = existing {
            fs::write(&path, text).unwrap();
        }
        let before = names(directory.path());
        let error = atomic::write_whole(&path, |file| {
            file.write_all(&vec![7; 100_000])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert!(
            matches!(
                error,
                OutputError::Io {
                    action: "writing",
                    ..
                }
            ),
            "{error}"
        );
        assert!(error.to_string().contains("picture.png"), "{error}");
        assert_eq!(names(directory.path()), before);
        assert_eq!(fs::read_to_string(&path).ok().as_deref(), existing);
    }
    atomic::write_whole(&path, |file| file.write_all(b"new")).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(names(directory.path()), ["picture.png"]);
}

#[test]
fn bad_targets_are_named_before_and_while_writing() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("folder")).unwrap();
    fs::write(at("file"), "x").unwrap();
    fs::write(at("kept"), "kept").unwrap();
    let mut locked = fs::metadata(at("kept")).unwrap().permissions();
    locked.set_readonly(true);
    fs::set_permissions(at("kept"), locked).unwrap();
    let before = names(directory.path());
    let both = |name: &str| {
        let written = atomic::write_whole(&at(name), |file| file.write_all(b"new")).unwrap_err();
        let probed = atomic::probe(&at(name)).unwrap_err();
        assert_eq!(written.to_string(), probed.to_string());
        written
    };
    let error = both("nowhere/picture.exr");
    assert!(
        matches!(error, OutputError::MissingDirectory { .. }),
        "{error}"
    );
    assert!(
        error.to_string().ends_with("nowhere does not exist"),
        "{error}"
    );
    assert!(matches!(both("folder"), OutputError::IsDirectory { .. }));
    assert!(matches!(
        both("file/picture.exr"),
        OutputError::NotADirectory { .. }
    ));
    assert!(matches!(both("kept"), OutputError::ReadOnly { .. }));
    assert_eq!(fs::read_to_string(at("kept")).unwrap(), "kept");
    assert_eq!(names(directory.path()), before);
    atomic::probe(&at("fine.exr")).unwrap();
    assert_eq!(names(directory.path()), before, "a probe leaves nothing");
}

#[cfg(unix)]
#[test]
fn results_are_ordinary_files_and_links_are_followed() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::write(at("plain"), "x").unwrap();
    atomic::write_whole(&at("real"), |file| file.write_all(b"1")).unwrap();
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode();
    assert_eq!(mode("real"), mode("plain"), "as the umask has it");
    symlink(at("real"), at("link")).unwrap();
    atomic::write_whole(&at("link"), |file| file.write_all(b"2")).unwrap();
    assert!(at("link").is_symlink());
    assert_eq!(fs::read_to_string(at("real")).unwrap(), "2");
}

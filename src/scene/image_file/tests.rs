use super::*;
use ::exr::prelude as ox;
use ::exr::prelude::WritableImage as _;
use ::image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use proptest::{collection::vec, prelude::*};

fn png(width: u32, height: u32, bytes: &[u8], colour: ExtendedColorType) -> Vec<u8> {
    let mut out = Vec::new();
    PngEncoder::new(&mut out)
        .write_image(bytes, width, height, colour)
        .unwrap();
    out
}

fn grey_16(width: u32, height: u32, values: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_ne_bytes()).collect();
    png(width, height, &bytes, ExtendedColorType::L16)
}

fn exr(size: [usize; 2], channels: &[(&str, ox::FlatSamples)]) -> Vec<u8> {
    let list = channels
        .iter()
        .map(|(name, samples)| ox::AnyChannel::new(*name, samples.clone()));
    let image = ox::Image::from_channels((size[0], size[1]), ox::AnyChannels::sort(list.collect()));
    let mut out = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut out).unwrap();
    out.into_inner()
}

fn floats(values: &[f32]) -> ox::FlatSamples {
    ox::FlatSamples::F32(values.to_vec())
}

fn fault(name: &str, bytes: &[u8], channel: Option<&str>) -> Fault {
    parse(Path::new(name), bytes, channel).unwrap_err()
}

#[test]
fn sixteen_bits_are_fractions_of_the_range() {
    let bytes = grey_16(3, 2, &[0, 1, 65535, 32768, 2, 3]);
    let read = parse(Path::new("a.PNG"), &bytes, None).unwrap();
    assert_eq!((read.kind, read.size), (Kind::Fractions, [3, 2]));
    assert_eq!(
        read.values[..4],
        [0.0, 1.0 / 65535.0, 1.0, 32768.0 / 65535.0]
    );
}

#[test]
fn png_that_cannot_tell_heights_are_refused() {
    let cases: [(&[u8], ExtendedColorType, &str); 4] = [
        (&[7; 4], ExtendedColorType::L8, "8 bits"),
        (&[7; 8], ExtendedColorType::La8, "alpha"),
        (&[7; 12], ExtendedColorType::Rgb8, "colours"),
        (&[7; 24], ExtendedColorType::Rgb16, "colours"),
    ];
    for (bytes, colour, word) in cases {
        let found = fault("a.png", &png(2, 2, bytes, colour), None);
        assert!(found.message.contains(word), "{found:?}");
        assert!(found.help.contains("16"), "{found:?}");
    }
    let thin = fault("a.png", &grey_16(1, 4, &[0; 4]), None);
    assert!(thin.message.contains("1 x 4"), "{thin:?}");
    let whole = grey_16(4, 4, &[9; 16]);
    let cut = fault("a.png", &whole[..whole.len() - 20], None);
    assert!(cut.message.contains("broken PNG"), "{cut:?}");
    assert!(fault("a.png", &whole, Some("Y")).help.contains("channel"));
    assert!(fault("a.tif", &whole, None).message.contains(".exr"));
}

/// A header alone must not cost memory: it claims 2^31 x 2^31 pixels.
#[test]
fn a_png_that_claims_to_be_huge_is_refused() {
    let mut bytes = grey_16(4, 4, &[9; 16]);
    bytes[16..20].copy_from_slice(&0x7fff_ffffu32.to_be_bytes());
    bytes[20..24].copy_from_slice(&0x7fff_ffffu32.to_be_bytes());
    let crc = crc_32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    let found = fault("a.png", &bytes, None);
    assert!(!found.message.is_empty());
}

/// The check sum of PNG (ISO 3309), bit by bit.
fn crc_32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(c & 1))
        })
    })
}

#[test]
fn exr_channels_are_chosen_by_name() {
    let one = exr([2, 2], &[("height", floats(&[1.0, 2.0, 3.0, -4.5]))]);
    let read = parse(Path::new("a.exr"), &one, None).unwrap();
    assert_eq!((read.kind, read.size), (Kind::Numbers, [2, 2]));
    assert_eq!(read.values, [1.0, 2.0, 3.0, -4.5]);
    let two = [
        ("A", floats(&[0.0; 4])),
        ("Y", floats(&[0.1, 0.2, 0.3, 0.4])),
    ];
    let two = exr([2, 2], &two);
    assert_eq!(
        parse(Path::new("a.exr"), &two, None).unwrap().values[1],
        f64::from(0.2f32)
    );
    assert_eq!(
        parse(Path::new("a.exr"), &two, Some("A")).unwrap().values[1],
        0.0
    );
    let missing = fault("a.exr", &two, Some("Z"));
    assert!(missing.message.contains("\"Z\"") && missing.help.contains("A, Y"));
    let colours = ["R", "G", "B"].map(|c| (c, floats(&[0.0; 4])));
    let several = fault("a.exr", &exr([2, 2], &colours), None);
    assert!(several.help.contains("channel: \"B\""), "{several:?}");
}

#[test]
fn exr_that_cannot_tell_heights_are_refused() {
    for (bad, word) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        let mut list = [0.5; 6];
        list[4] = bad;
        let found = fault("a.exr", &exr([3, 2], &[("Y", floats(&list))]), None);
        assert!(found.message.contains("column 1 of row 1"), "{found:?}");
        assert!(found.message.contains(word), "{found:?}");
    }
    let half = ox::FlatSamples::F16(vec![ox::f16::ONE; 4]);
    let found = fault("a.exr", &exr([2, 2], &[("Y", half)]), None);
    assert!(found.message.contains("half precision"), "{found:?}");
    let whole = exr([8, 8], &[("Y", floats(&[0.25; 64]))]);
    let cut = fault("a.exr", &whole[..whole.len() / 2], None);
    assert!(cut.message.contains("broken EXR"), "{cut:?}");
    assert!(fault("a.exr", b"", None).message.contains("broken EXR"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Damaged files are answered, not believed.
    #[test]
    fn damage_is_survived(
        changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        kind in 0..2,
    ) {
        let (name, mut bytes) = match kind {
            0 => ("a.png", grey_16(8, 8, &[500; 64])),
            _ => ("a.exr", exr([8, 8], &[("Y", floats(&[0.25; 64]))])),
        };
        for (index, byte) in changes {
            let at = index.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(read) = parse(Path::new(name), &bytes, None) {
            prop_assert_eq!(read.values.len(), read.size[0] * read.size[1]);
            prop_assert!(read.values.iter().all(|v| v.is_finite()));
        }
    }
}

//! Checkpoints that are whole come back as they were; all others are refused.

use std::{fs, io::Cursor, ops::ControlFlow};

use proptest::prelude::*;

use super::*;
use crate::{
    render::{Job, Renderer, Report, go_on},
    scene::load_str,
};

const SCENE: &str = "(
    camera: (eye: (0, -5, 3.5), look_at: (0, 0, 0.3), fov: 45),
    image: (width: 6, height: 4),
    objects: [
        (shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: Diffuse(reflectance: 0.5)),
        (shape: Sphere(center: (0, 0, 1), radius: 1), material: Dielectric(ior: 1.5)),
    ],
    lights: [Sphere(center: (2, -1, 4), radius: 0.15, radiance: 200), Point(position: (1, 1, 5), power: 9)],
    render: (photons: 500),
)";

/// Passes `first..end` of the scene.
fn part(first: u32, end: u32) -> Part {
    let scene = load_str(SCENE, "scene.ron", Path::new("")).expect("a scene");
    let mut job = Job::of(&scene);
    job.first_pass = first;
    job.settings.passes = end;
    let renderer = Renderer::new(&scene, &job.settings, job.resolution, job.window());
    let mut part = Part::new(Subject::of(&scene, &job, &renderer));
    go_on(&renderer, &job, &mut part, &mut |_, _| {
        ControlFlow::Continue(())
    });
    part.set_seconds(f64::from(end - first));
    part
}

fn bytes(part: &Part) -> Vec<u8> {
    let mut bytes = Vec::new();
    part.write_to(&part.subject.bytes(), &mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> Result<Part, CheckpointFault> {
    Part::read_from(&mut Cursor::new(bytes))
}

/// The bytes with the checksum that belongs to them.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - CHECKSUM as usize;
    let checksum = blake3::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(checksum.as_bytes());
    bytes
}

#[test]
fn parts_come_back_as_they_were() {
    let whole = part(3, 14);
    let back = read(&bytes(&whole)).unwrap();
    assert_eq!(bytes(&back), bytes(&whole));
    assert_eq!(back.film, whole.film);
    assert_eq!(back.totals, whole.totals);
    let json = |part| serde_json::to_string(&Report::of(part)).unwrap();
    assert_eq!(json(&back), json(&whole));
    assert_eq!(back.runs()[0], 3..14);
}

/// Two parts, cut anywhere, against one run: equal to the byte, ledgers and
/// all; from one range, from files, in either order.
#[test]
fn merged_parts_are_the_whole() {
    let whole = part(0, 13);
    for cut in [1, 5, 8] {
        let [first, second] = [part(0, cut), part(cut, 13)].map(|p| read(&bytes(&p)).unwrap());
        for [mut a, b] in [[first.clone(), second.clone()], [second, first]] {
            a.merge(&b).unwrap();
            assert_eq!(bytes(&a), bytes(&whole), "cut at {cut}");
        }
    }
}

#[test]
fn foreign_and_overlapping_parts_are_refused() {
    let mut ours = part(0, 4);
    let before = bytes(&ours);
    let overlap = ours.merge(&part(3, 5)).unwrap_err();
    assert_eq!(overlap.to_string(), "pass 3 is in both");
    let mut other = part(4, 5);
    other.subject.seed = 9;
    let foreign = ours.merge(&other).unwrap_err().to_string();
    assert_eq!(foreign, "the seed is 0 there and 9 here");
    assert_eq!(bytes(&ours), before, "unchanged");
}

#[test]
fn cut_anywhere_it_is_refused() {
    let whole = bytes(&part(0, 2));
    for end in 0..whole.len() {
        let refused = read(&whole[..end]);
        assert!(matches!(refused, Err(CheckpointFault::Damaged(_))), "{end}");
    }
    let longer = [&whole[..], b"x"].concat();
    assert!(matches!(read(&longer), Err(CheckpointFault::Damaged(_))));
}

#[test]
fn every_flipped_bit_is_found() {
    let mut bytes = bytes(&part(0, 2));
    for at in 0..bytes.len() {
        let bit = 1 << (at % 8);
        bytes[at] ^= bit;
        let refused = read(&bytes);
        match at {
            0..8 => assert!(matches!(refused, Err(CheckpointFault::Other))),
            8..12 => assert!(matches!(refused, Err(CheckpointFault::Format(_)))),
            _ => assert!(matches!(refused, Err(CheckpointFault::Damaged(_))), "{at}"),
        }
        bytes[at] ^= bit;
    }
    assert!(read(&bytes).is_ok());
}

#[test]
fn another_version_is_named() {
    let mut bytes = bytes(&part(0, 1));
    assert_eq!(&bytes[13..13 + VERSION.len()], VERSION.as_bytes());
    bytes[13] = b'9';
    let refused = read(&sealed(bytes)).map(drop).unwrap_err();
    let name = format!("nephroid 9{} has written", &VERSION[1..]);
    assert!(refused.to_string().starts_with(&name), "{refused}");
}

/// A disk that is full after so many bytes.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = bytes.len().min(self.0);
        self.0 -= written;
        if written == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_told_of_wherever_it_ends() {
    let part = part(0, 2);
    let subject = part.subject.bytes();
    let length = bytes(&part).len();
    for room in (0..length).step_by(7).chain([length - 1]) {
        let told = part.write_to(&subject, &mut Full(room)).unwrap_err();
        assert_eq!(told.kind(), io::ErrorKind::StorageFull, "{room}");
    }
    assert!(part.write_to(&subject, &mut Full(length)).is_ok());
}

#[test]
fn files_of_others_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ckpt");
    let ours = part(0, 2);
    for foreign in ["", "precious", "\u{89}NPHCK"] {
        fs::write(&path, foreign).unwrap();
        let refused = ours.save(&path);
        assert!(matches!(refused, Err(SaveError::Foreign(_))), "{foreign}");
        assert_eq!(fs::read(&path).unwrap(), foreign.as_bytes());
        assert!(Part::load(&path).is_err());
    }
    let mut other = part(0, 1);
    other.subject.seed = 9;
    fs::remove_file(&path).unwrap();
    other.save(&path).unwrap();
    assert!(matches!(ours.save(&path), Err(SaveError::Foreign(_))));
    assert_eq!(fs::read(&path).unwrap(), bytes(&other));
    fs::write(&path, bytes(&part(0, 1))).unwrap();
    ours.save(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), bytes(&ours));
    // A directory is none of ours either.
    assert!(ours.save(folder.path()).is_err());
    assert!(matches!(
        Part::load(folder.path()),
        Err(CheckpointFault::Other)
    ));
}

proptest! {
    /// Bytes that someone has made fit their checksum are still not believed.
    #[test]
    fn forged_bytes_break_nothing(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        static WHOLE: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
        let mut forged = WHOLE.get_or_init(|| bytes(&part(0, 2))).clone();
        for (at, value) in changes {
            let at = 12 + at.index(forged.len() - 12);
            forged[at] = value;
        }
        if let Some(cut) = cut {
            let end = 44 + cut.index(forged.len() - 44);
            forged.truncate(end);
        }
        if let Ok(part) = read(&sealed(forged)) {
            // Whatever it says, it can be reported, merged and written.
            let _ = serde_json::to_string(&Report::of(&part));
            let _ = part.clone().merge(&part);
            let _ = part.film().image();
            bytes(&part);
        }
    }

    #[test]
    fn noise_is_no_checkpoint(noise in prop::collection::vec(any::<u8>(), 0..300), is_marked: bool) {
        let mut bytes = noise;
        if is_marked {
            bytes.splice(0..0, [&MARK[..], &FORMAT.to_le_bytes()].concat());
            bytes.extend([0; 32]);
            bytes = sealed(bytes);
        }
        prop_assert!(read(&bytes).is_err());
    }
}

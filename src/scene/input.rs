//! Which files a scene was made from.

use std::{
    cell::RefCell,
    fmt,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

/// What the scene's own file is called in [`Input::name`].
const SCENE_FILE: &str = "the scene file";

/// A fingerprint of bytes: BLAKE3, 256 bits. Nobody knows two inputs that have
/// the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Digest(pub [u8; 32]);

impl Digest {
    /// The fingerprint of `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        // Large files by all threads; small ones are not worth waking them.
        let mut hasher = blake3::Hasher::new();
        if bytes.len() < 1 << 20 {
            hasher.update(bytes);
        } else {
            hasher.update_rayon(bytes);
        }
        Self(hasher.finalize().into())
    }
}

/// In hexadecimal.
impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// A file that was read while a scene was loaded.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// The scene's own file, or the path of a mesh or image as seen from the
    /// scene's directory.
    pub name: String,
    /// Fingerprint of the bytes that were read.
    pub digest: Digest,
}

impl Input {
    /// The scene's own file.
    pub(super) fn scene(text: &str) -> Self {
        Self {
            name: SCENE_FILE.to_owned(),
            digest: Digest::of(text.as_bytes()),
        }
    }
}

/// One fingerprint for all files together.
pub fn fingerprint(inputs: &[Input]) -> Digest {
    let mut all = Vec::new();
    for input in inputs {
        all.extend_from_slice(&(input.name.len() as u64).to_le_bytes());
        all.extend_from_slice(input.name.as_bytes());
        all.extend_from_slice(&input.digest.0);
    }
    Digest::of(&all)
}

/// Collects the files that are read.
#[derive(Debug, Default)]
pub struct Inputs {
    base: PathBuf,
    list: RefCell<Vec<Input>>,
}

impl Inputs {
    /// None yet; names will be relative to `base`.
    pub fn new(base: &Path) -> Self {
        Self {
            base: base.to_owned(),
            list: RefCell::default(),
        }
    }

    /// Takes note of a file's bytes.
    pub fn add(&self, path: &Path, bytes: &[u8]) {
        let name = path.strip_prefix(&self.base).unwrap_or(path);
        self.list.borrow_mut().push(Input {
            name: name.display().to_string(),
            digest: Digest::of(bytes),
        });
    }

    /// The files in the order in which they were read.
    pub fn into_list(self) -> Vec<Input> {
        self.list.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vectors that come with BLAKE3: bytes 0, 1, 2, .., 250, 0, 1, ..
    #[test]
    fn digests_follow_the_published_vectors() {
        let input = |n: usize| (0..n).map(|i| (i % 251) as u8).collect::<Vec<_>>();
        for (length, starts) in [
            (0, "af1349b9f5f9a1a6a0404dea36dcc949"),
            (1, "2d3adedff11b61f14c886e35afa03673"),
            (1024, "42214739f095a406f3fc83deb889744a"),
        ] {
            let digest = Digest::of(&input(length)).to_string();
            assert!(digest.starts_with(starts) && digest.len() == 64, "{length}");
        }
        let large = input(3 << 20);
        let alone = blake3::Hasher::new().update(&large).finalize();
        assert_eq!(Digest::of(&large).0, *alone.as_bytes(), "by all threads");
    }

    #[test]
    fn names_are_seen_from_the_scene() {
        let inputs = Inputs::new(Path::new("/a/b"));
        inputs.add(Path::new("/a/b/c/lens.ply"), b"1");
        inputs.add(Path::new("/elsewhere/x.obj"), b"2");
        let names: Vec<String> = inputs.into_list().into_iter().map(|i| i.name).collect();
        assert_eq!(names, ["c/lens.ply", "/elsewhere/x.obj"]);
    }

    #[test]
    fn names_and_bytes_both_count() {
        let input = |name: &str, bytes: &[u8]| Input {
            name: name.to_owned(),
            digest: Digest::of(bytes),
        };
        let lists = [
            vec![],
            vec![input("a", b"1")],
            vec![input("a", b"2")],
            vec![input("b", b"1")],
            vec![input("a", b"1"), input("b", b"1")],
            vec![input("b", b"1"), input("a", b"1")],
        ];
        for (i, a) in lists.iter().enumerate() {
            for (j, b) in lists.iter().enumerate() {
                assert_eq!(fingerprint(a) == fingerprint(b), i == j);
            }
        }
    }
}

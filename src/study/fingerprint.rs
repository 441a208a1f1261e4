//! A print of a scene: its text and all files that it names.

use std::{collections::BTreeSet, fs, io, path::Path};

/// A print of bytes: 128-bit FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo) in
/// hexadecimal. Tells apart what changed by accident; no proof against intent.
pub(super) fn print_of(bytes: &[u8]) -> String {
    format!("{:032x}", fnv_1a(START, bytes))
}

/// A print of a scene file and of all files that it names, at any depth: every
/// quoted text that is the path of a file beside the one that it stands in
/// counts as a name, so that no reader of scenes has to be asked.
///
/// # Errors
/// If the scene file cannot be read. A named file that cannot be read leaves
/// no trace: loading the scene says more about it.
pub fn fingerprint(scene: &Path) -> io::Result<String> {
    let bytes = fs::read(scene)?;
    let mut hash = fnv_1a(START, &bytes);
    let mut seen = BTreeSet::new();
    let mut open = named_files(scene, &bytes);
    // Sets are in order, so the print does not depend on anything else.
    while let Some(path) = open.pop_first() {
        if !seen.insert(path.clone()) {
            continue;
        }
        if let Ok(bytes) = fs::read(&path) {
            hash = fnv_1a(hash, &(bytes.len() as u64).to_le_bytes());
            hash = fnv_1a(hash, &bytes);
            let is_gltf = path.extension().is_some_and(|e| e == "gltf");
            if is_gltf {
                open.extend(named_files(&path, &bytes));
            }
        }
    }
    Ok(format!("{hash:032x}"))
}

/// Longest text that is taken for a path.
const LONGEST_PATH: usize = 4096;

/// The files that `bytes`, the content of `file`, name in double quotes.
fn named_files(file: &Path, bytes: &[u8]) -> BTreeSet<std::path::PathBuf> {
    let base = file.parent().unwrap_or(Path::new(""));
    bytes
        .split(|&b| b == b'"')
        .filter(|part| !part.is_empty() && part.len() <= LONGEST_PATH)
        .filter_map(|part| std::str::from_utf8(part).ok())
        .filter(|part| !part.contains(['\n', '\0']))
        .map(|part| base.join(part))
        .filter(|path| path.is_file())
        .collect()
}

const START: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;

fn fnv_1a(start: u128, bytes: &[u8]) -> u128 {
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    bytes.iter().fold(start, |hash, &byte| {
        (hash ^ u128::from(byte)).wrapping_mul(PRIME)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_follow_the_published_vectors() {
        assert_eq!(print_of(b"a"), "d228cb696f1a8caf78912b704e4a8964");
        assert_eq!(print_of(b"foobar"), "343e1662793c64bf6f0d3597ba446f18");
    }

    /// The print changes with the scene, with a mesh and with what a mesh
    /// names, and with nothing else.
    #[test]
    fn files_that_are_named_count() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        fs::create_dir(path("sub")).unwrap();
        let write = |name: &str, text: &str| fs::write(path(name), text).unwrap();
        write("scene.ron", r#"(objects: [(file: "sub/a.gltf")])"#);
        write("sub/a.gltf", r#"{"uri": "a.bin"}"#);
        write("sub/a.bin", "numbers");
        write("other.ply", "not named");
        let print = || fingerprint(&path("scene.ron")).unwrap();
        let first = print();
        write("other.ply", "still not named");
        assert_eq!(print(), first);
        write("sub/a.bin", "other numbers");
        let second = print();
        assert_ne!(second, first);
        write("sub/a.gltf", r#"{"uri":  "a.bin"}"#);
        let third = print();
        assert_ne!(third, second);
        write("scene.ron", r#"( objects: [(file: "sub/a.gltf")])"#);
        assert_ne!(print(), third);
        assert!(fingerprint(&path("none.ron")).is_err());
    }
}

//! What is kept on disk, so that a study goes on where it was.
//!
//! A record is a small JSON file and, where it has pictures, an EXR file that
//! the JSON file names, with the print of its bytes. Both appear whole or not
//! at all, the JSON last; what belongs to another question, or is damaged,
//! counts as not there.

use std::{
    fs::{self, File, TryLockError},
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::{
    film::{Image, OutputError, Window, atomic::write_whole, encode_exr, read_exr_layers},
    scene::Digest,
};

use super::{fault::Fault, record::FORMAT};

/// The directory of a study that keeps its runs.
const RUNS: &str = "runs";
/// The file in it that says that the directory is a study's.
const MARK: &str = "study";

/// The kept records of a study; locked, so that two studies do not work in
/// one directory.
#[derive(Debug)]
pub(super) struct Store {
    runs: PathBuf,
    /// The lock ends with it.
    _lock: File,
}

/// A record as it stands in its JSON file.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Kept<T> {
    format: u32,
    /// The question that it answers, in words.
    key: String,
    /// Name of the picture file, and the print of its bytes.
    pictures: Option<[String; 2]>,
    answer: T,
}

/// Layers of an EXR file by name.
pub(super) type Pictures = Vec<(String, Image)>;

impl Store {
    /// Opens the directory of a study, or makes it.
    ///
    /// # Errors
    /// [`Fault::Invalid`] if the directory holds something else than a study,
    /// or another study works in it; [`Fault::Output`] if it cannot be made.
    pub(super) fn open(directory: &Path) -> Result<Self, Fault> {
        let runs = directory.join(RUNS);
        let mark = runs.join(MARK);
        let failed = |action: &'static str| {
            let path = directory.to_owned();
            move |source: io::Error| {
                Fault::Output(OutputError::Io {
                    path,
                    action,
                    source,
                })
            }
        };
        if !mark.is_file() {
            match fs::read_dir(directory) {
                Ok(mut entries) => {
                    if entries.next().is_some() {
                        return Err(Fault::Invalid(format!(
                            "{} is not empty and holds no study; name another directory",
                            directory.display()
                        )));
                    }
                }
                Err(e) if e.kind() == ErrorKind::NotFound => {}
                Err(e) if e.kind() == ErrorKind::NotADirectory => {
                    return Err(Fault::Invalid(format!(
                        "{} is a file; a study needs a directory",
                        directory.display()
                    )));
                }
                Err(e) => return Err(failed("looking into it")(e)),
            }
            fs::create_dir_all(&runs).map_err(failed("making the directory"))?;
            write_whole(&mark, |file| {
                writeln!(file, "nephroid study, format {FORMAT}")
            })?;
        }
        let lock = File::open(&mark).map_err(failed("opening its mark"))?;
        // Not every file system has locks; the files are whole without.
        if let Err(TryLockError::WouldBlock) = lock.try_lock() {
            return Err(Fault::Invalid(format!(
                "another study is at work in {}; wait for it or name another directory",
                directory.display()
            )));
        }
        let store = Self { runs, _lock: lock };
        store.sweep();
        Ok(store)
    }

    /// Removes what a crash left of files that were being written.
    fn sweep(&self) {
        let entries = fs::read_dir(&self.runs).into_iter().flatten().flatten();
        for entry in entries {
            let name = entry.file_name();
            let name = name.as_encoded_bytes();
            if name.starts_with(b".") && name.ends_with(b".part") {
                // One that stays does no harm.
                let _ = fs::remove_file(entry.path());
            }
        }
    }

    /// The answer to the question `key` that was kept under `name`; `None` if
    /// there is none.
    pub(super) fn read<T: DeserializeOwned>(&self, name: &str, key: &str) -> Option<(T, Pictures)> {
        let bytes = fs::read(self.json(name)).ok()?;
        let kept: Kept<T> = serde_json::from_slice(&bytes).ok()?;
        if kept.format != FORMAT || kept.key != key {
            return None;
        }
        let Some([file, print]) = kept.pictures else {
            return Some((kept.answer, Vec::new()));
        };
        // The name is one of ours, but the file is anyone's.
        if file.contains(['/', '\\']) {
            return None;
        }
        let path = self.runs.join(file);
        let bytes = fs::read(&path).ok()?;
        if Digest::of(&bytes).to_string() != print {
            return None;
        }
        Some((kept.answer, read_exr_layers(&path).ok()?))
    }

    /// Keeps an answer in place of the one that was there.
    ///
    /// # Errors
    /// See [`OutputError`].
    pub(super) fn write<T: Serialize>(
        &self,
        name: &str,
        key: &str,
        answer: &T,
        pictures: &[(&str, &Image)],
    ) -> Result<(), OutputError> {
        let before = self.picture_file(name);
        let mut named = None;
        if let Some((_, first)) = pictures.first() {
            let window = Window::whole(first.width(), first.height());
            let bytes =
                encode_exr(pictures, window, &[]).map_err(|reason| OutputError::Encode {
                    path: self.runs.join(name),
                    reason,
                })?;
            let print = Digest::of(&bytes).to_string();
            // Under a name of its own: the old one stays until it is not needed.
            let file = format!("{name}-{}.exr", &print[..8]);
            write_whole(&self.runs.join(&file), |out| out.write_all(&bytes))?;
            named = Some([file, print]);
        }
        let file = named.as_ref().map(|[file, _]| file.clone());
        let kept = Kept {
            format: FORMAT,
            key: key.to_owned(),
            pictures: named,
            answer,
        };
        let path = self.json(name);
        let text = serde_json::to_string_pretty(&kept).map_err(|e| OutputError::Encode {
            path: path.clone(),
            reason: e.to_string(),
        })?;
        write_whole(&path, |out| writeln!(out, "{text}"))?;
        if let Some(before) = before
            && Some(&before) != file.as_ref()
        {
            // It is in nobody's way if it stays.
            let _ = fs::remove_file(self.runs.join(before));
        }
        Ok(())
    }

    /// The picture file that the record of this name has now.
    fn picture_file(&self, name: &str) -> Option<String> {
        let bytes = fs::read(self.json(name)).ok()?;
        let kept: Kept<serde_json::Value> = serde_json::from_slice(&bytes).ok()?;
        kept.pictures
            .map(|[file, _]| file)
            .filter(|file| file.starts_with(name) && !file.contains(['/', '\\']))
    }

    fn json(&self, name: &str) -> PathBuf {
        self.runs.join(format!("{name}.json"))
    }
}

/// A name for files: what is no letter, digit, point or underscore becomes a
/// hyphen.
pub(super) fn slug(text: &str) -> String {
    let mut slug = String::new();
    for c in text.chars() {
        if c.is_ascii_alphanumeric() || c == '.' || c == '_' {
            slug.push(c);
        } else if !slug.ends_with('-') {
            slug.push('-');
        }
    }
    slug
}

/// The name of a record: words for people, and the print of its question.
pub(super) fn record_name(words: &str, key: &str) -> String {
    format!(
        "{}-{}",
        slug(words),
        &Digest::of(key.as_bytes()).to_string()[..12]
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Rgb;

    fn image(value: f64) -> Image {
        Image::from_fn(3, 2, |x, _| Rgb::grey(value + f64::from(x)))
    }

    #[test]
    fn what_was_kept_comes_back() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(&directory.path().join("a/b")).unwrap();
        assert!(store.read::<u32>("one", "key").is_none());
        let (a, b) = (image(0.5), image(2.0));
        store
            .write("one", "key", &7u32, &[("p1", &a), ("p2", &b)])
            .unwrap();
        let (answer, pictures) = store.read::<u32>("one", "key").unwrap();
        assert_eq!(answer, 7);
        assert_eq!(
            pictures,
            [("p1".to_owned(), a), ("p2".to_owned(), b.clone())]
        );
        assert!(
            store.read::<u32>("one", "other").is_none(),
            "another question"
        );
        assert!(
            store.read::<String>("one", "key").is_none(),
            "another answer"
        );
        // Replaced: no file is left behind.
        store.write("one", "key", &8u32, &[("p1", &b)]).unwrap();
        assert_eq!(store.read::<u32>("one", "key").unwrap().0, 8);
        assert_eq!(fs::read_dir(&store.runs).unwrap().count(), 3);
        store.write("two", "key", &9u32, &[]).unwrap();
        assert_eq!(store.read::<u32>("two", "key").unwrap(), (9, Vec::new()));
    }

    #[test]
    fn what_is_damaged_is_not_there() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(directory.path()).unwrap();
        store
            .write("one", "key", &7u32, &[("p1", &image(1.0))])
            .unwrap();
        let exr = store.picture_file("one").unwrap();
        let exr = store.runs.join(exr);
        let whole = fs::read(&exr).unwrap();
        let mut bytes = whole.clone();
        *bytes.last_mut().unwrap() ^= 1;
        fs::write(&exr, &bytes).unwrap();
        assert!(store.read::<u32>("one", "key").is_none(), "one bit");
        fs::write(&exr, &whole[..whole.len() - 1]).unwrap();
        assert!(store.read::<u32>("one", "key").is_none(), "cut off");
        let window = Window::whole(3, 2);
        let other = encode_exr(&[("p1", &image(2.0))], window, &[]).unwrap();
        fs::write(&exr, other).unwrap();
        let read = store.read::<u32>("one", "key");
        assert!(read.is_none(), "a whole picture, but another");
        fs::write(&exr, &whole).unwrap();
        assert!(store.read::<u32>("one", "key").is_some());
        let json = store.json("one");
        let text = fs::read_to_string(&json).unwrap();
        fs::write(&json, &text[..text.len() / 2]).unwrap();
        assert!(store.read::<u32>("one", "key").is_none(), "half a record");
        fs::remove_file(&exr).unwrap();
        fs::write(&json, &text).unwrap();
        assert!(store.read::<u32>("one", "key").is_none(), "no picture");
    }

    #[test]
    fn only_a_studys_directory_is_written_to() {
        let directory = tempfile::tempdir().unwrap();
        let foreign = directory.path().join("letters");
        fs::create_dir(&foreign).unwrap();
        fs::write(foreign.join("study.json"), "mine").unwrap();
        let refused = Store::open(&foreign).unwrap_err().to_string();
        assert!(refused.contains("is not empty"), "{refused}");
        let refused = Store::open(&foreign.join("study.json"))
            .unwrap_err()
            .to_string();
        assert!(refused.contains("is a file"), "{refused}");
        let own = directory.path().join("own");
        let first = Store::open(&own).unwrap();
        let refused = Store::open(&own).unwrap_err().to_string();
        assert!(refused.contains("another study"), "{refused}");
        drop(first);
        fs::write(own.join("notes.txt"), "kept").unwrap();
        let torn = own.join("runs/.one.json123.part");
        fs::write(&torn, "hal").unwrap();
        assert!(Store::open(&own).is_ok(), "a study, whatever else is there");
        assert!(!torn.exists() && own.join("notes.txt").exists());
    }

    #[test]
    fn names_are_fit_for_files() {
        assert_eq!(slug("photons, radius 0.5"), "photons-radius-0.5");
        assert_eq!(slug("Blau & grün/../x"), "Blau-gr-n-..-x");
    }
}

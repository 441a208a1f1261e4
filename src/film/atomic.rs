//! Files that are written whole or not at all.
//!
//! The bytes go to a temporary file in the directory of the target, reach the
//! disk, and only then take the target's name in one step. Whatever goes wrong
//! before that step leaves an existing file as it was and nothing new behind.

use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Random characters in the name of a temporary file.
const RANDOM: usize = 6;

/// Why a file could not be written. The message names the path and the cause.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The directory that should hold the file does not exist.
    #[error("cannot write {}: the directory {} does not exist", .path.display(), .directory.display())]
    MissingDirectory {
        /// The file that was to be written.
        path: PathBuf,
        /// The directory that is missing.
        directory: PathBuf,
    },
    /// What should be the directory of the file is something else.
    #[error("cannot write {}: {} is not a directory", .path.display(), .directory.display())]
    NotADirectory {
        /// The file that was to be written.
        path: PathBuf,
        /// What stands where its directory should be.
        directory: PathBuf,
    },
    /// The path is a directory (or names no file).
    #[error("cannot write {}: it is a directory", .path.display())]
    IsDirectory {
        /// The path that was to be written.
        path: PathBuf,
    },
    /// A file of that name exists and is marked read-only.
    #[error("cannot write {}: the file exists and is read-only", .path.display())]
    ReadOnly {
        /// The file that was to be replaced.
        path: PathBuf,
    },
    /// The operating system refused (no permission, disk full, ...).
    #[error("cannot write {}: {action} failed: {source}", .path.display())]
    Io {
        /// The file that was to be written.
        path: PathBuf,
        /// The step that failed.
        action: &'static str,
        /// What the operating system said.
        source: io::Error,
    },
    /// The picture cannot be expressed in the format.
    #[error("cannot write {}: {reason}", .path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// What the encoder objects to.
        reason: String,
    },
}

/// Writes the file `path` with what `fill` puts into the writer. If `fill` or
/// anything else fails, nothing is left and an existing file is untouched. A
/// symbolic link is followed: the file it points to is replaced.
///
/// # Errors
/// See [`OutputError`].
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    let io_error = |action: &'static str| {
        move |source: io::Error| OutputError::Io {
            path: path.to_owned(),
            action,
            source,
        }
    };
    let (target, directory) = locate(path)?;
    let mut temporary = create_beside(path, &target, &directory)?;
    let mut writer = BufWriter::new(temporary.as_file_mut());
    fill(&mut writer)
        .and_then(|()| writer.flush())
        .map_err(io_error("writing"))?;
    drop(writer);
    temporary
        .as_file()
        .sync_all()
        .map_err(io_error("flushing to disk"))?;
    temporary
        .persist(&target)
        .map_err(|e| io_error("renaming")(e.error))?;
    // The rename itself reaches the disk with the directory. Not every file
    // system lets a directory be opened or flushed, and the file is already
    // whole, so a refusal here is no failure.
    if let Ok(handle) = File::open(&directory) {
        let _ = handle.sync_all();
    }
    Ok(())
}

/// Whether `path` could be written now; so that a long render does not end in
/// an error that was there at its start. Leaves nothing behind, and takes away
/// what programs have left that were killed while they wrote this file.
///
/// # Errors
/// See [`OutputError`].
pub fn probe(path: &Path) -> Result<(), OutputError> {
    let (target, directory) = locate(path)?;
    sweep(&target, &directory);
    create_beside(path, &target, &directory).map(drop)
}

/// What temporary files for `target` start with, and what all end in.
fn affixes(target: &Path) -> (OsString, &'static str) {
    let mut prefix = OsString::from(".");
    prefix.push(target.file_name().unwrap_or_default());
    (prefix, ".part")
}

/// Removes temporary files for `target` that no program is writing: who writes
/// one holds a lock on it, and a lock ends with its program. What cannot be
/// removed is of no harm.
fn sweep(target: &Path, directory: &Path) {
    let (prefix, suffix) = affixes(target);
    let Ok(entries) = fs::read_dir(directory) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let random = name
            .as_encoded_bytes()
            .strip_prefix(prefix.as_encoded_bytes())
            .and_then(|rest| rest.strip_suffix(suffix.as_bytes()));
        let is_ours =
            random.is_some_and(|r| r.len() == RANDOM && r.iter().all(u8::is_ascii_alphanumeric));
        if is_ours
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The file to replace, links followed, and its directory; all that can be
/// objected to without touching the disk.
fn locate(path: &Path) -> Result<(PathBuf, PathBuf), OutputError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let path = path.to_owned();
    if target.file_name().is_none() || target.is_dir() {
        return Err(OutputError::IsDirectory { path });
    }
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    match fs::metadata(&directory) {
        Ok(found) if found.is_dir() => {}
        Ok(_) => return Err(OutputError::NotADirectory { path, directory }),
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return Err(OutputError::MissingDirectory { path, directory });
        }
        Err(e) if e.kind() == io::ErrorKind::NotADirectory => {
            return Err(OutputError::NotADirectory { path, directory });
        }
        Err(source) => {
            let action = "looking at its directory";
            return Err(OutputError::Io {
                path,
                action,
                source,
            });
        }
    }
    if fs::metadata(&target).is_ok_and(|found| found.permissions().readonly()) {
        return Err(OutputError::ReadOnly { path });
    }
    Ok((target, directory))
}

fn create_beside(
    path: &Path,
    target: &Path,
    directory: &Path,
) -> Result<NamedTempFile, OutputError> {
    let (prefix, suffix) = affixes(target);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(suffix).rand_bytes(RANDOM);
    // A result is an ordinary file: readable as far as the umask says, not
    // private as temporary files are by default.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder
        .tempfile_in(directory)
        .map_err(|source| OutputError::Io {
            path: path.to_owned(),
            action: "creating a file beside it",
            source,
        })?;
    // Where files cannot be locked, what a killed program leaves stays.
    let _ = temporary.as_file().try_lock();
    Ok(temporary)
}

//! A part of a picture as a file: checkpoints, and what is merged.
//!
//! | what | bytes |
//! |---|---|
//! | mark of the format | 8 |
//! | number of the format | 4 |
//! | version of the software: its length, its text | 1 + n |
//! | key: fingerprint of the subject's bytes | 32 |
//! | subject: its length, its bytes | 8 + n |
//! | time and totals: their length, their bytes | 8 + n |
//! | film ([`Film::write_state`]) | up to the checksum |
//! | checksum: BLAKE3 of all bytes before | 32 |
//!
//! Numbers are little-endian. Subject, time and totals are in the format of the
//! crate `postcard`. Nothing of a file is believed before its checksum agrees,
//! and no length before it is compared with the bytes that are there.

use std::{
    fs::File,
    io::{self, Read, Seek, Write},
    path::{Path, PathBuf},
};

use serde::de::DeserializeOwned;
use thiserror::Error;

use super::{Part, Subject, part::Totals};
use crate::{
    film::{Film, OutputError, StateError, atomic},
    numeric::DyadicSum,
    scene::Digest,
};

/// The first byte is none of a text's, the last two tell of a transfer that
/// took the file for one.
const MARK: [u8; 8] = *b"\x89NPHCK\r\n";
/// To be raised whenever the layout of any section changes.
const FORMAT: u32 = 4;
const VERSION: &str = env!("CARGO_PKG_VERSION");
const CHECKSUM: u64 = 32;
/// Bytes that are read and hashed at a time.
const BLOCK: usize = 1 << 20;

/// Why a file is of no use as a checkpoint.
#[derive(Debug, Error)]
pub enum CheckpointFault {
    /// It cannot be read.
    #[error("cannot read the checkpoint: {0}")]
    Unreadable(#[from] io::Error),
    /// It is something else.
    #[error("this is no checkpoint of nephroid")]
    Other,
    /// Its format is not known.
    #[error(
        "the checkpoint has format {0}, this program knows format {FORMAT} only; use the version that wrote it"
    )]
    Format(u32),
    /// Another version of the software has written it, whose passes may be
    /// others.
    #[error(
        "nephroid {0} has written the checkpoint, this is {VERSION}; go on with that version, or render anew"
    )]
    Version(String),
    /// Bytes are missing or wrong.
    #[error("the checkpoint is damaged: {0}; take an undamaged copy, or remove it and render anew")]
    Damaged(String),
}

/// Why a checkpoint was not written.
#[derive(Debug, Error)]
pub enum SaveError {
    /// Something else stands in its place.
    #[error("cannot write {}: the file there does not belong to this render", .0.display())]
    Foreign(PathBuf),
    /// What stands in its place cannot be looked at.
    #[error("cannot write {}: looking at the file there failed: {source}", .path.display())]
    Unreadable {
        /// The file that was to be replaced.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// Writing failed.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl Part {
    /// Writes the part to a file, whole or not at all. A file that is there is
    /// replaced if it holds passes of the same subject, and else left alone.
    ///
    /// # Errors
    /// See [`SaveError`]; the file that was there is then as it was.
    pub fn save(&self, path: &Path) -> Result<(), SaveError> {
        let subject = self.subject.bytes();
        match may_replace(path, Digest::of(&subject)) {
            Ok(true) => {}
            Ok(false) => return Err(SaveError::Foreign(path.to_owned())),
            Err(source) => {
                return Err(SaveError::Unreadable {
                    path: path.to_owned(),
                    source,
                });
            }
        }
        atomic::write_whole(path, |out| self.write_to(&subject, out))?;
        Ok(())
    }

    /// Reads a part from a file.
    ///
    /// # Errors
    /// If the file is not a whole, undamaged checkpoint of this version.
    pub fn load(path: &Path) -> Result<Self, CheckpointFault> {
        let is_file = std::fs::metadata(path)?.is_file();
        if !is_file {
            return Err(CheckpointFault::Other);
        }
        Self::read_from(&mut File::open(path)?)
    }

    fn write_to(&self, subject: &[u8], out: &mut dyn Write) -> io::Result<()> {
        let mut out = Hashing {
            inner: out,
            hasher: blake3::Hasher::new(),
        };
        out.write_all(&MARK)?;
        out.write_all(&FORMAT.to_le_bytes())?;
        out.write_all(&[VERSION.len() as u8])?;
        out.write_all(VERSION.as_bytes())?;
        out.write_all(&Digest::of(subject).0)?;
        let sums =
            postcard::to_allocvec(&(self.seconds, &self.totals)).map_err(io::Error::other)?;
        for section in [subject, &sums] {
            out.write_all(&(section.len() as u64).to_le_bytes())?;
            out.write_all(section)?;
        }
        self.film.write_state(&mut out)?;
        let checksum = out.hasher.finalize();
        out.inner.write_all(checksum.as_bytes())
    }

    /// Reads a part from the bytes of a file.
    ///
    /// # Errors
    /// If the bytes are not a whole, undamaged checkpoint of this version.
    pub fn read_from(input: &mut (impl Read + Seek)) -> Result<Self, CheckpointFault> {
        let length = input.seek(io::SeekFrom::End(0))?;
        input.rewind()?;
        read_mark(input, length)?;
        let end = length
            .checked_sub(CHECKSUM)
            .ok_or_else(|| damaged("it is cut off"))?;
        check(input, end)?;
        // The mark and the number of the format are known by now.
        input.seek(io::SeekFrom::Start((MARK.len() + 4) as u64))?;
        let left = end - (MARK.len() + 4) as u64;
        let mut input = io::BufReader::with_capacity(BLOCK, input.take(left));
        let version = read_section(&mut input, 1)?;
        if version != VERSION.as_bytes() {
            let version = String::from_utf8_lossy(&version).into_owned();
            return Err(CheckpointFault::Version(version));
        }
        let key = read_exactly(&mut input, 32)?;
        let subject = read_section(&mut input, 8)?;
        if Digest::of(&subject).0[..] != key {
            return Err(damaged("its key is that of another"));
        }
        let subject: Subject = decode(&subject)?;
        let (seconds, totals): (f64, DyadicSum<Totals>) = decode(&read_section(&mut input, 8)?)?;
        let left = input.get_ref().limit() + input.buffer().len() as u64;
        let film = Film::read_state(&mut input, left).map_err(|e| match e {
            StateError::Io(e) => from_io(e),
            StateError::Nonsense(why) => damaged(why),
        })?;
        let part = Self {
            subject,
            film,
            totals,
            seconds,
        };
        if !part.is_sound() {
            return Err(damaged("its sections do not belong together"));
        }
        Ok(part)
    }
}

/// Whether there is no file at `path`, or a checkpoint with this key.
fn may_replace(path: &Path, key: Digest) -> io::Result<bool> {
    match std::fs::metadata(path) {
        Ok(found) if found.is_file() => {}
        Ok(_) => return Ok(false),
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(true),
        Err(e) => return Err(e),
    }
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let found = read_mark(&mut file, length)
        .and_then(|()| read_section(&mut file, 1))
        .and_then(|_version| read_exactly(&mut file, 32));
    Ok(found.is_ok_and(|found| found == key.0))
}

/// Reads the mark and the number of the format.
fn read_mark(input: &mut impl Read, length: u64) -> Result<(), CheckpointFault> {
    let mut start = Vec::new();
    input.take(MARK.len() as u64 + 4).read_to_end(&mut start)?;
    let (mark, format) = start.split_at(start.len().min(MARK.len()));
    if !MARK.starts_with(mark) {
        return Err(CheckpointFault::Other);
    }
    let Ok(format) = format.try_into() else {
        return Err(damaged(&format!("it is cut off after {length} bytes")));
    };
    match u32::from_le_bytes(format) {
        FORMAT => Ok(()),
        other => Err(CheckpointFault::Format(other)),
    }
}

/// Compares the bytes up to `end` with the checksum that follows them.
fn check(input: &mut (impl Read + Seek), end: u64) -> Result<(), CheckpointFault> {
    input.rewind()?;
    let mut hasher = blake3::Hasher::new();
    let mut block = vec![0; BLOCK];
    let mut left = end;
    while left > 0 {
        let size = left.min(BLOCK as u64) as usize;
        input.read_exact(&mut block[..size]).map_err(from_io)?;
        hasher.update(&block[..size]);
        left -= size as u64;
    }
    let mut checksum = [0; CHECKSUM as usize];
    input.read_exact(&mut checksum).map_err(from_io)?;
    if hasher.finalize() != checksum {
        return Err(damaged("it is cut off, or bytes of it have changed"));
    }
    Ok(())
}

/// Reads a length of so many bytes, and as many bytes as it says.
fn read_section(input: &mut impl Read, width: usize) -> Result<Vec<u8>, CheckpointFault> {
    let mut length = [0; 8];
    input.read_exact(&mut length[..width]).map_err(from_io)?;
    read_exactly(input, u64::from_le_bytes(length))
}

/// Reads so many bytes; takes memory for those only that are there.
fn read_exactly(input: &mut impl Read, length: u64) -> Result<Vec<u8>, CheckpointFault> {
    let mut bytes = Vec::new();
    input.take(length).read_to_end(&mut bytes)?;
    if (bytes.len() as u64) < length {
        return Err(damaged("a section is longer than the file"));
    }
    Ok(bytes)
}

fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CheckpointFault> {
    match postcard::take_from_bytes(bytes) {
        Ok((value, [])) => Ok(value),
        _ => Err(damaged("a section cannot be understood")),
    }
}

fn damaged(why: &str) -> CheckpointFault {
    CheckpointFault::Damaged(why.to_owned())
}

/// Bytes that are missing are a damage, all else is the system's affair.
fn from_io(e: io::Error) -> CheckpointFault {
    match e.kind() {
        io::ErrorKind::UnexpectedEof => damaged("it is cut off"),
        _ => CheckpointFault::Unreadable(e),
    }
}

/// A writer that hashes what goes through it.
struct Hashing<'a> {
    inner: &'a mut dyn Write,
    hasher: blake3::Hasher,
}

impl Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(test)]
mod tests;

//! How far the reading of a file is.

use std::sync::atomic::{AtomicUsize, Ordering};

/// What is being done while a scene is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loading<'a> {
    /// A mesh file is read: bytes that were understood, of all.
    Reading {
        /// The file as the messages name it.
        file: &'a str,
        /// Bytes done.
        done: usize,
        /// Bytes in all.
        total: usize,
    },
    /// A mesh of so many triangles is checked and gets its tree.
    Building {
        /// Its triangles.
        triangles: usize,
    },
}

/// Is told how far loading is, from any thread, some thousand times for a
/// large file and a few times for a small one.
pub type Watch<'a> = &'a (dyn Fn(Loading<'_>) + Sync);

/// Bytes between two messages.
const STEP: usize = 1 << 20;

/// Counts the bytes of one file.
pub(super) struct Progress<'a> {
    watch: Watch<'a>,
    file: &'a str,
    total: usize,
    done: AtomicUsize,
}

impl<'a> Progress<'a> {
    pub(super) fn new(watch: Watch<'a>, file: &'a str, total: usize) -> Self {
        Self {
            watch,
            file,
            total,
            done: AtomicUsize::new(0),
        }
    }

    /// So many more bytes are done. Only the messages depend on the order in
    /// which threads come here.
    pub(super) fn advance(&self, bytes: usize) {
        let before = self.done.fetch_add(bytes, Ordering::Relaxed);
        let done = (before + bytes).min(self.total);
        if before / STEP != done / STEP || done == self.total {
            (self.watch)(Loading::Reading {
                file: self.file,
                done,
                total: self.total,
            });
        }
    }
}

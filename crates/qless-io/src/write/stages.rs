//! The hidden folders in which new files wait, known in one place so that a program that ends at once can remove them.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempDir;

static KNOWN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes all files that wait for their place. For a program that is about to end; waits for nobody.
pub fn abandon() {
    if let Ok(known) = KNOWN.try_lock() {
        known.iter().for_each(|path| drop(std::fs::remove_dir_all(path)));
    }
}

fn known() -> MutexGuard<'static, Vec<PathBuf>> {
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A hidden folder in another, removed when dropped.
#[derive(Debug)]
pub(super) struct Stage(TempDir);

impl Stage {
    pub fn new(folder: &Path) -> io::Result<Self> {
        // Room first: a folder that nobody knows could stay behind.
        known().reserve(1);
        let stage = tempfile::Builder::new().prefix(".qless-").tempdir_in(folder)?;
        known().push(stage.path().to_path_buf());
        Ok(Self(stage))
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        known().retain(|known| known != self.0.path());
    }
}

//! Systems of known rank in folders: the small ones of this repository, and those that `QLESS_CORPUS` names.
//!
//! Without `QLESS_CORPUS` a test that needs the larger ones fails; `QLESS_CORPUS=none` skips them with a message.
#![allow(dead_code, reason = "each test binary uses a part")]

use std::path::{Path, PathBuf};

pub use qless_scenes::corpus::larger;

/// A folder of the corpus in this repository.
pub fn small(part: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(part)
}

/// The case folders of a kind, ascending: `cases` are in this repository and in the larger corpus, other kinds in the larger corpus only.
pub fn folders(part: &str) -> Vec<PathBuf> {
    let here = (part == "cases").then(|| small(part));
    here.into_iter().chain(larger().map(|corpus| corpus.join(part))).flat_map(|folder| inside(&folder)).collect()
}

fn inside(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut folders: Vec<_> = entries.map(|entry| entry.expect("readable").path()).filter(|p| p.is_dir()).collect();
    assert!(!folders.is_empty(), "{}: no case", folder.display());
    folders.sort();
    folders
}

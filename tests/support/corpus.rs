//! Systems of known rank in folders: the small ones of this repository, and those that `QLESS_CORPUS` names.
//!
//! Without `QLESS_CORPUS` a test that needs the larger ones fails; `QLESS_CORPUS=none` leaves them out, aloud.
#![allow(dead_code, reason = "each test binary uses a part")]

use std::path::{Path, PathBuf};

/// The folder of the larger corpus; none only where that was said.
pub fn larger() -> Option<PathBuf> {
    let said = std::env::var_os("QLESS_CORPUS");
    let folder = said.expect(
        "QLESS_CORPUS is not set: it names the folder that holds cases/, extremes/ and decks/; say QLESS_CORPUS=none to leave those out",
    );
    if folder == "none" {
        eprintln!("SKIPPED: the larger corpus (QLESS_CORPUS=none)");
        return None;
    }
    Some(folder.into())
}

/// A folder of the corpus in this repository.
pub fn small(part: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(part)
}

/// The case folders of a part, ascending: `cases` of this repository and of the larger corpus, other parts of the larger one.
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

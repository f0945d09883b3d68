//! The fuzz targets pass on all kept inputs and on their seeds.

use std::path::{Path, PathBuf};

#[path = "../../../fuzz/src/lib.rs"]
mod fuzz;

/// Runs every file of `fuzz/corpus/TARGET` and `fuzz/seeds/TARGET`.
fn replay(target: &str, run: impl Fn(&[u8])) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let inputs: Vec<PathBuf> =
        ["seeds", "corpus"].iter().flat_map(|kind| files(&root.join(kind).join(target))).collect();
    assert!(!inputs.is_empty(), "no inputs of {target}");
    for path in inputs {
        println!("{}", path.display());
        run(&std::fs::read(&path).expect("read"));
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

#[test]
fn case_folders() {
    replay("case", fuzz::case);
}

#[test]
fn case_folders_by_their_meaning() {
    replay("folder", fuzz::folder);
}

#[test]
fn calculix_decks() {
    replay("calculix", fuzz::calculix);
}

#[test]
fn nastran_decks() {
    replay("nastran", fuzz::nastran);
}

#[test]
fn ansys_decks() {
    replay("ansys", fuzz::ansys);
}
